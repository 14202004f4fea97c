/* Hits and shadows of a crowd, in rounds: each ray goes on to the next box on its way, and the copies in these boxes are
 * tested side by side. A hit shortens its ray. Of hits at one distance the first copy of the list counts, so the order
 * of the boxes does not matter.
 */
#include "crowd/parts.h"

#include <string.h>

/* The lanes of a wave on their way. */
typedef struct march {
    int n;               /* lanes that have a copy to test */
    int32_t lane[LANES]; /* which */
    int32_t at[LANES];   /* and its copy */
    rays y;              /* their rays, in the space of the original */
    wide_walk walk[LANES];
} march;

static void begin_lane(const rays *x, int i, march *m)
{
    wide_begin(&m->walk[i], vec3s_get(&x->r, i), vec3s_get(&x->s, i));
    m->lane[m->n++] = i;
}

/* The next copy of each lane, up to end[lane]; without[lane]: a copy to leave out; NULL: none. False: no lane has one.
 */
static bool go_on(const crowd *f, const rays *x, const real *end, const int32_t *without, march *m)
{
    int n = 0;
    for (int j = 0; j < m->n; j++) {
        const int32_t i = m->lane[j];
        int32_t k = wide_next(f->tree, &m->walk[i], (double)end[i]);
        if (without && k >= 0 && k == without[i])
            k = wide_next(f->tree, &m->walk[i], (double)end[i]);
        if (k < 0)
            continue;
        crowd_ray_back(&f->copy[k], x, i, &m->y, n);
        m->at[n] = k;
        m->lane[n++] = i;
    }
    m->n = n;
    return n > 0;
}

/* ---- hits ---- */

static bool is_ours(const crowd *f, int32_t id, int32_t of) { return of >= id && of < id + f->kinds; }

/* Take the hit h of copy k on the original: where it is nearer, or as near and of an earlier copy. */
static void take(const crowd *f, int32_t k, real t, int32_t part, int32_t id, hits *h, int i)
{
    const crowd_copy *c = &f->copy[k];
    const bool same = t == h->t[i] && is_ours(f, id, h->id[i]);
    if (t < h->t[i] || (same && c->row < f->copy[crowd_copy_of(f, h->part[i])].row)) {
        h->t[i] = t;
        h->id[i] = id + c->kind;
        h->part[i] = k * f->parts + part;
    }
}

/* The limits of hits on the original: a little beyond the nearest yet, for one as near. */
static void begin_hits(const march *m, const hits *h, hits *some)
{
    for (int j = 0; j < m->n; j++) {
        some->t[j] = h->t[m->lane[j]] * (real)(1 + REAL_ROUNDING);
        some->id[j] = -1;
        some->part[j] = 0;
    }
}

static void take_all(const crowd *f, const march *m, const hits *some, int32_t id, hits *h)
{
    for (int j = 0; j < m->n; j++)
        if (some->id[j] == 0)
            take(f, m->at[j], some->t[j], some->part[j], id, h, m->lane[j]);
}

static void hit_all(const crowd *f, const rays *x, int32_t id, const int32_t *without, march *m, hits *h)
{
    hits some;
    while (go_on(f, x, h->t, without, m)) {
        begin_hits(m, h, &some);
        f->from->ops->hit(f->from, m->n, &m->y, 0, &some);
        take_all(f, m, &some, id, h);
    }
}

void crowd_hit(const surface *base, int n, const rays *x, int32_t id, hits *h)
{
    march m;
    m.n = 0;
    for (int i = 0; i < n; i++)
        begin_lane(x, i, &m);
    hit_all((const crowd *)base, x, id, NULL, &m, h);
}

/* Test each ray that starts on a copy with this copy: own[i], or -1. */
static void hit_same(const crowd *f, int n, const rays *x, const ray_origins *from, int32_t id, const int32_t *own,
                     march *m, hits *h)
{
    hits some;
    ray_origins begin;
    m->n = 0;
    for (int i = 0; i < n; i++) {
        if (own[i] < 0)
            continue;
        const crowd_copy *c = &f->copy[own[i]];
        const int j = m->n++;
        m->lane[j] = i;
        m->at[j] = own[i];
        begin.id[j] = 0;
        begin.part[j] = from->part[i] - own[i] * f->parts;
        crowd_ray_back(c, x, i, &m->y, j);
        crowd_place_back(c, &from->at, i, &begin.at, j);
    }
    if (m->n == 0)
        return;
    begin_hits(m, h, &some);
    f->from->ops->hit_own(f->from, m->n, &m->y, &begin, 0, &some);
    take_all(f, m, &some, id, h);
}

void crowd_hit_own(const surface *base, int n, const rays *x, const ray_origins *from, int32_t id, hits *h)
{
    const crowd *f = (const crowd *)base;
    march m;
    int32_t own[LANES];
    for (int i = 0; i < n; i++)
        own[i] = is_ours(f, id, from->id[i]) ? crowd_copy_of(f, from->part[i]) : -1;
    hit_same(f, n, x, from, id, own, &m, h);
    m.n = 0;
    for (int i = 0; i < n; i++)
        begin_lane(x, i, &m);
    hit_all(f, x, id, own, &m, h);
}

/* ---- shadows ---- */

static void occlude_all(const crowd *f, int n, const rays *x, const int32_t *without, real *lit)
{
    march m;
    real end[LANES], some[LANES];
    m.n = 0;
    for (int i = 0; i < n; i++) {
        end[i] = 1;
        if (lit[i] > 0)
            begin_lane(x, i, &m);
    }
    while (go_on(f, x, end, without, &m)) {
        for (int j = 0; j < m.n; j++)
            some[j] = 1;
        f->from->ops->occlude(f->from, m.n, &m.y, some);
        int still = 0;
        for (int j = 0; j < m.n; j++) {
            const int32_t i = m.lane[j];
            lit[i] = some[j] > 0 ? lit[i] : 0;
            m.lane[still] = i;
            still += some[j] > 0;
        }
        m.n = still;
    }
}

void crowd_occlude(const surface *base, int n, const rays *x, real *lit)
{
    occlude_all((const crowd *)base, n, x, NULL, lit);
}

void crowd_occlude_others(const crowd *f, int n, const rays *x, const int32_t *part, real *lit)
{
    int32_t own[LANES];
    for (int i = 0; i < n; i++)
        own[i] = crowd_copy_of(f, part[i]);
    occlude_all(f, n, x, own, lit);
}
