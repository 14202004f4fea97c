/* Bounds of P over rectangles of (u,w), from a pyramid over the cells of a grid: each node has the bounds of 2 x 2
 * nodes of the level below, as in maximum mipmaps [Tevs, Ihrke and Seidel 2008]. A look-up takes the finest level at
 * which the rectangle touches 2 x 2 nodes at most. A pyramid does not change once it is made.
 */
#ifndef KAGE_TEXTURE_PYRAMID_H
#define KAGE_TEXTURE_PYRAMID_H

#include "base/progress.h"
#include "texture/table.h"

/* Over each rectangle: P within lo..hi, and its partials within Pu_lo..Pu_hi and Pw_lo..Pw_hi. These bound differences
 * of P, too: P changes along a way as fast as they say. Pu and Pw are the most of their sizes, as Pu_max and Pw_max of
 * bump.h. */
typedef struct bump_ranges {
    real lo[LANES], hi[LANES], Pu_lo[LANES], Pu_hi[LANES], Pw_lo[LANES], Pw_hi[LANES], Pu[LANES], Pw[LANES];
} bump_ranges;

/* The same over one cell. */
typedef struct cell_range {
    double lo, hi, Pu_lo, Pu_hi, Pw_lo, Pw_hi;
} cell_range;

typedef struct pyramid pyramid;

/* Over the cells of a grid (1 x 1 at least), whose bounds cell(user, row, column) gives. About 43 bytes a cell in
 * float, from w's. NULL: out of memory, more than 2^29 cells, or stopped. */
pyramid *pyramid_new(const table_grid *grid, cell_range (*cell)(const void *user, int row, int column),
                     const void *user, const progress *w);

/* Bounds over the n <= LANES rectangles u0..u1 x w0..w1 (infinite ends allowed), rounded outward: they hold for
 * bilinear look-ups in the cells, and for what the cells' bounds hold for. */
void pyramid_ranges(const pyramid *y, int n, const real *u0, const real *u1, const real *w0, const real *w1,
                    bump_ranges *out);

void pyramid_free(pyramid *y); /* NULL is allowed */

#endif
