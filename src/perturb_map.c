/* P from discrete data, section 4.1 of the paper: "the data of the points next to the intersection ... their
 * differences as approximate derivatives ... where the coordinates are real numbers, the derivatives at the neighbouring
 * points are interpolated bilinearly".
 *
 * The central differences are made once, at the samples, and already carry scale and chain rule. The tables have a
 * column and a row more than the period, so that the cell of a point never wraps.
 */
#include "perturb.h"

#include <stdlib.h>

enum { VALUES = 4 }; /* a place in a table, in half a cache line: three values and padding */
enum { P_PU_PW, PUU_PUW_PWW, TABLES };

typedef struct map {
    perturb base;
    real *table[TABLES]; /* (rows + 1) x (columns + 1) x VALUES, row 0 at the lowest w, as in the image */
    int columns, rows;   /* of the period; of the whole map where it does not repeat */
    int repeat;
    real ku, kw, ou, ow; /* samples per (u,w), and the sample at (u,w) = 0 */
} map;

/* The place of a coordinate among n samples: i + fraction, 0 <= i < n, the fraction in 0..1, whatever x is. */
static inline int map_cell(real x, int n, int repeat, real *fraction)
{
    real N = (real)n, iN = 1 / N, y = repeat ? x - real_floor(x * iN) * N : x;
    y = real_min(real_max(y, 0), N); /* far out, and for NaN, the line above gives anything */
    int i = (int)y;                  /* y >= 0, so this is the floor */
    i = i < n ? i : n - 1;
    *fraction = y - (real)i;
    return i;
}

/* Call it with a constant `repeat`: a choice in the loop would keep it from being vectorised. */
static inline void map_cells(const map *m, int repeat, int n, const real *restrict u, const real *restrict w,
                             int32_t *restrict at, real *restrict a, real *restrict b)
{
    const int columns = m->columns, rows = m->rows;
    const real ku = m->ku, kw = m->kw, ou = m->ou, ow = m->ow;
#pragma omp simd
    for (int i = 0; i < n; i++) {
        int c = map_cell(u[i] * ku + ou, columns, repeat, &a[i]);
        int r = map_cell(w[i] * kw + ow, rows, repeat, &b[i]);
        at[i] = r * (columns + 1) + c;
    }
}

STAGE static void map_cells_repeat(const map *m, int n, const real *u, const real *w, int32_t *at, real *a, real *b)
{
    map_cells(m, 1, n, u, w, at, a, b);
}

STAGE static void map_cells_clamp(const map *m, int n, const real *u, const real *w, int32_t *at, real *a, real *b)
{
    map_cells(m, 0, n, u, w, at, a, b);
}

/* One value alone: a gather. */
STAGE static void map_look_up_one(const map *m, int n, const int32_t *restrict at, const real *restrict a,
                                  const real *restrict b, real *restrict out)
{
    const real *v = m->table[P_PU_PW];
    const int row = (m->columns + 1) * VALUES;
#pragma omp simd
    for (int i = 0; i < n; i++) {
        int p = at[i] * VALUES, q = p + row;
        real left = v[p] + (v[q] - v[p]) * b[i];
        real right = v[p + VALUES] + (v[q + VALUES] - v[p + VALUES]) * b[i];
        out[i] = left + (right - left) * a[i];
    }
}

/* All three of a table: the two left corners and the two right ones as one vector each way. Twelve gathers would cost
 * about twice as much. The fourth value is padding, but must not look dead to the compiler: it would take the vector to
 * pieces. So this is a stage of its own, and the next one picks the arrays out. */
STAGE static void map_interpolate(const map *m, int table, int n, const int32_t *restrict at, const real *restrict a,
                                  const real *restrict b, real (*restrict out)[VALUES])
{
    const real *v = m->table[table];
    const size_t row = (size_t)(m->columns + 1) * VALUES;
    for (int i = 0; i < n; i++) {
        const real *p = v + (size_t)at[i] * VALUES, *q = p + row;
        real side[2 * VALUES];
        for (int k = 0; k < 2 * VALUES; k++)
            side[k] = p[k] + (q[k] - p[k]) * b[i];
        for (int k = 0; k < VALUES; k++)
            out[i][k] = side[k] + (side[VALUES + k] - side[k]) * a[i];
    }
}

STAGE static void map_turn(int n, const real (*restrict from)[VALUES], real *restrict x, real *restrict y, real *restrict z)
{
    for (int i = 0; i < n; i++) {
        x[i] = from[i][0];
        y[i] = from[i][1];
        z[i] = from[i][2];
    }
}

static void map_look_up_three(const map *m, int table, int n, const int32_t *at, const real *a, const real *b, real *x, real *y,
                              real *z)
{
    real out[LANES][VALUES];
    map_interpolate(m, table, n, at, a, b, out);
    map_turn(n, (const real (*)[VALUES])out, x, y, z);
}

static void map_eval(const perturb *base, int n, const real *u, const real *w, int order, heights *h)
{
    const map *m = (const map *)base;
    int32_t at[LANES];
    real a[LANES], b[LANES];
    (m->repeat ? map_cells_repeat : map_cells_clamp)(m, n, u, w, at, a, b);
    if (order == 0)
        map_look_up_one(m, n, at, a, b, h->P);
    else
        map_look_up_three(m, P_PU_PW, n, at, a, b, h->P, h->Pu, h->Pw);
    if (order == 2)
        map_look_up_three(m, PUU_PUW_PWW, n, at, a, b, h->Puu, h->Puw, h->Pww);
}

static void map_free(perturb *base)
{
    map *m = (map *)base;
    for (int k = 0; k < TABLES; k++)
        free(m->table[k]);
    free(m);
}

static const perturb_methods map_methods = {"map", map_eval, map_free};

/* The index that stands for i outside 0..n-1. */
static int map_index(int i, int n, map_wrap wrap)
{
    if (wrap == MAP_CLAMP)
        return i < 0 ? 0 : i < n ? i : n - 1;
    int period = wrap == MAP_MIRROR ? 2 * n : n;
    i = (i % period + period) % period;
    return i < n ? i : 2 * n - 1 - i;
}

/* With samples on the edges a mirror does not double the first and the last, and a copy's last is the next one's
 * first; map_index is for samples in the middle of cells. */
static int map_sample(int i, int n, const map_layout *l)
{
    if (!l->corners || l->wrap == MAP_CLAMP)
        return map_index(i, n, l->wrap);
    if (l->wrap == MAP_REPEAT)
        return map_index(i, n - 1, MAP_REPEAT);
    int period = 2 * (n - 1);
    i = (i % period + period) % period;
    return i < n ? i : period - i;
}

/* The tables. ku, kw: samples per u and per w, for the chain rule. */
static void map_differences(map *m, const image *s, const map_layout *l, double ku, double kw)
{
    m->base.Pmin = REAL_FAR;
    m->base.Pmax = -REAL_FAR;
    for (int j = 0; j <= m->rows; j++)
        for (int i = 0; i <= m->columns; i++) {
            double z[3][3];
            for (int y = 0; y < 3; y++)
                for (int x = 0; x < 3; x++) {
                    int row = map_sample(j + y - 1, s->height, l), column = map_sample(i + x - 1, s->width, l);
                    double v = (double)s->v[(size_t)row * (size_t)s->width + (size_t)column];
                    z[y][x] = l->scale * (v - l->zero);
                }
            const double d[TABLES][VALUES] = {
                {z[1][1], (z[1][2] - z[1][0]) / 2 * ku, (z[2][1] - z[0][1]) / 2 * kw},
                {(z[1][2] - 2 * z[1][1] + z[1][0]) * ku * ku, (z[2][2] - z[2][0] - z[0][2] + z[0][0]) / 4 * ku * kw,
                 (z[2][1] - 2 * z[1][1] + z[0][1]) * kw * kw},
            };
            for (int t = 0; t < TABLES; t++)
                for (int k = 0; k < VALUES; k++)
                    m->table[t][((size_t)j * (size_t)(m->columns + 1) + (size_t)i) * VALUES + (size_t)k] = (real)d[t][k];
            m->base.Pmin = real_min((real)z[1][1], m->base.Pmin);
            m->base.Pmax = real_max((real)z[1][1], m->base.Pmax);
        }
}

static double steepest(const real *from, const real *to, double so_far)
{
    double d = fabs((double)*to - (double)*from);
    return d <= so_far ? so_far : d == d ? d : HUGE_VAL; /* NaN: a sample is, or is infinite */
}

/* Bilinear between the samples, P is steepest along the edge of a cell: by the difference of two neighbours, not by the
 * central ones, which are means of two such. The extra column and row hold the neighbours across the wrap. */
static void map_slopes(map *m)
{
    double du = 0, dw = 0;
    const size_t next = VALUES, below = (size_t)(m->columns + 1) * VALUES;
    const real *v = m->table[P_PU_PW];
    for (int j = 0; j <= m->rows; j++)
        for (int i = 0; i <= m->columns; i++, v += VALUES) {
            du = i < m->columns ? steepest(v, v + next, du) : du;
            dw = j < m->rows ? steepest(v, v + below, dw) : dw;
        }
    m->base.Pu_max = perturb_slope(du, (double)m->ku); /* as the stages have it */
    m->base.Pw_max = perturb_slope(dw, (double)m->kw);
}

/* Cells to step over before the map repeats, or ends. */
static int map_period(int n, const map_layout *l)
{
    int cells = n - (l->corners || l->wrap == MAP_CLAMP);
    return l->wrap == MAP_MIRROR ? 2 * cells : cells;
}

perturb *perturb_map(const image *samples, const map_layout *l)
{
    map *m = samples->width < 2 || samples->height < 2 ? NULL : calloc(1, sizeof *m);
    if (!m)
        return NULL;
    m->base.is = &map_methods;
    m->columns = map_period(samples->width, l);
    m->rows = map_period(samples->height, l);
    if ((m->columns + 1L) * (m->rows + 1L) > INT32_MAX / VALUES) { /* stages count places in 32 bits */
        free(m);
        return NULL;
    }
    for (int k = 0; k < TABLES; k++) {
        m->table[k] = malloc(sizeof(real) * VALUES * (size_t)(m->columns + 1) * (size_t)(m->rows + 1));
        if (!m->table[k]) {
            map_free(&m->base);
            return NULL;
        }
    }
    m->repeat = l->wrap != MAP_CLAMP;
    double ku = (double)(samples->width - l->corners) / l->size[0];
    double kw = (double)(samples->height - l->corners) / l->size[1];
    double half = l->corners ? 0 : 0.5;
    m->ku = (real)ku;
    m->kw = (real)kw;
    m->ou = (real)(-l->offset[0] * ku - half);
    m->ow = (real)(-l->offset[1] * kw - half);
    map_differences(m, samples, l, ku, kw);
    map_slopes(m);
    return &m->base;
}

void perturb_free(perturb *p)
{
    if (p)
        p->is->free(p);
}
