/* Nodes of eight boxes, built from the top by the surface area heuristic [Wald, On fast Construction of SAH-based
 * Bounding Volume Hierarchies, 2007]: of a node's parts the largest is halved until there are eight. All arithmetic is
 * float's + - * / and comparisons, so the same rays reach the same items everywhere. A node's box contains its items'
 * boxes exactly, and the test of a ray and a box is monotonic, so no item depends on the nodes above it.
 */
#include "bvh/wide.h"

#include "base/bits.h"
#include "base/real.h"
#include "base/threads.h"

#include <stdlib.h>
#include <string.h>

enum {
    WIDTH = 8,
    BINS = 16,
    BY_AREA = 14,     /* levels; below, parts are halved by number: at most 10 levels more, so the stack suffices */
    WORK = 320,       /* nodes and items that a beam tests; in more, single rays are faster */
    FOR_TASKS = 8192, /* items of a part that gets a task of its own */
};

/* By so many of float's roundings boxes and rays are wider. */
#define WIDER (16 * 1.2e-7)

/* What the division by 0 becomes: finite, so that 0 times it is 0. */
#define STEEP 1e30f

typedef struct node {
    float lo[3][WIDTH], hi[3][WIDTH];
    int32_t child[WIDTH]; /* a node, or ~item */
    unsigned present;     /* a bit for each child */
} node;

struct wide_bvh {
    int n, nodes;
    node *node; /* the first is the root */
};

/* ---- boxes ---- */

wide_box wide_box_of(const double lo[3], const double hi[3])
{
    wide_box b;
    for (int k = 0; k < 3; k++) {
        const double air = WIDER * (fabs(lo[k]) + fabs(hi[k]));
        b.lo[k] = (float)(lo[k] - air);
        b.hi[k] = (float)(hi[k] + air);
    }
    return b;
}

static wide_box nothing(void)
{
    return (wide_box){{HUGE_VALF, HUGE_VALF, HUGE_VALF}, {-HUGE_VALF, -HUGE_VALF, -HUGE_VALF}};
}

static inline void include(wide_box *b, const wide_box *x)
{
    for (int k = 0; k < 3; k++) {
        b->lo[k] = x->lo[k] < b->lo[k] ? x->lo[k] : b->lo[k];
        b->hi[k] = x->hi[k] > b->hi[k] ? x->hi[k] : b->hi[k];
    }
}

/* Half the surface. */
static float area(const wide_box *b)
{
    const float x = b->hi[0] - b->lo[0], y = b->hi[1] - b->lo[1], z = b->hi[2] - b->lo[2];
    return x * y + y * z + z * x;
}

/* Twice the middle. */
static inline float middle(const wide_box *b, int axis) { return b->lo[axis] + b->hi[axis]; }

/* ---- building ---- */

typedef struct builder {
    wide_bvh *w;
    const wide_box *box;
    int32_t *order;
} builder;

/* The items order[from..to). */
typedef struct part {
    int from, to;
    wide_box box, middles;
} part;

static part part_of(const builder *b, int from, int to)
{
    part p = {from, to, nothing(), nothing()};
    for (int i = from; i < to; i++) {
        const wide_box *x = &b->box[b->order[i]];
        wide_box at;
        for (int k = 0; k < 3; k++)
            at.lo[k] = at.hi[k] = middle(x, k);
        include(&p.box, x);
        include(&p.middles, &at);
    }
    return p;
}

static int longest(const part *p)
{
    float l[3];
    for (int k = 0; k < 3; k++)
        l[k] = p->middles.hi[k] - p->middles.lo[k];
    return l[0] >= l[1] && l[0] >= l[2] ? 0 : l[1] >= l[2] ? 1 : 2;
}

static inline int bin_of(const wide_box *x, int axis, float least, float scale)
{
    const int k = (int)((middle(x, axis) - least) * scale);
    return k < BINS ? k : BINS - 1;
}

/* The number of low bins that go to one side. */
static int cheapest(const int count[BINS], const wide_box bin[BINS])
{
    float right[BINS], best = HUGE_VALF;
    wide_box all = nothing();
    int number = 0, at = 1;
    for (int k = BINS - 1; k > 0; k--) {
        include(&all, &bin[k]);
        number += count[k];
        right[k] = number ? area(&all) * (float)number : HUGE_VALF;
    }
    all = nothing();
    number = 0;
    for (int k = 1; k < BINS; k++) {
        include(&all, &bin[k - 1]);
        number += count[k - 1];
        const float cost = number ? area(&all) * (float)number + right[k] : HUGE_VALF;
        if (cost < best) {
            best = cost;
            at = k;
        }
    }
    return at;
}

/* Put the items of one side first. Returns where the other side begins. */
static int divide(const builder *b, const part *p, int axis)
{
    const float least = p->middles.lo[axis], scale = BINS / (p->middles.hi[axis] - least);
    int count[BINS] = {0}, at = p->from;
    wide_box bin[BINS];
    for (int k = 0; k < BINS; k++)
        bin[k] = nothing();
    for (int i = p->from; i < p->to; i++) {
        const wide_box *x = &b->box[b->order[i]];
        const int k = bin_of(x, axis, least, scale);
        count[k]++;
        include(&bin[k], x);
    }
    const int split = cheapest(count, bin);
    for (int i = p->from; i < p->to; i++) {
        const int32_t item = b->order[i];
        if (bin_of(&b->box[item], axis, least, scale) < split) {
            b->order[i] = b->order[at];
            b->order[at++] = item;
        }
    }
    return at;
}

static void halve(const builder *b, const part *p, int level, part *low, part *high)
{
    const int axis = longest(p), half = p->from + (p->to - p->from) / 2;
    const float width = p->middles.hi[axis] - p->middles.lo[axis];
    int at = half;
    if (level < BY_AREA && BINS / width < HUGE_VALF)
        at = divide(b, p, axis);
    if (at == p->from || at == p->to)
        at = half;
    *low = part_of(b, p->from, at);
    *high = part_of(b, at, p->to);
}

/* The part with the largest boxes' area times its number of items; -1: all have one item. */
static int largest(const part *p, int n)
{
    float most = -1;
    int at = -1;
    for (int k = 0; k < n; k++) {
        const int items = p[k].to - p[k].from;
        const float x = area(&p[k].box) * (float)items;
        if (items > 1 && (at < 0 || x > most)) {
            most = x;
            at = k;
        }
    }
    return at;
}

/* By number, so that the largest has at most an eighth, and one more. */
static int most_items(const part *p, int n)
{
    int at = 0;
    for (int k = 1; k < n; k++)
        at = p[k].to - p[k].from > p[at].to - p[at].from ? k : at;
    return p[at].to - p[at].from > 1 ? at : -1;
}

static int32_t new_node(builder *b)
{
    int32_t k;
#pragma omp atomic capture
    k = b->w->nodes++;
    return k;
}

/* The node of a part, with those below it. */
static void build(builder *b, const part *all, int32_t to, int level)
{
    part p[WIDTH];
    int n = 1, k;
    p[0] = *all;
    while (n < WIDTH && (k = level < BY_AREA ? largest(p, n) : most_items(p, n)) >= 0) {
        const part whole = p[k];
        memmove(&p[k + 2], &p[k + 1], sizeof *p * (size_t)(n - k - 1)); /* in order, for the items' order */
        halve(b, &whole, level, &p[k], &p[k + 1]);
        n++;
    }
    node *x = &b->w->node[to];
    x->present = (1u << n) - 1;
    for (int c = 0; c < WIDTH; c++) {
        const part *of = &p[c < n ? c : 0];
        const bool leaf = of->to - of->from == 1;
        for (int a = 0; a < 3; a++) {
            x->lo[a][c] = of->box.lo[a];
            x->hi[a][c] = of->box.hi[a];
        }
        x->child[c] = leaf ? ~of->from : c < n ? new_node(b) : 0;
    }
    for (int c = 0; c < n; c++) {
        const part of = p[c];
        const int32_t its = x->child[c];
        if (its < 0)
            continue;
#pragma omp task if (of.to - of.from >= FOR_TASKS)
        build(b, &of, its, level + 1);
    }
#pragma omp taskwait
}

wide_bvh *wide_new(int n, const wide_box *box, int32_t *order, int threads)
{
    wide_bvh *w = calloc(1, sizeof *w);
    if (!w)
        return NULL;
    w->n = n;
    /* a node with a node below it has eight children, any other but the root two items or more: so at most 4/7 n + 1 */
    w->node = malloc(sizeof *w->node * (4 * (size_t)n / 7 + 2));
    if (!w->node) {
        free(w);
        return NULL;
    }
    for (int i = 0; i < n; i++)
        order[i] = i;
    builder b = {w, box, order};
    const part all = part_of(&b, 0, n);
    const int32_t root = new_node(&b);
    threads = threads_of(threads);
#pragma omp parallel num_threads(threads)
#pragma omp single
    build(&b, &all, root, 0);
    node *less = realloc(w->node, sizeof *w->node * (size_t)w->nodes);
    w->node = less ? less : w->node;
    return w;
}

void wide_free(wide_bvh *w)
{
    if (w)
        free(w->node);
    free(w);
}

size_t wide_size(const wide_bvh *w) { return sizeof *w + sizeof *w->node * (size_t)w->nodes; }

/* ---- a ray ---- */

/* 1/s, finite. */
static float over(double s)
{
    const double x = 1 / s;
    return x > -(double)STEEP && x < (double)STEEP ? (float)x : STEEP;
}

/* An end in float, and a little later. */
static float later(double end) { return end < (double)STEEP ? (float)(end * (1 + WIDER)) : STEEP; }

void wide_begin(wide_walk *k, vec3 r, vec3 s)
{
    const double at[3] = {r.x, r.y, r.z}, way[3] = {s.x, s.y, s.z};
    const double air = WIDER * (fabs(r.x) + fabs(r.y) + fabs(r.z));
    for (int a = 0; a < 3; a++) {
        k->low[a] = (float)(at[a] + air);
        k->high[a] = (float)(at[a] - air);
        k->over[a] = over(way[a]);
    }
    k->top = 1;
    k->enter[0] = 0;
    k->left[0] = 0;
}

/* Where the ray enters the node's eight boxes. Returns a bit for each that it passes up to `end`. */
STAGE static unsigned wide_pass(const node *restrict x, const wide_walk *restrict k, float end, float *restrict enter)
{
    const float lx = k->low[0], ly = k->low[1], lz = k->low[2], hx = k->high[0], hy = k->high[1], hz = k->high[2];
    const float ox = k->over[0], oy = k->over[1], oz = k->over[2];
    unsigned met = 0;
    for (int c = 0; c < WIDTH; c++) {
        const float ax = (x->lo[0][c] - lx) * ox, bx = (x->hi[0][c] - hx) * ox;
        const float ay = (x->lo[1][c] - ly) * oy, by = (x->hi[1][c] - hy) * oy;
        const float az = (x->lo[2][c] - lz) * oz, bz = (x->hi[2][c] - hz) * oz;
        const float nx = ax < bx ? ax : bx, fx = ax > bx ? ax : bx;
        const float ny = ay < by ? ay : by, fy = ay > by ? ay : by;
        const float nz = az < bz ? az : bz, fz = az > bz ? az : bz;
        const float nxy = nx > ny ? nx : ny, fxy = fx < fy ? fx : fy;
        const float in = nxy > nz ? nxy : nz, out = fxy < fz ? fxy : fz;
        const float from = in > 0 ? in : 0, to = out * (float)(1 + WIDER), last = to < end ? to : end;
        enter[c] = from;
        met |= from <= last ? 1u << c : 0;
    }
    return met;
}

/* Put the children that the ray passes on the stack, the nearest last. */
static void push(const node *x, wide_walk *k, float end)
{
    float enter[WIDTH];
    const int bottom = k->top;
    for (unsigned met = wide_pass(x, k, end, enter) & x->present; met; met &= met - 1) {
        const int c = lowest_bit(met);
        int at = k->top++;
        for (; at > bottom && k->enter[at - 1] < enter[c]; at--) {
            k->enter[at] = k->enter[at - 1];
            k->left[at] = k->left[at - 1];
        }
        k->enter[at] = enter[c];
        k->left[at] = x->child[c];
    }
}

int32_t wide_next(const wide_bvh *w, wide_walk *k, double end)
{
    const float last = later(end);
    while (k->top > 0) {
        const int at = --k->top;
        const int32_t x = k->left[at];
        if (k->enter[at] > last)
            continue;
        if (x < 0)
            return ~x;
        push(&w->node[x], k, last);
    }
    return -1;
}

/* ---- a beam of rays ---- */

/* The least of 16 numbers, which are used up; halves are compared, as a sum over lanes would not vectorise. */
static inline float least16(float *restrict v)
{
    for (int i = 0; i < 8; i++)
        v[i] = v[i] < v[i + 8] ? v[i] : v[i + 8];
    for (int i = 0; i < 4; i++)
        v[i] = v[i] < v[i + 4] ? v[i] : v[i + 4];
    const float a = v[0] < v[2] ? v[0] : v[2], b = v[1] < v[3] ? v[1] : v[3];
    return a < b ? a : b;
}

/* The least and the most of 16 numbers. */
static inline void bounds16(const float *restrict v, float *least, float *most)
{
    float low[WIDE_RAYS], high[WIDE_RAYS];
    for (int i = 0; i < WIDE_RAYS; i++) {
        low[i] = v[i];
        high[i] = -v[i];
    }
    *least = least16(low);
    *most = -least16(high);
}

/* Ends in float, a little later, and the largest. */
STAGE static void wide_beam_ends(wide_beam *restrict k, const float *restrict end)
{
    float none;
    for (int i = 0; i < WIDE_RAYS; i++)
        k->end[i] = end[i] < STEEP ? end[i] * (float)(1 + WIDER) : STEEP;
    bounds16(k->end, &none, &k->far);
}

/* The rays at[axis] + way[axis] t, wider by their rounding, and the bounds of all. */
STAGE static void wide_beam_rays_begin(wide_beam *restrict k, const float (*restrict at)[WIDE_RAYS],
                                       const float (*restrict way)[WIDE_RAYS])
{
    float none;
    for (int i = 0; i < WIDE_RAYS; i++) {
        const float x = at[0][i], y = at[1][i], z = at[2][i];
        const float air = (float)WIDER * (fabsf(x) + fabsf(y) + fabsf(z));
        k->low[0][i] = x + air, k->high[0][i] = x - air;
        k->low[1][i] = y + air, k->high[1][i] = y - air;
        k->low[2][i] = z + air, k->high[2][i] = z - air;
    }
    for (int a = 0; a < 3; a++) {
        for (int i = 0; i < WIDE_RAYS; i++) {
            const float x = 1 / way[a][i], least = x > -STEEP ? x : STEEP;
            k->over[a][i] = least < STEEP ? least : STEEP;
        }
        bounds16(k->high[a], &k->first[a], &none);
        bounds16(k->low[a], &none, &k->last[a]);
        bounds16(way[a], &k->slow[a][0], &k->fast[a][0]); /* s itself, until turn() */
    }
}

/* Lanes of an array; for those that the beam lacks the first one. */
static void pick16(int n, const int32_t *lane, const real *from, float *to)
{
    for (int i = 0; i < WIDE_RAYS; i++)
        to[i] = (float)from[lane[i < n ? i : 0]];
}

void wide_beam_shorten(wide_beam *k, const int32_t *lane, const real *end)
{
    float to[WIDE_RAYS];
    pick16(k->n, lane, end, to);
    for (int i = k->n; i < WIDE_RAYS; i++)
        to[i] = -1;
    wide_beam_ends(k, to);
}

/* From s to what a bound of t needs. */
static void turn(float k[3], bool from_below)
{
    const float x = over((double)k[0]);
    k[0] = from_below ? x : 0;
    k[1] = from_below ? 0 : x;
    k[2] = from_below ? STEEP : 0;
}

void wide_beam_begin(wide_beam *k, int n, const int32_t *lane, const real *const r[3], const real *const s[3],
                     const real *end)
{
    float at[3][WIDE_RAYS], way[3][WIDE_RAYS];
    for (int a = 0; a < 3; a++) {
        pick16(n, lane, r[a], at[a]);
        pick16(n, lane, s[a], way[a]);
    }
    k->n = n;
    wide_beam_rays_begin(k, (const float(*)[WIDE_RAYS])at, (const float(*)[WIDE_RAYS])way);
    for (int a = 0; a < 3; a++) {
        turn(k->slow[a], k->slow[a][0] < 0);
        turn(k->fast[a], !(k->fast[a][0] < 0));
    }
    wide_beam_shorten(k, lane, end);
    k->top = 1;
    k->enter[0] = 0;
    k->left[0] = 0;
    k->work = WORK;
}

/* The bounds of t on one axis, from below and from above. */
static inline void bound(float lo, float hi, const wide_beam *k, int a, float *from, float *to)
{
    const float slow = hi - k->first[a], fast = lo - k->last[a];
    const float s0 = slow * k->slow[a][0], s1 = slow * k->slow[a][1] + k->slow[a][2];
    const float f0 = fast * k->fast[a][0], f1 = fast * k->fast[a][1] + k->fast[a][2];
    const float below = s0 > f0 ? s0 : f0, above = s1 < f1 ? s1 : f1;
    *from = *from > below ? *from : below;
    *to = *to < above ? *to : above;
}

/* Where the beam enters the node's eight boxes. Returns a bit for each that some ray may pass. */
STAGE static unsigned wide_beam_pass(const node *restrict x, const wide_beam *restrict k, float *restrict enter)
{
    unsigned met = 0;
    for (int c = 0; c < WIDTH; c++) {
        float from = 0, to = STEEP;
        bound(x->lo[0][c], x->hi[0][c], k, 0, &from, &to);
        bound(x->lo[1][c], x->hi[1][c], k, 1, &from, &to);
        bound(x->lo[2][c], x->hi[2][c], k, 2, &from, &to);
        to *= (float)(1 + 2 * WIDER);
        const float last = to < k->far ? to : k->far;
        enter[c] = from;
        met |= from <= last ? 1u << c : 0;
    }
    return met;
}

/* A bit for each ray of the beam that passes box c of the node. */
STAGE static unsigned wide_beam_rays(const node *restrict x, int c, const wide_beam *restrict k)
{
    const float lx = x->lo[0][c], ly = x->lo[1][c], lz = x->lo[2][c];
    const float hx = x->hi[0][c], hy = x->hi[1][c], hz = x->hi[2][c];
    unsigned met = 0;
    for (int i = 0; i < WIDE_RAYS; i++) {
        const float ox = k->over[0][i], oy = k->over[1][i], oz = k->over[2][i];
        const float ax = (lx - k->low[0][i]) * ox, bx = (hx - k->high[0][i]) * ox;
        const float ay = (ly - k->low[1][i]) * oy, by = (hy - k->high[1][i]) * oy;
        const float az = (lz - k->low[2][i]) * oz, bz = (hz - k->high[2][i]) * oz;
        const float nx = ax < bx ? ax : bx, fx = ax > bx ? ax : bx;
        const float ny = ay < by ? ay : by, fy = ay > by ? ay : by;
        const float nz = az < bz ? az : bz, fz = az > bz ? az : bz;
        const float nxy = nx > ny ? nx : ny, fxy = fx < fy ? fx : fy;
        const float in = nxy > nz ? nxy : nz, out = fxy < fz ? fxy : fz;
        const float from = in > 0 ? in : 0, to = out * (float)(1 + WIDER), last = to < k->end[i] ? to : k->end[i];
        met |= from <= last ? 1u << i : 0;
    }
    return met;
}

/* As for one ray. */
static void push_beam(const wide_bvh *w, int32_t at_node, wide_beam *k)
{
    const node *x = &w->node[at_node];
    float enter[WIDTH];
    const int bottom = k->top;
    for (unsigned met = wide_beam_pass(x, k, enter) & x->present; met; met &= met - 1) {
        const int c = lowest_bit(met);
        int at = k->top++;
        for (; at > bottom && k->enter[at - 1] < enter[c]; at--) {
            k->enter[at] = k->enter[at - 1];
            k->left[at] = k->left[at - 1];
        }
        k->enter[at] = enter[c];
        k->left[at] = x->child[c] < 0 ? ~(WIDTH * at_node + c) : x->child[c];
    }
}

int32_t wide_beam_next(const wide_bvh *w, wide_beam *k, unsigned *rays)
{
    while (k->top > 0) {
        const int at = --k->top;
        const int32_t x = k->left[at];
        if (k->enter[at] > k->far)
            continue;
        if (--k->work < 0)
            return -1;
        if (x >= 0) {
            push_beam(w, x, k);
            continue;
        }
        const node *of = &w->node[~x / WIDTH];
        *rays = wide_beam_rays(of, ~x % WIDTH, k);
        if (*rays)
            return ~of->child[~x % WIDTH];
    }
    return -1;
}
