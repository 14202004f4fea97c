/* Heights at the samples of a map, one number each, and section 4.1 of the paper: their differences, formed where they
 * are looked up. The table has one row and one column more before its period, and two behind, so that the 4 x 4 samples
 * around a cell never wrap.
 */
#ifndef KAGE_TEXTURE_HEIGHTS_H
#define KAGE_TEXTURE_HEIGHTS_H

#include <stddef.h>

#include "base/progress.h"
#include "texture/table.h"

enum { HEIGHTS_BEFORE = 1, HEIGHTS_BEHIND = 2 };

typedef struct heights {
    table_grid grid;
    map_layout layout;
    int width, height; /* of the map, in samples */
    int pitch;         /* numbers from row to row of the table */
    bool large;        /* more than the caches hold */
    real *v;           /* (grid.rows + HEIGHTS_BEFORE + HEIGHTS_BEHIND) x pitch */
} heights;

/* Bounds of the heights, and the most that neighbours differ by along u and along w. Where a sample is NaN or infinite,
 * the differences are infinite. peaked: no two neighbours are at one bound, so that heights are there in single points
 * alone. */
typedef struct heights_bounds {
    real lo, hi;
    double du, dw;
    bool peaked;
} heights_bounds;

/* A table for a map of width x height samples, not yet filled. h->v: memory_free. w: as all of the maps' memory; NULL:
 * no limit. False: out of memory, or table_lay has refused. */
bool heights_new(heights *h, int width, int height, const map_layout *l, const progress *w);

/* Put n samples of row y in, from column x on. Several threads may do so. */
void heights_put(heights *h, int x, int y, int n, const float *samples);

/* Once all samples are in, before heights_wrap: move each toward the mean around it, by a Gaussian with a standard
 * deviation of `radius` samples, but by no more than `most` scene units. False: out of memory, or stopped: then it is
 * not known which are moved. (smooth.c) */
bool heights_smooth(heights *h, double radius, double most, int threads, const progress *w);

/* Once all samples are in: lay out what is around them. The bounds do not depend on the threads. */
heights_bounds heights_wrap(heights *h, int threads);

/* P; order 1: also Pu and Pw; order 2: also Puu and Pww; order 3: also Puw. As bump_ops.eval, but derivatives are not
 * level beyond a clamped map's ends. */
void heights_look(const heights *h, int n, const real *u, const real *w, int order, bump_values *out);

/* The height at the upper left corner of a cell; the next ones are to the right, and `pitch` below. */
static inline const real *heights_at(const heights *h, int row, int column)
{
    return h->v + (size_t)(row + HEIGHTS_BEFORE) * (size_t)h->pitch + (size_t)(column + HEIGHTS_BEFORE);
}

#endif
