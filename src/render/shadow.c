/* Shadows. The paper starts shadow rays at r + s t0 instead of at the smooth hit p1 = r + s t_hit (section 3: "the
 * shadow is computed from the intersection found anew"; section 6). kage does so for shadows of other objects. Its own
 * smooth shape would shadow a start that is shifted below it, so the object itself is tested from p1 (ours). Starts
 * have no offset: a surface's own test excludes the hit at t = 0.
 */
#include "render/shadow.h"

#include <string.h>

#include "render/intersect.h"
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

/* The shadow of a light at one point. */
static void shadow_place(const tracer *tr, int32_t id, const light *l, workspace *v)
{
    hit_group *g = &v->g;
    for (int i = 0; i < g->n; i++)
        g->lit[i] = 1;
    if (tr->scene->clear)
        vec3s_fill(&g->tint, g->n, 1, 1, 1);
    if (shadow_casts(tr, id) && (v->surface[id]->ops->occlude_own || is_clear(tr, id))) {
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
        shadow_place(tr, id, l, v);
        return;
    }
    real sum[LANES] = {0}, share;
    vec3s colors = {{0}, {0}, {0}};
    for (int k = 0; k < places; k++) {
        const light one = light_sample(l, k, &share);
        shadow_place(tr, id, &one, v);
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
}
