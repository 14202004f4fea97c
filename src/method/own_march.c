/* The march towards the light, for the lanes that need it. Most do not: bounds of P prove that it does not rise as fast
 * as the way does. What is left is gathered, so that lanes side by side do the same work.
 */
#include "method/own_shadow.h"

#include "wave/lane.h"

/* Ways that are not settled, side by side. */
typedef struct open_ways {
    int n;
    int32_t lane[LANES], below[LANES]; /* of the group; met the rough surface */
    real side[LANES], sn[LANES], a[LANES], b[LANES], curvature[LANES], end[LANES]; /* as own_ways */
    real u[LANES], w[LANES], P[LANES];
} open_ways;

/* Whether P stays below the way: P rises by at most Pu |a| + Pw |b| per t, the way by at least sn, less what the
 * surface's curvature takes. */
static inline int rises_faster(real sn, real a, real b, real curvature, real end, real Pu, real Pw)
{
    return sn - real_max(curvature, 0) * end >= Pu * real_abs(a) + Pw * real_abs(b);
}

/* The same from the slope of P at the start, and bounds of its second partials: the way and P part by sn - P' per t,
 * and come together again by at most half the curvature of both. Not so where a bound is infinite. */
static inline int parts_for_good(real apart, real a, real b, real curvature, real end, const real second[3])
{
    real together = second[0] * a * a + 2 * second[1] * real_abs(a * b) + second[2] * b * b + curvature;
    return apart >= R(0.5) * real_max(together, 0) * end;
}

/* The lanes whose ways bounds of the whole P do not settle. */
STAGE static void find_open(const hit_group *restrict g, const bump *P, const own_ways *restrict y, real seen_from,
                            int32_t *restrict open)
{
    const real Pu = P->Pu_max, Pw = P->Pw_max, second[3] = {P->Puu_max, P->Puw_max, P->Pww_max};
    for (int i = 0; i < g->n; i++) {
        real sn = y->sn[i], a = y->a[i], b = y->b[i], curvature = y->curvature[i], end = y->end[i], side = y->side[i];
        real apart = sn - side * (g->bump.Pu[i] * a + g->bump.Pw[i] * b), lit = g->lit[i];
        int settled =
            rises_faster(sn, a, b, curvature, end, Pu, Pw) | parts_for_good(apart, a, b, curvature, end, second);
        open[i] = (lit > 0) & (end > 0) & (seen_from * side >= 0) & !settled;
    }
}

static void gather_open(const hit_group *g, const own_ways *y, const int32_t *open, open_ways *o)
{
    o->n = 0;
    for (int i = 0; i < g->n; i++) {
        if (!open[i])
            continue;
        const int k = o->n++;
        o->lane[k] = i;
        o->below[k] = 0;
        o->side[k] = y->side[i];
        o->sn[k] = y->sn[i];
        o->a[k] = y->a[i];
        o->b[k] = y->b[i];
        o->curvature[k] = y->curvature[i];
        o->end[k] = y->end[i];
        o->u[k] = g->u[i];
        o->w[k] = g->w[i];
        o->P[k] = g->bump.P[i];
    }
}

/* The rectangle of (u,w) that a way is over. */
STAGE static void rectangles(const open_ways *restrict o, real *restrict u0, real *restrict u1, real *restrict w0,
                             real *restrict w1)
{
    for (int i = 0; i < o->n; i++) {
        real u = o->u[i] + o->a[i] * o->end[i], w = o->w[i] + o->b[i] * o->end[i];
        u0[i] = real_min(u, o->u[i]);
        u1[i] = real_max(u, o->u[i]);
        w0[i] = real_min(w, o->w[i]);
        w1[i] = real_max(w, o->w[i]);
    }
}

/* End the ways where they have risen above the P of their rectangles. */
STAGE static void shorten(open_ways *restrict o, const bump_ranges *restrict k)
{
    for (int i = 0; i < o->n; i++) {
        bs_view d = {o->sn[i], o->a[i], o->b[i]};
        real above = o->side[i] > 0 ? k->hi[i] - o->P[i] : o->P[i] - k->lo[i];
        o->end[i] = real_min(bs_way_to(d, o->curvature[i], real_max(above, 0)), o->end[i]);
    }
}

STAGE static void still_open(const open_ways *restrict o, const bump_ranges *restrict k, int32_t *restrict open)
{
    for (int i = 0; i < o->n; i++)
        open[i] = !rises_faster(o->sn[i], o->a[i], o->b[i], o->curvature[i], o->end[i], k->Pu[i], k->Pw[i]);
}

static void drop_settled(open_ways *o, const int32_t *open)
{
    int n = 0;
    for (int i = 0; i < o->n; i++) {
        if (!open[i])
            continue;
        o->lane[n] = o->lane[i];
        o->side[n] = o->side[i];
        o->sn[n] = o->sn[i];
        o->a[n] = o->a[i];
        o->b[n] = o->b[i];
        o->curvature[n] = o->curvature[i];
        o->end[n] = o->end[i];
        o->u[n] = o->u[i];
        o->w[n] = o->w[i];
        o->P[n] = o->P[i];
        n++;
    }
    o->n = n;
}

/* By bounds of P over the rectangles of the ways. */
static void settle_by_ranges(const bump *P, open_ways *o)
{
    enum { TIMES = 2 };
    real u0[LANES], u1[LANES], w0[LANES], w1[LANES];
    int32_t open[LANES];
    bump_ranges k;
    for (int time = 0; time < TIMES && o->n; time++) {
        rectangles(o, u0, u1, w0, w1);
        P->ops->range(P, o->n, u0, u1, w0, w1, &k);
        shorten(o, &k);
        still_open(o, &k, open);
        drop_settled(o, open);
    }
}

STAGE static void step_places(const open_ways *restrict o, int step, int steps, real *restrict u, real *restrict w)
{
    for (int i = 0; i < o->n; i++) {
        real t = bs_way_step(o->end[i], step, steps);
        u[i] = o->u[i] + o->a[i] * t;
        w[i] = o->w[i] + o->b[i] * t;
    }
}

STAGE static void step_below(open_ways *restrict o, int step, int steps, const real *restrict P)
{
    for (int i = 0; i < o->n; i++) {
        real t = bs_way_step(o->end[i], step, steps);
        bs_way w = {o->side[i], {o->sn[i], o->a[i], o->b[i]}, o->curvature[i], o->P[i], o->end[i]};
        int32_t below = o->below[i];
        o->below[i] = below | bs_way_below(w, t, P[i]);
    }
}

long own_march(hit_group *g, const bump *P, const own_ways *y, int steps, int seen_from)
{
    real u[LANES], w[LANES];
    int32_t open[LANES];
    open_ways o;
    bump_values h;
    find_open(g, P, y, (real)seen_from, open);
    gather_open(g, y, open, &o);
    if (P->pyramid)
        settle_by_ranges(P, &o);
    for (int step = 1; step <= steps && o.n; step++) {
        step_places(&o, step, steps, u, w);
        P->ops->eval(P, o.n, u, w, 0, &h);
        step_below(&o, step, steps, h.P);
    }
    for (int i = 0; i < o.n; i++)
        if (o.below[i])
            g->lit[o.lane[i]] = 0;
    return (long)steps * o.n;
}
