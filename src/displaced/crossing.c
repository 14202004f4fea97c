/* Roots of the gap within brackets, by the Illinois form of regula falsi [Dowell and Jarratt 1971], which needs no
 * slopes: those of a map are not its bilinear surface's. Where that does not pay, the bracket is halved. */
#include "displaced/crossing.h"

enum { MOST = 64 }; /* steps: more halvings than a real has digits */

#define ENOUGH R(0.125) /* of the tolerance: further steps would move the hit by less than rounding */

/* What goes on beside the brackets. */
typedef struct refinement {
    real best[LANES], before[LANES];  /* the best place; the gap at the last one */
    int32_t kept[LANES], open[LANES]; /* which end the last step kept: 1 for b, -1 for a */
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

/* The next place in the bracket; NaN or an end where there is none. */
static real next(const crossings *c, int i, bool halve)
{
    const real a = c->a[i], b = c->b[i], k = c->above_a[i] / (c->above_a[i] - c->above_b[i]);
    const real t = a + (b - a) * k;
    return halve || !(t > a && t < b) ? a + (b - a) * R(0.5) : t;
}

/* Take the gap at t; whether the search goes on. */
static bool narrow(crossings *c, refinement *r, int i)
{
    const real t = c->at.t[i], above = c->side[i] * c->at.gap[i], size = real_abs(above);
    const bool slow = size > R(0.5) * r->before[i];
    if (size < c->least[i]) {
        c->least[i] = size;
        r->best[i] = t;
    }
    if (above > 0) {
        c->a[i] = t;
        c->above_a[i] = above;
        c->above_b[i] *= r->kept[i] == 1 ? R(0.5) : 1;
        r->kept[i] = 1;
    } else {
        c->b[i] = t;
        c->above_b[i] = above;
        c->above_a[i] *= r->kept[i] == -1 ? R(0.5) : 1;
        r->kept[i] = -1;
    }
    r->before[i] = size;
    if (size <= ENOUGH * c->tolerance[i])
        return false;
    c->at.t[i] = next(c, i, slow);
    return c->at.t[i] > c->a[i] && c->at.t[i] < c->b[i];
}

/* A ray from the surface itself was let go on until it was clearly below, so that its bracket can begin there. */
static void take(const crossings *c, const refinement *r, int i, real *t, int32_t *found)
{
    const bool hit = c->least[i] <= (c->own[i] ? 2 : 1) * c->tolerance[i];
    t[c->at.lane[i]] = r->best[i];
    found[c->at.lane[i]] = hit ? DISPLACED_HIT : DISPLACED_UNCERTAIN;
}

void crossings_refine(const domain *f, const bump *P, crossings *c, real *t, int32_t *found)
{
    refinement r;
    for (int i = 0; i < c->at.n; i++) {
        c->at.t[i] = next(c, i, false);
        c->least[i] = real_abs(c->above_b[i]);
        r.best[i] = c->b[i];
        r.before[i] = REAL_FAR;
        r.kept[i] = 0;
    }
    for (int step = 0; step < MOST && c->at.n; step++) {
        int n = 0;
        paths_evaluate(f, P, 0, &c->at);
        for (int i = 0; i < c->at.n; i++)
            if (narrow(c, &r, i))
                keep(c, &r, i, n++);
            else
                take(c, &r, i, t, found);
        c->at.n = n;
    }
    for (int i = 0; i < c->at.n; i++)
        take(c, &r, i, t, found);
}
