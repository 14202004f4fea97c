/* The formulas of bumpshadow.h for the bumps' own shadows, in loops over the lanes of a group. */
#include "method/own_shadow.h"

#include <string.h>

#include "wave/lane.h"

#define AIR (64 * R(REAL_ROUNDING)) /* relative */

STAGE static void rough_places(const hit_group *restrict g, vec3s *restrict X)
{
    for (int i = 0; i < g->n; i++) {
        bs_vec3 n = lane_get(&g->n_smooth, i), Q = lane_get(&g->q.Q, i);
        real n2 = bs_dot(n, n), high = n2 > 0 ? g->bump.P[i] / real_sqrt(n2) : 0;
        X->x[i] = Q.x + high * n.x;
        X->y[i] = Q.y + high * n.y;
        X->z[i] = Q.z + high * n.z;
    }
}

void own_places(const hit_group *g, vec3s *X) { rough_places(g, X); }

/* Where the surface is not regular the way has no length: it is seen. */
STAGE static void ways(const hit_group *restrict g, real Pmin, real Pmax, own_ways *restrict y)
{
    const real top = 2 * real_max(Pmax, 0) - real_min(Pmin, 0), bottom = real_max(Pmax, 0) - 2 * real_min(Pmin, 0);
    for (int i = 0; i < g->n; i++) {
        bs_vec3 n = lane_get(&g->n_smooth, i), Qu = lane_get(&g->q.Qu, i), Qw = lane_get(&g->q.Qw, i);
        bs_vec3 Quu = lane_get(&g->q.Quu, i), Quw = lane_get(&g->q.Quw, i), Qww = lane_get(&g->q.Qww, i);
        bs_offset o = bs_offset_of(n, Qu, Qw, Quu, Quw, Qww, g->bump.P[i]);
        bs_view d = bs_view_of(lane_get(&g->to_light.s, i), bs_normal(o.Qu, o.Qw), o.Qu, o.Qw);
        bs_turn turn = bs_turn_of(d, n, Qu, Qw, Quu, Quw, Qww);
        real P = g->bump.P[i], side = bs_dot(n, lane_get(&g->x->s, i)) < 0 ? R(1) : R(-1);
        /* more than the rounding of places: the smooth surface is tested from there */
        real air = AIR * real_sqrt(bs_dot(lane_get(&g->rough, i), lane_get(&g->rough, i)));
        real curvature = bs_curvature(d, n, Quu, Quw, Qww);
        bs_way w = bs_way_of(side, d, curvature, P, Pmin, Pmax);
        real leave = bs_way_to(w.d, w.curvature, (side > 0 ? top - P : bottom + P) + air);
        int regular = bs_regular(n, Qu, Qw);
        y->side[i] = side;
        y->sn[i] = regular ? w.d.sn : 0;
        y->a[i] = regular ? d.a : 0;
        y->b[i] = regular ? d.b : 0;
        y->A[i] = regular ? turn.A : 0;
        y->B[i] = regular ? turn.B : 0;
        y->curvature[i] = regular ? w.curvature : 0;
        y->end[i] = regular ? w.end : 0;
        y->leave[i] = regular ? leave : 0;
    }
}

/* The same where the surface is flat: no curvature, and Quu, Quw and Qww are not read. A light at or below the tangent
 * plane leaves the slab at t = 1. */
STAGE static void ways_flat(const hit_group *restrict g, real Pmin, real Pmax, own_ways *restrict y)
{
    const real top = 2 * real_max(Pmax, 0) - real_min(Pmin, 0), bottom = real_max(Pmax, 0) - 2 * real_min(Pmin, 0);
    for (int i = 0; i < g->n; i++) {
        bs_vec3 n = lane_get(&g->n_smooth, i), to = lane_get(&g->to_light.s, i), X = lane_get(&g->rough, i);
        bs_view d = bs_view_of(to, n, lane_get(&g->q.Qu, i), lane_get(&g->q.Qw, i));
        real P = g->bump.P[i], side = bs_dot(n, lane_get(&g->x->s, i)) < 0 ? R(1) : R(-1);
        real above = side > 0 ? Pmax - P : P - Pmin, out = side > 0 ? top - P : bottom + P;
        real sn = side * d.sn, rise = real_max(sn, R(1e-30));
        y->side[i] = side;
        y->sn[i] = sn;
        y->a[i] = d.a;
        y->b[i] = d.b;
        y->end[i] = real_min((above + R(1e-30)) / rise, 1);
        y->leave[i] = real_min((out + AIR * real_sqrt(bs_dot(X, X))) / rise, 1);
    }
}

STAGE static void turned_away(hit_group *restrict g, const real *restrict side)
{
    for (int i = 0; i < g->n; i++) {
        real lit = g->lit[i];
        g->lit[i] = side[i] * bs_dot(lane_get(&g->n_bump, i), lane_get(&g->to_light.s, i)) > 0 ? lit : 0;
    }
}

/* The t at which x + a t is at an end of lo..hi. */
static inline real reach(real x, real a, real lo, real hi)
{
    real to = a > 0 ? hi - x : lo - x, t = to / a;
    real way = t > 0 ? t : 0;
    return a != 0 ? way : REAL_FAR;
}

STAGE static void end_at_edges(const hit_group *restrict g, const real *restrict ends, own_ways *restrict y)
{
    const real u0 = ends[0], u1 = ends[1], w0 = ends[2], w1 = ends[3];
    for (int i = 0; i < g->n; i++) {
        real u = reach(g->u[i], y->a[i], u0, u1), w = reach(g->w[i], y->b[i], w0, w1);
        y->end[i] = real_min(y->end[i], real_min(u, w));
    }
}

void own_begin(const hit_group *g, const bump *P, bool flat, const double u[2], const double w[2], own_ways *y)
{
    const real ends[4] = {(real)u[0], (real)u[1], (real)w[0], (real)w[1]};
    if (flat) {
        ways_flat(g, P->Pmin, P->Pmax, y);
        memset(y->A, 0, sizeof y->A);
        memset(y->B, 0, sizeof y->B);
        memset(y->curvature, 0, sizeof y->curvature);
    } else
        ways(g, P->Pmin, P->Pmax, y);
    end_at_edges(g, ends, y);
}

void own_turned_away(hit_group *g, const own_ways *y) { turned_away(g, y->side); }

STAGE static void bearings(int n, const own_ways *restrict y, real ku, real kw, real *restrict bearing,
                           real *restrict rise)
{
    for (int i = 0; i < n; i++) {
        bs_view d = {y->sn[i], y->a[i], y->b[i]};
        bs_bearing x = bs_bearing_of(d, ku, kw);
        bearing[i] = x.bearing;
        rise[i] = x.rise;
    }
}

STAGE static void subtract(int n, const real *restrict x, const real *restrict y, real *restrict z)
{
    for (int i = 0; i < n; i++)
        z[i] = x[i] - y[i];
}

void own_above(const hit_group *g, const own_ways *y, const horizon *h, real *above)
{
    const table_grid *t = horizon_grid(h);
    real bearing[LANES], rise[LANES], risen[LANES];
    bearings(g->n, y, t->ku, t->kw, bearing, rise);
    horizon_look(h, g->n, g->u, g->w, bearing, risen);
    subtract(g->n, rise, risen, above);
}

STAGE static void sink(hit_group *restrict g, const real *restrict side, const real *restrict above)
{
    for (int i = 0; i < g->n; i++) {
        real lit = g->lit[i];
        g->lit[i] = ((side[i] < 0) | (above[i] > 0)) ? lit : 0;
    }
}

void own_sink(hit_group *g, const own_ways *y, const real *above) { sink(g, y->side, above); }

STAGE static void shares(int n, const real *restrict side, const real *restrict middle, const real *restrict along_u,
                         const real *restrict along_w, real *restrict share)
{
    for (int i = 0; i < n; i++) {
        real x = bs_horizon_share(middle[i], along_u[i] - middle[i], along_w[i] - middle[i], R(1e-6));
        share[i] = side[i] < 0 ? 1 : x;
    }
}

void own_share(int n, const real *side, const real *middle, const real *along_u, const real *along_w, real *share)
{
    shares(n, side, middle, along_u, along_w, share);
}

STAGE static void leave(hit_group *restrict g, const real *restrict at)
{
    for (int i = 0; i < g->n; i++) {
        bs_vec3 r = lane_at(&g->to_light, i, at[i]), d = lane_get(&g->to_light.s, i);
        real rest = 1 - at[i];
        lane_set(&g->to_light.r, i, r);
        lane_set(&g->to_light.s, i, (bs_vec3){d.x * rest, d.y * rest, d.z * rest});
    }
}

void own_leave(hit_group *g, const own_ways *y) { leave(g, y->leave); }
