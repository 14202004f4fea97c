/* Horizon maps [Max 1986]: how high the bumps around each place of a table rise, in a few directions. They tell at once
 * which light reaches the place. include/bumpshadow.h has the formulas (bs_bearing, bs_horizon).
 */
#ifndef KAGE_TEXTURE_HORIZON_H
#define KAGE_TEXTURE_HORIZON_H

#include "texture/bump.h"

enum { HORIZON_DIRECTIONS = 32 }; /* 8, 16 and 32 had 10, 4 and 1.2 % wrong pixels under a light 10 degrees high */

typedef struct horizon horizon;

/* The smooth surface's second fundamental form at each sample of a table, (rows + 1) x (columns + 1). */
typedef struct horizon_curvature {
    const real *L, *M, *N;
} horizon_curvature;

/* The horizon of P at the samples of a grid. ends: there is nothing beyond the grid. c: of the surface under P; NULL:
 * it is flat. The result does not depend on the threads. NULL: out of memory, or more than 2^31 entries. */
horizon *horizon_new(const bump *P, const table_grid *grid, bool ends, const horizon_curvature *c, int threads,
                     const progress *w);

/* NULL is allowed. */
void horizon_free(horizon *h);

const table_grid *horizon_grid(const horizon *h);

/* The horizon of n <= LANES places, each towards a bearing: bilinear in place, linear in direction. */
void horizon_look(const horizon *h, int n, const real *u, const real *w, const real *bearing, real *rise);

#endif
