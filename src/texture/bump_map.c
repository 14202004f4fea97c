/* P from discrete data, section 4.1 of the paper: "the data of the points next to the intersection ... their
 * differences as approximate derivatives ... where the coordinates are real numbers, the derivatives at the
 * neighbouring points are interpolated bilinearly".
 *
 * The central differences are computed once, at the samples, with scale and chain rule applied. Interpolated, they are
 * the differences of P over one sample to either side: (P(u + du, w) - P(u - du, w))/(2 du). Beyond the outermost
 * samples of a clamped map P is constant along that axis, and the derivatives are set to 0, as a difference would
 * include samples where it is not. On the outermost sample they are the mean of both sides.
 */
#include "texture/bump.h"

#include <stdlib.h>

#define ROUNDING 1e-12    /* relative, more than the rounding of a coordinate in cells */
#define LARGEST_INDEX 1e9 /* of a cell, so that it fits an int */

enum { P_PU_PW, PUU_PUW_PWW, TABLES };

typedef struct map {
    bump base;
    table_grid grid;
    real *table[TABLES]; /* row 0 at the smallest w, as in the image */
} map;

/* 0 where x is beyond the outermost samples along its axis. */
STAGE static void level_beyond(int n, real k, real o, int last, const real *restrict x, real *restrict derivative)
{
    const real end = (real)last;
    for (int i = 0; i < n; i++) {
        const real y = x[i] * k + o;
        derivative[i] = y >= 0 && y <= end ? derivative[i] : 0;
    }
}

static void clamp_derivatives(const table_grid *g, int n, const real *u, const real *w, int order, bump_values *h)
{
    real *const along_u[] = {h->Pu, h->Puu, h->Puw}, *const along_w[] = {h->Pw, h->Puw, h->Pww};
    for (int k = 0; k < (order == 2 ? 3 : 1); k++) {
        level_beyond(n, g->ku, g->ou, g->columns, u, along_u[k]);
        level_beyond(n, g->kw, g->ow, g->rows, w, along_w[k]);
    }
}

static void map_eval(const bump *base, int n, const real *u, const real *w, int order, bump_values *h)
{
    const map *m = (const map *)base;
    int32_t at[LANES];
    real a[LANES], b[LANES];
    table_cells(&m->grid, n, u, w, at, a, b);
    if (order == 0)
        table_one(&m->grid, m->table[P_PU_PW], n, at, a, b, h->P);
    else
        table_three(&m->grid, m->table[P_PU_PW], n, at, a, b, h->P, h->Pu, h->Pw);
    if (order == 2)
        table_three(&m->grid, m->table[PUU_PUW_PWW], n, at, a, b, h->Puu, h->Puw, h->Pww);
    if (order >= 1 && !m->grid.repeat)
        clamp_derivatives(&m->grid, n, u, w, order, h);
}

/* P at the corners of a cell: above p0 and p1, below q0 and q1, from left to right. */
typedef struct corners {
    double p0, p1, q0, q1;
} corners;

static corners corners_of(const map *m, int row, int column)
{
    const size_t columns = (size_t)m->grid.columns + 1;
    const real *p = m->table[P_PU_PW] + ((size_t)row * columns + (size_t)column) * TABLE_VALUES;
    const real *q = p + columns * TABLE_VALUES;
    return (corners){(double)p[0], (double)p[TABLE_VALUES], (double)q[0], (double)q[TABLE_VALUES]};
}

/* The cell of a coordinate x among n samples, and the place in it; table.c's cell_of in double. *k, samples per unit,
 * becomes 0 beyond an end. */
static int cell(double x, int n, int repeat, double *fraction, double *k)
{
    *k = repeat || (x >= 0 && x <= n) ? *k : 0;
    const double y = fmin(fmax(repeat ? x - floor(x / n) * n : x, 0), n);
    const int i = y < n ? (int)y : n - 1;
    *fraction = y - i;
    return i;
}

static void map_jets(const bump *base, int n, const double *u, const double *w, expr_jets *out)
{
    const map *m = (const map *)base;
    const table_grid *g = &m->grid;
    for (int i = 0; i < n; i++) {
        double a, b, ku = (double)g->ku, kw = (double)g->kw;
        const int column = cell(u[i] * ku + (double)g->ou, g->columns, g->repeat, &a, &ku);
        const int row = cell(w[i] * kw + (double)g->ow, g->rows, g->repeat, &b, &kw);
        const corners c = corners_of(m, row, column);
        const double left = c.p0 + (c.q0 - c.p0) * b, right = c.p1 + (c.q1 - c.p1) * b;
        out->v[i] = left + (right - left) * a;
        out->u[i] = (right - left) * ku;
        out->w[i] = ((c.q0 - c.p0) + ((c.q1 - c.p1) - (c.q0 - c.p0)) * a) * kw;
    }
}

/* The cells that a range of u or of w overlaps: the first, wrapped, and their number. beyond: the range may go beyond
 * an end, where P is constant. */
typedef struct cells {
    int first, n;
    bool beyond;
} cells;

static cells cells_over(const double x[2], double k, double o, int n, int repeat)
{
    const double a = fmin(x[0] * k, x[1] * k) + o, b = fmax(x[0] * k, x[1] * k) + o,
                 air = ROUNDING * (fabs(a) + fabs(b) + fabs(o));
    double lo = floor(a - air), hi = floor(b + air);
    cells c = {0, n, !repeat && (a - air < 0 || b + air > n)};
    if (!(hi - lo < n) || !(fabs(lo) < LARGEST_INDEX))
        return c;
    if (!repeat) {
        lo = fmin(fmax(lo, 0), n - 1);
        hi = fmin(fmax(hi, 0), n - 1);
    }
    c.first = (int)(lo - (repeat ? floor(lo / n) * n : 0));
    c.n = (int)(hi - lo) + 1;
    return c;
}

static void widen(double range[2], double x)
{
    range[0] = fmin(range[0], x);
    range[1] = fmax(range[1], x);
}

/* From the samples of the cells if these are few, else those of the whole map. */
static void map_bound(const bump *base, const double u[2], const double w[2], expr_bounds *out)
{
    enum { FEW = 1024 }; /* cells */
    const map *m = (const map *)base;
    const table_grid *g = &m->grid;
    const double ku = (double)g->ku, kw = (double)g->kw, Pu = (double)base->Pu_max, Pw = (double)base->Pw_max;
    const cells c = cells_over(u, ku, (double)g->ou, g->columns, g->repeat),
                r = cells_over(w, kw, (double)g->ow, g->rows, g->repeat);
    *out = (expr_bounds){{(double)base->Pmin, (double)base->Pmax}, {-Pu, Pu}, {-Pw, Pw}};
    if ((double)c.n * r.n > FEW)
        return;
    *out = (expr_bounds){{HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, -HUGE_VAL}};
    for (int j = 0; j < r.n; j++)
        for (int i = 0; i < c.n; i++) {
            const corners z = corners_of(m, (r.first + j) % g->rows, (c.first + i) % g->columns);
            widen(out->v, fmin(fmin(z.p0, z.p1), fmin(z.q0, z.q1)));
            widen(out->v, fmax(fmax(z.p0, z.p1), fmax(z.q0, z.q1)));
            widen(out->u, (z.p1 - z.p0) * ku);
            widen(out->u, (z.q1 - z.q0) * ku);
            widen(out->w, (z.q0 - z.p0) * kw);
            widen(out->w, (z.q1 - z.p1) * kw);
        }
    if (c.beyond)
        widen(out->u, 0);
    if (r.beyond)
        widen(out->w, 0);
}

/* The partials of a bilinear P are between those along the edges of its cell. `none` is 0, or NaN by a sample that is
 * NaN or infinite. */
static cell_range map_cell(const void *user, int row, int column)
{
    const map *m = user;
    const corners c = corners_of(m, row, column);
    const double none = 0 * (c.p0 + c.p1 + c.q0 + c.q1), more = 1 + 1e-15; /* than the roundings here */
    const double ku = (double)m->grid.ku * more, kw = (double)m->grid.kw * more;
    const double p = (c.p1 - c.p0) * ku, q = (c.q1 - c.q0) * ku, l = (c.q0 - c.p0) * kw, r = (c.q1 - c.p1) * kw;
    return (cell_range){lesser(lesser(c.p0, c.p1), lesser(c.q0, c.q1)) + none,
                        greater(greater(c.p0, c.p1), greater(c.q0, c.q1)) + none,
                        lesser(p, q),
                        greater(p, q),
                        lesser(l, r),
                        greater(l, r)};
}

static bool map_prepare(bump *base)
{
    base->pyramid = pyramid_new(&((const map *)base)->grid, map_cell, base);
    return base->pyramid;
}

static void map_free(bump *base)
{
    map *m = (map *)base;
    pyramid_free(base->pyramid);
    for (int k = 0; k < TABLES; k++)
        free(m->table[k]);
    free(m);
}

static const bump_ops map_methods = {.kind = "map",
                                     .eval = map_eval,
                                     .jets = map_jets,
                                     .bound = map_bound,
                                     .range = bump_range,
                                     .prepare = map_prepare,
                                     .free = map_free};

/* Fill the tables, and find the range of P. ku, kw: samples per u and per w, for the chain rule. */
static void map_differences(map *m, const image *s, const map_layout *l, double ku, double kw)
{
    m->base.Pmin = REAL_FAR;
    m->base.Pmax = -REAL_FAR;
    for (int j = 0; j <= m->grid.rows; j++)
        for (int i = 0; i <= m->grid.columns; i++) {
            double z[3][3];
            for (int y = 0; y < 3; y++)
                for (int x = 0; x < 3; x++) {
                    int row = table_sample(j + y - 1, s->height, l), column = table_sample(i + x - 1, s->width, l);
                    double v = (double)s->v[(size_t)row * (size_t)s->width + (size_t)column];
                    z[y][x] = l->scale * (v - l->zero);
                }
            const double d[TABLES][TABLE_VALUES] = {
                {z[1][1], (z[1][2] - z[1][0]) / 2 * ku, (z[2][1] - z[0][1]) / 2 * kw},
                {(z[1][2] - 2 * z[1][1] + z[1][0]) * ku * ku, (z[2][2] - z[2][0] - z[0][2] + z[0][0]) / 4 * ku * kw,
                 (z[2][1] - 2 * z[1][1] + z[0][1]) * kw * kw},
            };
            for (int t = 0; t < TABLES; t++)
                for (int k = 0; k < TABLE_VALUES; k++)
                    m->table[t][((size_t)j * (size_t)(m->grid.columns + 1) + (size_t)i) * TABLE_VALUES + (size_t)k] =
                        (real)d[t][k];
            m->base.Pmin = real_min((real)z[1][1], m->base.Pmin);
            m->base.Pmax = real_max((real)z[1][1], m->base.Pmax);
        }
}

/* The larger of |to - from| and `so_far`. */
static double steepest(const real *from, const real *to, double so_far)
{
    double d = fabs((double)*to - (double)*from);
    return d <= so_far ? so_far : d == d ? d : HUGE_VAL; /* NaN: from a sample that is NaN or infinite */
}

/* A bilinear P is steepest along an edge of a cell, where its slope is the difference of two neighbours; central
 * differences are means of two such. The extra column and row hold the neighbours across the wrap. */
static void map_slopes(map *m)
{
    double du = 0, dw = 0;
    const size_t next = TABLE_VALUES, below = (size_t)(m->grid.columns + 1) * TABLE_VALUES;
    const real *v = m->table[P_PU_PW];
    for (int j = 0; j <= m->grid.rows; j++)
        for (int i = 0; i <= m->grid.columns; i++, v += TABLE_VALUES) {
            du = i < m->grid.columns ? steepest(v, v + next, du) : du;
            dw = j < m->grid.rows ? steepest(v, v + below, dw) : dw;
        }
    m->base.Pu_max = bump_slope(du, (double)m->grid.ku); /* rounded, as the stages use it */
    m->base.Pw_max = bump_slope(dw, (double)m->grid.kw);
}

bump *bump_map_new(const image *samples, const map_layout *l)
{
    table_grid grid;
    map *m = table_lay(&grid, samples->width, samples->height, l) ? calloc(1, sizeof *m) : NULL;
    if (!m)
        return NULL;
    m->base.ops = &map_methods;
    bump_unknown_bends(&m->base);
    m->grid = grid;
    for (int k = 0; k < TABLES; k++) {
        m->table[k] = malloc(sizeof(real) * TABLE_VALUES * (size_t)(m->grid.columns + 1) * (size_t)(m->grid.rows + 1));
        if (!m->table[k]) {
            map_free(&m->base);
            return NULL;
        }
    }
    map_differences(m, samples, l, (double)(samples->width - l->corners) / l->size[0],
                    (double)(samples->height - l->corners) / l->size[1]);
    map_slopes(m);
    return &m->base;
}

bool bump_prepare(bump *p) { return p->pyramid || p->ops->prepare(p); }

void bump_range(const bump *p, int n, const real *u0, const real *u1, const real *w0, const real *w1, bump_ranges *out)
{
    if (p->pyramid) {
        pyramid_ranges(p->pyramid, n, u0, u1, w0, w1, out);
        return;
    }
    for (int i = 0; i < n; i++) {
        out->lo[i] = p->Pmin;
        out->hi[i] = p->Pmax;
        out->Pu[i] = out->Pu_hi[i] = p->Pu_max;
        out->Pw[i] = out->Pw_hi[i] = p->Pw_max;
        out->Pu_lo[i] = -p->Pu_max;
        out->Pw_lo[i] = -p->Pw_max;
    }
}

void bump_free(bump *p)
{
    if (p)
        p->ops->free(p);
}
