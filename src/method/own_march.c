/* The march towards the light, for the lanes that need it. Most do not: bounds of P prove that it does not rise as fast
 * as the way does. What is left is gathered, so that lanes side by side do the same work.
 */
#include "method/own_shadow.h"

#include "wave/lane.h"

/* Ways that are not settled, side by side. */
typedef struct open_ways {
    int n;
    int32_t lane[LANES], below[LANES]; /* of the group; met the rough surface */
    real side[LANES], sn[LANES], a[LANES], b[LANES], A[LANES], B[LANES], curvature[LANES], end[LANES]; /* as own_ways */
    real u[LANES], w[LANES], P[LANES];
} open_ways;

/* How far u, or w, moves on a way until t, over t, at most. */
static inline real fastest(real a, real A, real end) { return real_abs(a) + real_abs(A) * end; }

/* Whether P stays below the way: P rises by at most Pu a + Pw b per t (a and b are the fastest), the way by at least
 * sn, less what the surface's curvature takes. */
static inline int rises_faster(real sn, real a, real b, real curvature, real end, real Pu, real Pw)
{
    return sn - real_max(curvature, 0) * end >= Pu * a + Pw * b;
}

/* The lanes whose ways bounds of P's slope do not settle. An infinite bound times 0 is NaN, and settles none. */
STAGE static void find_open(const hit_group *restrict g, const bump *P, const own_ways *restrict y, real seen_from,
                            int32_t *restrict open)
{
    const real Pu = P->Pu_max, Pw = P->Pw_max;
    for (int i = 0; i < g->n; i++) {
        real sn = y->sn[i], curvature = y->curvature[i], end = y->end[i], side = y->side[i], lit = g->lit[i];
        real a = fastest(y->a[i], y->A[i], end), b = fastest(y->b[i], y->B[i], end);
        int settled = rises_faster(sn, a, b, curvature, end, Pu, Pw);
        open[i] = (lit > 0) & (end > 0) & (seen_from * side >= 0) & !settled;
    }
}

/* Way i of the group as open way k, until `end`. */
static inline void take_way(const hit_group *restrict g, const own_ways *restrict y, int i, real end,
                            open_ways *restrict o, int k)
{
    o->lane[k] = i;
    o->side[k] = y->side[i];
    o->sn[k] = y->sn[i];
    o->a[k] = y->a[i];
    o->b[k] = y->b[i];
    o->A[k] = y->A[i];
    o->B[k] = y->B[i];
    o->curvature[k] = y->curvature[i];
    o->end[k] = end;
    o->u[k] = g->u[i];
    o->w[k] = g->w[i];
    o->P[k] = g->bump.P[i];
}

static void gather_open(const hit_group *g, const own_ways *y, const int32_t *open, open_ways *o)
{
    o->n = 0;
    for (int i = 0; i < g->n; i++)
        if (open[i])
            take_way(g, y, i, y->end[i], o, o->n++);
}

/* All lanes, where most are open. The settled ones get no way, so they stay where they are, and do not come below P. */
STAGE static void copy_all(const hit_group *restrict g, const own_ways *restrict y, const int32_t *restrict open,
                           open_ways *restrict o)
{
    o->n = g->n;
    for (int i = 0; i < g->n; i++) {
        real end = y->end[i]; /* always read: a conditional read would be a branch */
        take_way(g, y, i, open[i] ? end : 0, o, i);
    }
}

static void take_open(const hit_group *g, const own_ways *y, const int32_t *open, open_ways *o)
{
    int n = 0;
    for (int i = 0; i < g->n; i++)
        n += open[i];
    (2 * n > g->n ? copy_all : gather_open)(g, y, open, o);
    for (int i = 0; i < o->n; i++)
        o->below[i] = 0;
}

STAGE static void step_places(const open_ways *restrict o, int step, int steps, real *restrict u, real *restrict w)
{
    for (int i = 0; i < o->n; i++) {
        real t = bs_way_step(o->end[i], step, steps);
        u[i] = o->u[i] + (o->a[i] + o->A[i] * t) * t;
        w[i] = o->w[i] + (o->b[i] + o->B[i] * t) * t;
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
    take_open(g, y, open, &o);
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
