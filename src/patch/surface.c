/* Surfaces that are known by their points alone, with hits found by search (searched_quest.c). All in double: float
 * would bear neither the iteration nor the proofs.
 */
#include "patch/query.h"

#include "wave/lane.h"

#include <math.h>
#include <stdlib.h>

static void take(const patch_query *k, int n, int32_t id, hits *h, patch_counts *c)
{
    c->evaluations += k->evaluations;
    for (int i = 0; i < n; i++) {
        const real t = (real)(k->to[i] + k->start[i]);
        if (k->found[i] && t > 0 && t < h->t[i]) {
            h->t[i] = t;
            h->id[i] = id;
            c->unsure += k->unsure[i];
        }
    }
}

void patch_surface_intersect(const patch_surface *f, int n, const rays *x, int32_t id, hits *h, patch_counts *c)
{
    patch_query k;
    patch_query_begin(&k, f, false);
    for (int i = 0; i < n; i++)
        patch_query_add(&k, i, vec3s_get(&x->r, i), vec3s_get(&x->s, i), 0, (double)h->t[i]);
    patch_query_run(&k, n);
    take(&k, n, id, h, c);
}

static void searched_hit(const surface *base, int n, const rays *x, int32_t id, hits *h)
{
    patch_counts c = {0};
    patch_surface_intersect((const patch_surface *)base, n, x, id, h, &c);
}

static void searched_locate(const surface *base, int n, const rays *x, const real *t, int32_t *part, real *u, real *w)
{
    const patch_surface *f = (const patch_surface *)base;
    projections p;
    for (int i = 0; i < n; i++) {
        const vec3 r = vec3s_get(&x->r, i), way = vec3_scale(vec3s_get(&x->s, i), (double)t[i]);
        p.place[i] = vec3_add(r, way);
        p.off[i] = REAL_ROUNDING * (vec3_length(r) + vec3_length(way));
    }
    patch_project(f, n, NULL, &p);
    for (int i = 0; i < n; i++) {
        part[i] = p.part[i];
        u[i] = (real)p.u[i];
        w[i] = (real)p.w[i];
    }
}

/* ---- shadows ---- */

static void put_dark(const patch_query *k, int n, real *lit, patch_counts *c)
{
    c->evaluations += k->evaluations;
    for (int i = 0; i < n; i++)
        if (k->found[i]) {
            lit[i] = 0;
            c->unsure += k->unsure[i];
        }
}

void patch_surface_occlude(const patch_surface *f, int n, const rays *x, real *lit, patch_counts *c)
{
    patch_query k;
    patch_query_begin(&k, f, true);
    for (int i = 0; i < n; i++) /* what is dark already need not be searched */
        patch_query_add(&k, i, vec3s_get(&x->r, i), vec3s_get(&x->s, i), 0, lit[i] > 0 ? 1 : -1);
    patch_query_run(&k, n);
    put_dark(&k, n, lit, c);
}

static void searched_occlude(const surface *base, int n, const rays *x, real *lit)
{
    patch_counts c = {0};
    patch_surface_occlude((const patch_surface *)base, n, x, lit, &c);
}

/* Rays that start on the surface itself: each is moved onto it as double has it, Q(u,w). Then its own root is t = 0 but
 * for the error that Newton's iteration leaves there, a rounding over the sine of the ray's angle to the surface. Other
 * roots begin beyond that, however near. Rays so flat that their roots have no digit are not searched: light along a
 * surface gives it nothing. */
typedef struct departures {
    vec3 r[LANES];
    double beyond[LANES]; /* where other roots begin, times |s|; infinite: the ray is not to be searched */
} departures;

static void depart(const patch_surface *f, int n, const vec3s *at, const vec3s *s, const int32_t *part, departures *d)
{
    const double ERROR = 1e-13, FLATTEST = 1e-8, size = vec3_length(f->l.centre) + f->l.radius;
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

void patch_surface_intersect_own(const patch_surface *f, int n, const rays *x, const ray_origins *from, int32_t id,
                                 hits *h, patch_counts *c)
{
    departures d;
    vec3s at = {0}, s = {0};
    int32_t part[LANES] = {0};
    int own = 0;
    patch_query k;
    patch_query_begin(&k, f, false);
    for (int i = 0; i < n; i++)
        if (from->id[i] == id) {
            part[own] = from->part[i];
            lane_set(&at, own, lane_get(&from->at, i));
            lane_set(&s, own++, lane_get(&x->s, i));
        }
    depart(f, own, &at, &s, part, &d);
    own = 0;
    for (int i = 0; i < n; i++) {
        const bool here = from->id[i] == id;
        const vec3 way = vec3s_get(&x->s, i);
        patch_query_add(&k, i, here ? d.r[own] : vec3s_get(&x->r, i), way, here ? d.beyond[own] / vec3_length(way) : 0,
                        (double)h->t[i]);
        own += here;
    }
    patch_query_run(&k, n);
    take(&k, n, id, h, c);
}

static void searched_hit_own(const surface *base, int n, const rays *x, const ray_origins *from, int32_t id, hits *h)
{
    patch_counts c = {0};
    patch_surface_intersect_own((const patch_surface *)base, n, x, from, id, h, &c);
}

void patch_surface_occlude_own(const patch_surface *f, int n, const rays *x, const int32_t *part, real *lit,
                               patch_counts *c)
{
    departures d;
    patch_query k;
    patch_query_begin(&k, f, true);
    depart(f, n, &x->r, &x->s, part, &d);
    for (int i = 0; i < n; i++) {
        const vec3 s = vec3_sub(vec3_add(vec3s_get(&x->r, i), vec3s_get(&x->s, i)), d.r[i]); /* to the light still */
        patch_query_add(&k, i, d.r[i], s, d.beyond[i] / vec3_length(s), lit[i] > 0 ? 1 : -1);
    }
    patch_query_run(&k, n);
    put_dark(&k, n, lit, c);
}

static void searched_occlude_own(const surface *base, int n, const rays *x, const int32_t *part, real *lit)
{
    patch_counts c = {0};
    patch_surface_occlude_own((const patch_surface *)base, n, x, part, lit, &c);
}

static void searched_extent(const surface *base, int part, double u[2], double w[2])
{
    const patch *q = ((const patch_surface *)base)->q;
    (void)part;
    for (int k = 0; k < 2; k++) {
        u[k] = q->u[k];
        w[k] = q->w[k];
    }
}

static void searched_box(const surface *base, double lo[3], double hi[3])
{
    const pieces *l = &((const patch_surface *)base)->l;
    for (int k = 0; k < 3; k++) {
        lo[k] = HUGE_VAL;
        hi[k] = -HUGE_VAL;
    }
    for (int i = 0; i < l->n; i++)
        for (int k = 0; k < 3; k++) {
            lo[k] = fmin(lo[k], l->piece[i].box[0][k]);
            hi[k] = fmax(hi[k], l->piece[i].box[1][k]);
        }
}

/* ---- */

static bvh *tree_of(const pieces *l)
{
    bvh_box *box = malloc(sizeof *box * (size_t)l->n);
    const bvh_space space = {l->centre, l->radius};
    for (int i = 0; box && i < l->n; i++)
        box[i] = bvh_box_in(&space, l->piece[i].box[0], l->piece[i].box[1]);
    bvh *b = box ? bvh_new(l->n, box) : NULL;
    free(box);
    return b;
}

static void searched_free(surface *base)
{
    patch_surface *f = (patch_surface *)base;
    bvh_free(f->tree);
    patch_surface_free_displaced(f->rough);
    pieces_free(&f->l);
    f->q->ops->free(f->q);
    free(f->methods);
    free(f);
}

/* The table of a kind: how many parts there are is known only now. */
static surface_ops *methods_of(const patch *q)
{
    surface_ops *ops = malloc(sizeof *ops);
    if (ops)
        *ops = (surface_ops){
            .kind = q->kind,
            .hit = searched_hit,
            .hit_own = searched_hit_own,
            .locate = searched_locate,
            .eval = patch_surface_eval,
            .occlude = searched_occlude,
            .occlude_own = searched_occlude_own,
            .extent = searched_extent,
            .box = searched_box,
            .parts = q->parts,
        };
    return ops;
}

patch_surface *patch_surface_make(patch *q, double flat)
{
    patch_surface *f = calloc(1, sizeof *f);
    if (!f) {
        q->ops->free(q);
        return NULL;
    }
    f->q = q;
    f->base.free = searched_free;
    f->base.rough = &patch_surface_displaced;
    f->base.ops = f->methods = methods_of(q);
    if (f->base.ops && pieces_of(q, flat, &f->l))
        f->tree = tree_of(&f->l);
    if (!f->tree) {
        searched_free(&f->base);
        return NULL;
    }
    return f;
}

surface *patch_surface_new(patch *q)
{
    const double FLAT = 0.045;
    patch_surface *f = patch_surface_make(q, FLAT);
    return f ? &f->base : NULL;
}

surface *patch_surface_affine(const surface *base, const affine *m)
{
    const patch_surface *f = (const patch_surface *)base;
    patch *q = patch_affine_new(f->q, m);
    return q ? patch_surface_new(q) : NULL;
}
