/* The roots of Q(u,w) = r + s t for pairs of a ray and a piece, by Newton's iteration, many pairs side by side. */
#ifndef KAGE_PATCH_ROOTS_H
#define KAGE_PATCH_ROOTS_H

#include "patch/piece.h"
#include "patch/query.h"

/* Pairs that wait to be solved. */
typedef struct roots {
    patch_query *k;
    int n;
    int32_t lane[PATCH_BATCH], part[PATCH_BATCH];
    double u[PATCH_BATCH], w[PATCH_BATCH], t[PATCH_BATCH];
    double mu[PATCH_BATCH], mw[PATCH_BATCH], hu[PATCH_BATCH], hw[PATCH_BATCH]; /* the range: middle, half width */
    double close_u, close_w;                                                   /* smaller steps are rounding */
    double rx[PATCH_BATCH], ry[PATCH_BATCH], rz[PATCH_BATCH], sx[PATCH_BATCH], sy[PATCH_BATCH], sz[PATCH_BATCH];
    double open[PATCH_BATCH]; /* 1: not converged yet; 0: converged; -1: has left its range for good */
    bool tried[PATCH_BATCH];  /* it is not proved that there is one root at most */
} roots;

void roots_begin(roots *p, patch_query *k);

/* Add a pair, where the piece is not known to be missed; the iteration begins at (a,b) in it, -1..1. tried: it is not
 * proved that there is one root at most. The pairs are solved once there are PATCH_BATCH. */
void roots_add(roots *p, int lane, const piece *f, double a, double b, bool tried);

/* Solve those that wait, and keep each ray's first root in the query. */
void roots_solve(roots *p);

#endif
