/* Building horizon maps, and looking them up.
 *
 * From each sample a walk goes in each direction, until the highest bump there is, Pmax, could not rise above the
 * horizon found so far. Its steps are a sample wide at first and then a share of the way so far: what they pass by
 * between would raise the horizon by little. On a curved surface the curvature's drop is added to P.
 */
#include "texture/horizon.h"

#include <stdlib.h>
#include <string.h>

#include "base/gate.h"
#include "wave/lane.h"

#define LEAST 0.005 /* of the steepest slope: a rise that does not matter */

enum { ENTRIES = HORIZON_DIRECTIONS + 1 }; /* of a sample; the last is the first again */

struct horizon {
    table_grid grid;
    real *rise; /* ENTRIES of each sample */
};

enum {
    NEAR = 16,   /* steps of one sample; later ones are 1/NEAR of the way */
    COMPACT = 8, /* after so many steps, walks that have ended are dropped */
};

/* What walks in one direction need. */
typedef struct walk {
    real du, dw;             /* a step of one sample's width */
    real Pmax, range, least; /* a rise of `least` more does not matter */
    real u[2], w[2];         /* where there are bumps */
} walk;

/* Walks from samples of one row, side by side. */
typedef struct walks {
    int n;
    int32_t lane[LANES], open[LANES];
    real u[LANES], w[LANES], P[LANES], half_bend[LANES], best[LANES];
} walks;

/* The unit vector of direction k in samples, |x| + |y| = 1: the inverse of bs_bearing_of. */
static void direction(int k, real *x, real *y)
{
    const real turn = (real)(4 * k) / HORIZON_DIRECTIONS;
    *x = real_abs(2 - turn) - 1;
    *y = turn <= 2 ? 1 - real_abs(turn - 1) : real_abs(turn - 3) - 1;
}

STAGE static void step_to(const walks *restrict s, const walk *k, real way, real *restrict u, real *restrict w)
{
    for (int i = 0; i < s->n; i++) {
        u[i] = s->u[i] + k->du * way;
        w[i] = s->w[i] + k->dw * way;
    }
}

/* Raise the horizons. A walk is open if a higher bump farther on could raise its own again. Where the surface itself
 * has risen by more than the bumps' range, that is its own shadow and no longer the bumps'. */
STAGE static void raise_horizon(walks *restrict s, const walk *k, real way, const real *restrict u,
                                const real *restrict w, const real *restrict P)
{
    const real share = 1 / way, top = k->Pmax, range = k->range, least = k->least;
    const real u0 = k->u[0], u1 = k->u[1], w0 = k->w[0], w1 = k->w[1];
    for (int i = 0; i < s->n; i++) {
        real drop = s->half_bend[i] * way, rise = (P[i] - s->P[i]) * share + drop, so_far = s->best[i];
        int near = (drop * way <= range) & (u[i] >= u0) & (u[i] <= u1) & (w[i] >= w0) & (w[i] <= w1);
        real best = (near & (rise > so_far)) ? rise : so_far;
        s->best[i] = best;
        s->open[i] = near & ((top - s->P[i]) * share + drop > best + least);
    }
}

/* Drop the walks that have ended, after their horizons are stored. */
static void compact(walks *s, real *best)
{
    int n = 0;
    for (int i = 0; i < s->n; i++) {
        best[s->lane[i]] = s->best[i];
        s->lane[n] = s->lane[i];
        s->u[n] = s->u[i];
        s->w[n] = s->w[i];
        s->P[n] = s->P[i];
        s->half_bend[n] = s->half_bend[i];
        s->best[n] = s->best[i];
        n += s->open[i];
    }
    s->n = n;
}

static void walk_far(const bump *P, const table_grid *g, const walk *k, walks *s, real *best)
{
    const real far = (real)(g->columns > g->rows ? g->columns : g->rows);
    real u[LANES], w[LANES], way = 0;
    bump_values h;
    for (int step = 1; way < far && s->n; step++) {
        way += real_max(1, real_floor(way / NEAR));
        step_to(s, k, way, u, w);
        P->ops->eval(P, s->n, u, w, 0, &h);
        raise_horizon(s, k, way, u, w, h.P);
        if (step % COMPACT == 0)
            compact(s, best);
    }
    compact(s, best);
}

/* Half the curvature along the direction, and the horizon to begin with: without bumps it is 0, or below where the
 * surface curves away. */
static void bend(walks *s, const walk *k, const horizon_curvature *c, size_t at)
{
    for (int i = 0; i < s->n; i++) {
        const size_t j = at + (size_t)i;
        const real half = c ? (c->L[j] * k->du * k->du + 2 * c->M[j] * k->du * k->dw + c->N[j] * k->dw * k->dw) / 2 : 0;
        s->half_bend[i] = half == half ? half : 0;
        s->best[i] = s->half_bend[i] < 0 ? -REAL_FAR : 0;
    }
}

static void start_walks(const bump *P, const table_grid *g, int row, int column, walks *s)
{
    const int left = g->columns + 1 - column;
    bump_values h;
    s->n = left < LANES ? left : LANES;
    for (int i = 0; i < s->n; i++) {
        s->lane[i] = i;
        s->u[i] = ((real)(column + i) - g->ou) / g->ku;
        s->w[i] = ((real)row - g->ow) / g->kw;
    }
    P->ops->eval(P, s->n, s->u, s->w, 0, &h);
    memcpy(s->P, h.P, sizeof s->P);
}

static void set_ends(const table_grid *g, bool ends, walk *k)
{
    const real u[2] = {-g->ou / g->ku, ((real)g->columns - g->ou) / g->ku},
               w[2] = {-g->ow / g->kw, ((real)g->rows - g->ow) / g->kw};
    k->u[0] = ends ? real_min(u[0], u[1]) : -REAL_FAR;
    k->u[1] = ends ? real_max(u[0], u[1]) : REAL_FAR;
    k->w[0] = ends ? real_min(w[0], w[1]) : -REAL_FAR;
    k->w[1] = ends ? real_max(w[0], w[1]) : REAL_FAR;
}

/* The horizons of up to LANES samples of a row. */
static void build_block(horizon *h, const bump *P, bool ends, const horizon_curvature *c, int row, int column)
{
    const table_grid *g = &h->grid;
    const size_t at = (size_t)row * (size_t)(g->columns + 1) + (size_t)column;
    walks all, s;
    real best[LANES];
    start_walks(P, g, row, column, &all);
    for (int k = 0; k < HORIZON_DIRECTIONS; k++) {
        real x, y;
        direction(k, &x, &y);
        walk way = {.du = x / g->ku, .dw = y / g->kw, .Pmax = P->Pmax, .range = P->Pmax - P->Pmin};
        way.least = R(LEAST) * (P->Pu_max * real_abs(way.du) + P->Pw_max * real_abs(way.dw));
        set_ends(g, ends, &way);
        s = all;
        bend(&s, &way, c, at);
        walk_far(P, g, &way, &s, best);
        for (int i = 0; i < all.n; i++)
            h->rise[(at + (size_t)i) * ENTRIES + (size_t)k] = best[i];
    }
    for (int i = 0; i < all.n; i++)
        h->rise[(at + (size_t)i) * ENTRIES + HORIZON_DIRECTIONS] = h->rise[(at + (size_t)i) * ENTRIES];
}

static size_t entries(const table_grid *g) { return (size_t)(g->columns + 1) * (size_t)(g->rows + 1) * ENTRIES; }

horizon *horizon_new(const bump *P, const table_grid *grid, bool ends, const horizon_curvature *c, int threads,
                     const progress *w)
{
    threads = threads_of(threads);
    (void)threads; /* without OpenMP */
    if (entries(grid) > INT32_MAX)
        return NULL;
    horizon *h = calloc(1, sizeof *h);
    real *rise = h ? memory_new(progress_memory(w), entries(grid) * sizeof *rise) : NULL;
    if (!rise) {
        free(h);
        return NULL;
    }
    *h = (horizon){*grid, rise};
    const int blocks = grid->columns / LANES + 1, all = (grid->rows + 1) * blocks;
    gate g = {.to = w, .what = "horizons", .all = all};
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (int k = 0; k < all; k++)
        if (gate_is_open(&g)) {
            build_block(h, P, ends, c, k / blocks, k % blocks * LANES);
            gate_pass(&g, 1);
        }
    if (gate_is_open(&g))
        return h;
    horizon_free(h);
    return NULL;
}

void horizon_free(horizon *h)
{
    if (h)
        memory_free(h->rise);
    free(h);
}

const table_grid *horizon_grid(const horizon *h) { return &h->grid; }

/* Eight gathers: the corners of the cell, in two directions. */
STAGE static void look_up(const horizon *h, int n, const int32_t *restrict at, const real *restrict a,
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
    table_cells(&h->grid, h->grid.columns + 1, n, u, w, at, a, b);
    look_up(h, n, at, a, b, bearing, rise);
}
