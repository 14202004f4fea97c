/* Central differences of heights, interpolated bilinearly. Both are sums of products of a weight along u and one along
 * w, so a look-up goes first down the columns of the 4 x 4 samples, then across the four results.
 */
#define _DEFAULT_SOURCE /* madvise; the name is glibc's */
#include "texture/heights.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "base/threads.h"

/* ---- look-up ---- */

enum { AROUND = 4 }; /* samples around a cell along each axis */

/* At the four columns around a cell, at the place's height in it: P, twice its central difference along w, and its
 * second one. */
typedef struct columns {
    real P[LANES][AROUND], d[LANES][AROUND], e[LANES][AROUND];
} columns;

/* P alone, from the four heights that it needs: what a march looks up, step after step. As pairs, since four gathers
 * take a third more instructions. */
STAGE static void heights_pair_down(const real *restrict v, size_t pitch, int n, const int32_t *restrict at,
                                    const real *restrict b, real (*restrict P)[2])
{
    for (int i = 0; i < n; i++) {
        const real *q = v + (size_t)at[i] + pitch + 1, *r = v + (size_t)at[i] + 2 * pitch + 1;
        for (int k = 0; k < 2; k++)
            P[i][k] = q[k] + (r[k] - q[k]) * b[i];
    }
}

STAGE static void heights_pair_across(int n, const real *restrict a, const real (*restrict pair)[2], real *restrict P)
{
    for (int i = 0; i < n; i++)
        P[i] = pair[i][0] + (pair[i][1] - pair[i][0]) * a[i];
}

/* A row's four heights are one vector, so this takes four loads a lane. 12 to 16 gathers would cost several times as
 * much. */
STAGE static void heights_down(const real *restrict v, size_t pitch, int n, const int32_t *restrict at,
                               const real *restrict b, real (*restrict P)[AROUND], real (*restrict d)[AROUND])
{
    for (int i = 0; i < n; i++) {
        const real *p = v + (size_t)at[i], *q = p + pitch, *r = q + pitch, *s = p + 3 * pitch;
        for (int k = 0; k < AROUND; k++) {
            const real above = q[k] - p[k], here = r[k] - q[k], below = s[k] - r[k];
            P[i][k] = q[k] + here * b[i];
            d[i][k] = (above + here) + (below - above) * b[i];
        }
    }
}

STAGE static void heights_bend_down(const real *restrict v, size_t pitch, int n, const int32_t *restrict at,
                                    const real *restrict b, real (*restrict P)[AROUND], real (*restrict d)[AROUND],
                                    real (*restrict e)[AROUND])
{
    for (int i = 0; i < n; i++) {
        const real *p = v + (size_t)at[i], *q = p + pitch, *r = q + pitch, *s = p + 3 * pitch;
        for (int k = 0; k < AROUND; k++) {
            const real above = q[k] - p[k], here = r[k] - q[k], below = s[k] - r[k];
            P[i][k] = q[k] + here * b[i];
            d[i][k] = (above + here) + (below - above) * b[i];
            e[i][k] = (here - above) + ((below - here) - (here - above)) * b[i];
        }
    }
}

/* ku, kw: samples per u and per w, for the chain rule. */
STAGE static void heights_across(int n, real ku, real kw, const real *restrict a, const real (*restrict P)[AROUND],
                                 const real (*restrict d)[AROUND], bump_values *restrict h)
{
    const real hu = ku / 2, hw = kw / 2;
    for (int i = 0; i < n; i++) {
        const real left = P[i][1] - P[i][0], here = P[i][2] - P[i][1], right = P[i][3] - P[i][2];
        h->P[i] = P[i][1] + here * a[i];
        h->Pu[i] = ((left + here) + (right - left) * a[i]) * hu;
        h->Pw[i] = (d[i][1] + (d[i][2] - d[i][1]) * a[i]) * hw;
    }
}

STAGE static void heights_bend_across(int n, real ku, real kw, const real *restrict a, const real (*restrict P)[AROUND],
                                      const real (*restrict d)[AROUND], const real (*restrict e)[AROUND],
                                      bump_values *restrict h)
{
    const real hu = ku / 2, hw = kw / 2, uu = ku * ku, ww = kw * kw;
    for (int i = 0; i < n; i++) {
        const real left = P[i][1] - P[i][0], here = P[i][2] - P[i][1], right = P[i][3] - P[i][2];
        h->P[i] = P[i][1] + here * a[i];
        h->Pu[i] = ((left + here) + (right - left) * a[i]) * hu;
        h->Pw[i] = (d[i][1] + (d[i][2] - d[i][1]) * a[i]) * hw;
        h->Puu[i] = ((here - left) + ((right - here) - (here - left)) * a[i]) * uu;
        h->Pww[i] = (e[i][1] + (e[i][2] - e[i][1]) * a[i]) * ww;
    }
}

STAGE static void heights_twist_across(int n, real ku, real kw, const real *restrict a,
                                       const real (*restrict d)[AROUND], real *restrict Puw)
{
    const real uw = ku * kw / 4;
    for (int i = 0; i < n; i++) {
        const real twist = d[i][2] - d[i][0], next = d[i][3] - d[i][1];
        Puw[i] = (twist + (next - twist) * a[i]) * uw;
    }
}

static void look_bent(const heights *h, int n, const int32_t *at, const real *a, const real *b, bool twist,
                      bump_values *out)
{
    const table_grid *g = &h->grid;
    columns c;
    heights_bend_down(h->v, (size_t)h->pitch, n, at, b, c.P, c.d, c.e);
    heights_bend_across(n, g->ku, g->kw, a, (const real(*)[AROUND])c.P, (const real(*)[AROUND])c.d,
                        (const real(*)[AROUND])c.e, out);
    if (twist)
        heights_twist_across(n, g->ku, g->kw, a, (const real(*)[AROUND])c.d, out->Puw);
}

/* Ask for the rows around each cell before the first is needed, as a large map's are in lines of memory of their own.
 */
static void fetch(const heights *h, int n, const int32_t *at, int first, int rows)
{
    for (int i = 0; i < n; i++)
        for (int k = first; k < first + rows; k++)
            __builtin_prefetch(h->v + (size_t)at[i] + (size_t)k * (size_t)h->pitch + 1);
}

void heights_look(const heights *h, int n, const real *u, const real *w, int order, bump_values *out)
{
    const table_grid *g = &h->grid;
    const size_t pitch = (size_t)h->pitch;
    int32_t at[LANES];
    real a[LANES], b[LANES];
    table_cells(g, h->pitch, n, u, w, at, a, b);
    if (h->large)
        fetch(h, n, at, order == 0, order == 0 ? 2 : AROUND);
    if (order == 0) {
        real pair[LANES][2];
        heights_pair_down(h->v, pitch, n, at, b, pair);
        heights_pair_across(n, a, (const real(*)[2])pair, out->P);
    } else if (order == 1) {
        columns c;
        heights_down(h->v, pitch, n, at, b, c.P, c.d);
        heights_across(n, g->ku, g->kw, a, (const real(*)[AROUND])c.P, (const real(*)[AROUND])c.d, out);
    } else
        look_bent(h, n, at, a, b, order == 3, out);
}

/* ---- filling ---- */

enum {
    LINE = 64 / sizeof(real), /* heights in a line of cache; a row is an odd number of lines, so that the samples of a
                                 column are not all in the same few places of a cache */
    LARGE = 1 << 24           /* bytes: more than a core's own caches */
};

/* Memory in pages of 2 MiB, where the system has such: they are touched for the first time, and found at a look-up,
 * with less work. */
static void *large_pages(memory *m, size_t size)
{
    enum { PAGE = 1 << 21 };
    if (size < PAGE)
        return memory_new(m, size);
    char *p = memory_aligned(m, PAGE, size);
#ifdef MADV_HUGEPAGE
    if (p)
        madvise(p - (uintptr_t)p % PAGE, size, MADV_HUGEPAGE); /* a wish; without it all is but slower */
#endif
    return p;
}

bool heights_new(heights *h, int width, int height, const map_layout *l, const progress *w)
{
    *h = (heights){.layout = *l, .width = width, .height = height};
    if (!table_lay(&h->grid, width, height, l))
        return false;
    const int lines = (h->grid.columns + HEIGHTS_BEFORE + HEIGHTS_BEHIND + LINE - 1) / LINE;
    h->pitch = (lines | 1) * LINE;
    const int64_t numbers = (int64_t)h->pitch * (h->grid.rows + HEIGHTS_BEFORE + HEIGHTS_BEHIND);
    h->large = numbers > LARGE / (int64_t)sizeof *h->v;
    h->v = numbers <= INT32_MAX /* indices have 32 bits */
               ? large_pages(progress_memory(w), (size_t)numbers * sizeof *h->v)
               : NULL;
    return h->v;
}

static real *place(const heights *h, int row, int column)
{
    return h->v + (size_t)(row + HEIGHTS_BEFORE) * (size_t)h->pitch + (size_t)(column + HEIGHTS_BEFORE);
}

STAGE static void heights_of_samples(int n, double scale, double zero, const float *restrict from, real *restrict to)
{
    for (int i = 0; i < n; i++)
        to[i] = (real)(scale * ((double)from[i] - zero));
}

void heights_put(heights *h, int x, int y, int n, const float *samples)
{
    heights_of_samples(n, h->layout.scale, h->layout.zero, samples, place(h, y, x));
}

/* The columns of a row that are not the samples' own. The last sample's may be one: with corners, a map that repeats
 * has its first sample there. */
static void wrap_row(const heights *h, int row)
{
    real *to = place(h, row, 0);
    to[-1] = to[table_sample(-1, h->width, &h->layout)];
    for (int i = h->width - 1; i < h->grid.columns + HEIGHTS_BEHIND; i++)
        to[i] = to[table_sample(i, h->width, &h->layout)];
}

static void copy_row(const heights *h, int row)
{
    const int from = table_sample(row, h->height, &h->layout);
    if (from != row)
        memcpy(place(h, row, -1), place(h, from, -1), (size_t)h->pitch * sizeof *h->v);
}

/* What is found so far, each of LANES columns by itself. unknown: 0, or NaN by a sample that is NaN or infinite. */
typedef struct extremes {
    real lo[LANES], hi[LANES], unknown[LANES];
    double du[LANES], dw[LANES];
} extremes;

/* A bilinear P is steepest along an edge of a cell, where its slope is the difference of two neighbours. n columns of a
 * row; right: of those that have a neighbour there. */
STAGE static void heights_extremes(int n, int right, const real *restrict v, const real *restrict below,
                                   extremes *restrict x)
{
    for (int i = 0; i < n; i++) {
        x->lo[i] = real_min(v[i], x->lo[i]);
        x->hi[i] = real_max(v[i], x->hi[i]);
        x->unknown[i] += 0 * v[i];
        x->dw[i] = greater(fabs((double)below[i] - (double)v[i]), x->dw[i]);
    }
    for (int i = 0; i < right; i++)
        x->du[i] = greater(fabs((double)v[i + 1] - (double)v[i]), x->du[i]);
}

static void extremes_of_row(const heights *h, int row, extremes *x)
{
    const int all = h->grid.columns + 1;
    const real *v = place(h, row, 0), *below = place(h, row < h->grid.rows ? row + 1 : row, 0);
    for (int i = 0; i < all; i += LANES)
        heights_extremes(all - i < LANES ? all - i : LANES, all - 1 - i < LANES ? all - 1 - i : LANES, v + i, below + i,
                         x);
}

static void join(const extremes *x, heights_bounds *b)
{
    for (int i = 0; i < LANES; i++) {
        b->lo = real_min(x->lo[i], b->lo);
        b->hi = real_max(x->hi[i], b->hi);
        b->du = x->unknown[i] == 0 ? greater(x->du[i], b->du) : HUGE_VAL;
        b->dw = x->unknown[i] == 0 ? greater(x->dw[i], b->dw) : HUGE_VAL;
    }
}

static heights_bounds bounds_of(const heights *h, int threads)
{
    enum { FEW = 1 << 20 }; /* samples, which take less time than to start a thread */
    heights_bounds all = {REAL_FAR, -REAL_FAR, 0, 0, false};
    const bool many = (long)h->grid.rows * h->pitch > FEW;
    (void)threads, (void)many; /* without OpenMP */
#pragma omp parallel num_threads(threads) if (many)
    {
        extremes x;
        for (int i = 0; i < LANES; i++) {
            x.lo[i] = REAL_FAR;
            x.hi[i] = -REAL_FAR;
            x.unknown[i] = 0;
            x.du[i] = x.dw[i] = 0;
        }
#pragma omp for schedule(static)
        for (int row = 0; row <= h->grid.rows; row++)
            extremes_of_row(h, row, &x);
#pragma omp critical
        join(&x, &all);
    }
    return all;
}

/* Whether two neighbours, one of them in the n columns of a row, are both at lo or both at hi. */
STAGE static int heights_level(int n, real lo, real hi, const real *restrict v, const real *restrict below)
{
    int some = 0;
    for (int i = 0; i < n; i++) {
        const real most = real_max(v[i + 1], below[i]), least = real_min(v[i + 1], below[i]);
        some |= ((v[i] >= hi) & (most >= hi)) | ((v[i] <= lo) & (least <= lo));
    }
    return some;
}

static bool is_peaked(const heights *h, const heights_bounds *b)
{
    const real rounding = R(8 * REAL_ROUNDING) * (real_abs(b->lo) + real_abs(b->hi));
    for (int row = -1; row <= h->grid.rows; row++) /* with those before a clamped map, where P is level */
        if (heights_level(h->grid.columns + 2, b->lo + rounding, b->hi - rounding, place(h, row, -1),
                          place(h, row + 1, -1)))
            return false;
    return true;
}

heights_bounds heights_wrap(heights *h, int threads)
{
    for (int row = 0; row < h->height; row++)
        wrap_row(h, row);
    copy_row(h, -1);
    for (int row = h->height - 1; row < h->grid.rows + HEIGHTS_BEHIND; row++)
        copy_row(h, row);
    heights_bounds b = bounds_of(h, threads_of(threads));
    b.peaked = is_peaked(h, &b);
    return b;
}
