/* Patches as surfaces: hits, shadows and (u,w), by the searches of query.h. All in double: in float neither the
 * iteration nor the proofs would hold.
 */
#include "patch/query.h"

#include "wave/lane.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rays that start on the surface itself. The start is projected to Q(u,w) in double. Then the ray's own root is t = 0,
 * up to the error of Newton's iteration there: a rounding over the sine of the ray's angle to the surface. Roots beyond
 * that error are other roots, however near. A ray at so flat an angle that its roots have no digits is not searched:
 * light along a surface gives it nothing. */
typedef struct own_starts {
    vec3 r[LANES];
    double beyond[LANES]; /* other roots are farther than this, in scene units; infinite: the ray is not searched */
} own_starts;

static void find_own_starts(const patch_surface *f, int n, const vec3s *at, const vec3s *s, const int32_t *part,
                            own_starts *d)
{
    /* some hundred roundings of double; and the sine at which ERROR / sine is 1e-5 of the surface */
    const double ERROR = 1e-13, FLATTEST = 1e-8, size = vec3_length(f->l.space.centre) + f->l.space.radius;
    projections p;
    for (int i = 0; i < n; i++) {
        p.place[i] = vec3s_get(at, i);
        p.off[i] = 8 * REAL_ROUNDING * vec3_length(p.place[i]);
    }
    patch_project(f, n, part, &p);
    for (int first = 0; first < n; first += PATCH_BATCH) {
        const int m = n - first < PATCH_BATCH ? n - first : PATCH_BATCH;
        patch_jets j;
        f->q->ops->eval(f->q, m, p.part + first, p.u + first, p.w + first, 1, &j);
        for (int i = 0; i < m; i++) {
            const vec3 N = vec3_cross(patch_jets_u(&j, i), patch_jets_w(&j, i)), way = vec3s_get(s, first + i);
            const double sine = fabs(vec3_dot(way, N)) / (vec3_length(way) * vec3_length(N));
            d->r[first + i] = (vec3){j.axis[0].v[i], j.axis[1].v[i], j.axis[2].v[i]};
            d->beyond[first + i] = sine < FLATTEST ? HUGE_VAL : ERROR * size / sine;
        }
    }
}

/* The same for the rays of a wave that start on object `id`, one after another. */
static void gather_own_starts(const patch_surface *f, int n, const rays *x, const ray_origins *from, int32_t id,
                              own_starts *d)
{
    vec3s at = {0}, s = {0};
    int32_t part[LANES];
    int own = 0;
    for (int i = 0; i < n; i++)
        if (from->id[i] == id) {
            part[own] = from->part[i];
            lane_set(&at, own, lane_get(&from->at, i));
            lane_set(&s, own++, lane_get(&x->s, i));
        }
    find_own_starts(f, own, &at, &s, part, d);
}

/* ---- hits and shadows ---- */

void patch_surface_intersect(const patch_surface *f, int n, const rays *x, const ray_origins *from, int32_t id, hits *h,
                             patch_counts *c)
{
    own_starts d;
    patch_query k;
    patch_query_begin(&k, f, false, c->pulse);
    if (from)
        gather_own_starts(f, n, x, from, id, &d);
    for (int i = 0, own = 0; i < n; i++) {
        const vec3 s = vec3s_get(&x->s, i);
        if (from && from->id[i] == id) {
            patch_query_add(&k, i, d.r[own], s, d.beyond[own] / vec3_length(s), (double)h->t[i]);
            own++;
        } else
            patch_query_add(&k, i, vec3s_get(&x->r, i), s, 0, (double)h->t[i]);
    }
    patch_query_run(&k, n);
    c->evaluations += k.evaluations;
    for (int i = 0; i < n; i++) {
        const real t = (real)(k.to[i] + k.start[i]);
        const bool hit = k.found[i] && t > 0 && t < h->t[i];
        if (hit) {
            h->t[i] = t;
            h->id[i] = id;
        }
        c->unsure += (hit && k.unsure[i]) || k.gave_up[i];
    }
}

patch_surface patch_surface_counting(const surface *f, patch_counts *c)
{
    patch_surface g = *(const patch_surface *)f;
    g.counts = c;
    return g;
}

static void count(const surface *base, const patch_counts *c)
{
    patch_counts *sum = ((const patch_surface *)base)->counts;
    if (sum) {
        sum->evaluations += c->evaluations;
        sum->unsure += c->unsure;
    }
}

static void patch_hit(const surface *base, int n, const rays *x, int32_t id, hits *h)
{
    patch_counts c = {0};
    patch_surface_intersect((const patch_surface *)base, n, x, NULL, id, h, &c);
    count(base, &c);
}

static void patch_hit_own(const surface *base, int n, const rays *x, const ray_origins *from, int32_t id, hits *h)
{
    patch_counts c = {0};
    patch_surface_intersect((const patch_surface *)base, n, x, from, id, h, &c);
    count(base, &c);
}

void patch_surface_occlude(const patch_surface *f, int n, const rays *x, bool own, const int32_t *part, real *lit,
                           patch_counts *c)
{
    own_starts d;
    patch_query k;
    patch_query_begin(&k, f, true, c->pulse);
    if (own)
        find_own_starts(f, n, &x->r, &x->s, part, &d);
    for (int i = 0; i < n; i++) {
        vec3 r = vec3s_get(&x->r, i), s = vec3s_get(&x->s, i);
        double from = 0;
        if (own) {
            s = vec3_sub(vec3_add(r, s), d.r[i]); /* still ends at the light */
            r = d.r[i];
            from = d.beyond[i] / vec3_length(s);
        }
        patch_query_add(&k, i, r, s, from, lit[i] > 0 ? 1 : -1); /* in shadow already: an empty range */
    }
    patch_query_run(&k, n);
    c->evaluations += k.evaluations;
    for (int i = 0; i < n; i++) {
        if (k.found[i])
            lit[i] = 0;
        c->unsure += (k.found[i] && k.unsure[i]) || (!k.found[i] && k.gave_up[i]);
    }
}

static void patch_occlude(const surface *base, int n, const rays *x, real *lit)
{
    patch_counts c = {0};
    patch_surface_occlude((const patch_surface *)base, n, x, false, NULL, lit, &c);
    count(base, &c);
}

static void patch_occlude_own(const surface *base, int n, const rays *x, const int32_t *part, real *lit)
{
    patch_counts c = {0};
    patch_surface_occlude((const patch_surface *)base, n, x, true, part, lit, &c);
    count(base, &c);
}

/* ---- (u,w) and size ---- */

/* The closest points to p->place, at most p->off away. */
static void project(const surface *base, int n, projections *p, int32_t *part, real *u, real *w)
{
    patch_project((const patch_surface *)base, n, NULL, p);
    for (int i = 0; i < n; i++) {
        part[i] = p->part[i];
        u[i] = (real)p->u[i];
        w[i] = (real)p->w[i];
    }
}

static void patch_locate(const surface *base, int n, const rays *x, const real *t, int32_t *part, real *u, real *w)
{
    projections p;
    for (int i = 0; i < n; i++) {
        const vec3 r = vec3s_get(&x->r, i), way = vec3_scale(vec3s_get(&x->s, i), (double)t[i]);
        p.place[i] = vec3_add(r, way);
        p.off[i] = REAL_ROUNDING * (vec3_length(r) + vec3_length(way));
    }
    project(base, n, &p, part, u, w);
}

/* The closest point is at most as far away as Q at the ray's hit. */
static void patch_foot(const surface *base, int n, const rays *x, const real *t, int32_t *part, real *u, real *w)
{
    projections p;
    partials q;
    patch_surface_eval(base, n, part, u, w, 1, &q);
    for (int i = 0; i < n; i++) {
        const vec3 r = vec3s_get(&x->r, i), way = vec3_scale(vec3s_get(&x->s, i), (double)t[i]);
        p.place[i] = vec3_add(r, way);
        p.off[i] = vec3_length(vec3_sub(p.place[i], vec3s_get(&q.Q, i)));
    }
    project(base, n, &p, part, u, w);
}

/* ---- shadows ---- */

static void patch_extent(const surface *base, int part, double u[2], double w[2])
{
    const patch *q = ((const patch_surface *)base)->q;
    (void)part;
    memcpy(u, q->u, sizeof q->u);
    memcpy(w, q->w, sizeof q->w);
}

static void patch_box(const surface *base, double lo[3], double hi[3])
{
    const pieces *l = &((const patch_surface *)base)->l;
    memcpy(lo, l->lo, sizeof l->lo);
    memcpy(hi, l->hi, sizeof l->hi);
}

/* ---- making one ---- */

static bvh *tree_of(const pieces *l, int threads, const progress *w)
{
    bvh_box *box = memory_new(progress_memory(w), sizeof *box * (size_t)l->n);
    for (int i = 0; box && i < l->n; i++)
        box[i] = bvh_box_in(&l->space, l->piece[i].box[0], l->piece[i].box[1]);
    bvh *b = box ? bvh_new(l->n, box, threads, w) : NULL;
    memory_free(box);
    return b;
}

static void patch_free(surface *base)
{
    patch_surface *f = (patch_surface *)base;
    bvh_free(f->tree);
    pieces_free(&f->l);
    f->q->ops->free(f->q);
    free(f->methods);
    free(f);
}

bool patch_surface_is(const surface *f) { return f->free == patch_free; }

/* A table for each surface: `kind` and `parts` are the patch's. */
static surface_ops *methods_of(const patch *q)
{
    surface_ops *ops = malloc(sizeof *ops);
    if (ops)
        *ops = (surface_ops){
            .kind = q->kind,
            .hit = patch_hit,
            .hit_own = patch_hit_own,
            .locate = patch_locate,
            .foot = patch_foot,
            .eval = patch_surface_eval,
            .occlude = patch_occlude,
            .occlude_own = patch_occlude_own,
            .extent = patch_extent,
            .box = patch_box,
            .parts = q->parts,
        };
    return ops;
}

patch_surface *patch_surface_make(patch *q, double flat, const progress *w, bool *bounded)
{
    patch_surface *f = calloc(1, sizeof *f);
    *bounded = true;
    if (!f) {
        q->ops->free(q);
        return NULL;
    }
    f->q = q;
    f->base.free = patch_free;
    f->base.ops = f->methods = methods_of(q);
    if (f->base.ops && pieces_of(q, flat, w, &f->l, bounded))
        f->tree = tree_of(&f->l, q->threads, w);
    if (f->tree)
        return f;
    patch_free(&f->base);
    return NULL;
}

surface *patch_surface_new_bounded(patch *q, const progress *w, bool *bounded)
{
    const double FLAT = 0.045; /* 2.6 degrees: few pieces stay undecided. Only speed depends on it. */
    patch_surface *f = patch_surface_make(q, FLAT, w, bounded);
    return f ? &f->base : NULL;
}

surface *patch_surface_new(patch *q, const progress *w)
{
    bool bounded;
    return patch_surface_new_bounded(q, w, &bounded);
}

surface *patch_surface_formula(const char *kind, const form_formula *f, int threads, const progress *w)
{
    expr *e[3];
    expr_error wrong;
    for (int k = 0; k < 3; k++)
        e[k] = expr_parse(f->xyz[k], &wrong);
    patch *q = patch_function_new(kind, e, f->u, f->w);
    if (!q)
        return NULL;
    q->threads = threads;
    return patch_surface_new(q, w);
}

surface *patch_surface_affine(const surface *base, const affine *m, const progress *w)
{
    const patch_surface *f = (const patch_surface *)base;
    patch *q = patch_affine_new(f->q, m);
    return q ? patch_surface_new(q, w) : NULL;
}
