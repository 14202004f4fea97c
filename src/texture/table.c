/* Bilinear look-up in tables, and the layout of tables on (u,w). */
#include "texture/table.h"

#include <stddef.h>

/* real_floor without its choice for a distant x. */
static inline real near_floor(real x)
{
    real f = (x + REAL_INTEGER) - REAL_INTEGER;
    return f > x ? f - 1 : f;
}

/* The cell i of a coordinate, 0 <= i < n, and its fraction in the cell, 0..1; for any x, also NaN. */
static inline int cell_of(real x, int n, int repeat, real *fraction)
{
    real N = (real)n, iN = 1 / N, y = repeat ? x - near_floor(x * iN) * N : x;
    y = real_min(real_max(y, 0), N); /* without a meaning for a distant x or NaN */
    int i = (int)y, last = n - 1;    /* y >= 0, so this is the floor */
    i = i < last ? i : last;
    *fraction = y - (real)i;
    return i;
}

/* Called with a constant `repeat`, as a choice in the loop would prevent SIMD. */
static inline void cells(const table_grid *t, int repeat, int pitch, int n, const real *restrict u,
                         const real *restrict w, int32_t *restrict at, real *restrict a, real *restrict b)
{
    const int columns = t->columns, rows = t->rows;
    const real ku = t->ku, kw = t->kw, ou = t->ou, ow = t->ow;
#pragma omp simd
    for (int i = 0; i < n; i++) {
        int c = cell_of(u[i] * ku + ou, columns, repeat, &a[i]);
        int r = cell_of(w[i] * kw + ow, rows, repeat, &b[i]);
        at[i] = r * pitch + c;
    }
}

STAGE static void cells_repeat(const table_grid *t, int pitch, int n, const real *u, const real *w, int32_t *at,
                               real *a, real *b)
{
    cells(t, 1, pitch, n, u, w, at, a, b);
}

STAGE static void cells_clamp(const table_grid *t, int pitch, int n, const real *u, const real *w, int32_t *at, real *a,
                              real *b)
{
    cells(t, 0, pitch, n, u, w, at, a, b);
}

/* All three values: the two upper corners of a cell are one vector of 8, and so are the lower ones. Twelve gathers
 * would cost about twice as much. The fourth value is padding, but if it looked dead the compiler would split the
 * vector. So this stage stores it, and the next one copies the other three. */
STAGE static void map_interpolate(const table_grid *t, const real *restrict v, int n, const int32_t *restrict at,
                                  const real *restrict a, const real *restrict b, real (*restrict out)[TABLE_VALUES])
{
    const size_t row = (size_t)(t->columns + 1) * TABLE_VALUES;
    for (int i = 0; i < n; i++) {
        const real *p = v + (size_t)at[i] * TABLE_VALUES, *q = p + row;
        real side[2 * TABLE_VALUES];
        for (int k = 0; k < 2 * TABLE_VALUES; k++)
            side[k] = p[k] + (q[k] - p[k]) * b[i];
        for (int k = 0; k < TABLE_VALUES; k++)
            out[i][k] = side[k] + (side[TABLE_VALUES + k] - side[k]) * a[i];
    }
}

STAGE static void map_unpack(int n, const real (*restrict from)[TABLE_VALUES], real *restrict x, real *restrict y,
                             real *restrict z)
{
    for (int i = 0; i < n; i++) {
        x[i] = from[i][0];
        y[i] = from[i][1];
        z[i] = from[i][2];
    }
}

void table_cells(const table_grid *t, int pitch, int n, const real *u, const real *w, int32_t *at, real *a, real *b)
{
    (t->repeat ? cells_repeat : cells_clamp)(t, pitch, n, u, w, at, a, b);
}

void table_three(const table_grid *t, const real *v, int n, const int32_t *at, const real *a, const real *b, real *x,
                 real *y, real *z)
{
    real out[LANES][TABLE_VALUES];
    map_interpolate(t, v, n, at, a, b, out);
    map_unpack(n, (const real(*)[TABLE_VALUES])out, x, y, z);
}

/* ---- layout ---- */

/* The number of cells after which the map repeats or ends. */
static int period(int n, const map_layout *l)
{
    int cells = n - (l->corners || l->wrap == MAP_CLAMP);
    return l->wrap == MAP_MIRROR ? 2 * cells : cells;
}

/* A mirrored map repeats its first and last samples if they are in the middle of cells. */
int table_sample(int i, int n, const map_layout *l)
{
    if (l->wrap == MAP_CLAMP)
        return i < 0 ? 0 : i < n ? i : n - 1;
    const int p = period(n, l);
    i = (i % p + p) % p;
    return i < n ? i : p - !l->corners - i;
}

bool table_lay(table_grid *t, int width, int height, const map_layout *l)
{
    const double ku = (double)(width - l->corners) / l->size[0], kw = (double)(height - l->corners) / l->size[1];
    const double half = l->corners ? 0 : 0.5;
    *t = (table_grid){.columns = period(width, l),
                      .rows = period(height, l),
                      .repeat = l->wrap != MAP_CLAMP,
                      .ku = (real)ku,
                      .kw = (real)kw,
                      .ou = (real)(-l->offset[0] * ku - half),
                      .ow = (real)(-l->offset[1] * kw - half)};
    return width > 1 && height > 1 &&
           (t->columns + 1L) * (t->rows + 1L) <= INT32_MAX / TABLE_VALUES; /* indices have 32 bits */
}
