/* Tables over (u,w): samples in rows and columns, how they are laid on (u,w), and bilinear look-up. Heights and colours
 * are looked up in them.
 *
 * A table has one column and one row more than its period, so that the cell of a place never wraps.
 */
#ifndef KAGE_TEXTURE_TABLE_H
#define KAGE_TEXTURE_TABLE_H

#include <stdbool.h>

#include "wave/wave.h"

enum { TABLE_VALUES = 4 }; /* of each sample: three and padding, so that they are one vector */

/* How a map continues beyond its edges. */
typedef enum map_wrap { MAP_REPEAT, MAP_CLAMP, MAP_MIRROR } map_wrap;

/* How a map lies on (u,w), and how its samples become heights. */
typedef struct map_layout {
    double size[2];   /* of one copy of the map in u and in w; not 0 */
    double offset[2]; /* (u,w) of its corner */
    map_wrap wrap;
    bool corners; /* n samples span n - 1 cells, the first and the last on the edge, as in POV-Ray's height_field;
                     otherwise n cells with a sample in the middle of each, as in an image map */
    double scale; /* scene units per unit of the samples; may be negative */
    double zero;  /* the sample whose height is 0 */
} map_layout;

/* A table laid on (u,w). */
typedef struct table_grid {
    int columns, rows;   /* of the period; of the whole table where it does not repeat */
    int repeat;          /* 0: clamped, 1: not */
    real ku, kw, ou, ow; /* samples per (u,w), and the sample at (u,w) = 0 */
} table_grid;

/* The cell of each of n places, as the index of its upper left sample, and where in it the place is: a to the right and
 * b down, both 0..1. A stage, as are the next two. */
void table_cells(const table_grid *t, int n, const real *u, const real *w, int32_t *at, real *a, real *b);

/* The first value, or all three, interpolated bilinearly. v: (rows + 1) x (columns + 1) x TABLE_VALUES. */
void table_one(const table_grid *t, const real *v, int n, const int32_t *at, const real *a, const real *b, real *x);
void table_three(const table_grid *t, const real *v, int n, const int32_t *at, const real *a, const real *b, real *x,
                 real *y, real *z);

/* Lay out the table of a map of width x height samples. False where that is below 2 x 2 or above 2^29 samples. */
bool table_lay(table_grid *t, int width, int height, const map_layout *l);

/* The sample, of n, that stands at index i, which may be outside 0..n-1. */
int table_sample(int i, int n, const map_layout *l);

#endif
