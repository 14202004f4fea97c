/* Bumps: P(u,w), a height along a surface's unit normal in scene units, with its partials and bounds. Bumps know
 * nothing of surfaces, scenes or light. Once it is made, and prepared where `range` is used, a bump does not change,
 * and any number of threads may use it.
 */
#ifndef KAGE_TEXTURE_BUMP_H
#define KAGE_TEXTURE_BUMP_H

#include <stdbool.h>

#include "base/progress.h"
#include "expr/expr.h"
#include "texture/pyramid.h"
#include "texture/table.h"

typedef struct bump bump;

typedef struct bump_ops {
    const char *kind; /* as in the scene file: "map" or "function" */

    /* P at n <= LANES places; order 1: also Pu and Pw; order 2: also Puu and Pww; order 3 (2+): also Puw. Where P, or
     * Pu or Pw if asked for, is NaN, infinite or beyond REAL_FAR, all are 0, and h->undefined tells. Reentrant, no
     * allocation. */
    void (*eval)(const bump *p, int n, const real *u, const real *w, int order, bump_values *h);

    /* P, Pu and Pw at n <= EXPR_BATCH places, in double. Here a map's partials are the derivatives of its bilinear
     * cells, not central differences. NULL: not available. */
    void (*jets)(const bump *p, int n, const double *u, const double *w, expr_jets *out);

    /* Bounds of these over a box of (u,w); those of the partials are Lipschitz bounds, as expr_bound_gradient's. NULL
     * where jets is. */
    void (*bound)(const bump *p, const double u[2], const double w[2], expr_bounds *out);

    /* Bounds over the n <= LANES rectangles u0..u1 x w0..w1, which may have infinite ends: of P, and of how fast it
     * changes. They hold for what eval returns at places in both the rectangle and the range that P is made for. */
    void (*range)(const bump *p, int n, const real *u0, const real *u1, const real *w0, const real *w1,
                  bump_ranges *out);

    bool (*prepare)(bump *p, const progress *w); /* bump_prepare */
    void (*free)(bump *p);
} bump_ops;

struct bump {
    const bump_ops *ops;
    real Pmin, Pmax; /* bounds of P; infinite where none are known */
    bool peaked;     /* P is at these in single points alone, if at all. False where that is not known */

    /* Lipschitz constants of P: for any two places on the surface
     *     |P(u,w) - P(u',w')| <= Pu_max |u - u'| + Pw_max |w - w'|
     * up to rounding. Infinite where none is known, as for a function that jumps. |Pu| and |Pw| are at most these. */
    real Pu_max, Pw_max;

    /* Once prepared: bounds of |Puu|, |Puw| and |Pww|, which are Lipschitz constants of Pu and Pw, so that with du and
     * dw the way from a place of the range to another
     *     |P' - P - Pu du - Pw dw| <= (Puu_max du^2 + 2 Puw_max |du dw| + Pww_max dw^2)/2
     * up to rounding. Infinite where none are known, as for maps. */
    real Puu_max, Puw_max, Pww_max;

    int others; /* its other owners: base/shared.h */
    int ready;  /* bump_prepare: 0 not yet, 1 one thread is at it, 2 done */

    pyramid *pyramid; /* what `range` looks up; NULL before bump_prepare, when it gives the bounds above */
};

/* P from width x height samples, by section 4.1 of the paper: partials by central differences at the samples; heights
 * and partials interpolated bilinearly. Beyond the outermost samples of a clamped map P is constant. u is to the right,
 * w down. It is of use once all samples are put in, n of row y from column x on, by any threads, and bump_map_end has
 * laid out what is around them and found the bounds, which do not depend on its threads (0: one for each processor).
 * w: what its memory is taken from; NULL: no limit. NULL: out of memory, fewer than 2 x 2 samples, or more than 2^29
 * (four times as many if mirrored). */
bump *bump_map_new(int width, int height, const map_layout *layout, const progress *w);
void bump_map_put(bump *p, int x, int y, int n, const float *samples);
void bump_map_end(bump *p, int threads);

/* Before bump_map_end: smooth the heights, as heights_smooth. */
bool bump_map_smooth(bump *p, double radius, double most, int threads, const progress *w);

/* P = scale f(u,w), with exact partials. Owns f, also on failure. Pmin to Pw_max hold for (u,w) in the given range
 * (infinite ends allowed). NULL: out of memory. */
bump *bump_function_new(expr *f, double scale, const double u[2], const double w[2]);

/* Make ready for `range` and set the second partials' bounds. Again: no effect. Several threads may do so, also while
 * others use all else of p. False: out of memory, or stopped. */
bool bump_prepare(bump *p, const progress *w);

/* One owner more, who frees it, too. Returns p. */
bump *bump_share(bump *p);

void bump_free(bump *p);

/* Whether bounds of P are known. */
static inline bool bump_is_bounded(const bump *p) { return p->Pmax - p->Pmin < REAL_FAR; }

/* For the constructors: nothing is known of second partials. */
static inline void bump_unknown_bends(bump *p) { p->Puu_max = p->Puw_max = p->Pww_max = (real)HUGE_VAL; }

/* The member `range` of maps and functions: by the pyramid, or before bump_prepare the bounds over all places. */
void bump_range(const bump *p, int n, const real *u0, const real *u1, const real *w0, const real *w1, bump_ranges *out);

/* For the constructors: slope |scale|, rounded up. */
static inline real bump_slope(double slope, double scale)
{
    double x = scale == 0 ? 0 : slope * fabs(scale) * (1 + 1e-15); /* more than the roundings that led here */
#ifdef KAGE_DOUBLE
    return x;
#else
    real r = (real)x;
    return (double)r < x ? nextafterf(r, HUGE_VALF) : r;
#endif
}

#endif
