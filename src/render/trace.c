/* A wave of rays from the eye to the light, in the paper's steps:
 *
 *     wave -> nearest hit with the smooth surfaces -> for the lanes on each surface:
 *     Q and its partials -> P and its partials -> n' -> the shift tau (none, 0, 1, 2 ...)
 *     -> the place that is shaded, Q or r + s t0 -> shadow rays from r + s t0 -> light there with n'
 *
 * Mirrors and transparent materials send secondary waves from r + s t0 by n' (secondary.h), which are traced by the
 * same steps. For comparison, rays can meet displaced surfaces (displaced.h), which need no shift.
 */
#include "render/trace.h"

#include "light/lighting.h"
#include "light/shade.h"
#include "method/shift.h"
#include "render/bumps.h"
#include "render/intersect.h"
#include "render/place.h"
#include "render/shadow.h"
#include "render/tau.h"
#include "wave/gather.h"

/* The smooth hit Q and its partials; P and its partials, a map's by bilinear interpolation of differences
 * (texture/bump_map.c); n' (bs_perturbed_normal); and tau (tau.h; the paper's by bs_tau0, bs_tau1 and bs_tau2). The
 * guard keeps tau within the slab of P (bs_slab_of). */
static void shape_and_shift(const tracer *tr, int32_t id, workspace *v)
{
    const surface *f = v->surface[id];
    const bump *P = tr->scene->object[id].bump;
    hit_group *g = &v->g;
    stats *st = v->stats;
    g->undefined = 0;
    g->flat = f->ops->flat;
    f->ops->locate(f, g->n, g->x, g->t, g->part, g->u, g->w);
    f->ops->eval(f, g->n, g->part, g->u, g->w, tau_partials(tr, id, v), &g->q);
    stats_stage(st, STAGE_SURFACE);
    if (P) {
        P->ops->eval(P, g->n, g->u, g->w, method_order(tr->shadow), &g->bump);
        st->evaluations += g->n;
    }
    stats_stage(st, STAGE_BUMP);
    shift_normals(g, P);
    stats_stage(st, STAGE_NORMAL);
    tau_find(tr, id, v);
    stats_stage(st, STAGE_SHIFT);
}

static void shape_displaced(int32_t id, workspace *v)
{
    v->alone = false;
    v->g.undefined = 0;
    displaced_shape(v->surface[id], &v->g);
    stats_orders(v->stats, v->g.n, v->g.order, ORDER_EXACT);
    stats_stage(v->stats, STAGE_SURFACE);
}

/* The light that object `id` sends to the eye. */
static void light_group(const tracer *tr, int32_t id, workspace *v)
{
    const scene *s = tr->scene;
    const object *o = &s->object[id];
    const material *m = &s->material[o->material];
    hit_group *g = &v->g;
    const bool own = bumps_cast(tr, id, v);
    if (o->color)
        o->color->ops->eval(o->color, g->n, g->u, g->w, &g->color);
    shade_ambient(g, m);
    for (int l = 0; l < s->lights && (l == 0 || pulse_beats(v->pulse)); l++) {
        shadow_light(tr, id, &s->light[l], v);
        stats_stage(v->stats, STAGE_SHADOW);
        if (tr->layers)
            samples_put_visibility(g, s->clear, v->visibility[l]);
        lighting_fade(&s->light[l], g);
        shade_light(g, m, &s->light[l], s->clear, !own);
        stats_stage(v->stats, STAGE_SHADE);
    }
}

void trace_group(const tracer *tr, int32_t id, workspace *v)
{
    if (displaced_is(v->surface[id]))
        shape_displaced(id, v);
    else
        shape_and_shift(tr, id, v);
    if (v->of || (tr->guard && tr->scene->object[id].bump))
        shift_within(&v->g);
    shift_origins(&v->g);
    place_find(tr, id, v);
    if (v->g.undefined)
        stats_undefined(v->stats, id, v->g.undefined);
    light_group(tr, id, v);
}

/* Trace a queue of secondary rays, after which `left` more may follow, and add their light. A ray straight through a
 * surface does not count as one more, as in POV-Ray; it is traced in the same workspace, in a loop. */
static void follow(const tracer *tr, ray_queue *q, int left, workspace *v)
{
    workspace *d = v->deeper;
    tracer inner = *tr;
    inner.layers = false;
    for (int times = 0; q->n > 0 && times < STRAIGHTS && pulse_beats(v->pulse); times++) {
        d->of = q;
        d->left = left;
        d->x = q->x;
        trace(&inner, q->n, d);
        secondary_add(q, &d->out.rgb, &v->out.rgb);
        secondary_go_on(&d->straight, q);
    }
}

static void follow_all(const tracer *tr, workspace *v)
{
    if (v->left == 0)
        return;
    follow(tr, &v->reflected, v->left - 1, v);
    follow(tr, &v->refracted, v->left - 1, v);
    if (!v->of) /* for secondary waves the loop in follow() does it */
        follow(tr, &v->straight, v->left, v);
}

void trace(const tracer *tr, int n, workspace *v)
{
    const scene *s = tr->scene;
    intersect_nearest(s, n, v);
    stats_stage(v->stats, STAGE_HIT);
    int left = gather_hits(n, &v->nearest);
    if (left < n || tr->layers)
        samples_background(n, s->background, tr->layers, &v->out);
    for (int l = 0; tr->layers && l < s->lights; l++)
        samples_dark(n, v->visibility[l]);
    secondary_begin(v);
    for (; left > 0; left -= v->g.n) {
        const int32_t id = gather_next_group(n, &v->x, &v->nearest, &v->g);
        stats_stage(v->stats, STAGE_SORT);
        trace_group(tr, id, v);
        samples_put(&v->g, tr->layers, s->object[id].bump != NULL, &v->out);
        if (s->sends)
            secondary_send(s, id, v);
        stats_stage(v->stats, STAGE_SORT);
        if (left > v->g.n && !pulse_beats(v->pulse))
            break;
    }
    if (s->sends)
        follow_all(tr, v);
    samples_bound(n, &v->out.rgb);
}
