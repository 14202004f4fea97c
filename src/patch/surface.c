/* Surfaces that are known by their points alone, with hits found by search (searched_quest.c). All in double: float
 * would bear neither the iteration nor the proofs.
 */
#include "patch/surface.h"

#include "wave/lane.h"

#include <math.h>
#include <stdlib.h>

static inline vec3 get(const vec3s *v, int i) { return (vec3){(double)v->x[i], (double)v->y[i], (double)v->z[i]}; }

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
        patch_query_add(&k, i, get(&x->r, i), get(&x->s, i), 0, (double)h->t[i]);
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
        const vec3 r = get(&x->r, i), way = vec3_scale(get(&x->s, i), (double)t[i]);
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

/* ---- Q and its partials ---- */

STAGE static void put(int n, const double *restrict from, real *restrict to)
{
    for (int i = 0; i < n; i++)
        to[i] = (real)from[i];
}

static void put3(int n, const double *x, const double *y, const double *z, vec3s *to, int at)
{
    put(n, x, to->x + at);
    put(n, y, to->y + at);
    put(n, z, to->z + at);
}

static vec3 along_u(const patch_jets *j, int i) { return (vec3){j->axis[0].u[i], j->axis[1].u[i], j->axis[2].u[i]}; }
static vec3 along_w(const patch_jets *j, int i) { return (vec3){j->axis[0].w[i], j->axis[1].w[i], j->axis[2].w[i]}; }

static bool has_two_directions(vec3 U, vec3 W)
{
    const vec3 n = vec3_cross(U, W);
    const double e = vec3_dot(U, U) + vec3_dot(W, W);
    return vec3_dot(n, n) > 1e-18 * e * e;
}

/* Where Qu x Qw = 0, as at the end of a patch that is but a point, n is the limit from within the range: that a little
 * way off. One of the partials is made so short that bs_regular still sees that there is no second direction. Only
 * directions count there: where both are short, as at a cusp, the longer one is made LONG, so that float holds the
 * square of their product. */
static void take_limit(const patch *q, int32_t part, double u, double w, int lane, vec3s *Qu, vec3s *Qw)
{
    const double NEAR = 1e-6, SHORT = 1e-9, LONG = 1e-4;
    patch_jets j;
    u += NEAR * (0.5 * (q->u[0] + q->u[1]) - u);
    w += NEAR * (0.5 * (q->w[0] + q->w[1]) - w);
    q->ops->eval(q, 1, &part, &u, &w, 1, &j);
    vec3 U = along_u(&j, 0), W = along_w(&j, 0);
    const double lu = vec3_length(U), lw = vec3_length(W), l = fmax(fmax(lu, lw), LONG);
    U = vec3_scale(U, (lu < lw ? SHORT : 1) * l / lu);
    W = vec3_scale(W, (lu < lw ? 1 : SHORT) * l / lw);
    put3(1, &U.x, &U.y, &U.z, Qu, lane);
    put3(1, &W.x, &W.y, &W.z, Qw, lane);
}

static double clamp(double x, const double range[2]) { return x < range[0] ? range[0] : x > range[1] ? range[1] : x; }

static void searched_eval(const surface *base, int n, const int32_t *part, const real *u, const real *w, int order,
                          partials *q)
{
    const patch_surface *f = (const patch_surface *)base;
    for (int at = 0; at < n; at += PATCH_BATCH) {
        const int m = n - at < PATCH_BATCH ? n - at : PATCH_BATCH;
        double U[PATCH_BATCH], W[PATCH_BATCH];
        patch_jets j;
        const expr_jets *x = &j.axis[0], *y = &j.axis[1], *z = &j.axis[2];
        for (int i = 0; i < m; i++) { /* float's pi is beyond pi, where a sphere would be inside out */
            U[i] = clamp((double)u[at + i], f->q->u);
            W[i] = clamp((double)w[at + i], f->q->w);
        }
        f->q->ops->eval(f->q, m, part + at, U, W, order > 1 ? 2 : 1, &j);
        put3(m, x->v, y->v, z->v, &q->Q, at);
        put3(m, x->u, y->u, z->u, &q->Qu, at);
        put3(m, x->w, y->w, z->w, &q->Qw, at);
        if (order > 1) {
            put3(m, x->uu, y->uu, z->uu, &q->Quu, at);
            put3(m, x->uw, y->uw, z->uw, &q->Quw, at);
            put3(m, x->ww, y->ww, z->ww, &q->Qww, at);
        }
        for (int i = 0; i < m; i++)
            if (!has_two_directions(along_u(&j, i), along_w(&j, i)))
                take_limit(f->q, part[at + i], U[i], W[i], at + i, &q->Qu, &q->Qw);
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
        patch_query_add(&k, i, get(&x->r, i), get(&x->s, i), 0, lit[i] > 0 ? 1 : -1);
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
        p.place[i] = get(at, i);
        p.off[i] = 8 * REAL_ROUNDING * vec3_length(p.place[i]);
    }
    patch_project(f, n, part, &p);
    for (int first = 0; first < n; first += PATCH_BATCH) {
        const int m = n - first < PATCH_BATCH ? n - first : PATCH_BATCH;
        patch_jets j;
        f->q->ops->eval(f->q, m, p.part + first, p.u + first, p.w + first, 1, &j);
        for (int i = 0; i < m; i++) {
            const vec3 N = vec3_cross(along_u(&j, i), along_w(&j, i)), way = get(s, first + i);
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
        const vec3 way = get(&x->s, i);
        patch_query_add(&k, i, here ? d.r[own] : get(&x->r, i), way, here ? d.beyond[own] / vec3_length(way) : 0,
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
        const vec3 s = vec3_sub(vec3_add(get(&x->r, i), get(&x->s, i)), d.r[i]); /* to the light still */
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
    pieces_free(&f->l);
    f->q->ops->free(f->q);
    free(f->methods);
    free(f);
}

bool patch_surface_is(const surface *f) { return f->free == searched_free; }

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
            .eval = searched_eval,
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
