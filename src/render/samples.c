/* Copies a group's results to its lanes of the wave. */
#include "render/samples.h"

#include "wave/fill.h"
#include "wave/gather.h"

void samples_background(int n, vec3 color, bool layers, samples *o)
{
    fill_vec3s(n, (real)color.x, (real)color.y, (real)color.z, &o->rgb);
    if (!layers)
        return;
    fill(n, REAL_FAR, o->depth);
    fill_vec3s(n, 0, 0, 0, &o->position);
    fill_vec3s(n, 0, 0, 0, &o->normal);
    fill(n, 0, o->u);
    fill(n, 0, o->w);
    fill(n, 0, o->height);
    fill(n, 0, o->tau);
    fill_ids(n, -1, o->order);
}

STAGE static void bound(int n, real *restrict v)
{
    for (int i = 0; i < n; i++)
        v[i] = real_max(real_min(v[i], REAL_FAR), -REAL_FAR);
}

/* The number of colours that may have something to bound: a look costs a fifth of bounding all. */
STAGE static int count_bright(int n, const real *restrict x, const real *restrict y, const real *restrict z)
{
    int far = 0;
    for (int i = 0; i < n; i++)
        far += REAL_IS_FAR(real_abs(x[i]) + real_abs(y[i]) + real_abs(z[i]));
    return far;
}

void samples_bound(int n, vec3s *rgb)
{
    if (count_bright(n, rgb->x, rgb->y, rgb->z) == 0)
        return;
    bound(n, rgb->x);
    bound(n, rgb->y);
    bound(n, rgb->z);
}

void samples_dark(int n, real *visibility) { fill(n, 0, visibility); }

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
