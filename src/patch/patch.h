/* A surface that is known by its points alone: Q(u,w) over a range of (u,w), in one or several parts. It can be evaluated, and
 * bounded over a box of (u,w); searched.c finds where rays meet it. All in double, whatever `real` is.
 */
#ifndef KAGE_PATCH_PATCH_H
#define KAGE_PATCH_PATCH_H

#include <stdint.h>

#include "base/affine.h"
#include "expr/expr.h"
#include "base/vec3.h"

enum { SHEET_BATCH = EXPR_BATCH };

/* Q and its partials at up to SHEET_BATCH places: x, y and z each as an expression has them. */
typedef struct sheet_jets {
    expr_jets axis[3];
} sheet_jets;

/* Bounds of Q, Qu and Qw over a box of (u,w), for x, y and z. Infinite where none is known. */
typedef struct sheet_bounds {
    expr_bounds axis[3];
} sheet_bounds;

/* The same of Quu, Quw and Qww. */
typedef struct sheet_bends {
    expr_bends axis[3];
} sheet_bends;

typedef struct sheet sheet;

typedef struct sheet_methods {
    /* order 0: Q; 1: also Qu and Qw; 2: also Quu, Quw and Qww. Reentrant, no allocation; each lane by itself. (u,w) may lie
     * beyond the range: what holds there is the same formula. */
    void (*eval)(const sheet *q, int n, const int32_t *part, const double *u, const double *w, int order, sheet_jets *out);

    /* All that Q, Qu and Qw can be over the box; and, unless it is NULL, in *second what Quu, Quw and Qww can. The partials are
     * Lipschitz bounds, as expr_range_gradient's. */
    void (*bound)(const sheet *q, int part, const double u[2], const double w[2], sheet_bounds *out, sheet_bends *second);

    void (*free)(sheet *q);
} sheet_methods;

struct sheet {
    const sheet_methods *is;
    const char *kind; /* as in the scene file */
    int parts;
    double u[2], w[2]; /* the range, of every part */
};

/* Q from three expressions over u[0]..u[1], w[0]..w[1]. Owns them, also on failure. kind: a constant. NULL: out of memory. */
sheet *sheet_function(const char *kind, expr *const xyz[3], const double u[2], const double w[2]);

/* Bicubic Bezier patches, each a part over 0..1 in u and in w, from 16 control points each: point 4 j + i goes with the i-th
 * Bernstein polynomial in u and the j-th in w. Copies them. NULL: out of memory. */
sheet *sheet_bezier(int patches, const vec3 *point);

/* The rough surface Q + P n/|n| of a sheet, n = Qu x Qw; both must outlive it. It is evaluated to order 1 only, and has no second bounds.
 * NULL: out of memory. */
struct perturb;
sheet *sheet_rough(const sheet *q, const struct perturb *P);

/* The image of a sheet by an affine map. `from` must outlive it. Where the map mirrors, u runs the other way, so that Qu x Qw is the
 * image of that of `from`. NULL: out of memory. */
sheet *sheet_moved(const sheet *from, const affine *m);

#endif
