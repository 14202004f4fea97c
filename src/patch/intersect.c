/* Where a ray meets a patch: Q(u,w) = r + s t.
 *
 * The hierarchy reports the pieces that the ray may meet. For each pair of ray and piece there is a proof that they
 * miss each other, or that they meet at most once (piece_intersect). Where neither is proved, as where the ray grazes,
 * the piece is subdivided for this ray. So no hit is lost, and none depends on how small the pieces are. Each pair that
 * is left has one root. Newton's iteration finds it in three or four steps, many pairs side by side.
 *
 * A ray's first root depends neither on the order in which the hierarchy reports pieces nor on how many it reports too
 * many: the pictures are the same on every processor. That holds where a ray reaches its limit of halvings, too:
 *
 * - Such a ray is searched again, from the nearest piece or half on (search_nearest). No other order halves fewer until
 *   the first root is proved. So if the limit is reached in that order, it is in any other, and all processors search
 *   again; if it is not, the root is the one that is proved in any order. What is beyond the first root, or beyond
 *   another object, comes last and so changes nothing.
 * - Shadows end at any root. Their pieces are halved in an order that only depends on the pieces, and those that only a
 *   hierarchy reports, as the ray misses their boxes, do not count.
 */
#include "patch/query.h"
#include "patch/roots.h"

#include "base/real.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    DEPTH = 128,     /* of the stack of halves; each halving adds one, and 64 in u and in w leave no digit to halve */
    HALVINGS = 1024, /* for one ray, where bounds prove nothing (smooth surfaces take some tens); what is left
                      * is tried as it is, and not proved */
    TRIES = 256,     /* of that, from the nearest on */
    QUEUE = 2 * HALVINGS, /* undecided pieces that wait, of all rays; of one ray no more than HALVINGS count */
};

#define UNPROVED (1 / 4096.0) /* of the patch's range: with jumps, a piece this small is tried without a proof */
#define POINT 1e-10 /* a piece of this share of the patch's size and place is a point and is not halved any more */

/* A piece that a ray may meet more than once. */
typedef struct undecided {
    int32_t lane, index;
    double near; /* the ray does not meet it before t s.s = near */
} undecided;

/* The state of a query that runs. */
typedef struct search {
    patch_query *k;
    roots p;
    int lane;            /* whose ray is in the hierarchy */
    double end;          /* of its ray, before a root was found */
    int waiting, others; /* pieces that wait; those of rays before this one, which come first */
    undecided queue[QUEUE];
} search;

/* A piece that is a point and still undecided: at a pole, on an edge, or where a ray just touches. It counts as met,
 * unless it may be the ray's own start: it is no farther than its size from where roots begin to count. */
static void accept_point(patch_query *k, int lane, const piece *f)
{
    const vec3 s = k->s[lane];
    const double s2 = vec3_dot(s, s), t = vec3_dot(vec3_sub(f->c, k->r[lane]), s) / s2;
    if (t - piece_radius(f) / sqrt(s2) > k->from[lane] && t < k->to[lane]) {
        k->to[lane] = k->any ? -HUGE_VAL : t;
        k->found[lane] = true;
        k->unsure[lane] = false;
    }
}

/* Whether nothing can be proved of a piece because P or Q jumps there. */
static bool is_unprovable(const patch_surface *f, const piece *p)
{
    return f->broken && p->ea + p->eb == HUGE_VAL && p->u[1] - p->u[0] < UNPROVED * (f->q->u[1] - f->q->u[0]) &&
           p->w[1] - p->w[0] < UNPROVED * (f->q->w[1] - f->q->w[0]);
}

/* A piece without a proof, unless the ray has had too many of them. */
static void try_piece(search *h, int lane, const piece *f)
{
    if (h->k->tries[lane]++ < TRIES)
        roots_add(&h->p, lane, f, 0, 0, true);
}

/* What becomes of a half. Whether it is to be halved again. */
static bool is_open(search *h, int lane, const piece *half)
{
    const patch_surface *f = h->k->f;
    const patch_query *k = h->k;
    const double point = POINT * (f->l.space.radius + 0.1 * vec3_length(f->l.space.centre));
    double a, b;
    const piece_answer answer = piece_intersect(half, k->r[lane], k->s[lane], k->from[lane], k->to[lane], &a, &b);
    if (answer == PIECE_ONCE)
        roots_add(&h->p, lane, half, a, b, false);
    else if (answer == PIECE_OPEN && is_unprovable(f, half))
        roots_add(&h->p, lane, half, 0, 0, true);
    else if (answer == PIECE_OPEN && piece_radius(half) > point)
        return true;
    else if (answer == PIECE_OPEN)
        accept_point(h->k, lane, half);
    return false;
}

/* Subdivide a piece for one ray until each half is decided. */
static void subdivide(search *h, int lane, const piece *whole)
{
    const patch_surface *f = h->k->f;
    patch_query *k = h->k;
    piece open[DEPTH];
    int n = 1;
    open[0] = *whole;
    while (n && k->halvings[lane] < HALVINGS) {
        const piece one = open[--n];
        k->halvings[lane]++;
        for (int which = 0; which < 2; which++) {
            const piece half = piece_half(f->q, &one, which);
            if (!is_open(h, lane, &half))
                continue;
            if (n < DEPTH)
                open[n++] = half;
            else
                accept_point(k, lane, &half);
        }
    }
    while (n && k->any) /* other rays are searched again */
        try_piece(h, lane, &open[--n]);
}

static int by_lane_and_near(const void *a, const void *b)
{
    const undecided *x = a, *y = b;
    if (x->lane != y->lane)
        return x->lane < y->lane ? -1 : 1;
    if (x->near != y->near)
        return x->near < y->near ? -1 : 1;
    return x->index < y->index ? -1 : x->index > y->index;
}

/* Whether a ray's root so far comes before all of what it does not meet before t s.s = near. */
static bool is_beyond(const patch_query *k, int lane, double near)
{
    return near > k->to[lane] * vec3_dot(k->s[lane], k->s[lane]);
}

/* The first n undecided pieces: in each round the next nearest one of every ray, unless a root is nearer. */
static void subdivide_all(search *h, int n)
{
    const patch_query *k = h->k;
    int start[LANES + 1], lanes = 0;
    roots_solve(&h->p);
    qsort(h->queue, (size_t)n, sizeof *h->queue, by_lane_and_near);
    for (int i = 0; i < n; i++)
        if (i == 0 || h->queue[i].lane != h->queue[i - 1].lane)
            start[lanes++] = i;
    start[lanes] = n;
    for (int round = 0, left = n; left; round++) {
        left = 0;
        for (int i = 0; i < lanes; i++) {
            const undecided *d = &h->queue[start[i] + round];
            if (start[i] + round >= start[i + 1] || is_beyond(k, d->lane, d->near) || !pulse_beats(k->pulse))
                continue;
            subdivide(h, d->lane, &k->f->l.piece[d->index]);
            left++;
        }
        roots_solve(&h->p);
    }
    h->waiting -= n;
    memmove(h->queue, h->queue + n, sizeof *h->queue * (size_t)h->waiting);
}

/* The queue is rather full: the rays before this one are searched, or all but this ray's nearest pieces are given up,
 * of which each costs a halving at least. */
static void make_room(search *h)
{
    if (h->others)
        subdivide_all(h, h->others);
    else {
        qsort(h->queue, (size_t)h->waiting, sizeof *h->queue, by_lane_and_near);
        h->waiting = HALVINGS;
    }
    h->others = 0;
}

/* The least t s.s at which the ray can meet a piece, as piece_intersect has it. */
static double near_end(const piece *f, vec3 r, vec3 s)
{
    const double reach = fabs(vec3_dot(f->A, s)) + fabs(vec3_dot(f->B, s)) + f->e * sqrt(vec3_dot(s, s));
    return -vec3_dot(vec3_sub(r, f->c), s) - reach;
}

/* Whether r + s t, from <= t <= to, passes the piece's box. The hierarchy's box is larger, so it reports all these. */
static bool passes_box(const piece *f, vec3 r, vec3 s, double from, double to)
{
    const double o[3] = {r.x, r.y, r.z}, d[3] = {s.x, s.y, s.z};
    for (int k = 0; k < 3; k++) {
        const double a = (f->box[0][k] - o[k]) / d[k], b = (f->box[1][k] - o[k]) / d[k];
        const bool along = d[k] == 0;
        if (along && (o[k] < f->box[0][k] || o[k] > f->box[1][k]))
            return false;
        from = along ? from : greater(from, lesser(a, b));
        to = along ? to : lesser(to, greater(a, b));
    }
    return from <= to;
}

static void visit(void *user, int32_t index)
{
    search *h = user;
    const patch_query *k = h->k;
    const piece *f = &k->f->l.piece[index];
    double a, b;
    switch (piece_intersect(f, k->r[h->lane], k->s[h->lane], k->from[h->lane], k->to[h->lane], &a, &b)) {
    case PIECE_ONCE:
        roots_add(&h->p, h->lane, f, a, b, false);
        break;
    case PIECE_OPEN:
        if (!passes_box(f, k->r[h->lane], k->s[h->lane], k->from[h->lane], h->end))
            break;
        h->queue[h->waiting++] = (undecided){h->lane, index, near_end(f, k->r[h->lane], k->s[h->lane])};
        if (h->waiting == QUEUE)
            make_room(h);
        break;
    case PIECE_MISSED:
        break;
    }
}

/* Begin with a ray: the pieces that it may meet, but for those that are decided. */
static void enter(search *h, int lane)
{
    const patch_query *k = h->k;
    const bvh_space *space = &k->f->l.space;
    float r[3], s[3], end;
    double from = k->from[lane], to = k->to[lane];
    h->lane = lane;
    h->end = to;
    h->others = h->waiting;
    if (bvh_enter(space, space->radius, k->r[lane], k->s[lane], &from, &to, r, s, &end))
        bvh_along(k->f->tree, r, s, end, visit, h);
}

/* ---- a ray that has reached its limit ---- */

/* A piece or half that is undecided. The bounds are found again from its range, which takes less room. */
typedef struct range {
    double near; /* as undecided.near, and not less than that of what it is a half of */
    int32_t part;
    double u[2], w[2];
} range;

/* The order does not depend on where in memory or in the hierarchy they are. */
static int by_near(const void *a, const void *b)
{
    const range *x = a, *y = b;
    if (x->near != y->near)
        return x->near < y->near ? -1 : 1;
    if (x->part != y->part)
        return x->part < y->part ? -1 : 1;
    if (x->u[0] != y->u[0])
        return x->u[0] < y->u[0] ? -1 : 1;
    return x->w[0] < y->w[0] ? -1 : x->w[0] > y->w[0];
}

/* A heap: the nearest is the first, and none is nearer than the one at (its place - 1) / 2. */
typedef struct heap {
    int n;
    range at[2 * HALVINGS]; /* a halving takes one and adds two at most */
} heap;

static void heap_add(heap *p, range x)
{
    int i = p->n++;
    for (int up; i && by_near(&x, &p->at[up = (i - 1) / 2]) < 0; i = up)
        p->at[i] = p->at[up];
    p->at[i] = x;
}

static range heap_take(heap *p)
{
    const range first = p->at[0], x = p->at[--p->n];
    int i = 0;
    for (int down; (down = 2 * i + 1) < p->n; i = down) {
        down += down + 1 < p->n && by_near(&p->at[down + 1], &p->at[down]) < 0;
        if (by_near(&x, &p->at[down]) < 0)
            break;
        p->at[i] = p->at[down];
    }
    p->at[i] = x;
    return first;
}

static void add_range(search *h, heap *p, int lane, const piece *f, double least)
{
    const double near = greater(least, near_end(f, h->k->r[lane], h->k->s[lane]));
    heap_add(p, (range){near, f->part, {f->u[0], f->u[1]}, {f->w[0], f->w[1]}});
}

/* Halve the nearest until a root comes before all that is left, or the limit is reached: what is left is then tried. */
static void search_nearest(search *h, int lane)
{
    const patch *q = h->k->f->q;
    patch_query *k = h->k;
    heap p;
    p.n = 0;
    enter(h, lane);
    roots_solve(&h->p);
    if (h->waiting > HALVINGS)
        make_room(h);
    for (int i = 0; i < h->waiting; i++)
        add_range(h, &p, lane, &k->f->l.piece[h->queue[i].index], -HUGE_VAL);
    h->waiting = 0;
    for (; p.n && k->halvings[lane] < HALVINGS && !is_beyond(k, lane, p.at[0].near); k->halvings[lane]++) {
        if (!pulse_beats(k->pulse))
            break;
        const range x = heap_take(&p);
        const piece one = piece_of(q, x.part, x.u, x.w);
        for (int which = 0; which < 2; which++) {
            const piece half = piece_half(q, &one, which);
            if (is_open(h, lane, &half))
                add_range(h, &p, lane, &half, x.near);
        }
        roots_solve(&h->p); /* at once, so that nothing beyond a root is halved */
    }
    k->gave_up[lane] = p.n && !is_beyond(k, lane, p.at[0].near);
    while (p.n && k->gave_up[lane] && k->tries[lane] < TRIES) {
        const range x = heap_take(&p);
        const piece one = piece_of(q, x.part, x.u, x.w);
        try_piece(h, lane, &one);
    }
    roots_solve(&h->p);
}

void patch_query_begin(patch_query *k, const patch_surface *f, bool any, const pulse *p)
{
    k->pulse = p;
    k->f = f;
    k->any = any;
    k->evaluations = 0;
}

void patch_query_add(patch_query *k, int i, vec3 r, vec3 s, double from, double to)
{
    const vec3 o = vec3_sub(r, k->f->l.space.centre);
    const double start = -vec3_dot(o, s) / vec3_dot(s, s);
    k->r[i] = vec3_add(r, vec3_scale(s, start));
    k->s[i] = s;
    k->start[i] = start;
    k->from[i] = from - start;
    k->to[i] = to - start;
    k->found[i] = k->unsure[i] = false;
    k->halvings[i] = k->tries[i] = 0;
}

void patch_query_run(patch_query *k, int n)
{
    double to[LANES];
    search h;
    h.k = k;
    h.waiting = 0;
    roots_begin(&h.p, k);
    for (int i = 0; i < n; i++) {
        to[i] = k->to[i];
        enter(&h, i);
    }
    subdivide_all(&h, h.waiting);
    for (int i = 0; i < n; i++) {
        k->evaluations += 2L * k->halvings[i];
        k->gave_up[i] = k->halvings[i] >= HALVINGS;
        if (!k->gave_up[i] || k->any)
            continue;
        k->to[i] = to[i];
        k->found[i] = k->unsure[i] = false;
        k->halvings[i] = 0;
        search_nearest(&h, i);
        k->evaluations += 3L * k->halvings[i];
    }
}
