/* Embree reports the boxes near a ray; each is tested again in double, so the result does not depend on the processor.
 */
#include "scene/object_bvh.h"

#include "bvh/bvh.h"
#include "scene/scene.h"

#include <stdlib.h>
#include <string.h>

enum {
    FEW = 12, /* bounded objects: up to this number testing all is faster (docs/design.md) */
    BITS = 64,
    ROUNDINGS = 16,
    WORDS = LANES / BITS,
};

typedef struct box {
    double lo[3], hi[3];
} box;

struct object_bvh {
    const scene *of;
    int objects, bounded, unbounded;
    int32_t *object; /* of each box; the unbounded objects at its end */
    box *box;
    bvh_space space;
    bvh *tree;
};

struct candidates {
    int objects;
    uint64_t *met;           /* a bit for each object */
    uint64_t (*lane)[WORDS]; /* and for each ray of those objects */
};

/* ---- the objects ---- */

/* The displaced surface's box contains the smooth surface, too. */
static box box_of(const object *o)
{
    const surface *f = o->displaced ? o->displaced : o->shape;
    box b;
    f->ops->box(f, b.lo, b.hi);
    return b;
}

static bool has_end(const box *b)
{
    bool ends = true;
    for (int k = 0; k < 3; k++)
        ends = ends && b->hi[k] - b->lo[k] < HUGE_VAL;
    return ends;
}

/* c->space, about all boxes. */
static void measure(object_bvh *c)
{
    box all = c->box[0];
    for (int i = 1; i < c->bounded; i++)
        for (int k = 0; k < 3; k++) {
            all.lo[k] = fmin(all.lo[k], c->box[i].lo[k]);
            all.hi[k] = fmax(all.hi[k], c->box[i].hi[k]);
        }
    c->space = bvh_space_about(all.lo, all.hi);
}

static bvh *tree_of(const object_bvh *c, int threads, const progress *w)
{
    bvh_box *b = memory_new(progress_memory(w), sizeof *b * (size_t)c->bounded);
    for (int i = 0; b && i < c->bounded; i++)
        b[i] = bvh_box_in(&c->space, c->box[i].lo, c->box[i].hi);
    bvh *tree = b ? bvh_new(c->bounded, b, threads, w) : NULL;
    memory_free(b);
    return tree;
}

object_bvh *object_bvh_new(const scene *s, int threads, const progress *w, bool *good)
{
    const size_t n = (size_t)s->objects;
    object_bvh *c = calloc(1, sizeof *c);
    memory *m = progress_memory(w);
    *good = c && (c->object = memory_new(m, sizeof *c->object * n)) && (c->box = memory_new(m, sizeof *c->box * n));
    for (int i = 0; *good && i < s->objects; i++) {
        if (s->object[i].first != i)
            continue;
        const box b = box_of(&s->object[i]);
        if (has_end(&b)) {
            c->box[c->bounded] = b;
            c->object[c->bounded++] = i;
        } else
            c->object[s->objects - ++c->unbounded] = i;
    }
    if (*good && c->bounded > FEW) {
        c->of = s;
        c->objects = s->objects;
        measure(c);
        *good = (c->tree = tree_of(c, threads, w)) != NULL;
    }
    if (c && c->tree)
        return c;
    object_bvh_free(c);
    return NULL;
}

void object_bvh_free(object_bvh *c)
{
    if (!c)
        return;
    bvh_free(c->tree);
    memory_free(c->object);
    memory_free(c->box);
    free(c);
}

/* ---- a wave ---- */

static size_t words_for(int objects) { return ((size_t)objects + BITS - 1) / BITS; }

candidates *candidates_new(const object_bvh *c, memory *of)
{
    candidates *m = calloc(1, sizeof *m);
    if (!m)
        return NULL;
    m->objects = c->objects;
    m->met = memory_zeroed(of, words_for(c->objects) * sizeof *m->met);
    m->lane = memory_zeroed(of, (size_t)c->objects * sizeof *m->lane);
    if (m->met && m->lane)
        return m;
    candidates_free(m);
    return NULL;
}

void candidates_free(candidates *m)
{
    if (!m)
        return;
    memory_free(m->met);
    memory_free(m->lane);
    free(m);
}

static void note(candidates *m, int32_t id, int lane)
{
    m->met[id / BITS] |= (uint64_t)1 << (id % BITS);
    m->lane[id][lane / BITS] |= (uint64_t)1 << (lane % BITS);
}

static void clear(candidates *m)
{
    for (int32_t k = candidates_next(m, -1); k >= 0; k = candidates_next(m, k))
        memset(m->lane[k], 0, sizeof m->lane[k]);
    memset(m->met, 0, words_for(m->objects) * sizeof *m->met);
}

/* A ray in the hierarchy. */
typedef struct passage {
    const object_bvh *c;
    candidates *m;
    int lane;
    double r[3], s[3], end, size; /* size: of r's coordinates */
} passage;

/* Whether the ray meets the box, or comes so near that a hit in float is possible: a hit takes fewer than ROUNDINGS
 * roundings of coordinates of that size. */
static bool passes(const passage *p, const box *b)
{
    double t0 = 0, t1 = p->end;
    for (int k = 0; k < 3; k++) {
        const double air = ROUNDINGS * REAL_ROUNDING * (p->size + fabs(b->lo[k]) + fabs(b->hi[k]));
        const double lo = b->lo[k] - air - p->r[k], hi = b->hi[k] + air - p->r[k];
        if (p->s[k] == 0) {
            t1 = lo <= 0 && hi >= 0 ? t1 : -1;
            continue;
        }
        const double x = lo / p->s[k], y = hi / p->s[k];
        t0 = fmax(t0, fmin(x, y));
        t1 = fmin(t1, fmax(x, y));
    }
    return t0 <= t1 * (1 + ROUNDINGS * REAL_ROUNDING);
}

static void visit(void *user, int32_t index)
{
    const passage *p = user;
    if (passes(p, &p->c->box[index]))
        note(p->m, p->c->object[index], p->lane);
}

void object_bvh_find(const object_bvh *c, int n, const rays *x, const real *end, const int32_t *own, candidates *m)
{
    clear(m);
    for (int k = c->objects - c->unbounded; k < c->objects; k++)
        for (int i = 0; i < n; i++)
            note(m, c->object[k], i);
    for (int i = 0; i < n; i++) {
        const vec3 r = {(double)x->r.x[i], (double)x->r.y[i], (double)x->r.z[i]};
        const vec3 s = {(double)x->s.x[i], (double)x->s.y[i], (double)x->s.z[i]};
        passage p = {c, m, i, {r.x, r.y, r.z}, {s.x, s.y, s.z}, (double)end[i], fabs(r.x) + fabs(r.y) + fabs(r.z)};
        double from = 0, to = p.end;
        float at[3], way[3], far;
        if (own && own[i] >= 0)
            note(m, c->of->object[own[i]].first, i);
        if (bvh_enter(&c->space, c->space.radius, r, s, &from, &to, at, way, &far))
            bvh_along(c->tree, at, way, far, visit, &p);
    }
}

int32_t candidates_next(const candidates *m, int32_t after)
{
    for (int32_t k = after + 1; k < m->objects; k++) {
        const uint64_t rest = m->met[k / BITS] >> (k % BITS);
        if (rest & 1)
            return k;
        if (!rest)
            k |= BITS - 1; /* none in this word */
    }
    return -1;
}

int candidates_rays(const candidates *m, int32_t id, int32_t *lane)
{
    int n = 0;
    for (int i = 0; i < LANES; i++) { /* without a branch */
        lane[n] = i;
        n += (int)(m->lane[id][i / BITS] >> (i % BITS) & 1);
    }
    return n;
}
