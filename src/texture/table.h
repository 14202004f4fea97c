/* Tables over (u,w): values at samples in rows and columns, and their look-up.
 *
 * A table has a column and a row more than its period, so that the cell of a place never wraps.
 */
#ifndef KAGE_TEXTURE_TABLE_H
#define KAGE_TEXTURE_TABLE_H

#include <stdbool.h>

#include "wave/wave.h"

enum { TABLE_VALUES = 4 }; /* a place in a table, in half a cache line: three values and padding */

/* How a map goes on when (u,w) leaves it. */
typedef enum map_wrap { MAP_REPEAT, MAP_CLAMP, MAP_MIRROR } map_wrap;

/* How a map lies on (u,w); and, of heights, what makes its samples one. */
typedef struct map_layout {
    double size[2];   /* of one copy of the map in u and in w; not 0 */
    double offset[2]; /* (u,w) of its corner */
    map_wrap wrap;
    bool corners; /* n samples span n - 1 cells, the first and the last on the edge, as in POV-Ray's height_field;
                     otherwise n cells with a sample in the middle of each, as in an image map */
    double scale; /* scene units for one unit of the samples; negative turns the relief inside out */
    double zero;  /* the sample whose height is 0 */
} map_layout;

/* A table on (u,w). */
typedef struct table_grid {
    int columns, rows; /* of the period; of the whole table where it does not repeat */
    int repeat;
    real ku, kw, ou, ow; /* samples per (u,w), and the sample at (u,w) = 0 */
} table_grid;

/* The cells that n places are in, and where in them: 0..1 to the right and down. Stages, as are those below. */
void table_cells(const table_grid *t, int n, const real *u, const real *w, int32_t *at, real *a, real *b);

/* The first of a place's values, or all three, interpolated bilinearly. v: (rows + 1) x (columns + 1) x TABLE_VALUES.
 */
void table_one(const table_grid *t, const real *v, int n, const int32_t *at, const real *a, const real *b, real *x);
void table_three(const table_grid *t, const real *v, int n, const int32_t *at, const real *a, const real *b, real *x,
                 real *y, real *z);

/* The table for a map of that size. False where it is too small (2 x 2 samples at least) or too large (2^29). */
bool table_lay(table_grid *t, int width, int height, const map_layout *l);

/* Which of n samples stands at i, within them or beyond. */
int table_sample(int i, int n, const map_layout *l);

#endif
