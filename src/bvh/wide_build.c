/* Nodes of eight boxes, built from the top by the surface area heuristic [Wald, On fast Construction of SAH-based
 * Bounding Volume Hierarchies, 2007]: of a node's parts the largest is halved until there are eight. All arithmetic is
 * float's + - * / and comparisons, so the same boxes make the same nodes everywhere.
 */
#include "bvh/wide_node.h"

#include "base/real.h"
#include "base/threads.h"

#include <stdlib.h>
#include <string.h>

enum {
    BINS = 16,
    BY_AREA = 14,     /* levels; below, parts are halved by number: at most 10 levels more, so the stack suffices */
    FOR_TASKS = 8192, /* items of a part that gets a task of its own */
};

/* ---- boxes ---- */

wide_box wide_box_of(const double lo[3], const double hi[3])
{
    wide_box b;
    for (int k = 0; k < 3; k++) {
        const double air = WIDE_AIR * (fabs(lo[k]) + fabs(hi[k]));
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
    part p[WIDE_WIDTH];
    int n = 1, k;
    p[0] = *all;
    while (n < WIDE_WIDTH && (k = level < BY_AREA ? largest(p, n) : most_items(p, n)) >= 0) {
        const part whole = p[k];
        memmove(&p[k + 2], &p[k + 1], sizeof *p * (size_t)(n - k - 1)); /* in order, for the items' order */
        halve(b, &whole, level, &p[k], &p[k + 1]);
        n++;
    }
    wide_node *x = &b->w->node[to];
    x->present = (1u << n) - 1;
    for (int c = 0; c < WIDE_WIDTH; c++) {
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

wide_bvh *wide_new(int n, const wide_box *box, int32_t *order, int threads, const progress *show)
{
    wide_bvh *w = calloc(1, sizeof *w);
    if (!w)
        return NULL;
    w->n = n;
    /* a node with a node below it has eight children, any other but the root two items or more: so at most 4/7 n + 1 */
    w->node = memory_new(progress_memory(show), sizeof *w->node * (4 * (size_t)n / 7 + 2));
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
    wide_node *less = memory_resize(progress_memory(show), w->node, sizeof *w->node * (size_t)w->nodes);
    w->node = less ? less : w->node;
    return w;
}

void wide_free(wide_bvh *w)
{
    if (w)
        memory_free(w->node);
    free(w);
}
