/* Which tables an object's horizons are laid on, and the curvature under them. */
#include "scene/horizons.h"

#include <stdlib.h>

#include "wave/lane.h"

enum {
    PARTS = 7,           /* of a surface at most: a box has 6 */
    FUNCTION_SIDE = 256, /* samples along a function's extent */
    SAMPLES = 1 << 18,   /* of a table over an extent at most: finer maps are sampled more coarsely */
    LEAST = 8,           /* samples along a side at least */
};

struct horizons {
    int objects;
    horizon *(*of)[PARTS];
};

static bool is_finite(const double x[2]) { return x[1] - x[0] < HUGE_VAL; }

/* The table of the map. */
static bool lay_map(const object *o, table_grid *g)
{
    return o->map.width > 0 && table_lay(g, o->map.width, o->map.height, &o->bump_spec.layout);
}

/* How many samples there are along a side of n, if all of `samples` are too many. */
static int thinned(double n, double samples)
{
    const double fewer = ceil(n * fmin(1, sqrt(SAMPLES / samples)));
    return (int)fmin(fmax(fewer, LEAST), SAMPLES / LEAST);
}

/* A table over one period of the map. */
static bool lay_period(const object *o, table_grid *g)
{
    table_grid m;
    if (!lay_map(o, &m))
        return false;
    *g = m;
    g->columns = thinned(m.columns, (double)m.columns * m.rows);
    g->rows = thinned(m.rows, (double)m.columns * m.rows);
    const real x = (real)g->columns / (real)m.columns, y = (real)g->rows / (real)m.rows;
    g->ku *= x;
    g->ou *= x;
    g->kw *= y;
    g->ow *= y;
    return true;
}

/* A table over an extent, as fine as the map, if that has fewer than SAMPLES there. */
static void lay_extent(const object *o, const double u[2], const double w[2], table_grid *g)
{
    table_grid m;
    double columns = FUNCTION_SIDE, rows = FUNCTION_SIDE;
    if (lay_map(o, &m)) {
        columns = fabs((double)m.ku) * (u[1] - u[0]);
        rows = fabs((double)m.kw) * (w[1] - w[0]);
    }
    *g = (table_grid){.columns = thinned(columns, columns * rows), .rows = thinned(rows, columns * rows)};
    g->ku = (real)(g->columns / (u[1] - u[0]));
    g->kw = (real)(g->rows / (w[1] - w[0]));
    g->ou = (real)(-u[0] * g->columns / (u[1] - u[0]));
    g->ow = (real)(-w[0] * g->rows / (w[1] - w[0]));
}

/* The second fundamental form of a wave of places. */
STAGE static void forms(int n, const partials *restrict q, real *restrict L, real *restrict M, real *restrict N)
{
    for (int i = 0; i < n; i++) {
        bs_vec3 m = bs_normal(lane_get(&q->Qu, i), lane_get(&q->Qw, i));
        real il = 1 / real_sqrt(bs_dot(m, m));
        L[i] = bs_dot(lane_get(&q->Quu, i), m) * il;
        M[i] = bs_dot(lane_get(&q->Quw, i), m) * il;
        N[i] = bs_dot(lane_get(&q->Qww, i), m) * il;
    }
}

static void curvature_of_row(const surface *f, int part, const table_grid *g, int row, real *L, real *M, real *N)
{
    real u[LANES], w[LANES];
    int32_t parts[LANES];
    partials q;
    for (int at = 0; at <= g->columns; at += LANES) {
        const int left = g->columns + 1 - at, n = left < LANES ? left : LANES;
        for (int i = 0; i < n; i++) {
            u[i] = ((real)(at + i) - g->ou) / g->ku;
            w[i] = ((real)row - g->ow) / g->kw;
            parts[i] = part;
        }
        f->ops->eval(f, n, parts, u, w, 2, &q);
        forms(n, &q, L + at, M + at, N + at);
    }
}

/* The horizon over a part's extent. NULL: out of memory. */
static horizon *over_extent(const object *o, int part, const double u[2], const double w[2], int threads,
                            const progress *show)
{
    const surface *f = o->shape;
    table_grid g;
    lay_extent(o, u, w, &g);
    const size_t row = (size_t)g.columns + 1, size = row * ((size_t)g.rows + 1);
    real *all = memory_new(progress_memory(show), 3 * size * sizeof *all);
    if (!all)
        return NULL;
    real *const L = all, *const M = L + size, *const N = M + size;
    for (int j = 0; j <= g.rows; j++)
        curvature_of_row(f, part, &g, j, L + (size_t)j * row, M + (size_t)j * row, N + (size_t)j * row);
    const horizon_curvature c = {L, M, N};
    horizon *h = horizon_new(o->bump, &g, f->ops->flat, &c, threads, show);
    memory_free(all);
    return h;
}

/* False: out of memory. */
static bool build(const object *o, horizon **of, int threads, const progress *show)
{
    const surface *f = o->shape;
    if (!o->bump || o->shape_spec.kind == SHAPE_MESH || !(o->bump->Pmax - o->bump->Pmin < REAL_FAR) ||
        f->ops->parts > PARTS)
        return true;
    for (int part = 0; part < f->ops->parts; part++) {
        double u[2], w[2];
        table_grid g;
        f->ops->extent(f, part, u, w);
        const bool endless = !is_finite(u) || !is_finite(w);
        if (endless && !lay_period(o, &g))
            continue;
        of[part] =
            endless ? horizon_new(o->bump, &g, false, NULL, threads, show) : over_extent(o, part, u, w, threads, show);
        if (!of[part])
            return false;
    }
    return true;
}

horizons *horizons_new(const scene *s, int threads, const progress *w)
{
    horizons *h = calloc(1, sizeof *h);
    if (!h)
        return NULL;
    h->objects = s->objects;
    h->of = calloc((size_t)s->objects + 1, sizeof *h->of);
    bool good = h->of != NULL;
    for (int k = 0; good && k < s->objects; k++)
        good = build(&s->object[k], h->of[k], threads, w);
    if (good)
        return h;
    horizons_free(h);
    return NULL;
}

void horizons_free(horizons *h)
{
    if (h && h->of)
        for (int k = 0; k < h->objects; k++)
            for (int part = 0; part < PARTS; part++)
                horizon_free(h->of[k][part]);
    if (h)
        free(h->of);
    free(h);
}

const horizon *horizons_of(const horizons *h, int id, int part) { return part < PARTS ? h->of[id][part] : NULL; }
