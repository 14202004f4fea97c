/* Ellipsoid with its axes along the scene's: Q(u,w) = C + (a sin w cos u, b cos w, c sin w sin u).
 *
 * Relative to C and divided by the radii, it is the unit sphere, with the same t. Its closest points have no closed
 * form, so true displacement takes it as a patch, by its formula.
 */
#include "geometry/closed_form.h"
#include "math/kmath.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct ellipsoid {
    surface base;
    real C[3], R[3], over[3]; /* the centre, the radii along x, y and z, 1/radius */
} ellipsoid;

/* A ray in the space of the unit sphere. */
typedef struct unit_ray {
    real ox, oy, oz, dx, dy, dz;
} unit_ray;

KM_INLINE unit_ray ray_of(const ellipsoid *f, const vec3s *r, const vec3s *s, int i)
{
    return (unit_ray){(r->x[i] - f->C[0]) * f->over[0],
                      (r->y[i] - f->C[1]) * f->over[1],
                      (r->z[i] - f->C[2]) * f->over[2],
                      s->x[i] * f->over[0],
                      s->y[i] * f->over[1],
                      s->z[i] * f->over[2]};
}

/* Both roots, t0 <= t1; 0 where there is none. As sphere_roots, from the foot of the perpendicular to the ray. */
KM_INLINE int roots_of(unit_ray y, real *t0, real *t1)
{
    real a = y.dx * y.dx + y.dy * y.dy + y.dz * y.dz, tc = -(y.ox * y.dx + y.oy * y.dy + y.oz * y.dz) / a;
    real fx = y.ox + tc * y.dx, fy = y.oy + tc * y.dy, fz = y.oz + tc * y.dz;
    real d = 1 - (fx * fx + fy * fy + fz * fz), h = real_sqrt(real_max(d, 0) / a);
    *t0 = tc - h;
    *t1 = tc + h;
    return d >= 0;
}

/* From a point of the surface one root is 0; this is the other. */
KM_INLINE real far_root(unit_ray y)
{
    return -2 * (y.ox * y.dx + y.oy * y.dy + y.oz * y.dz) / (y.dx * y.dx + y.dy * y.dy + y.dz * y.dz);
}

STAGE static void ellipsoid_hit(const surface *base, int n, const rays *x, int32_t id, hits *h)
{
    const ellipsoid f = *(const ellipsoid *)base;
    for (int i = 0; i < n; i++) {
        real t0, t1;
        int met = roots_of(ray_of(&f, &x->r, &x->s, i), &t0, &t1);
        real t = t0 > 0 ? t0 : t1;
        int take = met & (t > 0) & (t < h->t[i]);
        hits_take(h, i, take, t, id);
    }
}

STAGE static void ellipsoid_hit_own(const surface *base, int n, const rays *x, const ray_origins *from, int32_t id,
                                    hits *h)
{
    const ellipsoid f = *(const ellipsoid *)base;
    for (int i = 0; i < n; i++) {
        real t0, t1;
        int met = roots_of(ray_of(&f, &x->r, &x->s, i), &t0, &t1), own = from->id[i] == id;
        real far = far_root(ray_of(&f, &from->at, &x->s, i)), near = t0 > 0 ? t0 : t1, t = own ? far : near;
        int take = (met | own) & (t > 0) & (t < h->t[i]);
        hits_take(h, i, take, t, id);
    }
}

STAGE static void ellipsoid_locate(const surface *base, int n, const rays *x, const real *t, int32_t *part, real *u,
                                   real *w)
{
    const ellipsoid f = *(const ellipsoid *)base;
    for (int i = 0; i < n; i++) {
        unit_ray y = ray_of(&f, &x->r, &x->s, i);
        double px = (double)(y.ox + y.dx * t[i]), py = (double)(y.oy + y.dy * t[i]), pz = (double)(y.oz + y.dz * t[i]);
        part[i] = 0;
        u[i] = (real)km_atan2(pz, px);
        w[i] = (real)km_atan2(sqrt(px * px + pz * pz), py);
    }
}

STAGE static void ellipsoid_eval(const surface *base, int n, const int32_t *part, const real *u, const real *w,
                                 int order, partials *q)
{
    const ellipsoid f = *(const ellipsoid *)base;
    (void)part;
    for (int i = 0; i < n; i++) {
        real cu = (real)km_cos((double)u[i]), su = (real)km_sin((double)u[i]);
        real cw = (real)km_cos((double)w[i]), sw = (real)km_sin((double)w[i]);
        real rim = real_max(sw, R(1e-12)); /* at a pole Qu is 0; this keeps the direction of n (sphere_eval) */
        q->Q.x[i] = f.C[0] + f.R[0] * sw * cu;
        q->Q.y[i] = f.C[1] + f.R[1] * cw;
        q->Q.z[i] = f.C[2] + f.R[2] * sw * su;
        q->Qu.x[i] = -f.R[0] * rim * su;
        q->Qu.y[i] = 0;
        q->Qu.z[i] = f.R[2] * rim * cu;
        q->Qw.x[i] = f.R[0] * cw * cu;
        q->Qw.y[i] = -f.R[1] * sw;
        q->Qw.z[i] = f.R[2] * cw * su;
    }
    if (order < 2)
        return;
    for (int i = 0; i < n; i++) {
        real cu = (real)km_cos((double)u[i]), su = (real)km_sin((double)u[i]);
        real cw = (real)km_cos((double)w[i]), sw = (real)km_sin((double)w[i]);
        q->Quu.x[i] = q->Qww.x[i] = -f.R[0] * sw * cu;
        q->Quu.y[i] = 0;
        q->Quu.z[i] = q->Qww.z[i] = -f.R[2] * sw * su;
        q->Quw.x[i] = -f.R[0] * cw * su;
        q->Quw.y[i] = 0;
        q->Quw.z[i] = f.R[2] * cw * cu;
        q->Qww.y[i] = -f.R[1] * cw;
    }
}

STAGE static void ellipsoid_occlude(const surface *base, int n, const rays *x, real *lit)
{
    const ellipsoid f = *(const ellipsoid *)base;
    for (int i = 0; i < n; i++) {
        real t0, t1;
        int met = roots_of(ray_of(&f, &x->r, &x->s, i), &t0, &t1);
        lit[i] = (met & (((t0 > 0) & (t0 < 1)) | ((t1 > 0) & (t1 < 1)))) ? 0 : lit[i];
    }
}

STAGE static void ellipsoid_occlude_own(const surface *base, int n, const rays *x, const int32_t *part, real *lit)
{
    const ellipsoid f = *(const ellipsoid *)base;
    (void)part;
    for (int i = 0; i < n; i++) {
        real t = far_root(ray_of(&f, &x->r, &x->s, i));
        lit[i] = ((t > 0) & (t < 1)) ? 0 : lit[i];
    }
}

static void ellipsoid_box(const surface *base, double lo[3], double hi[3])
{
    const ellipsoid *f = (const ellipsoid *)base;
    for (int k = 0; k < 3; k++) {
        lo[k] = (double)f->C[k] - (double)f->R[k];
        hi[k] = (double)f->C[k] + (double)f->R[k];
    }
}

static const surface_ops ellipsoid_methods = {
    .kind = "ellipsoid",
    .hit = ellipsoid_hit,
    .hit_own = ellipsoid_hit_own,
    .locate = ellipsoid_locate,
    .eval = ellipsoid_eval,
    .occlude = ellipsoid_occlude,
    .occlude_own = ellipsoid_occlude_own,
    .extent = extent_polar,
    .box = ellipsoid_box,
    .parts = 1,
};

/* ---- in the scene file ---- */

static const form_parameter ellipsoid_parameters[] = {
    {"center", FORM_PLACE, 0, "a place [x, y, z]"},
    {"radii", FORM_VECTOR, 1, "the radii along x, y and z"},
    {0},
};

static surface *make_ellipsoid(const shape_values *v, form_fault *fault)
{
    const vec3 c = v->v[0], radii = v->v[1];
    if (fmin(radii.x, fmin(radii.y, radii.z)) < SHAPE_SMALL) {
        *fault = (form_fault){"radii", "a radius that is not above 0, expected three of 1e-6 to 1e6"};
        return NULL;
    }
    ellipsoid *f = calloc(1, sizeof *f);
    if (!f)
        return NULL;
    f->base.ops = &ellipsoid_methods;
    vec3_round(f->C, c);
    vec3_round(f->R, radii);
    vec3_round(f->over, (vec3){1 / radii.x, 1 / radii.y, 1 / radii.z});
    return &f->base;
}

static bool ellipsoid_formula(const shape_values *v, form_formula *out)
{
    extent_polar(NULL, 0, out->u, out->w);
    snprintf(out->xyz[0], sizeof out->xyz[0], "%.17g*sin(w)*cos(u)", v->v[1].x);
    snprintf(out->xyz[1], sizeof out->xyz[1], "%.17g*cos(w)", v->v[1].y);
    snprintf(out->xyz[2], sizeof out->xyz[2], "%.17g*sin(w)*sin(u)", v->v[1].z);
    return true;
}

const closed_form form_ellipsoid = {
    .name = "ellipsoid",
    .parameters = ellipsoid_parameters,
    .make = make_ellipsoid,
    .formula = ellipsoid_formula,
    .solid = true,
    .povray = "sphere {\n  0, 1\n  scale $radii\n  translate $center\n",
};
