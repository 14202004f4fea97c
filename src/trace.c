/* The way of a ray, as the paper has it:
 *
 *     wave -> nearest hit with the smooth surfaces -> for the lanes on each surface:
 *     Q and its partials -> P and its partials -> n' -> the shift tau (none, 0, 1, 2 ...)
 *     -> shadow rays from r + s t0 -> light at Q with n'
 *
 * For comparison, rough surfaces can be met where they really are (displace.h) in place of the smooth ones.
 */
#include "trace.h"

#include <string.h>

#include "displace.h"
#include "lane.h"
#include "light.h"
#include "shade.h"
#include "shift.h"
#include "wave_stages.h"

/* Whether an object is taken for its displaced surface. */
static bool is_rough(const tracer *k, const object *o) { return k->displaced && o->bump; }

/* A rough surface that is turned away from the light is dark; from where it is not, the way to the light is searched. */
static void shadow_rough(const object *o, const light *l, group *g, stats *st)
{
    light_aim(l, g, false);
    for (int i = 0; i < g->n; i++) {
        bs_vec3 n = lane_get(&g->n_smooth, i);
        bool lit = bs_dot(n, lane_get(&g->to_light.s, i)) * bs_dot(n, lane_get(&g->x.s, i)) < 0;
        g->lit[i] = lit ? g->lit[i] : 0;
    }
    displace_occlude(o->shape, o->bump, g->n, &g->to_light, g->part, g->lit, &st->displaced);
}

/* Whether an object casts shadows. */
static bool casts(const tracer *k, const object *o) { return k->self_shadow || !o->bump; }

/* The receiver's own shadow on itself. */
static void shadow_own(const tracer *k, const object *o, const light *l, group *g, stats *st)
{
    if (is_rough(k, o)) {
        shadow_rough(o, l, g, st);
    } else if (o->shape->is->occlude_own) {
        light_aim(l, g, false);
        o->shape->is->occlude_own(o->shape, g->n, &g->to_light, g->part, g->lit);
    }
}

/* Which lanes of object `id` a light of one place shines on. The segments to it are r + s t, 0 < t < 1, from
 *     the smooth hit p1                 for the receiver's own smooth surface, which is left out at t = 0 by its own methods, and
 *     the shifted hit r + s (t_hit+tau) for every other object. */
static void shadow_one(const tracer *k, int id, const light *l, group *g, stats *st)
{
    const scene *sc = k->scene;
    for (int i = 0; i < g->n; i++)
        g->lit[i] = 1;
    if (casts(k, &sc->object[id]))
        shadow_own(k, &sc->object[id], l, g, st);
    light_aim(l, g, true);
    for (int j = 0; j < sc->objects; j++) {
        const object *o = &sc->object[j];
        if (j == id || !casts(k, o))
            continue;
        if (!is_rough(k, o))
            o->shape->is->occlude(o->shape, g->n, &g->to_light, g->lit);
        else
            displace_occlude(o->shape, o->bump, g->n, &g->to_light, NULL, g->lit, &st->displaced);
    }
    st->shadow_rays += g->n;
}

/* The share of a light that is seen: of an area, the samples that are. */
static void shadow(const tracer *k, int id, const light *l, group *g, stats *st)
{
    const int places = l->samples[0] * l->samples[1];
    if (places == 1) {
        shadow_one(k, id, l, g, st);
        return;
    }
    real sum[LANES] = {0}, share;
    for (int j = 0; j < places; j++) {
        const light one = light_sample(l, j, &share);
        shadow_one(k, id, &one, g, st);
        light_gather(g, share, sum);
    }
    memcpy(g->lit, sum, sizeof sum);
}

/* Where a group's lanes are on their surface, P there, n and n', and how far the shadow rays' origin is shifted. */
static void shape_and_shift(const tracer *k, const object *o, group *g, stats *st)
{
    const surface *f = o->shape;
    const perturb *P = o->bump;
    f->is->locate(f, g->n, &g->x, g->t, g->part, g->u, g->w);
    f->is->eval(f, g->n, g->part, g->u, g->w, P && method_bends(k->shadow) ? 2 : 1, &g->q);
    stats_stage(st, STAGE_SURFACE);
    if (P) {
        P->is->eval(P, g->n, g->u, g->w, method_order(k->shadow), &g->h);
        st->heights += g->n;
    }
    stats_stage(st, STAGE_BUMP);
    shift_normals(g, P);
    stats_stage(st, STAGE_NORMAL);
    if (P && k->shadow.kind == METHOD_EXACT)
        displace_shift(f, P, g, &st->displaced);
    else
        st->heights += shift_group(g, P, k->shadow, k->guard);
    stats_stage(st, STAGE_SHIFT);
}

void trace_group(const tracer *k, int id, workspace *v)
{
    const scene *sc = k->scene;
    const object *o = &sc->object[id];
    const material *m = &sc->material[o->material];
    group *g = &v->g;
    stats *st = &v->stats;

    if (is_rough(k, o)) {
        displace_shape(o->shape, o->bump, g);
        stats_stage(st, STAGE_SURFACE);
    } else
        shape_and_shift(k, o, g, st);
    if (o->color)
        o->color->is->eval(o->color, g->n, g->u, g->w, &g->color);
    shade_ambient(g, m);
    for (int l = 0; l < sc->lights; l++) {
        shadow(k, id, &sc->light[l], g, st);
        stats_stage(st, STAGE_SHADOW);
        if (k->layers)
            wave_scatter_visibility(g, v->visibility[l]);
        light_fade(&sc->light[l], g);
        shade_light(g, m, &sc->light[l]);
        stats_stage(st, STAGE_SHADE);
    }
    if (o->bump)
        stats_orders(st, g->n, g->order, is_rough(k, o) ? ORDER_EXACT : method_code(k->shadow));
}

int32_t trace_nearest(const tracer *k, int n, workspace *v)
{
    const scene *sc = k->scene;
    wave_start(n, &v->h);
    for (int32_t id = 0; id < sc->objects; id++) {
        const object *o = &sc->object[id];
        if (is_rough(k, o))
            displace_hit(o->shape, o->bump, n, &v->x, id, &v->h, &v->stats.displaced);
        else
            o->shape->is->hit(o->shape, n, &v->x, id, &v->h);
    }
    v->stats.rays += n;
    stats_stage(&v->stats, STAGE_HIT);
    return wave_next_group(n, &v->x, &v->h, &v->g);
}

void trace(const tracer *k, int n, workspace *v)
{
    const scene *sc = k->scene;
    int32_t id = trace_nearest(k, n, v);
    wave_background(n, sc->background, k->layers, sc->lights, v);
    for (; id >= 0; id = wave_next_group(n, &v->x, &v->h, &v->g)) {
        stats_stage(&v->stats, STAGE_SORT);
        trace_group(k, id, v);
        wave_scatter(&v->g, k->layers, sc->object[id].bump != NULL, &v->out);
        stats_stage(&v->stats, STAGE_SORT);
    }
}
