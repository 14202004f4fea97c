/* Shadows. The paper starts shadow rays at r + s t0 instead of at the smooth hit p1 = r + s t_hit (section 3: "the
 * shadow is computed from the intersection found anew"; section 6). kage does so for shadows of other objects. Its own
 * smooth shape would shadow a start that is shifted below it, so the object itself is tested from p1 (ours). Starts
 * have no offset: a surface's own test excludes the hit at t = 0.
 */
#include "render/shadow.h"

#include <string.h>

#include "render/intersect.h"
#include "scene/horizons.h"
#include "method/own_shadow.h"
#include "light/lighting.h"
#include "wave/gather.h"
#include "wave/lane.h"

/* ---- transparent objects ---- */

enum { CROSSINGS = 64 }; /* hits followed on one object; a ray with more is dark */

/* The shadow rays that are still followed, side by side; the light is at t = 1. */
typedef struct segments {
    int n;
    int32_t lane[LANES];
    rays x;
    ray_origins from;
    hits h;
    real u[LANES], w[LANES];
    vec3s color;
} segments;

static void begin_segments(const hit_group *g, int32_t id, bool own, segments *a)
{
    a->n = 0;
    for (int i = 0; i < g->n; i++) { /* without a branch */
        a->lane[a->n] = i;
        a->n += g->lit[i] > 0;
    }
    gather_rays(a->n, a->lane, &g->to_light, &a->x);
    a->from.at = a->x.r;
    for (int i = 0; i < a->n; i++) {
        a->from.id[i] = own ? id : -1;
        a->from.part[i] = g->part[a->lane[i]];
    }
}

/* Keep the rays that hit the surface; they start again from the hit. */
static void cross_surface(int32_t id, segments *a)
{
    int n = 0;
    for (int i = 0; i < a->n; i++) {
        if (a->h.id[i] < 0)
            continue;
        const real t = a->h.t[i];
        bs_vec3 at = lane_at(&a->x, i, t), s = lane_get(&a->x.s, i),
                rest = {s.x * (1 - t), s.y * (1 - t), s.z * (1 - t)};
        a->lane[n] = a->lane[i];
        lane_set(&a->x.r, n, at);
        lane_set(&a->x.s, n, rest);
        lane_set(&a->from.at, n, at);
        a->from.id[n] = id;
        a->from.part[n] = a->h.part[i];
        n++;
    }
    a->n = n;
}

static void tint(const material *m, const segments *a, hit_group *g)
{
    const real filter = (real)m->filter, transmit = (real)m->transmit;
    const bs_vec3 plain = {(real)m->color.x, (real)m->color.y, (real)m->color.z};
    for (int i = 0; i < a->n; i++) {
        const int at = a->lane[i];
        if (a->h.id[i] < 0)
            continue;
        bs_vec3 c = m->pattern ? lane_get(&a->color, i) : plain;
        g->tint.x[at] *= c.x * filter + transmit;
        g->tint.y[at] *= c.y * filter + transmit;
        g->tint.z[at] *= c.z * filter + transmit;
    }
}

/* Multiply v->g.tint by the transmittance of object `id` at each hit along g->to_light, without refraction, as in
 * POV-Ray. Rays with too many hits get g->lit = 0. own: the rays start on this object. */
static void follow_through(const scene *s, int32_t id, bool own, workspace *v)
{
    const object *o = &s->object[id];
    const material *m = &s->material[o->material];
    const surface *f = v->surface[id];
    segments a;
    begin_segments(&v->g, id, own, &a);
    for (int crossing = 0; crossing < CROSSINGS && a.n; crossing++) {
        for (int i = 0; i < a.n; i++) {
            a.h.t[i] = 1;
            a.h.id[i] = -1;
            a.h.part[i] = 0;
        }
        intersect_surface(f, a.n, &a.x, &a.from, id, &a.h);
        f->ops->locate(f, a.n, &a.x, a.h.t, a.h.part, a.u, a.w);
        if (o->color)
            o->color->ops->eval(o->color, a.n, a.u, a.w, &a.color);
        tint(m, &a, &v->g);
        cross_surface(id, &a);
    }
    for (int i = 0; i < a.n; i++)
        v->g.lit[a.lane[i]] = 0;
}

/* ---- all objects ---- */

bool shadow_casts(const tracer *tr, int32_t id) { return tr->self_shadow || !tr->scene->object[id].bump; }

static bool is_clear(const tracer *tr, int32_t id)
{
    return material_clear(&tr->scene->material[tr->scene->object[id].material]);
}

/* A displaced surface is dark where the light is on the other side than the viewer. */
static void darken_facing_away(hit_group *g)
{
    for (int i = 0; i < g->n; i++) {
        bs_vec3 n = lane_get(&g->n_smooth, i);
        bool lit = bs_dot(n, lane_get(&g->to_light.s, i)) * bs_dot(n, lane_get(&g->x.s, i)) < 0;
        g->lit[i] = lit ? g->lit[i] : 0;
    }
}

static void cast_own(const tracer *tr, int32_t id, workspace *v)
{
    const surface *f = v->surface[id];
    hit_group *g = &v->g;
    if (displaced_is(f))
        darken_facing_away(g);
    if (is_clear(tr, id))
        follow_through(tr->scene, id, true, v);
    else
        f->ops->occlude_own(f, g->n, &g->to_light, g->part, g->lit);
}

/* Another object's shadow on some lanes of the group. */
static void occlude_some(const surface *f, int n, const int32_t *lane, hit_group *g)
{
    rays x;
    real lit[LANES];
    gather_rays(n, lane, &g->to_light, &x);
    for (int i = 0; i < n; i++)
        lit[i] = g->lit[lane[i]];
    f->ops->occlude(f, n, &x, lit);
    for (int i = 0; i < n; i++)
        g->lit[lane[i]] = lit[i];
}

/* The objects that a group's shadow rays may hit. Lanes that are dark already are skipped. */
static void find_candidates(const object_bvh *c, const hit_group *g, candidates *m)
{
    real end[LANES];
    for (int i = 0; i < g->n; i++)
        end[i] = g->lit[i] > 0 ? R(1) : R(-1);
    object_bvh_find(c, g->n, &g->to_light, end, NULL, m);
}

static void cast_others(const tracer *tr, int32_t id, workspace *v)
{
    const scene *s = tr->scene;
    hit_group *g = &v->g;
    int32_t lane[LANES];
    if (v->candidates)
        find_candidates(s->object_bvh, g, v->candidates);
    for (int32_t j = intersect_next(s, v->candidates, -1); j >= 0; j = intersect_next(s, v->candidates, j)) {
        const surface *f = v->surface[j];
        if (j == id || !shadow_casts(tr, j))
            continue;
        if (is_clear(tr, j))
            follow_through(s, j, false, v);
        else if (v->candidates)
            occlude_some(f, candidates_rays(v->candidates, j, lane), lane, g);
        else
            f->ops->occlude(f, g->n, &g->to_light, g->lit);
    }
}

/* ---- the bumps' own shadows ---- */

enum { STEPS = 24 }; /* of the march where there is no horizon map */

bool shadow_is_own(const tracer *tr, int32_t id, const workspace *v)
{
    const bump *P = tr->scene->object[id].bump;
    return tr->bump_shadow.kind != BUMP_SHADOW_NONE && tr->self_shadow && P && P->Pmin < P->Pmax &&
           !displaced_is(v->surface[id]);
}

/* The ways from X to a light at one point. */
static void begin_ways(const tracer *tr, int32_t id, const light *l, workspace *v, own_ways *y)
{
    const surface *f = v->surface[id];
    double u[2] = {-REAL_FAR, REAL_FAR}, w[2] = {-REAL_FAR, REAL_FAR};
    if (f->ops->flat) /* all of its parts have the same extent */
        f->ops->extent(f, 0, u, w);
    lighting_aim_from(l, &v->g.rough, &v->g);
    own_begin(&v->g, tr->scene->object[id].bump, f->ops->flat, u, w, y);
}

/* The rise of the ways over the horizons. False: some part of the surface has none. */
static bool rise_above(const tracer *tr, int32_t id, const workspace *v, const own_ways *y, real *above)
{
    const hit_group *g = &v->g;
    const int32_t *part = tr->shifted ? g->shade_part : g->part;
    const int parts = v->surface[id]->ops->parts;
    for (int p = 0; p < parts; p++) {
        const horizon *h = horizons_of(tr->scene->horizons, id, p);
        real of_part[LANES];
        if (!h)
            return false;
        own_above(g, y, h, of_part);
        for (int i = 0; i < g->n; i++)
            above[i] = parts == 1 || part[i] == p ? of_part[i] : above[i];
    }
    return true;
}

static void march(const tracer *tr, int32_t id, const own_ways *y, int steps, int seen_from, workspace *v)
{
    v->stats->evaluations += own_march(&v->g, tr->scene->object[id].bump, y, steps, seen_from);
}

static bool from_behind(int n, const own_ways *y)
{
    for (int i = 0; i < n; i++)
        if (y->side[i] < 0)
            return true;
    return false;
}

/* The map is of the front. shared: its part is known from share_above. */
static void sink(const tracer *tr, int32_t id, const own_ways *y, bool shared, workspace *v)
{
    real above[LANES];
    const bool mapped = shared || rise_above(tr, id, v, y, above);
    if (mapped && !shared)
        own_sink(&v->g, y, above);
    if (!mapped || from_behind(v->g.n, y))
        march(tr, id, y, STEPS, mapped ? -1 : 0, v);
}

/* g->lit = 0 in the shadow of the object's bumps; then, from where the way leaves them, in that of its smooth shape. */
static void cast_bumps(const tracer *tr, int32_t id, const light *l, bool shared, workspace *v)
{
    const surface *f = v->surface[id], *exact = &v->displaced[id].base;
    hit_group *g = &v->g;
    own_ways y;
    begin_ways(tr, id, l, v, &y);
    if (!shared)
        own_turned_away(g, &y);
    if (tr->bump_shadow.kind == BUMP_SHADOW_EXACT) {
        if (exact->ops->occlude_own)
            exact->ops->occlude_own(exact, g->n, &g->to_light, tr->shifted ? g->shade_part : g->part, g->lit);
        return;
    }
    if (tr->bump_shadow.kind == BUMP_SHADOW_MARCH)
        march(tr, id, &y, tr->bump_shadow.n, 0, v);
    else
        sink(tr, id, &y, shared, v);
    if (!f->ops->occlude_own && !is_clear(tr, id))
        return;
    own_leave(g, &y);
    if (is_clear(tr, id))
        follow_through(tr->scene, id, false, v);
    else
        f->ops->occlude(f, g->n, &g->to_light, g->lit);
}

/* Whether a horizon map can tell the share of an area light that is above it, so that its samples need not be tested.
 */
static bool share_above(const tracer *tr, int32_t id, const light *l, workspace *v, real *share)
{
    const double half_u[3] = {0, 0.5, 0}, half_w[3] = {0, 0, 0.5};
    real above[3][LANES];
    own_ways y;
    if (tr->bump_shadow.kind != BUMP_SHADOW_HORIZON || !shadow_is_own(tr, id, v))
        return false;
    for (int k = 2; k >= 0; k--) { /* the middle is last: its ways decide the side */
        light one = *l;
        one.at = vec3_add(l->at, vec3_add(vec3_scale(l->u, half_u[k]), vec3_scale(l->w, half_w[k])));
        begin_ways(tr, id, &one, v, &y);
        if (!rise_above(tr, id, v, &y, above[k]))
            return false;
    }
    own_share(v->g.n, y.side, above[0], above[1], above[2], share);
    return true;
}

/* ---- one light ---- */

/* The shadow of a light at one point. shared: the bumps' shadow is known from share_above. */
static void shadow_place(const tracer *tr, int32_t id, const light *l, bool shared, workspace *v)
{
    hit_group *g = &v->g;
    for (int i = 0; i < g->n; i++)
        g->lit[i] = 1;
    if (tr->scene->clear)
        vec3s_fill(&g->tint, g->n, 1, 1, 1);
    if (shadow_is_own(tr, id, v))
        cast_bumps(tr, id, l, shared, v);
    else if (shadow_casts(tr, id) && (v->surface[id]->ops->occlude_own || is_clear(tr, id))) {
        lighting_aim(l, g->t, g); /* from p1 */
        cast_own(tr, id, v);
    }
    if (!v->alone) {
        lighting_aim(l, g->t0, g); /* from r + s t0 */
        cast_others(tr, id, v);
    }
    v->stats->shadow_rays += g->n;
}

void shadow_light(const tracer *tr, int32_t id, const light *l, workspace *v)
{
    const int places = l->samples[0] * l->samples[1];
    const bool tinted = tr->scene->clear;
    hit_group *g = &v->g;
    if (places == 1) {
        shadow_place(tr, id, l, false, v);
        return;
    }
    real sum[LANES] = {0}, above[LANES], share;
    const bool shared = share_above(tr, id, l, v, above);
    vec3s colors = {{0}, {0}, {0}};
    for (int k = 0; k < places; k++) {
        const light one = light_sample(l, k, &share);
        shadow_place(tr, id, &one, shared, v);
        if (tinted)
            lighting_add_tint(g, share, &colors);
        else
            lighting_add(g, share, sum);
    }
    if (tinted) {
        g->tint = colors;
        for (int i = 0; i < g->n; i++)
            g->lit[i] = 1;
    } else
        memcpy(g->lit, sum, sizeof sum);
    for (int i = 0; shared && i < g->n; i++)
        g->lit[i] *= above[i];
}
