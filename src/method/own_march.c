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
    real u[LANES], w[LANES], P[LANES], Pu[LANES], Pw[LANES];
} open_ways;

static void move(const open_ways *from, int i, open_ways *to, int k)
{
    to->lane[k] = from->lane[i];
    to->side[k] = from->side[i];
    to->sn[k] = from->sn[i];
    to->a[k] = from->a[i];
    to->b[k] = from->b[i];
    to->curvature[k] = from->curvature[i];
    to->end[k] = from->end[i];
    to->u[k] = from->u[i];
    to->w[k] = from->w[i];
    to->P[k] = from->P[i];
    to->Pu[k] = from->Pu[i];
    to->Pw[k] = from->Pw[i];
}

/* Keep those that are open. */
static void drop_settled(open_ways *o, const int32_t *open)
{
    int n = 0;
    for (int i = 0; i < o->n; i++) {
        if (n < i)
            move(o, i, o, n);
        n += open[i];
    }
    o->n = n;
}

static void begin(const hit_group *g, const own_ways *y, int seen_from, open_ways *o)
{
    int n = 0;
    for (int i = 0; i < g->n; i++) { /* without a branch */
        o->lane[n] = i;
        o->side[n] = y->side[i];
        o->sn[n] = y->sn[i];
        o->a[n] = y->a[i];
        o->b[n] = y->b[i];
        o->curvature[n] = y->curvature[i];
        o->end[n] = y->end[i];
        o->u[n] = g->u[i];
        o->w[n] = g->w[i];
        o->P[n] = g->bump.P[i];
        o->Pu[n] = g->bump.Pu[i];
        o->Pw[n] = g->bump.Pw[i];
        n += (g->lit[i] > 0) & (y->end[i] > 0) & ((real)seen_from * y->side[i] >= 0);
    }
    o->n = n;
}

/* open[i] = 0 where P stays below the way: P rises by at most Pu |a| + Pw |b| per t, the way by at least sn, less what
 * the surface's curvature takes. */
STAGE static void rises_faster(const open_ways *restrict o, const real *restrict Pu, const real *restrict Pw,
                               int32_t *restrict open)
{
    for (int i = 0; i < o->n; i++) {
        real rise = o->sn[i] - real_max(o->curvature[i], 0) * o->end[i];
        real most = Pu[i] * real_abs(o->a[i]) + Pw[i] * real_abs(o->b[i]);
        open[i] = !(rise >= most);
    }
}

/* The same from the slope of P at the start, and bounds of its second partials: the way and P part by sn - P' per t,
 * and come together again by at most half the curvature of both. */
STAGE static void parts_for_good(const open_ways *restrict o, real Puu, real Puw, real Pww, int32_t *restrict open)
{
    for (int i = 0; i < o->n; i++) {
        real a = real_abs(o->a[i]), b = real_abs(o->b[i]);
        real apart = o->sn[i] - o->side[i] * (o->Pu[i] * o->a[i] + o->Pw[i] * o->b[i]);
        real together = Puu * a * a + 2 * Puw * a * b + Pww * b * b + o->curvature[i];
        open[i] = !(apart >= R(0.5) * real_max(together, 0) * o->end[i]);
    }
}

static void settle_by_slopes(const bump *P, open_ways *o)
{
    real Pu[LANES], Pw[LANES];
    int32_t open[LANES];
    if (P->Puu_max < REAL_FAR && P->Puw_max < REAL_FAR && P->Pww_max < REAL_FAR)
        parts_for_good(o, P->Puu_max, P->Puw_max, P->Pww_max, open);
    else {
        for (int i = 0; i < o->n; i++) {
            Pu[i] = P->Pu_max;
            Pw[i] = P->Pw_max;
        }
        rises_faster(o, Pu, Pw, open);
    }
    drop_settled(o, open);
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
        rises_faster(o, k.Pu, k.Pw, open);
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
    open_ways o;
    bump_values h;
    begin(g, y, seen_from, &o);
    settle_by_slopes(P, &o);
    if (P->pyramid)
        settle_by_ranges(P, &o);
    for (int i = 0; i < o.n; i++)
        o.below[i] = 0;
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
