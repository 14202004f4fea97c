/* Building horizon maps, and looking them up.
 *
 * From each sample a walk goes in each direction, one sample's width a step, until the highest bump there is, Pmax,
 * could not rise above the horizon found so far. On a curved surface P has the curvature's drop added: the way of a
 * light that is seen is a straight line above both.
 */
#include "texture/horizon.h"

#include <stdlib.h>

#include "base/threads.h"
#include "wave/lane.h"

enum { ENTRIES = HORIZON_DIRECTIONS + 1 }; /* of a sample; the last is the first again */

struct horizon {
    table_grid grid;
    real *rise; /* ENTRIES of each sample */
};

/* What a walk in one direction needs. */
typedef struct walk {
    real du, dw; /* a step of one sample's width */
    real Pmax, range;
} walk;

/* Samples of one row that are walked from, side by side. */
typedef struct samples {
    int n;
    real u[LANES], w[LANES], P[LANES], half_bend[LANES], best[LANES];
} samples;

/* The unit vector of direction k in samples, |x| + |y| = 1: the inverse of bs_bearing_of. */
static void direction(int k, real *x, real *y)
{
    const real turn = (real)(4 * k) / HORIZON_DIRECTIONS;
    *x = real_abs(2 - turn) - 1;
    *y = turn <= 2 ? 1 - real_abs(turn - 1) : real_abs(turn - 3) - 1;
}

STAGE static void step_to(const samples *restrict s, const walk *k, real steps, real *restrict u, real *restrict w)
{
    for (int i = 0; i < s->n; i++) {
        u[i] = s->u[i] + k->du * steps;
        w[i] = s->w[i] + k->dw * steps;
    }
}

/* Raise the horizons. Returns for how many samples a higher bump farther on could raise it again. Where the surface
 * itself has risen by more than the bumps' range, that is its own shadow and no longer the bumps'. */
STAGE static int raise(samples *restrict s, const walk *k, real steps, const real *restrict P)
{
    const real share = 1 / steps;
    int open = 0;
    for (int i = 0; i < s->n; i++) {
        real drop = s->half_bend[i] * steps, rise = (P[i] - s->P[i]) * share + drop, so_far = s->best[i];
        int near = drop * steps <= k->range;
        real best = near & (rise > so_far) ? rise : so_far;
        s->best[i] = best;
        open += near & ((k->Pmax - s->P[i]) * share + drop > best) ? 1 : 0;
    }
    return open;
}

/* The curvature along the direction, and the horizon to begin with. */
static void bend(samples *s, const walk *k, const horizon_curvature *c, size_t at)
{
    for (int i = 0; i < s->n; i++) {
        const size_t j = at + (size_t)i;
        const real half = c ? (c->L[j] * k->du * k->du + 2 * c->M[j] * k->du * k->dw + c->N[j] * k->dw * k->dw) / 2 : 0;
        s->half_bend[i] = half == half ? half : 0;
        s->best[i] = s->half_bend[i] < 0 ? -REAL_FAR : 0;
    }
}

static void walk_direction(const bump *P, const table_grid *g, const walk *k, samples *s)
{
    const int far = g->columns > g->rows ? g->columns : g->rows;
    real u[LANES], w[LANES];
    bump_values h;
    for (int step = 1; step <= far; step++) {
        step_to(s, k, (real)step, u, w);
        P->ops->eval(P, s->n, u, w, 0, &h);
        if (raise(s, k, (real)step, h.P) == 0)
            break;
    }
}

/* The horizons of up to LANES samples of a row. */
static void build_block(horizon *h, const bump *P, const horizon_curvature *c, int row, int column)
{
    const table_grid *g = &h->grid;
    const size_t at = (size_t)row * (size_t)(g->columns + 1) + (size_t)column;
    const int left = g->columns + 1 - column;
    samples s = {.n = left < LANES ? left : LANES};
    bump_values start;
    for (int i = 0; i < s.n; i++) {
        s.u[i] = ((real)(column + i) - g->ou) / g->ku;
        s.w[i] = ((real)row - g->ow) / g->kw;
    }
    P->ops->eval(P, s.n, s.u, s.w, 0, &start);
    for (int i = 0; i < s.n; i++)
        s.P[i] = start.P[i];
    for (int k = 0; k < HORIZON_DIRECTIONS; k++) {
        real x, y;
        direction(k, &x, &y);
        const walk way = {.du = x / g->ku, .dw = y / g->kw, .Pmax = P->Pmax, .range = P->Pmax - P->Pmin};
        bend(&s, &way, c, at);
        walk_direction(P, g, &way, &s);
        for (int i = 0; i < s.n; i++)
            h->rise[(at + (size_t)i) * ENTRIES + (size_t)k] = s.best[i];
    }
    for (int i = 0; i < s.n; i++)
        h->rise[(at + (size_t)i) * ENTRIES + HORIZON_DIRECTIONS] = h->rise[(at + (size_t)i) * ENTRIES];
}

static size_t entries(const table_grid *g) { return (size_t)(g->columns + 1) * (size_t)(g->rows + 1) * ENTRIES; }

horizon *horizon_new(const bump *P, const table_grid *grid, const horizon_curvature *c, int threads)
{
    if (entries(grid) > INT32_MAX)
        return NULL;
    horizon *h = calloc(1, sizeof *h);
    real *rise = h ? malloc(entries(grid) * sizeof *rise) : NULL;
    if (!rise) {
        free(h);
        return NULL;
    }
    *h = (horizon){*grid, rise};
#pragma omp parallel for schedule(dynamic) num_threads(threads_of(threads))
    for (int row = 0; row <= grid->rows; row++)
        for (int column = 0; column <= grid->columns; column += LANES)
            build_block(h, P, c, row, column);
    return h;
}

void horizon_free(horizon *h)
{
    if (h)
        free(h->rise);
    free(h);
}

const table_grid *horizon_grid(const horizon *h) { return &h->grid; }

size_t horizon_bytes(const horizon *h) { return sizeof *h + entries(&h->grid) * sizeof *h->rise; }

/* Eight gathers: the corners of the cell, in two directions. */
STAGE static void look(const horizon *h, int n, const int32_t *restrict at, const real *restrict a,
                       const real *restrict b, const real *restrict bearing, real *restrict rise)
{
    const real *restrict v = h->rise;
    const int row = (h->grid.columns + 1) * ENTRIES;
#pragma omp simd
    for (int i = 0; i < n; i++) {
        real turn = bearing[i] * R(HORIZON_DIRECTIONS / 4.0);
        int k = (int)turn, p = at[i] * ENTRIES + k, q = p + row;
        real f = turn - (real)k;
        real p0 = bs_horizon(v[p], v[p + 1], f), p1 = bs_horizon(v[p + ENTRIES], v[p + ENTRIES + 1], f);
        real q0 = bs_horizon(v[q], v[q + 1], f), q1 = bs_horizon(v[q + ENTRIES], v[q + ENTRIES + 1], f);
        real left = p0 + (q0 - p0) * b[i], right = p1 + (q1 - p1) * b[i];
        rise[i] = left + (right - left) * a[i];
    }
}

void horizon_look(const horizon *h, int n, const real *u, const real *w, const real *bearing, real *rise)
{
    int32_t at[LANES];
    real a[LANES], b[LANES];
    table_cells(&h->grid, n, u, w, at, a, b);
    look(h, n, at, a, b, bearing, rise);
}
