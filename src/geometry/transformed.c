/* A surface under an affine map: rays are mapped back into the space of the original, and results are mapped from
 * there. Directions are not made unit vectors, so that t is the same in both spaces.
 *
 * A map that mirrors would make n = Qu x Qw point inward. So u then runs the other way, and seen from outside u still
 * goes to the right where w goes down.
 *
 * For true displacement, heights are in scene units along the normal of the image. The closest point stays the closest
 * where the map keeps angles. Where it does not, flat surfaces still have flat images with closest points of their own:
 * planes become planes, and the faces of a box become rectangles. Stretched round surfaces cannot be displaced.
 */
#include "base/affine.h"
#include "wave/lane.h"
#include "geometry/closed_form.h"
#include "geometry/plane.h"

#include <stdlib.h>
#include <string.h>

enum { FACES = 6 };

typedef struct transformed {
    surface base;
    surface_ops methods;       /* the original's, with those of this file in place of some */
    const surface *from;       /* the original; not owned */
    real to[3][3], back[3][3]; /* images of the axes; the rows of the inverse */
    real o[3];                 /* the image of the origin */
    real scale, over;          /* of lengths, where the map keeps angles, and 1/scale; else 0 */
    real mirror, u_ends_sum;   /* u here is u_ends_sum + mirror u there; mirror is -1 where the map mirrors, else 1 */
    plane face[FACES];         /* the faces of a box */
} transformed;

static const transformed *of(const surface *f) { return (const transformed *)f; }

/* ---- there and back ---- */

STAGE static void places_back(const transformed *restrict base, int n, const vec3s *restrict r, vec3s *restrict to)
{
    const transformed f = *base;
    for (int i = 0; i < n; i++) {
        real rx = r->x[i] - f.o[0], ry = r->y[i] - f.o[1], rz = r->z[i] - f.o[2];
        to->x[i] = f.back[0][0] * rx + f.back[0][1] * ry + f.back[0][2] * rz;
        to->y[i] = f.back[1][0] * rx + f.back[1][1] * ry + f.back[1][2] * rz;
        to->z[i] = f.back[2][0] * rx + f.back[2][1] * ry + f.back[2][2] * rz;
    }
}

STAGE static void rays_back(const transformed *restrict base, int n, const rays *restrict x, rays *restrict y)
{
    const transformed f = *base;
    for (int i = 0; i < n; i++) {
        real rx = x->r.x[i] - f.o[0], ry = x->r.y[i] - f.o[1], rz = x->r.z[i] - f.o[2];
        real sx = x->s.x[i], sy = x->s.y[i], sz = x->s.z[i];
        y->r.x[i] = f.back[0][0] * rx + f.back[0][1] * ry + f.back[0][2] * rz;
        y->r.y[i] = f.back[1][0] * rx + f.back[1][1] * ry + f.back[1][2] * rz;
        y->r.z[i] = f.back[2][0] * rx + f.back[2][1] * ry + f.back[2][2] * rz;
        y->s.x[i] = f.back[0][0] * sx + f.back[0][1] * sy + f.back[0][2] * sz;
        y->s.y[i] = f.back[1][0] * sx + f.back[1][1] * sy + f.back[1][2] * sz;
        y->s.z[i] = f.back[2][0] * sx + f.back[2][1] * sy + f.back[2][2] * sz;
    }
}

/* v = k M v + o, by the columns of M. */
static inline void apply(int n, const real M[3][3], real k, const real o[3], vec3s *v)
{
    const real xx = k * M[0][0], xy = k * M[0][1], xz = k * M[0][2], yx = k * M[1][0], yy = k * M[1][1],
               yz = k * M[1][2];
    const real zx = k * M[2][0], zy = k * M[2][1], zz = k * M[2][2], ox = o[0], oy = o[1], oz = o[2];
    for (int i = 0; i < n; i++) {
        real x = v->x[i], y = v->y[i], z = v->z[i];
        v->x[i] = x * xx + y * yx + z * zx + ox;
        v->y[i] = x * xy + y * yy + z * zy + oy;
        v->z[i] = x * xz + y * yz + z * zz + oz;
    }
}

static const real nowhere[3] = {0, 0, 0};

STAGE static void places_to(const transformed *f, int n, vec3s *v) { apply(n, f->to, 1, f->o, v); }
STAGE static void vectors_to(const transformed *f, int n, real k, vec3s *v) { apply(n, f->to, k, nowhere, v); }

/* Gradients are mapped by the transpose of the inverse. */
STAGE static void gradients_to(const transformed *f, int n, real k, vec3s *v) { apply(n, f->back, k, nowhere, v); }

/* From one u to the other, in either direction. */
STAGE static void mirror_u(const transformed *f, int n, const real *u, real *to)
{
    const real mirror = f->mirror, sum = f->u_ends_sum;
    for (int i = 0; i < n; i++)
        to[i] = sum + mirror * u[i];
}

STAGE static void stretch(int n, real k, real *v)
{
    for (int i = 0; i < n; i++)
        v[i] *= k;
}

/* ---- the surface ---- */

static void transformed_hit(const surface *base, int n, const rays *x, int32_t id, hits *h)
{
    const transformed *f = of(base);
    rays y;
    rays_back(f, n, x, &y);
    f->from->ops->hit(f->from, n, &y, id, h);
}

static void transformed_hit_own(const surface *base, int n, const rays *x, const ray_origins *from, int32_t id, hits *h)
{
    const transformed *f = of(base);
    rays y;
    ray_origins there;
    rays_back(f, n, x, &y);
    memcpy(there.id, from->id, (size_t)n * sizeof *there.id);
    memcpy(there.part, from->part, (size_t)n * sizeof *there.part);
    places_back(f, n, &from->at, &there.at);
    f->from->ops->hit_own(f->from, n, &y, &there, id, h);
}

static void transformed_locate(const surface *base, int n, const rays *x, const real *t, int32_t *part, real *u,
                               real *w)
{
    const transformed *f = of(base);
    rays y;
    rays_back(f, n, x, &y);
    f->from->ops->locate(f->from, n, &y, t, part, u, w);
    mirror_u(f, n, u, u);
}

static void transformed_foot(const surface *base, int n, const rays *x, const real *t, int32_t *part, real *u, real *w)
{
    const transformed *f = of(base);
    rays y;
    rays_back(f, n, x, &y);
    f->from->ops->foot(f->from, n, &y, t, part, u, w);
    mirror_u(f, n, u, u);
}

static void transformed_eval(const surface *base, int n, const int32_t *part, const real *u, const real *w, int order,
                             partials *q)
{
    const transformed *f = of(base);
    real v[LANES];
    mirror_u(f, n, u, v);
    f->from->ops->eval(f->from, n, part, v, w, order, q);
    places_to(f, n, &q->Q);
    vectors_to(f, n, f->mirror, &q->Qu);
    vectors_to(f, n, 1, &q->Qw);
    if (order < 2)
        return;
    vectors_to(f, n, 1, &q->Quu);
    vectors_to(f, n, f->mirror, &q->Quw);
    vectors_to(f, n, 1, &q->Qww);
}

static void transformed_occlude(const surface *base, int n, const rays *x, real *lit)
{
    const transformed *f = of(base);
    rays y;
    rays_back(f, n, x, &y);
    f->from->ops->occlude(f->from, n, &y, lit);
}

static void transformed_occlude_own(const surface *base, int n, const rays *x, const int32_t *part, real *lit)
{
    const transformed *f = of(base);
    rays y;
    rays_back(f, n, x, &y);
    f->from->ops->occlude_own(f->from, n, &y, part, lit);
}

/* The original's: where the map mirrors, u is reflected about the middle of its extent. */
static void transformed_extent(const surface *base, int part, double u[2], double w[2])
{
    of(base)->from->ops->extent(of(base)->from, part, u, w);
}

/* ---- for true displacement, by maps that keep angles ---- */

static void similar_bound(const surface *base, int part, int n, const rays *x, const real *end, real Pmin, real Pmax,
                          real *t0, real *t1)
{
    const transformed *f = of(base);
    rays y;
    rays_back(f, n, x, &y);
    f->from->ops->bound(f->from, part, n, &y, end, Pmin * f->over, Pmax * f->over, t0, t1);
}

static void similar_closest(const surface *base, int part, int n, const rays *x, const real *t, closest_points *p)
{
    const transformed *f = of(base);
    rays y;
    rays_back(f, n, x, &y);
    f->from->ops->closest(f->from, part, n, &y, t, p);
    mirror_u(f, n, p->u, p->u);
    stretch(n, f->scale, p->h);
    gradients_to(f, n, f->mirror, &p->gu);
    gradients_to(f, n, 1, &p->gw);
    gradients_to(f, n, f->scale, &p->gh);
}

/* As in `from`: it depends on the ray and the gradients alone. */
static void similar_bend(const surface *base, int part, int n, const rays *x, const closest_points *p, path_bends *out)
{
    const surface *from = of(base)->from;
    from->ops->bend(from, part, n, x, p, out);
}

/* ---- the same on a box, by any map ---- */

static void faces_bound(const surface *base, int part, int n, const rays *x, const real *end, real Pmin, real Pmax,
                        real *t0, real *t1)
{
    const surface *face = &of(base)->face[part].base;
    face->ops->bound(face, 0, n, x, end, Pmin, Pmax, t0, t1);
}

static void faces_closest(const surface *base, int part, int n, const rays *x, const real *t, closest_points *p)
{
    const surface *face = &of(base)->face[part].base;
    face->ops->closest(face, 0, n, x, t, p);
}

/* The box of the image of the original's box. */
static void transformed_box(const surface *base, double lo[3], double hi[3])
{
    const transformed *f = of(base);
    double a[3], b[3];
    f->from->ops->box(f->from, a, b);
    for (int k = 0; k < 3; k++) {
        lo[k] = hi[k] = (double)f->o[k];
        for (int j = 0; j < 3; j++) {
            const double x = (double)f->to[j][k] * a[j], y = (double)f->to[j][k] * b[j];
            lo[k] += fmin(x, y);
            hi[k] += fmax(x, y);
        }
    }
}

/* ---- making them ---- */

static bool is(const surface *f, const char *kind) { return strcmp(f->ops->kind, kind) == 0; }

/* Place a plane or a rectangle at the image of a flat part of a surface. */
static bool flat_image(plane *to, const surface *f, int part, const affine *m, double mirror, double sum)
{
    const int32_t p = part;
    const real u = (real)sum, w = 0;
    partials q;
    f->ops->eval(f, 1, &p, &u, &w, 1, &q);
    return plane_place(to, affine_point(m, vec3s_get(&q.Q, 0)),
                       vec3_scale(affine_vector(m, vec3s_get(&q.Qu, 0)), mirror),
                       affine_vector(m, vec3s_get(&q.Qw, 0)));
}

static surface *plane_image(const surface *f, const affine *m, double mirror, double sum)
{
    plane *p = malloc(sizeof *p);
    if (p) {
        *p = *(const plane *)f;
        p->base.others = 0;
    }
    if (p && flat_image(p, f, 0, m, mirror, sum))
        return &p->base;
    free(p);
    return NULL;
}

static bool box_image(transformed *f, const affine *m)
{
    bool good = true;
    for (int part = 0; part < FACES; part++) {
        rectangle_set(&f->face[part]);
        good = flat_image(&f->face[part], f->from, part, m, (double)f->mirror, (double)f->u_ends_sum) && good;
    }
    f->methods.bound = faces_bound;
    f->methods.closest = faces_closest;
    f->methods.bend = bend_flat;
    return good;
}

static void choose_methods(transformed *f)
{
    f->base.ops = &f->methods;
    f->methods = *f->from->ops;
    f->methods.hit = transformed_hit;
    f->methods.hit_own = transformed_hit_own;
    f->methods.locate = transformed_locate;
    f->methods.foot = f->scale > 0 && f->from->ops->foot ? transformed_foot : NULL;
    f->methods.eval = transformed_eval;
    f->methods.occlude = transformed_occlude;
    f->methods.occlude_own = f->from->ops->occlude_own ? transformed_occlude_own : NULL;
    f->methods.extent = transformed_extent;
    f->methods.box = transformed_box;
    const bool known = f->scale > 0 && f->from->ops->closest;
    f->methods.bound = known ? similar_bound : NULL;
    f->methods.closest = known ? similar_closest : NULL;
    f->methods.bend = known ? similar_bend : NULL;
}

surface *surface_transformed(const surface *from, const affine *m)
{
    const double volume = affine_volume(m), scale = affine_scale(m);
    double u[2], w[2];
    if (!(fabs(volume) > 0) || !(fabs(volume) < HUGE_VAL))
        return NULL;
    from->ops->extent(from, 0, u, w);
    const double mirror = volume < 0 ? -1 : 1, sum = volume < 0 && u[1] < HUGE_VAL ? u[0] + u[1] : 0;
    if (is(from, "plane") || is(from, "rectangle") || is(from, "disc"))
        return plane_image(from, m, mirror, sum);
    transformed *f = calloc(1, sizeof *f);
    if (!f)
        return NULL;
    f->from = from;
    f->mirror = (real)mirror;
    f->u_ends_sum = (real)sum;
    const affine back = affine_back(m);
    vec3_round(f->to[0], m->x);
    vec3_round(f->to[1], m->y);
    vec3_round(f->to[2], m->z);
    vec3_round(f->back[0], back.x);
    vec3_round(f->back[1], back.y);
    vec3_round(f->back[2], back.z);
    vec3_round(f->o, m->o);
    f->scale = (real)scale;
    f->over = scale > 0 ? (real)(1 / scale) : 0;
    choose_methods(f);
    if (is(from, "box") && !box_image(f, m)) {
        free(f);
        return NULL;
    }
    return &f->base;
}
