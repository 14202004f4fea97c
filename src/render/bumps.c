/* The bumps' own shadows by the render's setting: a march, horizon maps, or the displaced surface. method/own_shadow.h
 * has the stages.
 */
#include "render/bumps.h"

#include "light/lighting.h"
#include "method/own_shadow.h"
#include "render/transparent.h"
#include "scene/horizons.h"

enum { STEPS = 24 }; /* of the march where there is no horizon map */

bool bumps_cast(const tracer *tr, int32_t id, const workspace *v)
{
    const bump *P = tr->scene->object[id].bump;
    return tr->bump_shadow.kind != BUMP_SHADOW_NONE && tr->self_shadow && P && P->Pmin < P->Pmax &&
           !displaced_is(v->surface[id]);
}

/* The ways from X to a light at one point. */
static void begin_ways(const tracer *tr, int32_t id, const light *l, workspace *v, own_ways *y)
{
    const surface *f = v->surface[id];
    const double far = (double)REAL_FAR;
    double u[2] = {-far, far}, w[2] = {-far, far};
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

/* The map is of the front. shared: its part is known from bumps_share. */
static void sink(const tracer *tr, int32_t id, const own_ways *y, bool shared, workspace *v)
{
    real above[LANES];
    const bool mapped = shared || rise_above(tr, id, v, y, above);
    if (mapped && !shared)
        own_sink(&v->g, y, above);
    if (!mapped || from_behind(v->g.n, y))
        march(tr, id, y, STEPS, mapped ? -1 : 0, v);
}

void bumps_shadow(const tracer *tr, int32_t id, const light *l, bool shared, workspace *v)
{
    const surface *f = v->surface[id], *exact = &v->displaced[id].base;
    hit_group *g = &v->g;
    own_ways y;
    begin_ways(tr, id, l, v, &y);
    if (!shared)
        own_turned_away(g, &y);
    if (tr->bump_shadow.kind == BUMP_SHADOW_EXACT) {
        exact->ops->occlude_own(exact, g->n, &g->to_light, tr->shifted ? g->shade_part : g->part, g->lit);
        return;
    }
    if (tr->bump_shadow.kind == BUMP_SHADOW_MARCH)
        march(tr, id, &y, tr->bump_shadow.n, 0, v);
    else
        sink(tr, id, &y, shared, v);
    if (!f->ops->occlude_own && !transparent_is(tr->scene, id))
        return;
    own_leave(g, &y);
    if (transparent_is(tr->scene, id))
        transparent_cast(tr->scene, id, false, v);
    else if (tr->scene->object[id].crowd) /* others cast theirs later */
        crowd_occlude_same(tr->scene->object[id].crowd, g->n, &g->to_light, g->part, g->lit);
    else
        f->ops->occlude(f, g->n, &g->to_light, g->lit);
}

bool bumps_share(const tracer *tr, int32_t id, const light *l, workspace *v, real *share)
{
    const double half_u[3] = {0, 0.5, 0}, half_w[3] = {0, 0, 0.5};
    real above[3][LANES];
    own_ways y;
    if (tr->bump_shadow.kind != BUMP_SHADOW_HORIZON || !bumps_cast(tr, id, v))
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
