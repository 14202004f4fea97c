/* The way of a ray, as the paper has it:
 *
 *     wave -> nearest hit with the smooth surfaces -> for the lanes on each surface:
 *     Q and its partials -> P and its partials -> n' -> the shift tau (none, 0, 1, 2 ...)
 *     -> shadow rays from r + s t0 -> light at Q with n'
 *
 * Where the surface mirrors or lets light through, further waves go on from r + s t0 by n' (secondary.h), and come the
 * same way.
 *
 * For comparison, rough surfaces can be met where they really are (displace.h) in place of the smooth ones.
 */
#include "render/trace.h"

#include <string.h>

#include "scene/object_bvh.h"
#include "displaced/march.h"
#include "render/transmittance.h"
#include "wave/lane.h"
#include "scene/light.h"
#include "render/shade.h"
#include "method/shift.h"
#include "wave/gather.h"

/* Whether an object is taken for its displaced surface. */
static bool is_rough(const tracer *k, const object *o) { return k->displaced && o->bump; }

/* A rough surface that is turned away from the light is dark; from where it is not, the way to the light is searched.
 */
static void shadow_turned(const light *l, hit_group *g)
{
    light_aim(l, g, false);
    for (int i = 0; i < g->n; i++) {
        bs_vec3 n = lane_get(&g->n_smooth, i);
        bool lit = bs_dot(n, lane_get(&g->to_light.s, i)) * bs_dot(n, lane_get(&g->x.s, i)) < 0;
        g->lit[i] = lit ? g->lit[i] : 0;
    }
}

/* Whether an object casts shadows. */
static bool casts(const tracer *k, const object *o) { return k->self_shadow || !o->bump; }

/* Whether an object lets some light through. */
static bool is_clear(const tracer *k, const object *o) { return material_clear(&k->scene->material[o->material]); }

/* The receiver's own shadow on itself. */
static void shadow_own(const tracer *k, int id, const light *l, hit_group *g, stats *st)
{
    const object *o = &k->scene->object[id];
    if (is_rough(k, o)) {
        shadow_turned(l, g);
        if (!is_clear(k, o))
            displaced_occlude(o->shape, o->bump, g->n, &g->to_light, g->part, g->lit, &st->displaced);
        else
            transmittance_light(k, id, true, g, st);
    } else if (is_clear(k, o)) {
        light_aim(l, g, false);
        transmittance_light(k, id, true, g, st);
    } else if (o->shape->ops->occlude_own) {
        light_aim(l, g, false);
        o->shape->ops->occlude_own(o->shape, g->n, &g->to_light, g->part, g->lit);
    }
}

/* Put lit[i] = 0 where an opaque object lies across the segment. */
static void block(const tracer *k, const object *o, int n, const rays *x, real *lit, stats *st)
{
    if (!is_rough(k, o))
        o->shape->ops->occlude(o->shape, n, x, lit);
    else
        displaced_occlude(o->shape, o->bump, n, x, NULL, lit, &st->displaced);
}

/* The same for some lanes of a group. */
static void block_some(const tracer *k, const object *o, int n, const int32_t *lane, hit_group *g, stats *st)
{
    rays x;
    real lit[LANES];
    gather_rays(n, lane, &g->to_light, &x);
    for (int i = 0; i < n; i++)
        lit[i] = g->lit[lane[i]];
    block(k, o, n, &x, lit, st);
    for (int i = 0; i < n; i++)
        g->lit[lane[i]] = lit[i];
}

/* The objects that a group's segments to the light may meet; what is dark already need not be searched. */
static void meet_lit(const object_bvh *c, const hit_group *g, candidates *m)
{
    real end[LANES];
    for (int i = 0; i < g->n; i++)
        end[i] = g->lit[i] > 0 ? R(1) : R(-1);
    object_bvh_find(c, g->n, &g->to_light, end, NULL, m);
}

/* The next object after `after` that is to be tried. */
static int32_t next_object(const scene *s, const candidates *m, int32_t after)
{
    return s->object_bvh ? candidates_next(m, after) : after + 1 < s->objects ? after + 1 : -1;
}

/* Which lanes of object `id` a light of one place shines on. The segments to it are r + s t, 0 < t < 1, from
 *     the smooth hit p1                 for the receiver's own smooth surface, which is left out at t = 0 by its own
 * methods, and the shifted hit r + s (t_hit+tau) for every other object. */
static void shadow_one(const tracer *k, int id, const light *l, hit_group *g, candidates *m, stats *st)
{
    const scene *sc = k->scene;
    int32_t lane[LANES];
    for (int i = 0; i < g->n; i++)
        g->lit[i] = 1;
    if (sc->clear)
        transmittance_begin(g);
    if (casts(k, &sc->object[id]))
        shadow_own(k, id, l, g, st);
    light_aim(l, g, true);
    if (sc->object_bvh)
        meet_lit(sc->object_bvh, g, m);
    for (int32_t j = next_object(sc, m, -1); j >= 0; j = next_object(sc, m, j)) {
        const object *o = &sc->object[j];
        if (j == id || !casts(k, o))
            continue;
        if (is_clear(k, o))
            transmittance_light(k, j, false, g, st);
        else if (sc->object_bvh)
            block_some(k, o, candidates_rays(m, j, lane), lane, g, st);
        else
            block(k, o, g->n, &g->to_light, g->lit, st);
    }
    st->shadow_rays += g->n;
}

/* The share of a light that is seen: of an area, the samples that are. */
static void shadow(const tracer *k, int id, const light *l, hit_group *g, candidates *m, stats *st)
{
    const int places = l->samples[0] * l->samples[1];
    if (places == 1) {
        shadow_one(k, id, l, g, m, st);
        return;
    }
    const bool tinted = k->scene->clear;
    real sum[LANES] = {0}, share;
    vec3s colors = {{0}, {0}, {0}};
    for (int j = 0; j < places; j++) {
        const light one = light_sample(l, j, &share);
        shadow_one(k, id, &one, g, m, st);
        if (tinted)
            light_gather_tint(g, share, &colors);
        else
            light_gather(g, share, sum);
    }
    if (tinted) {
        g->tint = colors;
        for (int i = 0; i < g->n; i++)
            g->lit[i] = 1;
    } else
        memcpy(g->lit, sum, sizeof sum);
}

/* Where a group's lanes are on their surface, P there, n and n', and how far the shadow rays' origin is shifted. */
static void shape_and_shift(const tracer *k, const object *o, hit_group *g, stats *st)
{
    const surface *f = o->shape;
    const bump *P = o->bump;
    f->ops->locate(f, g->n, &g->x, g->t, g->part, g->u, g->w);
    f->ops->eval(f, g->n, g->part, g->u, g->w, P && method_bends(k->shadow) ? 2 : 1, &g->q);
    stats_stage(st, STAGE_SURFACE);
    if (P) {
        P->ops->eval(P, g->n, g->u, g->w, method_order(k->shadow), &g->h);
        st->evaluations += g->n;
    }
    stats_stage(st, STAGE_BUMP);
    shift_normals(g, P);
    stats_stage(st, STAGE_NORMAL);
    if (P && k->shadow.kind == METHOD_EXACT)
        displaced_shift(f, P, g, &st->displaced);
    else
        st->evaluations += shift_group(g, P, k->shadow, k->guard);
    stats_stage(st, STAGE_SHIFT);
}

void trace_group(const tracer *k, int id, workspace *v)
{
    const scene *sc = k->scene;
    const object *o = &sc->object[id];
    const material *m = &sc->material[o->material];
    hit_group *g = &v->g;
    stats *st = &v->stats;

    if (is_rough(k, o)) {
        displaced_shape(o->shape, o->bump, g);
        stats_stage(st, STAGE_SURFACE);
    } else
        shape_and_shift(k, o, g, st);
    if (v->of)
        shift_within(g);
    if (o->color)
        o->color->ops->eval(o->color, g->n, g->u, g->w, &g->color);
    shade_ambient(g, m);
    for (int l = 0; l < sc->lights; l++) {
        shadow(k, id, &sc->light[l], g, v->candidates, st);
        stats_stage(st, STAGE_SHADOW);
        if (k->layers)
            scatter_visibility(g, sc->clear, v->visibility[l]);
        light_fade(&sc->light[l], g);
        shade_light(g, m, &sc->light[l], sc->clear);
        stats_stage(st, STAGE_SHADE);
    }
    if (o->bump)
        stats_orders(st, g->n, g->order, is_rough(k, o) ? ORDER_EXACT : method_code(k->shadow));
}

void trace_hit(const tracer *k, int32_t id, int n, const rays *x, const ray_origins *from, hits *h, stats *st)
{
    const object *o = &k->scene->object[id];
    if (is_rough(k, o))
        displaced_hit(o->shape, o->bump, n, x, from, id, h, &st->displaced);
    else if (from)
        o->shape->ops->hit_own(o->shape, n, x, from, id, h);
    else
        o->shape->ops->hit(o->shape, n, x, id, h);
}

/* The same for some of the rays. */
static void hit_some(const tracer *k, int32_t id, int n, const int32_t *lane, const rays *x, const ray_origins *from,
                     hits *h, stats *st)
{
    rays y;
    ray_origins begin;
    hits some;
    gather_rays(n, lane, x, &y);
    if (from)
        gather_ray_origins(n, lane, from, &begin);
    for (int i = 0; i < n; i++) {
        some.t[i] = h->t[lane[i]];
        some.id[i] = h->id[lane[i]];
        some.part[i] = h->part[lane[i]];
    }
    trace_hit(k, id, n, &y, from ? &begin : NULL, &some, st);
    for (int i = 0; i < n; i++) {
        h->t[lane[i]] = some.t[i];
        h->id[lane[i]] = some.id[i];
        h->part[lane[i]] = some.part[i];
    }
}

int32_t trace_nearest(const tracer *k, int n, workspace *v)
{
    const scene *sc = k->scene;
    gather_begin(n, &v->h);
    const ray_origins *from = v->of ? &v->of->from : NULL;
    int32_t lane[LANES];
    if (sc->object_bvh)
        object_bvh_find(sc->object_bvh, n, &v->x, v->h.t, from ? from->id : NULL, v->candidates);
    for (int32_t id = next_object(sc, v->candidates, -1); id >= 0; id = next_object(sc, v->candidates, id)) {
        const int some = sc->object_bvh ? candidates_rays(v->candidates, id, lane) : n;
        if (some < n)
            hit_some(k, id, some, lane, &v->x, from, &v->h, &v->stats);
        else
            trace_hit(k, id, n, &v->x, from, &v->h, &v->stats);
    }
    if (v->of)
        gather_move_origins(n, &v->of->from, &v->h, &v->x);
    *(v->of ? &v->stats.secondary_rays : &v->stats.rays) += n;
    stats_stage(&v->stats, STAGE_HIT);
    return gather_next_group(n, &v->x, &v->h, &v->g);
}

void trace(const tracer *k, int n, workspace *v)
{
    const scene *sc = k->scene;
    int32_t id = trace_nearest(k, n, v);
    gather_background(n, sc->background, k->layers, sc->lights, v);
    secondary_begin(v);
    for (; id >= 0; id = gather_next_group(n, &v->x, &v->h, &v->g)) {
        stats_stage(&v->stats, STAGE_SORT);
        trace_group(k, id, v);
        scatter_samples(&v->g, k->layers, sc->object[id].bump != NULL, &v->out);
        if (sc->sends)
            secondary_send(k, id, v);
        stats_stage(&v->stats, STAGE_SORT);
    }
    if (sc->sends)
        secondary_follow(k, v);
}
