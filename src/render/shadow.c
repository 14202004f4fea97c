/* Shadows. The paper starts shadow rays at r + s t0 instead of at the smooth hit p1 = r + s t_hit (section 3: "the
 * shadow is computed from the intersection found anew"; section 6). kage does so for shadows of other objects. Its own
 * smooth shape would shadow a start that is shifted below it, so the object itself is tested from p1 (ours). Starts
 * have no offset: a surface's own test excludes the hit at t = 0.
 */
#include "render/shadow.h"

#include <string.h>

#include "light/lighting.h"
#include "render/bumps.h"
#include "render/intersect.h"
#include "render/transparent.h"
#include "wave/fill.h"
#include "wave/gather.h"
#include "wave/lane.h"

/* ---- the casters ---- */

bool shadow_casts(const tracer *tr, int32_t id) { return tr->self_shadow || !tr->scene->object[id].bump; }

/* A displaced surface is dark where the light is on the other side than the viewer. */
static void darken_facing_away(hit_group *g)
{
    for (int i = 0; i < g->n; i++) {
        bs_vec3 n = lane_get(&g->n_smooth, i);
        bool lit = bs_dot(n, lane_get(&g->to_light.s, i)) * bs_dot(n, lane_get(&g->x->s, i)) < 0;
        g->lit[i] = lit ? g->lit[i] : 0;
    }
}

static void cast_own(const tracer *tr, int32_t id, workspace *v)
{
    const surface *f = v->surface[id];
    hit_group *g = &v->g;
    if (displaced_is(f))
        darken_facing_away(g);
    if (transparent_is(tr->scene, id))
        transparent_cast(tr->scene, id, true, v);
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

/* The shadows of the other copies on a copy. Transparent ones are all crossed in cast_own. */
static void cast_other_copies(const tracer *tr, int32_t id, workspace *v)
{
    hit_group *g = &v->g;
    if (!transparent_is(tr->scene, id))
        crowd_occlude_others(tr->scene->object[id].crowd, g->n, &g->to_light, g->part, g->lit);
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
        if (!shadow_casts(tr, j) || (j == id && !s->object[id].crowd))
            continue;
        if (j == s->object[id].first)
            cast_other_copies(tr, id, v);
        else if (transparent_is(s, j))
            transparent_cast(s, j, false, v);
        else if (v->candidates)
            occlude_some(f, candidates_rays(v->candidates, j, lane), lane, g);
        else
            f->ops->occlude(f, g->n, &g->to_light, g->lit);
    }
}

/* ---- one light ---- */

/* The shadow of a light at one point. shared: the bumps' shadow is known from bumps_share. */
static void shadow_place(const tracer *tr, int32_t id, const light *l, bool shared, workspace *v)
{
    hit_group *g = &v->g;
    fill(g->n, 1, g->lit);
    if (tr->scene->clear)
        fill_vec3s(g->n, 1, 1, 1, &g->tint);
    if (bumps_cast(tr, id, v))
        bumps_shadow(tr, id, l, shared, v);
    else if (shadow_casts(tr, id) && (v->surface[id]->ops->occlude_own || transparent_is(tr->scene, id))) {
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
    const bool shared = bumps_share(tr, id, l, v, above);
    vec3s colors = {{0}, {0}, {0}};
    for (int k = 0; k < places && (k == 0 || pulse_beats(v->pulse)); k++) {
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
