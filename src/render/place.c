/* The place that is shaded. With order 0 to 2 the paper starts shadow rays at r + s t0 but shades at the smooth hit, so
 * bumps stay where they are on the surface, and a high one does not hide what is behind it. Shaded where the shadow ray
 * starts, they move as in parallax mapping.
 *
 * (u,w) moves by (a,b) tau along the ray (bs_place_of). On a plane that is all. On a curved surface the place is the
 * foot of the point on the surface, in closed form, or by Newton's steps, of which (a,b) tau is the first. No seam
 * shows: flat parts and the sides of cones go on beyond their edges; spheres, tori and patches have a closest point
 * everywhere; on a mesh the foot may be on any triangle.
 */
#include "render/place.h"

#include <string.h>

#include "method/own_shadow.h"
#include "method/shift.h"
#include "render/bumps.h"
#include "wave/lane.h"

/* Of Newton's iteration without second partials. The first is (a,b) tau; each further one leaves of the error the share
 * that the height is of the radius of curvature (tests/unit/method/relief_cases.h). */
enum { STEPS = 5 };

static void place_smooth(bool own, hit_group *g)
{
    g->t_shade = g->t;
    if (own)
        own_places(g, &g->rough);
}

/* t0 where it can be shaded. */
STAGE static void choose(int n, const real *restrict t, const real *restrict t0, real *restrict shade)
{
    for (int i = 0; i < n; i++)
        shade[i] = t0[i] > 0 && t0[i] < REAL_FAR ? t0[i] : t[i];
}

/* Move (u,w) by the part of r + s t - Q that is in the tangent plane. */
STAGE static void foot_step(hit_group *restrict g, const partials *restrict q)
{
    for (int i = 0; i < g->n; i++) {
        bs_vec3 x = lane_at(g->x, i, g->t_shade[i]), Q = lane_get(&q->Q, i), Qu = lane_get(&q->Qu, i),
                Qw = lane_get(&q->Qw, i), n = bs_normal(Qu, Qw), d = {x.x - Q.x, x.y - Q.y, x.z - Q.z};
        bs_view v = bs_view_of(d, n, Qu, Qw);
        int regular = bs_regular(n, Qu, Qw);
        g->u[i] += regular ? v.a : 0;
        g->w[i] += regular ? v.b : 0;
    }
}

static void foot_by_steps(const surface *f, hit_group *g)
{
    partials q;
    for (int k = 0; k < STEPS; k++) {
        f->ops->eval(f, g->n, g->shade_part, g->u, g->w, 1, &q);
        foot_step(g, &q);
    }
}

STAGE static void put_places(hit_group *restrict g)
{
    for (int i = 0; i < g->n; i++)
        lane_set(&g->q.Q, i, lane_at(g->x, i, g->t_shade[i]));
}

/* n' of the rough surface itself, with the smooth surface's curvature in it. */
STAGE static void bend_normals(hit_group *restrict g)
{
    for (int i = 0; i < g->n; i++) {
        bs_vec3 Qu = lane_get(&g->q.Qu, i), Qw = lane_get(&g->q.Qw, i), n = bs_normal(Qu, Qw),
                before = lane_get(&g->n_bump, i);
        bs_offset o = bs_offset_of(n, Qu, Qw, lane_get(&g->q.Quu, i), lane_get(&g->q.Quw, i), lane_get(&g->q.Qww, i),
                                   g->bump.P[i]);
        bs_vec3 N = bs_normal(o.Qu, o.Qw),
                np = lane_unit(bs_perturbed_normal(N, o.Qu, o.Qw, g->bump.Pu[i], g->bump.Pw[i]));
        int has = bs_dot(np, np) > R(0.5);                           /* within float's range */
        int good = bs_regular(n, Qu, Qw) & (bs_dot(n, N) > 0) & has; /* not beyond the centre of curvature */
        np.x = good ? np.x : before.x;
        np.y = good ? np.y : before.y;
        np.z = good ? np.z : before.z;
        lane_set(&g->n_bump, i, np);
    }
}

static inline int is_lost(real u, real w) { return REAL_IS_FAR(real_abs(u) + real_abs(w)); }

STAGE static int count_lost(int n, const real *restrict u, const real *restrict w)
{
    int lost = 0;
    for (int i = 0; i < n; i++)
        lost += is_lost(u[i], w[i]);
    return lost;
}

/* Places whose foot has no (u,w) are shaded at the smooth hit. */
static void keep_lost(const surface *f, hit_group *g)
{
    real u[LANES], w[LANES];
    int32_t part[LANES];
    memcpy(part, g->part, sizeof part);
    f->ops->locate(f, g->n, g->x, g->t, part, u, w);
    for (int i = 0; i < g->n; i++)
        if (is_lost(g->u[i], g->w[i])) {
            g->t_moved[i] = g->t[i];
            g->shade_part[i] = part[i];
            g->u[i] = u[i];
            g->w[i] = w[i];
            shift_undefined(g, i);
        }
}

static void place_shifted(const surface *f, const bump *P, bool own, hit_group *g)
{
    choose(g->n, g->t, g->t0, g->t_moved);
    g->t_shade = g->t_moved;
    memcpy(g->shade_part, g->part, sizeof g->part);
    if (f->ops->foot)
        f->ops->foot(f, g->n, g->x, g->t_shade, g->shade_part, g->u, g->w);
    else
        foot_by_steps(f, g);
    if (count_lost(g->n, g->u, g->w))
        keep_lost(f, g);
    f->ops->eval(f, g->n, g->shade_part, g->u, g->w, f->ops->flat ? 1 : 2, &g->q);
    P->ops->eval(P, g->n, g->u, g->w, 1, &g->bump);
    shift_normals(g, P);
    if (!f->ops->flat)
        bend_normals(g);
    if (own)
        own_places(g, &g->rough);
    put_places(g);
}

void place_find(const tracer *tr, int32_t id, workspace *v)
{
    const bump *P = tr->scene->object[id].bump;
    const bool own = bumps_cast(tr, id, v);
    if (!tr->shifted || !P || displaced_is(v->surface[id])) {
        place_smooth(own, &v->g);
        return;
    }
    place_shifted(v->surface[id], P, own, &v->g);
    v->stats->evaluations += v->g.n;
    stats_stage(v->stats, STAGE_PLACE);
}
