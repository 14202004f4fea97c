/* Functions of u and w, given as text (the language is in docs/scene.md). They are parsed once, then evaluated in
 * batches of points, with exact first and second partial derivatives. Numbers are double in either build of kage,
 * because heights are small compared with the scene. An expr is constant: any number of threads may use it.
 */
#ifndef KAGE_EXPR_EXPR_H
#define KAGE_EXPR_EXPR_H

#include <stdbool.h>
#include <stddef.h>

#include "base/limits.h"

enum { EXPR_BATCH = 64 };

/* The value and the partials of an expression at up to EXPR_BATCH points. */
typedef struct expr_jets {
    double v[EXPR_BATCH], u[EXPR_BATCH], w[EXPR_BATCH], uu[EXPR_BATCH], uw[EXPR_BATCH], ww[EXPR_BATCH];
} expr_jets;

typedef struct expr expr;

typedef struct expr_error {
    size_t offset;     /* byte in the text */
    char message[160]; /* what is wrong, what was expected; without place or newline */
} expr_error;

/* Parse `text`. The caller frees the result with expr_free. NULL on error, with the reason in *error. */
expr *expr_parse(const char *text, expr_error *error);

/* The same within a caller's limits, or NULL. */
expr *expr_parse_within(const limits *l, const char *text, expr_error *error);

/* Evaluate at n <= EXPR_BATCH points (u[i], w[i]). Order 0 writes out->v, order 1 also u and w, order 2 also uu, uw
 * and ww. Reentrant; allocates nothing. Outside a function's domain (log of a negative number, a/0) the result is
 * NaN or infinite. */
void expr_eval(const expr *e, int n, const double *u, const double *w, int order, expr_jets *out);

/* Lower and upper bounds of the value and of the first partials. */
typedef struct expr_bounds {
    double v[2], u[2], w[2];
} expr_bounds;

/* Bounds over u0 <= u <= u1, w0 <= w <= w1 (infinite ends allowed), by interval arithmetic. They hold wherever e is
 * defined, may be wider than needed, are never NaN, and are infinite where none is known.
 *
 * Those of the partials are Lipschitz bounds, too: with L the largest |e_u| and M the largest |e_w|,
 * |e(p) - e(q)| <= L |pu - qu| + M |pw - qw| for all points p and q of the box at which e is defined. So at a kink
 * (abs, min, max, clamp) they include the slopes of both sides. They are infinite where the box may contain a jump
 * (floor, mod, select with different branches, atan2's cut, poles) or an infinite slope (sqrt at 0, asin at 1). They
 * also include the partials of expr_eval, unless intermediate results underflow. */
void expr_bound_gradient(const expr *e, double u0, double u1, double w0, double w1, expr_bounds *out);

/* Bounds of the second partials. */
typedef struct expr_hessians {
    double uu[2], uw[2], ww[2];
} expr_hessians;

/* The same, and bounds of the second partials. They are Lipschitz bounds of the first partials, so infinite where a
 * slope may jump. */
void expr_bound_hessian(const expr *e, double u0, double u1, double w0, double w1, expr_bounds *out,
                        expr_hessians *hessian);

void expr_free(expr *e);

#endif
