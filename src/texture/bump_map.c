/* P from discrete data, section 4.1 of the paper: "the data of the points next to the intersection ... their
 * differences as approximate derivatives ... where the coordinates are real numbers, the derivatives at the
 * neighbouring points are interpolated bilinearly".
 *
 * The central differences are those of the heights, which heights.h looks up. Interpolated, they are
 * the differences of P over one sample to either side: (P(u + du, w) - P(u - du, w))/(2 du). Beyond the outermost
 * samples of a clamped map P is constant along that axis, and the derivatives are set to 0, as a difference would
 * include samples where it is not. On the outermost sample they are the mean of both sides.
 */
#include "texture/bump.h"

#include <sched.h>
#include <stdlib.h>

#include "base/shared.h"
#include "texture/heights.h"

#define ROUNDING 1e-12    /* relative, more than the rounding of a coordinate in cells */
#define LARGEST_INDEX 1e9 /* of a cell, so that it fits an int */

typedef struct map {
    bump base;
    heights heights; /* row 0 at the smallest w, as in the image */
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
    real *const along_u[] = {h->Pu, h->Puu, h->Puw}, *const along_w[] = {h->Pw, h->Pww, h->Puw};
    for (int k = 0; k < order; k++) {
        level_beyond(n, g->ku, g->ou, g->columns, u, along_u[k]);
        level_beyond(n, g->kw, g->ow, g->rows, w, along_w[k]);
    }
}

static void map_eval(const bump *base, int n, const real *u, const real *w, int order, bump_values *h)
{
    const map *m = (const map *)base;
    h->undefined = 0;
    heights_look(&m->heights, n, u, w, order, h);
    if (order >= 1 && !m->heights.grid.repeat)
        clamp_derivatives(&m->heights.grid, n, u, w, order, h);
}

/* P at the corners of a cell: above p0 and p1, below q0 and q1, from left to right. */
typedef struct corners {
    double p0, p1, q0, q1;
} corners;

static corners corners_of(const map *m, int row, int column)
{
    const real *p = heights_at(&m->heights, row, column), *q = p + m->heights.pitch;
    return (corners){(double)p[0], (double)p[1], (double)q[0], (double)q[1]};
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
    const table_grid *g = &m->heights.grid;
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
    const table_grid *g = &m->heights.grid;
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
    const double ku = (double)m->heights.grid.ku * more, kw = (double)m->heights.grid.kw * more;
    const double p = (c.p1 - c.p0) * ku, q = (c.q1 - c.q0) * ku, l = (c.q0 - c.p0) * kw, r = (c.q1 - c.p1) * kw;
    return (cell_range){lesser(lesser(c.p0, c.p1), lesser(c.q0, c.q1)) + none,
                        greater(greater(c.p0, c.p1), greater(c.q0, c.q1)) + none,
                        lesser(p, q),
                        greater(p, q),
                        lesser(l, r),
                        greater(l, r)};
}

static bool map_prepare(bump *base, const progress *w)
{
    base->pyramid = pyramid_new(&((const map *)base)->heights.grid, map_cell, base, w);
    return base->pyramid;
}

static void map_free(bump *base)
{
    map *m = (map *)base;
    pyramid_free(base->pyramid);
    memory_free(m->heights.v);
    free(m);
}

static const bump_ops map_methods = {.kind = "map",
                                     .eval = map_eval,
                                     .jets = map_jets,
                                     .bound = map_bound,
                                     .range = bump_range,
                                     .prepare = map_prepare,
                                     .free = map_free};

bump *bump_map_new(int width, int height, const map_layout *l, const progress *w)
{
    map *m = calloc(1, sizeof *m);
    if (!m || !heights_new(&m->heights, width, height, l, w)) {
        free(m);
        return NULL;
    }
    m->base.ops = &map_methods;
    bump_unknown_bends(&m->base);
    return &m->base;
}

void bump_map_put(bump *p, int x, int y, int n, const float *samples)
{
    heights_put(&((map *)p)->heights, x, y, n, samples);
}

bool bump_map_smooth(bump *p, double radius, double most, int threads, const progress *w)
{
    return heights_smooth(&((map *)p)->heights, radius, most, threads, w);
}

void bump_map_end(bump *p, int threads)
{
    heights *h = &((map *)p)->heights;
    const heights_bounds b = heights_wrap(h, threads);
    p->Pmin = b.lo;
    p->Pmax = b.hi;
    p->peaked = b.peaked;
    p->Pu_max = bump_slope(b.du, (double)h->grid.ku); /* rounded, as the stages use it */
    p->Pw_max = bump_slope(b.dw, (double)h->grid.kw);
}

bool bump_prepare(bump *p, const progress *w)
{
    enum { NOT_YET, BEGUN, READY };
    for (int is; (is = __atomic_load_n(&p->ready, __ATOMIC_ACQUIRE)) != READY; sched_yield())
        if (is == NOT_YET &&
            __atomic_compare_exchange_n(&p->ready, &is, BEGUN, false, __ATOMIC_ACQUIRE, __ATOMIC_RELAXED)) {
            const bool good = p->ops->prepare(p, w);
            __atomic_store_n(&p->ready, good ? READY : NOT_YET, __ATOMIC_RELEASE);
            return good;
        }
    return true;
}

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

bump *bump_share(bump *p)
{
    shared_add(&p->others);
    return p;
}

void bump_free(bump *p)
{
    if (p && shared_drop(&p->others))
        p->ops->free(p);
}
