/* Roots of the gap within brackets, by regula falsi as Anderson and Bjorck (1973) have it, which needs no slopes: those
 * of a map are not its bilinear surface's. Where that does not pay, the bracket is halved. */
#include "displaced/crossing.h"

enum {
    MOST = 64,  /* steps: more halvings than a real has digits */
    CLOSED = 4, /* those that have ended are dropped when they are so large a part of the wave */
};

#define ENOUGH R(0.0625) /* of the tolerance: further steps would move the hit by less than rounding */

/* What goes on beside the brackets. */
typedef struct refinement {
    real best[LANES], before[LANES]; /* the best place; the gap at the last one */
    real kept[LANES];                /* which end the last step kept: 1 for b, -1 for a, 0 for none yet */
    int32_t open[LANES];             /* goes on */
} refinement;

static void keep(crossings *c, refinement *r, int from, int to)
{
    paths_copy(&c->at, from, &c->at, to);
    c->side[to] = c->side[from];
    c->a[to] = c->a[from];
    c->b[to] = c->b[from];
    c->above_a[to] = c->above_a[from];
    c->above_b[to] = c->above_b[from];
    c->tolerance[to] = c->tolerance[from];
    c->least[to] = c->least[from];
    c->own[to] = c->own[from];
    r->best[to] = r->best[from];
    r->before[to] = r->before[from];
    r->kept[to] = r->kept[from];
    r->open[to] = r->open[from];
}

/* The next place in a bracket; an end where there is none. */
static inline real next(real a, real b, real above_a, real above_b, int halve)
{
    const real t = a + (b - a) * (above_a / (above_a - above_b)), middle = a + (b - a) * R(0.5);
    const int out = halve | !((t > a) & (t < b));
    return out ? middle : t;
}

STAGE static void lay_brackets(crossings *restrict c, refinement *restrict r)
{
    const int n = c->at.n;
    for (int i = 0; i < n; i++) {
        c->at.t[i] = next(c->a[i], c->b[i], c->above_a[i], c->above_b[i], 0);
        c->least[i] = real_abs(c->above_b[i]);
        r->best[i] = c->b[i];
        r->before[i] = REAL_FAR;
        r->kept[i] = 0;
        r->open[i] = 1;
    }
}

/* The share of the gap at an end that is left where that end is kept again, and `was` became `is` at the other. */
static inline real share_left(real is, real was)
{
    const real k = 1 - is / was;
    return k > 0 ? k : R(0.5);
}

/* Take the gaps at t. Where a search has ended nothing changes any more. */
STAGE static void narrow(crossings *restrict c, refinement *restrict r)
{
    const int n = c->at.n;
    for (int i = 0; i < n; i++) {
        const real t = c->at.t[i], above = c->side[i] * c->at.gap[i], size = real_abs(above), kept = r->kept[i];
        const int open = r->open[i] != 0, up = above > 0, better = open & (size < c->least[i]);
        const int slow = size > R(0.5) * r->before[i];
        const real less_a = kept < 0 ? share_left(above, c->above_b[i]) * c->above_a[i] : c->above_a[i];
        const real less_b = kept > 0 ? share_left(above, c->above_a[i]) * c->above_b[i] : c->above_b[i];
        const real a = up ? t : c->a[i], b = up ? c->b[i] : t, fa = up ? above : less_a, fb = up ? less_b : above;
        const real to = next(a, b, fa, fb, slow);
        r->best[i] = better ? t : r->best[i];
        c->least[i] = better ? size : c->least[i];
        c->a[i] = a;
        c->b[i] = b;
        c->above_a[i] = fa;
        c->above_b[i] = fb;
        r->kept[i] = up ? R(1) : R(-1);
        r->before[i] = size;
        r->open[i] = open & (size > ENOUGH * c->tolerance[i]) & (to > a) & (to < b);
        c->at.t[i] = to;
    }
}

/* A ray from the surface itself was let go on until it was clearly below, so that its bracket can begin there. */
static void take(const crossings *c, const refinement *r, int i, real *t, int32_t *found)
{
    const bool hit = c->least[i] <= (c->own[i] ? 2 : 1) * c->tolerance[i];
    t[c->at.lane[i]] = r->best[i];
    found[c->at.lane[i]] = hit ? DISPLACED_HIT : DISPLACED_UNCERTAIN;
}

STAGE static int32_t count_open(int n, const int32_t *restrict open)
{
    int32_t sum = 0;
    for (int i = 0; i < n; i++)
        sum += open[i];
    return sum;
}

/* Those that have ended. */
static void drop(crossings *c, refinement *r, real *t, int32_t *found)
{
    int n = 0;
    for (int i = 0; i < c->at.n; i++)
        if (!r->open[i])
            take(c, r, i, t, found);
        else if (n++ < i)
            keep(c, r, i, n - 1);
    c->at.n = n;
}

void crossings_refine(const domain *f, const bump *P, crossings *c, real *t, int32_t *found)
{
    refinement r;
    lay_brackets(c, &r);
    for (int step = 0; step < MOST && c->at.n; step++) {
        paths_evaluate(f, P, 0, &c->at);
        narrow(c, &r);
        if (count_open(c->at.n, r.open) <= c->at.n - c->at.n / CLOSED)
            drop(c, &r, t, found);
    }
    for (int i = 0; i < c->at.n; i++)
        take(c, &r, i, t, found);
}
