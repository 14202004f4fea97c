/* Tables of heights or colours: samples in rows and columns, their layout on (u,w), and bilinear look-up. A table has
 * one column and one row more than its period, so that no cell wraps around.
 */
#ifndef KAGE_TEXTURE_TABLE_H
#define KAGE_TEXTURE_TABLE_H

#include <stdbool.h>

#include "wave/wave.h"

enum { TABLE_VALUES = 4 }; /* of each sample: three and padding, so that they are one vector */

typedef enum map_wrap { MAP_REPEAT, MAP_CLAMP, MAP_MIRROR } map_wrap;

/* The position of a map on (u,w), and the heights of its samples. */
typedef struct map_layout {
    double size[2];   /* of one copy of the map in u and in w; not 0 */
    double offset[2]; /* (u,w) of its corner */
    map_wrap wrap;
    bool corners;  /* n samples span n - 1 cells, the first and the last on the edge, as in POV-Ray's height_field;
                      otherwise n cells with a sample in the middle of each, as in an image map */
    double scale;  /* scene units per unit of the samples; may be negative */
    double zero;   /* the sample whose height is 0 */
    double smooth; /* of the heights: the standard deviation of a Gaussian, in samples; 0: none */
} map_layout;

/* A table laid on (u,w). */
typedef struct table_grid {
    int columns, rows;   /* of the period; of the whole table where it does not repeat */
    int repeat;          /* bool; 0: clamped */
    real ku, kw, ou, ow; /* samples per (u,w), and the sample at (u,w) = 0 */
} table_grid;

/* The cells of n <= LANES places: `at` is row x pitch + column of the upper left sample, a and b are the place in the
 * cell, to the right and down, both 0..1. */
void table_cells(const table_grid *t, int pitch, int n, const real *u, const real *w, int32_t *at, real *a, real *b);

/* The three values, interpolated bilinearly. v: (rows + 1) x (columns + 1) x TABLE_VALUES; the pitch of `at` is
 * columns + 1. */
void table_three(const table_grid *t, const real *v, int n, const int32_t *at, const real *a, const real *b, real *x,
                 real *y, real *z);

/* Lay out the table of a map of width x height samples. False: fewer than 2 x 2 or more than 2^29 samples. */
bool table_lay(table_grid *t, int width, int height, const map_layout *l);

/* The index of the sample, 0..n-1, for an index i that may be outside of that. */
int table_sample(int i, int n, const map_layout *l);

#endif
