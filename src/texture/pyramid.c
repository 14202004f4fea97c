/* Pyramids of bounds. A node is numbers of which each is the most of the nodes below: -lo and hi of P, Pu and Pw.
 *
 * Where the grid repeats, a rectangle may begin before its end and go on behind its start. So each level goes on for
 * some nodes behind the end, over the cells that follow there.
 */
#include "texture/pyramid.h"

#include <stdlib.h>
#include <string.h>

#include "base/gate.h"

enum {
    LEVELS = 32,
    BEHIND = 3, /* nodes that a level has behind the last whole one */
    NODE = 8,   /* numbers of a node: six and padding, so that they are one vector */
};

struct pyramid {
    table_grid grid;
    int levels;
    int32_t first[LEVELS], pitch[LEVELS], rows[LEVELS]; /* of each level: its first node, nodes in a row, rows */
    real *node;                                         /* NODE each */
};

/* ---- look-up ---- */

/* A number's exponent, by its bits. */
#ifdef KAGE_DOUBLE
enum { DIGITS = 52, BIAS = 1023 };
typedef int64_t bits;
#else
enum { DIGITS = 23, BIAS = 127 };
typedef int32_t bits;
#endif

/* The level whose nodes are longer than x >= 0, but no more than twice as long if longer than a cell. */
static inline int32_t level_over(real x)
{
    bits b;
    memcpy(&b, &x, sizeof b);
    return (int32_t)(b >> DIGITS) - BIAS + 1;
}

/* A cell's share of a node's side. */
static inline real share_at(int32_t level)
{
    const bits b = (bits)(BIAS - level) << DIGITS;
    real x;
    memcpy(&x, &b, sizeof x);
    return x;
}

/* The grid along an axis. */
typedef struct axis {
    real k, o, cells;
} axis;

/* Where ranges begin and end, in cells from the first one. The end may be up to a period behind the grid's where that
 * repeats; elsewhere both are on the grid, as P is constant beyond it. `air` is more than the roundings of this and of
 * table_cells. Called with a constant `repeat`, as a choice in the loop would prevent SIMD. */
static inline void place(axis g, int repeat, int n, const real *restrict x0, const real *restrict x1,
                         real *restrict first, real *restrict last, int32_t *restrict beyond)
{
    const real cells = g.cells, k = g.k, o = g.o, each = 1 / cells, most = repeat ? 2 * cells : cells;
    for (int i = 0; i < n; i++) {
        const real y0 = x0[i] * k + o, y1 = x1[i] * k + o, lo = real_min(y0, y1), hi = real_max(y0, y1);
        const real air = 2 * R(REAL_ROUNDING) * (real_abs(lo) + real_abs(hi) + real_abs(o) + cells);
        const real from = lo - air, to = hi + air, start = repeat ? real_floor(from * each) * cells : 0;
        const int some = to - from < cells; /* not NaN */
        const real a = real_min(real_max(from - start, 0), cells), b = real_min(real_max(to - start, a), most);
        first[i] = some ? a : 0;
        last[i] = some ? b : cells;
        beyond[i] = repeat ? 0 : !((from >= 0) & (to <= cells));
    }
}

STAGE static void place_repeat(axis g, int n, const real *x0, const real *x1, real *first, real *last, int32_t *beyond)
{
    place(g, 1, n, x0, x1, first, last, beyond);
}

STAGE static void place_clamp(axis g, int n, const real *x0, const real *x1, real *first, real *last, int32_t *beyond)
{
    place(g, 0, n, x0, x1, first, last, beyond);
}

/* What a range along each axis begins and ends with, and whether it goes beyond the grid. */
typedef struct spans {
    real a0[LANES], a1[LANES], b0[LANES], b1[LANES];
    int32_t beyond_u[LANES], beyond_w[LANES];
} spans;

/* The level of each range: what it goes over fits one node. */
STAGE static void levels_of(int most, int n, const spans *restrict x, int32_t *restrict level, real *restrict share)
{
    for (int i = 0; i < n; i++) {
        const real size = real_max(x->a1[i] - x->a0[i], x->b1[i] - x->b0[i]);
        const int32_t up = level_over(size), k = up < 0 ? 0 : up > most ? most : up;
        level[i] = k;
        share[i] = share_at(k);
    }
}

static inline int32_t lesser_of(int32_t a, int32_t b) { return a < b ? a : b; }

/* The 2 x 2 nodes; some or all of them may be the same. */
STAGE static void nodes_of(const pyramid *restrict y, int n, const spans *restrict x, const int32_t *restrict level,
                           const real *restrict share, int32_t *restrict p, int32_t *restrict q, int32_t *restrict r,
                           int32_t *restrict s)
{
    const int32_t *restrict first = y->first, *restrict pitches = y->pitch, *restrict rows = y->rows;
    for (int i = 0; i < n; i++) {
        const real k = share[i];
        const int32_t pitch = pitches[level[i]], right = pitch - 1, low = rows[level[i]] - 1;
        const int32_t c0 = lesser_of((int32_t)(x->a0[i] * k), right), r0 = lesser_of((int32_t)(x->b0[i] * k), low);
        const int32_t c1 = lesser_of(lesser_of((int32_t)(x->a1[i] * k), c0 + 1), right);
        const int32_t r1 = lesser_of(lesser_of((int32_t)(x->b1[i] * k), r0 + 1), low);
        const int32_t upper = first[level[i]] + r0 * pitch, lower = first[level[i]] + r1 * pitch;
        p[i] = upper + c0;
        q[i] = upper + c1;
        r[i] = lower + c0;
        s[i] = lower + c1;
    }
}

/* A node is one vector, so this takes four loads a lane and no gather. */
STAGE static void most_of(const real *restrict v, int n, const int32_t *restrict p, const int32_t *restrict q,
                          const int32_t *restrict r, const int32_t *restrict s, real (*restrict out)[NODE])
{
    for (int i = 0; i < n; i++) {
        const real *a = v + (size_t)p[i] * NODE, *b = v + (size_t)q[i] * NODE;
        const real *c = v + (size_t)r[i] * NODE, *d = v + (size_t)s[i] * NODE;
        for (int k = 0; k < NODE; k++)
            out[i][k] = real_max(real_max(a[k], b[k]), real_max(c[k], d[k]));
    }
}

/* Bilinear look-ups are rounded, and may pass the samples by as much. Beyond the grid P does not change along its axis.
 */
STAGE static void unpack(int n, const spans *restrict x, const real (*restrict from)[NODE], bump_ranges *restrict out)
{
    for (int i = 0; i < n; i++) {
        const real lo = -from[i][0], hi = from[i][1], air = 4 * R(REAL_ROUNDING) * real_max(real_abs(lo), real_abs(hi));
        const real u0 = from[i][2], u1 = from[i][3], w0 = from[i][4], w1 = from[i][5];
        out->lo[i] = lo - air;
        out->hi[i] = hi + air;
        out->Pu_lo[i] = -(x->beyond_u[i] ? real_max(u0, 0) : u0);
        out->Pu_hi[i] = x->beyond_u[i] ? real_max(u1, 0) : u1;
        out->Pw_lo[i] = -(x->beyond_w[i] ? real_max(w0, 0) : w0);
        out->Pw_hi[i] = x->beyond_w[i] ? real_max(w1, 0) : w1;
        out->Pu[i] = real_max(u0, u1);
        out->Pw[i] = real_max(w0, w1);
    }
}

void pyramid_ranges(const pyramid *y, int n, const real *u0, const real *u1, const real *w0, const real *w1,
                    bump_ranges *out)
{
    real share[LANES], most[LANES][NODE];
    int32_t level[LANES], p[LANES], q[LANES], r[LANES], s[LANES];
    spans x;
    const table_grid *g = &y->grid;
    const axis u = {g->ku, g->ou, (real)g->columns}, w = {g->kw, g->ow, (real)g->rows};
    (g->repeat ? place_repeat : place_clamp)(u, n, u0, u1, x.a0, x.a1, x.beyond_u);
    (g->repeat ? place_repeat : place_clamp)(w, n, w0, w1, x.b0, x.b1, x.beyond_w);
    levels_of(y->levels - 1, n, &x, level, share);
    nodes_of(y, n, &x, level, share, p, q, r, s);
    most_of(y->node, n, p, q, r, s, most);
    unpack(n, &x, (const real(*)[NODE])most, out);
}

/* ---- building ---- */

static real above(double x)
{
    const real r = (real)x;
#ifdef KAGE_DOUBLE
    return r;
#else
    return (double)r < x ? nextafterf(r, HUGE_VALF) : r;
#endif
}

/* Of cells first..last of n: those of the nodes of 2^k cells that cover them. */
typedef struct nodes {
    int first, last;
} nodes;

/* The nodes of level k that node i of the next level covers. */
static nodes below(int i, int k, int cells, int repeat)
{
    const int64_t size = (int64_t)2 << k, at = i * size, from = repeat ? at % cells : at < cells ? at : cells - 1;
    const int64_t to = from + size - 1, last = repeat || to < cells ? to : cells - 1;
    return (nodes){(int)(from >> k), (int)(last >> k)};
}

static void join(real *to, const real *from)
{
    for (int k = 0; k < NODE; k++)
        to[k] = real_max(to[k], from[k]);
}

static real *node_of(const pyramid *y, int level, int row, int column)
{
    const size_t at = (size_t)y->first[level] + (size_t)row * (size_t)y->pitch[level] + (size_t)column;
    return y->node + at * NODE;
}

static int cell_at(int i, int cells, int repeat) { return i < cells ? i : repeat ? i % cells : cells - 1; }

static void lay_bottom(pyramid *y, cell_range (*cell)(const void *user, int row, int column), const void *user,
                       gate *on)
{
    const table_grid *g = &y->grid;
    for (int j = 0; j < y->rows[0] && gate_is_open(on); j++, gate_pass(on, 1))
        for (int i = 0; i < y->pitch[0]; i++) {
            real *to = node_of(y, 0, j, i);
            if (j >= g->rows || i >= g->columns) {
                const real *same = node_of(y, 0, cell_at(j, g->rows, g->repeat), cell_at(i, g->columns, g->repeat));
                for (int k = 0; k < NODE; k++)
                    to[k] = same[k];
                continue;
            }
            const cell_range c = cell(user, j, i);
            const double v[NODE] = {-c.lo, c.hi, -c.Pu_lo, c.Pu_hi, -c.Pw_lo, c.Pw_hi};
            for (int k = 0; k < NODE; k++)
                to[k] = v[k] == v[k] ? above(v[k]) : (real)HUGE_VAL; /* NaN: from a sample that is */
        }
}

static void lay_level(pyramid *y, int level, gate *on)
{
    const table_grid *g = &y->grid;
    for (int j = 0; j < y->rows[level] && gate_is_open(on); j++, gate_pass(on, 1))
        for (int i = 0; i < y->pitch[level]; i++) {
            const nodes r = below(j, level - 1, g->rows, g->repeat), c = below(i, level - 1, g->columns, g->repeat);
            real *to = node_of(y, level, j, i);
            for (int k = 0; k < NODE; k++)
                to[k] = -(real)HUGE_VAL;
            for (int b = r.first; b <= r.last; b++)
                for (int a = c.first; a <= c.last; a++)
                    join(to, node_of(y, level - 1, b, a));
        }
}

pyramid *pyramid_new(const table_grid *grid, cell_range (*cell)(const void *user, int row, int column),
                     const void *user, const progress *w)
{
    const int longest = grid->columns > grid->rows ? grid->columns : grid->rows;
    pyramid *y = calloc(1, sizeof *y);
    int64_t nodes_in_all = 0;
    gate on = {.to = w, .what = "building"};
    if (!y)
        return NULL;
    y->grid = *grid;
    for (int k = 0; k == 0 || (int64_t)1 << (k - 1) < longest; k++) {
        y->first[k] = (int32_t)nodes_in_all;
        y->pitch[k] = (grid->columns >> k) + BEHIND;
        y->rows[k] = (grid->rows >> k) + BEHIND;
        nodes_in_all += (int64_t)y->pitch[k] * y->rows[k];
        on.all += y->rows[k];
        y->levels = k + 1;
    }
    y->node =
        nodes_in_all < INT32_MAX ? memory_new(progress_memory(w), sizeof(real) * NODE * (size_t)nodes_in_all) : NULL;
    if (!y->node) {
        free(y);
        return NULL;
    }
    lay_bottom(y, cell, user, &on);
    for (int k = 1; k < y->levels; k++)
        lay_level(y, k, &on);
    if (gate_is_open(&on))
        return y;
    pyramid_free(y);
    return NULL;
}

void pyramid_free(pyramid *y)
{
    if (y)
        memory_free(y->node);
    free(y);
}
