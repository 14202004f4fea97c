/* Copies a group's results to its lanes of the wave. */
#include "render/samples.h"

#include "wave/gather.h"

STAGE static void fill(int n, real *v, real x)
{
    for (int i = 0; i < n; i++)
        v[i] = x;
}

void samples_background(int n, vec3 color, bool layers, samples *o)
{
    vec3s_fill(&o->rgb, n, (real)color.x, (real)color.y, (real)color.z);
    if (!layers)
        return;
    fill(n, o->depth, (real)HUGE_VAL);
    vec3s_fill(&o->position, n, 0, 0, 0);
    vec3s_fill(&o->normal, n, 0, 0, 0);
    fill(n, o->u, 0);
    fill(n, o->w, 0);
    fill(n, o->height, 0);
    fill(n, o->tau, 0);
    for (int i = 0; i < n; i++)
        o->order[i] = -1;
}

void samples_dark(int n, real *visibility) { fill(n, visibility, 0); }

STAGE static void brightness(const hit_group *restrict g, real *restrict v)
{
    for (int i = 0; i < g->n; i++)
        v[i] = g->lit[i] * ((g->tint.x[i] + g->tint.y[i] + g->tint.z[i]) / 3);
}

void samples_put_visibility(const hit_group *g, bool tinted, real *visibility)
{
    real v[LANES];
    if (tinted)
        brightness(g, v);
    scatter(g, tinted ? v : g->lit, visibility);
}

void samples_put(const hit_group *g, bool layers, bool bumped, samples *o)
{
    scatter_vec3s(g, &g->rgb, &o->rgb);
    if (!layers)
        return;
    scatter(g, g->t_shade, o->depth);
    scatter_vec3s(g, &g->q.Q, &o->position);
    scatter_vec3s(g, &g->n_bump, &o->normal);
    scatter(g, g->u, o->u);
    scatter(g, g->w, o->w);
    if (bumped)
        scatter(g, g->bump.P, o->height);
    scatter(g, g->tau, o->tau);
    for (int i = 0; i < g->n; i++)
        o->order[hit_group_place(g, i)] = g->order[i];
}
