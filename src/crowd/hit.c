/* Hits and shadows of a crowd. Rays go through the hierarchy, 16 together where they are close to each other, and the
 * copies that they come near are tested side by side, each lane with another copy. Then the rays go on, shortened by
 * their hits. Of hits at one distance the first copy of the list counts, so the order of the tests does not matter.
 */
#include "base/bits.h"
#include "crowd/parts.h"
#include "wave/lane.h"

/* Pairs of a lane and a copy, to be tested side by side. */
typedef struct pairs {
    int n;
    int32_t lane[LANES], at[LANES];
    rays y; /* when tested: the lanes' rays in the space of the original */
} pairs;

/* What is asked of a wave: its first hits, or whether it reaches a light. */
typedef struct query {
    const crowd *f;
    const rays *x;
    const int32_t *without; /* for each lane a copy to leave out; NULL: none */
    int32_t id;             /* of hits */
    hits *h;                /* NULL: shadows */
    real *lit;
    real *end; /* of the rays: the hits' t; of shadow rays 1, or -1 in shadow */
    pairs p;
} query;

static void add_pair(query *q, int lane, int32_t copy)
{
    q->p.lane[q->p.n] = lane;
    q->p.at[q->p.n] = copy;
    q->p.n += !q->without || q->without[lane] != copy;
}

/* ---- tests ---- */

static bool is_ours(const crowd *f, int32_t id, int32_t of) { return of >= id && of < id + f->kinds; }

/* Take a hit at t of copy k on the original, where it is nearer, or as near and of an earlier copy. */
static void take(const query *q, int32_t k, real t, int32_t part, int i)
{
    hits *h = q->h;
    const crowd_copy *c = &q->f->copy[k];
    const bool same = t == h->t[i] && is_ours(q->f, q->id, h->id[i]);
    if (t < h->t[i] || (same && c->row < q->f->copy[crowd_copy_of(q->f, h->part[i])].row)) {
        h->t[i] = t;
        h->id[i] = q->id + c->kind;
        h->part[i] = k * q->f->parts + part;
    }
}

/* The pairs' hits; `from`: of lanes that start on the copy; NULL: none does. */
static void test_hits(query *q, const ray_origins *from)
{
    const surface *f = q->f->from;
    pairs *p = &q->p;
    hits some;
    crowd_rays_back(q->f, p->n, p->at, p->lane, q->x, &p->y);
    for (int j = 0; j < p->n; j++) {
        some.t[j] = q->h->t[p->lane[j]] * (real)(1 + REAL_ROUNDING); /* a little further, for hits as near */
        some.id[j] = -1;
        some.part[j] = 0;
    }
    if (from)
        f->ops->hit_own(f, p->n, &p->y, from, 0, &some);
    else
        f->ops->hit(f, p->n, &p->y, 0, &some);
    for (int j = 0; j < p->n; j++)
        if (some.id[j] == 0)
            take(q, p->at[j], some.t[j], some.part[j], p->lane[j]);
}

static void test_shadows(query *q)
{
    const surface *f = q->f->from;
    pairs *p = &q->p;
    real lit[LANES];
    crowd_rays_back(q->f, p->n, p->at, p->lane, q->x, &p->y);
    for (int j = 0; j < p->n; j++)
        lit[j] = 1;
    f->ops->occlude(f, p->n, &p->y, lit);
    for (int j = 0; j < p->n; j++)
        if (!(lit[j] > 0))
            q->lit[p->lane[j]] = 0, q->end[p->lane[j]] = -1;
}

static void test(query *q)
{
    if (q->p.n && q->h)
        test_hits(q, NULL);
    else if (q->p.n)
        test_shadows(q);
    q->p.n = 0;
}

/* ---- the lanes' ways ---- */

enum { ENOUGH = 24 }; /* pairs of a beam, to be tested before it goes on */

/* Lanes that are close to each other. False: they are not, and it gave up. */
static bool beam(query *q, int n, const int32_t *lane)
{
    const real *const r[3] = {q->x->r.x, q->x->r.y, q->x->r.z}, *const s[3] = {q->x->s.x, q->x->s.y, q->x->s.z};
    wide_beam k;
    unsigned met;
    wide_beam_begin(&k, n, lane, r, s, q->end);
    for (int32_t copy; (copy = wide_beam_next(q->f->tree, &k, &met)) >= 0;) {
        for (; met; met &= met - 1)
            add_pair(q, lane[lowest_bit(met)], copy);
        if (q->p.n < ENOUGH)
            continue;
        test(q);
        wide_beam_shorten(&k, lane, q->end);
    }
    return k.work >= 0;
}

/* Lanes in all directions: in rounds, each goes on to its next copy. */
static void rounds(query *q, int n, const int32_t *lane)
{
    wide_walk walk[WIDE_RAYS];
    int left = n, on[WIDE_RAYS];
    for (int i = 0; i < n; i++) {
        wide_begin(&walk[i], vec3s_get(&q->x->r, lane[i]), vec3s_get(&q->x->s, lane[i]));
        on[i] = i;
    }
    test(q);
    while (left) {
        int still = 0;
        for (int j = 0; j < left; j++) {
            const int32_t copy = wide_next(q->f->tree, &walk[on[j]], (double)q->end[lane[on[j]]]);
            if (copy < 0)
                continue;
            add_pair(q, lane[on[j]], copy);
            on[still++] = on[j];
        }
        left = still;
        test(q);
    }
}

/* The lanes that are on their way, square by square. */
static int order_lanes(const query *q, int n, int32_t *lane)
{
    int m = 0;
    for (int k = 0; k < n; k++) {
        const int i = wave_lane(n, k);
        lane[m] = i;
        m += q->end[i] > 0;
    }
    return m;
}

static void ask(query *q, int n)
{
    int32_t lane[LANES];
    bool close = true;
    n = order_lanes(q, n, lane);
    for (int from = 0; from < n; from += WIDE_RAYS) {
        const int some = n - from < WIDE_RAYS ? n - from : WIDE_RAYS;
        close = close && beam(q, some, lane + from);
        if (!close)
            rounds(q, some, lane + from);
    }
    test(q);
}

/* ---- the methods ---- */

void crowd_hit(const surface *base, int n, const rays *x, int32_t id, hits *h)
{
    query q = {.f = (const crowd *)base, .x = x, .id = id, .h = h, .end = h->t};
    ask(&q, n);
}

/* Test each ray that starts on a copy with this copy: own[i], or -1. */
static void hit_same(query *q, int n, const ray_origins *from, const int32_t *own)
{
    ray_origins begin;
    for (int i = 0; i < n; i++) {
        if (own[i] < 0)
            continue;
        const int j = q->p.n;
        add_pair(q, i, own[i]);
        begin.id[j] = 0;
        begin.part[j] = from->part[i] - own[i] * q->f->parts;
        lane_set(&begin.at, j, lane_get(&from->at, i));
    }
    crowd_places_back(q->f, q->p.n, q->p.at, &begin.at);
    if (q->p.n)
        test_hits(q, &begin);
    q->p.n = 0;
}

void crowd_hit_own(const surface *base, int n, const rays *x, const ray_origins *from, int32_t id, hits *h)
{
    query q = {.f = (const crowd *)base, .x = x, .id = id, .h = h, .end = h->t};
    int32_t own[LANES];
    for (int i = 0; i < n; i++)
        own[i] = is_ours(q.f, id, from->id[i]) ? crowd_copy_of(q.f, from->part[i]) : -1;
    hit_same(&q, n, from, own);
    q.without = own;
    ask(&q, n);
}

static void ask_shadows(const crowd *f, int n, const rays *x, const int32_t *without, real *lit)
{
    real end[LANES];
    query q = {.f = f, .x = x, .without = without, .lit = lit, .end = end};
    for (int i = 0; i < n; i++)
        end[i] = lit[i] > 0 ? 1 : -1;
    ask(&q, n);
}

void crowd_occlude(const surface *base, int n, const rays *x, real *lit)
{
    ask_shadows((const crowd *)base, n, x, NULL, lit);
}

void crowd_occlude_others(const crowd *f, int n, const rays *x, const int32_t *part, real *lit)
{
    int32_t own[LANES];
    for (int i = 0; i < n; i++)
        own[i] = crowd_copy_of(f, part[i]);
    ask_shadows(f, n, x, own, lit);
}
