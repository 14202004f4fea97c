/* The way of a ray, as the paper has it:
 *
 *     wave -> nearest hit with the smooth surfaces -> for the lanes on each surface:
 *     Q and its partials -> P and its partials -> n' -> the shift tau (none, 0, 1, 2 ...)
 *     -> shadow rays from r + s t0 -> light at Q with n'
 */
#include "trace.h"

#include "lane.h"
#include "shade.h"
#include "shift.h"
#include "wave_stages.h"

/* Where shadow rays start, and how far they go: the segments r + s t, 0 < t < 1, from
 *     the smooth hit p1                 to the light, for the receiver's own smooth surface, which is left out at t = 0 by
 *                                       its own methods, and
 *     the shifted hit r + s (t_hit+tau) to the light, for every other object.
 * No offset is added to either: it would shorten each shadow by offset/tan(elevation), and P is small, too. */
STAGE static void aim(group *restrict g, const light *l, int shifted)
{
    const real lx = (real)l->at.x, ly = (real)l->at.y, lz = (real)l->at.z;
    for (int i = 0; i < g->n; i++) {
        bs_vec3 o = lane_at(&g->x, i, shifted ? g->t[i] + g->tau[i] : g->t[i]), d = {lx - o.x, ly - o.y, lz - o.z};
        lane_set(&g->to_light.r, i, o);
        lane_set(&g->to_light.s, i, d);
    }
}

static void shadow(const scene *sc, int id, const light *l, group *g, stats *st)
{
    const surface *own = sc->object[id].shape;
    for (int i = 0; i < g->n; i++)
        g->lit[i] = 1;
    if (own->is->occlude_own) {
        aim(g, l, 0);
        own->is->occlude_own(own, g->n, &g->to_light, g->part, g->lit);
    }
    aim(g, l, 1);
    for (int k = 0; k < sc->objects; k++)
        if (k != id) {
            const surface *f = sc->object[k].shape;
            f->is->occlude(f, g->n, &g->to_light, g->lit);
        }
    st->shadow_rays += g->n;
}

void trace_group(const tracer *k, int id, workspace *v)
{
    const scene *sc = k->scene;
    const object *o = &sc->object[id];
    const surface *f = o->shape;
    const perturb *P = o->bump;
    const material *m = &sc->material[o->material];
    const bool bends = P && method_bends(k->shadow);
    group *g = &v->g;
    stats *st = &v->stats;

    f->is->locate(f, g->n, &g->x, g->t, g->part, g->u, g->w);
    f->is->eval(f, g->n, g->part, g->u, g->w, bends ? 2 : 1, &g->q);
    stats_stage(st, STAGE_SURFACE);
    if (P) {
        P->is->eval(P, g->n, g->u, g->w, method_order(k->shadow), &g->h);
        st->heights += g->n;
    }
    stats_stage(st, STAGE_BUMP);
    shift_normals(g, P);
    stats_stage(st, STAGE_NORMAL);
    st->heights += shift_group(g, P, k->shadow, k->guard);
    stats_stage(st, STAGE_SHIFT);
    shade_ambient(g, m);
    for (int l = 0; l < sc->lights; l++) {
        shadow(sc, id, &sc->light[l], g, st);
        stats_stage(st, STAGE_SHADOW);
        shade_light(g, m, &sc->light[l]);
        stats_stage(st, STAGE_SHADE);
        if (k->layers)
            wave_scatter_visibility(g, v->visibility[l]);
    }
    if (P)
        stats_orders(st, g->n, g->order, method_code(k->shadow));
}

int32_t trace_nearest(const tracer *k, int n, workspace *v)
{
    const scene *sc = k->scene;
    wave_start(n, &v->h);
    for (int32_t id = 0; id < sc->objects; id++)
        sc->object[id].shape->is->hit(sc->object[id].shape, n, &v->x, id, &v->h);
    v->stats.rays += n;
    stats_stage(&v->stats, STAGE_HIT);
    return wave_next_group(n, &v->x, &v->h, &v->g);
}

void trace(const tracer *k, int n, workspace *v)
{
    const scene *sc = k->scene;
    int32_t id = trace_nearest(k, n, v);
    wave_background(n, sc->background, k->layers ? sc->lights : 0, v);
    for (; id >= 0; id = wave_next_group(n, &v->x, &v->h, &v->g)) {
        stats_stage(&v->stats, STAGE_SORT);
        trace_group(k, id, v);
        wave_scatter(&v->g, k->layers, sc->object[id].bump != NULL, &v->out);
        stats_stage(&v->stats, STAGE_SORT);
    }
}
