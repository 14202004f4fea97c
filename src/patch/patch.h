/* A parametric patch: Q(u,w) over a range of (u,w), in one or several parts. It can be evaluated at points and bounded
 * over boxes of (u,w); patch/surface.c makes a surface of it. All in double, whatever `real` is. A patch does not
 * change once it is made, and any number of threads may use it.
 */
#ifndef KAGE_PATCH_PATCH_H
#define KAGE_PATCH_PATCH_H

#include <stdint.h>

#include "base/affine.h"
#include "expr/expr.h"
#include "base/vec3.h"

enum { PATCH_BATCH = EXPR_BATCH };

/* Q and its partials at up to PATCH_BATCH places, for x, y and z. */
typedef struct patch_jets {
    expr_jets axis[3];
} patch_jets;

/* Qu and Qw at place i. */
static inline vec3 patch_jets_u(const patch_jets *j, int i)
{
    return (vec3){j->axis[0].u[i], j->axis[1].u[i], j->axis[2].u[i]};
}
static inline vec3 patch_jets_w(const patch_jets *j, int i)
{
    return (vec3){j->axis[0].w[i], j->axis[1].w[i], j->axis[2].w[i]};
}

/* Bounds of Q, Qu and Qw over a box of (u,w), for x, y and z. Infinite where no bound is known. */
typedef struct patch_bounds {
    expr_bounds axis[3];
} patch_bounds;

/* The same of Quu, Quw and Qww: the Hessian bounds. */
typedef struct patch_hessians {
    expr_hessians axis[3];
} patch_hessians;

typedef struct patch patch;

typedef struct patch_ops {
    /* Q at n places; order 1: also Qu and Qw; order 2: also Quu, Quw and Qww. Each result depends on its own place
     * only. (u,w) may lie beyond the range, where the same formula holds. No allocation. */
    void (*eval)(const patch *q, int n, const int32_t *part, const double *u, const double *w, int order,
                 patch_jets *out);

    /* Bounds of Q, Qu and Qw over the box, and in *second those of Quu, Quw and Qww unless it is NULL. The bounds of
     * partials are Lipschitz bounds, as expr_bound_gradient's. */
    void (*bound)(const patch *q, int part, const double u[2], const double w[2], patch_bounds *out,
                  patch_hessians *second);

    void (*free)(patch *q); /* of the patch and all that it owns */
} patch_ops;

struct patch {
    const patch_ops *ops;
    const char *kind; /* as in the scene file */
    int parts;
    double u[2], w[2]; /* the range, of every part */
    int threads;       /* that subdivide it (piece.c); 0: one for each processor */
};

/* Q from three expressions over u[0]..u[1], w[0]..w[1]. Owns them, also on failure. `kind` must outlive it. NULL: an
 * expression is NULL, or out of memory. */
patch *patch_function_new(const char *kind, expr *const xyz[3], const double u[2], const double w[2]);

/* Bicubic Bezier patches, each a part over 0..1 in u and in w, from 16 control points each: point 4 j + i goes with the
 * i-th Bernstein polynomial in u and the j-th in w. Copies them. NULL: out of memory. */
patch *patch_bezier_new(int patches, const vec3 *point);

/* The image of a patch by an affine map. `from` must outlive it. Where the map mirrors, u runs the other way, so that
 * Qu x Qw is the image of that of `from`. NULL: out of memory. */
patch *patch_affine_new(const patch *from, const affine *m);

#endif
