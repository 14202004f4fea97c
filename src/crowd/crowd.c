/* A crowd as a surface: each method maps its lanes to the originals of their copies, asks the original for all of them
 * at once, and maps the results. Hits and shadows are in crowd/hit.c. The formulas are those of geometry/transformed.c,
 * in the same order: a copy has the same bytes as an object of its own.
 */
#include "base/threads.h"
#include "crowd/parts.h"

#include <stdlib.h>
#include <string.h>

STAGE static void crowd_mirror_u(const crowd *f, int n, const real *u, real *to)
{
    const real mirror = f->mirror, sum = f->u_ends_sum;
    for (int i = 0; i < n; i++)
        to[i] = sum + mirror * u[i];
}

/* ---- the surface ---- */

/* surface_ops.locate or foot. */
typedef void find_uw(const surface *f, int n, const rays *x, const real *t, int32_t *part, real *u, real *w);

static void find_by(find_uw *of_original, const crowd *f, int n, const rays *x, const real *t, int32_t *part, real *u,
                    real *w)
{
    rays y;
    int32_t at[LANES], its[LANES];
    crowd_split(f, n, part, at, its);
    crowd_rays_back(f, n, at, NULL, x, &y);
    of_original(f->from, n, &y, t, its, u, w);
    crowd_mirror_u(f, n, u, u);
    crowd_join(f, n, at, its, part);
}

static void crowd_locate(const surface *base, int n, const rays *x, const real *t, int32_t *part, real *u, real *w)
{
    const crowd *f = (const crowd *)base;
    find_by(f->from->ops->locate, f, n, x, t, part, u, w);
}

static void crowd_foot(const surface *base, int n, const rays *x, const real *t, int32_t *part, real *u, real *w)
{
    const crowd *f = (const crowd *)base;
    find_by(f->from->ops->foot, f, n, x, t, part, u, w);
}

static void crowd_eval(const surface *base, int n, const int32_t *part, const real *u, const real *w, int order,
                       partials *q)
{
    const crowd *f = (const crowd *)base;
    real v[LANES];
    int32_t at[LANES], its[LANES];
    crowd_maps k;
    crowd_split(f, n, part, at, its);
    crowd_maps_to(f, n, at, &k);
    crowd_mirror_u(f, n, u, v);
    f->from->ops->eval(f->from, n, its, v, w, order, q);
    crowd_places_to(&k, n, &q->Q);
    crowd_vectors_to(&k, n, f->mirror, &q->Qu);
    crowd_vectors_to(&k, n, 1, &q->Qw);
    if (order < 2)
        return;
    crowd_vectors_to(&k, n, 1, &q->Quu);
    crowd_vectors_to(&k, n, f->mirror, &q->Quw);
    crowd_vectors_to(&k, n, 1, &q->Qww);
}

static void crowd_occlude_own(const surface *base, int n, const rays *x, const int32_t *part, real *lit)
{
    const crowd *f = (const crowd *)base;
    rays y;
    int32_t at[LANES], its[LANES];
    crowd_split(f, n, part, at, its);
    crowd_rays_back(f, n, at, NULL, x, &y);
    f->from->ops->occlude_own(f->from, n, &y, its, lit);
}

void crowd_occlude_same(const crowd *f, int n, const rays *x, const int32_t *part, real *lit)
{
    rays y;
    int32_t at[LANES], its[LANES];
    crowd_split(f, n, part, at, its);
    crowd_rays_back(f, n, at, NULL, x, &y);
    f->from->ops->occlude(f->from, n, &y, lit);
}

static void crowd_extent(const surface *base, int part, double u[2], double w[2])
{
    const crowd *f = (const crowd *)base;
    f->from->ops->extent(f->from, part % f->parts, u, w);
}

static void crowd_box(const surface *base, double lo[3], double hi[3])
{
    const crowd *f = (const crowd *)base;
    memcpy(lo, f->lo, sizeof f->lo);
    memcpy(hi, f->hi, sizeof f->hi);
}

static void crowd_free(surface *base)
{
    crowd *f = (crowd *)base;
    wide_free(f->tree);
    memory_free(f->copy);
    free(f);
}

int32_t crowd_count(const crowd *f, int32_t kind)
{
    int32_t n = 0;
    for (int32_t k = 0; k < f->n; k++)
        n += f->copy[k].kind == kind;
    return n;
}

affine crowd_map(const crowd *f, int32_t k)
{
    const crowd_copy *c = &f->copy[k];
    vec3 v[3];
    for (int a = 0; a < 3; a++)
        v[a] = (vec3){(double)c->to[a][0], (double)c->to[a][1], (double)c->to[a][2]};
    return (affine){v[0], v[1], v[2], {(double)c->o[0], (double)c->o[1], (double)c->o[2]}};
}

/* ---- making it ---- */

static void choose_methods(crowd *f, bool keeps_angles)
{
    f->base = (surface){.ops = &f->methods, .free = crowd_free};
    f->methods = *f->from->ops;
    f->methods.kind = "copies";
    f->methods.hit = crowd_hit;
    f->methods.hit_own = crowd_hit_own;
    f->methods.locate = crowd_locate;
    f->methods.foot = keeps_angles && f->from->ops->foot ? crowd_foot : NULL;
    f->methods.eval = crowd_eval;
    f->methods.occlude = crowd_occlude;
    f->methods.occlude_own = f->from->ops->occlude_own ? crowd_occlude_own : NULL;
    f->methods.extent = crowd_extent;
    f->methods.box = crowd_box;
    f->methods.parts = f->n * f->parts;
    f->methods.bound = NULL;
    f->methods.closest = NULL;
    f->methods.bend = NULL;
}

static crowd_copy copy_by(const affine *m, int32_t kind, int32_t row)
{
    crowd_copy c = {.kind = kind, .row = row};
    const affine back = affine_back(m);
    vec3_round(c.to[0], m->x);
    vec3_round(c.to[1], m->y);
    vec3_round(c.to[2], m->z);
    vec3_round(c.back[0], back.x);
    vec3_round(c.back[1], back.y);
    vec3_round(c.back[2], back.z);
    vec3_round(c.o, m->o);
    return c;
}

/* The box of the image of the original's box a..b. */
static void box_by(const affine *m, const double a[3], const double b[3], double lo[3], double hi[3])
{
    const double axis[3][3] = {{m->x.x, m->x.y, m->x.z}, {m->y.x, m->y.y, m->y.z}, {m->z.x, m->z.y, m->z.z}};
    const double o[3] = {m->o.x, m->o.y, m->o.z};
    for (int k = 0; k < 3; k++) {
        lo[k] = hi[k] = o[k];
        for (int j = 0; j < 3; j++) {
            const double x = axis[j][k] * a[j], y = axis[j][k] * b[j];
            lo[k] += fmin(x, y);
            hi[k] += fmax(x, y);
        }
    }
}

/* The boxes of all copies, and the crowd's own. */
static void boxes_of(crowd *f, const crowd_list *list, wide_box *box, int threads)
{
    double a[3], b[3];
    f->from->ops->box(f->from, a, b);
    (void)threads; /* without OpenMP */
#pragma omp parallel for num_threads(threads)
    for (int32_t i = 0; i < list->n; i++) {
        double lo[3], hi[3];
        int32_t kind;
        const affine m = list->copy(list->user, i, &kind);
        box_by(&m, a, b, lo, hi);
        box[i] = wide_box_of(lo, hi);
    }
    for (int32_t i = 0; i < list->n; i++)
        for (int k = 0; k < 3; k++) {
            f->lo[k] = i && f->lo[k] < (double)box[i].lo[k] ? f->lo[k] : (double)box[i].lo[k];
            f->hi[k] = i && f->hi[k] > (double)box[i].hi[k] ? f->hi[k] : (double)box[i].hi[k];
        }
}

/* The copies, in the hierarchy's order. Returns whether all maps keep angles. */
static bool place_copies(crowd *f, const crowd_list *list, const int32_t *order, int threads)
{
    bool keep = true;
    (void)threads;
#pragma omp parallel for num_threads(threads) reduction(&& : keep)
    for (int32_t k = 0; k < list->n; k++) {
        int32_t kind;
        const affine m = list->copy(list->user, order[k], &kind);
        f->copy[k] = copy_by(&m, kind, order[k]);
        keep = keep && affine_scale(&m) > 0;
    }
    return keep;
}

static void begin(crowd *f, const surface *from, int32_t parts, const crowd_list *list)
{
    double u[2], w[2];
    int32_t kind;
    const affine first = list->copy(list->user, 0, &kind);
    const bool mirrors = affine_volume(&first) < 0;
    f->from = from;
    f->n = list->n;
    f->parts = parts;
    f->kinds = list->kinds;
    from->ops->extent(from, 0, u, w);
    f->mirror = mirrors ? -1 : 1;
    f->u_ends_sum = mirrors && u[1] < HUGE_VAL ? (real)(u[0] + u[1]) : 0;
}

crowd *crowd_new(const surface *from, int32_t parts, const crowd_list *list, int threads, const progress *w)
{
    const size_t n = (size_t)list->n;
    memory *m = progress_memory(w);
    crowd *f = calloc(1, sizeof *f);
    wide_box *box = memory_new(m, sizeof *box * n);
    int32_t *order = memory_new(m, sizeof *order * n);
    threads = threads_of(threads);
    if (f && box && order && (f->copy = memory_new(m, sizeof *f->copy * n))) {
        begin(f, from, parts, list);
        boxes_of(f, list, box, threads);
        f->tree = wide_new(list->n, box, order, threads, w);
        if (f->tree)
            choose_methods(f, place_copies(f, list, order, threads));
    }
    memory_free(box);
    memory_free(order);
    if (f && f->tree)
        return f;
    if (f)
        memory_free(f->copy);
    free(f);
    return NULL;
}
