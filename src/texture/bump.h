/* Bumps: P(u,w), a height along a surface's unit normal in scene units, with its partials and bounds. Bumps know
 * nothing of surfaces, scenes or light. A bump does not change once it is made, and any number of threads may use it.
 */
#ifndef KAGE_TEXTURE_BUMP_H
#define KAGE_TEXTURE_BUMP_H

#include <stdbool.h>

#include "expr/expr.h"
#include "image/image.h"
#include "texture/table.h"

typedef struct bump bump;

typedef struct bump_ops {
    const char *kind; /* as in the scene file: "map" or "function" */

    /* P at (u,w); order 1: also Pu and Pw; order 2: also Puu, Puw and Pww. A stage: n lanes, no allocation, reentrant.
     */
    void (*eval)(const bump *p, int n, const real *u, const real *w, int order, bump_values *h);

    /* P, Pu and Pw at up to EXPR_BATCH places, in double. Unlike eval's, the partials are the derivatives of P itself:
     * with a map those of its bilinear cells. NULL: not known. */
    void (*jets)(const bump *p, int n, const double *u, const double *w, expr_jets *out);

    /* Bounds of these over a box of (u,w); of the partials Lipschitz bounds, as expr_bound_gradient's. NULL: as jets.
     */
    void (*bound)(const bump *p, const double u[2], const double w[2], expr_bounds *out);

    void (*free)(bump *p);
} bump_ops;

struct bump {
    const bump_ops *ops;
    real Pmin, Pmax; /* bounds of P, for the slab; infinite where none is known */

    /* Lipschitz constants of P as it is looked up: for any two places on the surface
     *     |P(u,w) - P(u',w')| <= Pu_max |u - u'| + Pw_max |w - w'|
     * up to the rounding of the two P, and with a map of the places among its samples. Rounded up; 0 where P does not
     * depend on the coordinate; infinite where none is known, as with a function that jumps. |Pu| and |Pw| stay within
     * them, too; a map's are central differences and can stay far below. */
    real Pu_max, Pw_max;
};

/* P from samples as the paper has it (section 4.1): partials by central differences at the samples; height and
 * partials interpolated bilinearly. Beyond the outermost samples of a clamped map P is level, and its partials that way
 * are 0. u goes along the rows from left to right, w down the columns. `samples` is only read here. NULL: out of
 * memory, fewer than 2 x 2 samples, or more than 2^29 (a mirrored map counts four times). */
bump *bump_map_new(const image *samples, const map_layout *layout);

/* P = scale f(u,w), with exact partials. Owns f, also on failure. The bounds (Pmin to Pw_max) hold for u and w in
 * the extent given (infinite ends allowed). NULL: out of memory. */
bump *bump_function_new(expr *f, double scale, const double u[2], const double w[2]);

void bump_free(bump *p);

/* For the constructors: a bound of slope |scale|, rounded up. */
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
