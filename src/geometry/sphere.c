/* Sphere: Q(u,w) = C + R (sin w cos u, cos w, sin w sin u). */
#include "math/kmath.h"
#include "geometry/closed_form.h"

#include <stdio.h>
#include <stdlib.h>

/* At a pole Qu is 0, and so would be n. Qu is taken as if the sine of w were this much, which keeps the direction of n;
 * bs_regular still sees that there is no second direction. */
#define POLE 1e-12

typedef struct sphere {
    surface base;
    real C[3], R;
} sphere;

/* Both roots t0 <= t1 of |r + s t - C|^2 = R^2. Returns 0 where there are none.
 * The discriminant is taken from the foot of the perpendicular from C to the ray, |s|^2 R^2 - |s|^2 |foot|^2, which
 * keeps the digits that b^2 - a c loses for a small sphere far away [Haines et al., Ray Tracing Gems, ch. 7]. */
static inline int sphere_roots(const sphere *f, real rx, real ry, real rz, real sx, real sy, real sz, real *t0,
                               real *t1)
{
    real ox = rx - f->C[0], oy = ry - f->C[1], oz = rz - f->C[2];
    real a = sx * sx + sy * sy + sz * sz, tc = -(ox * sx + oy * sy + oz * sz) / a;
    real fx = ox + tc * sx, fy = oy + tc * sy, fz = oz + tc * sz;
    real d = f->R * f->R - (fx * fx + fy * fy + fz * fz);
    real h = real_sqrt(real_max(d, 0) / a);
    *t0 = tc - h;
    *t1 = tc + h;
    return d >= 0;
}

STAGE static void sphere_hit(const surface *base, int n, const rays *x, int32_t id, hits *h)
{
    const sphere f = *(const sphere *)base;
    for (int i = 0; i < n; i++) {
        real t0, t1;
        int met = sphere_roots(&f, x->r.x[i], x->r.y[i], x->r.z[i], x->s.x[i], x->s.y[i], x->s.z[i], &t0, &t1);
        real t = t0 > 0 ? t0 : t1;
        int take = met & (t > 0) & (t < h->t[i]);
        hits_take(h, i, take, t, id);
    }
}

/* From a point of the sphere one root is 0; the other is -2 (r - C).s/|s|^2. */
static inline real sphere_far(const sphere *f, real rx, real ry, real rz, real sx, real sy, real sz)
{
    return -2 * ((rx - f->C[0]) * sx + (ry - f->C[1]) * sy + (rz - f->C[2]) * sz) / (sx * sx + sy * sy + sz * sz);
}

STAGE static void sphere_hit_own(const surface *base, int n, const rays *x, const ray_origins *from, int32_t id,
                                 hits *h)
{
    const sphere f = *(const sphere *)base;
    for (int i = 0; i < n; i++) {
        real t0, t1, sx = x->s.x[i], sy = x->s.y[i], sz = x->s.z[i];
        real ax = from->at.x[i], ay = from->at.y[i], az = from->at.z[i];
        int met = sphere_roots(&f, x->r.x[i], x->r.y[i], x->r.z[i], sx, sy, sz, &t0, &t1), own = from->id[i] == id;
        real far = sphere_far(&f, ax, ay, az, sx, sy, sz), near = t0 > 0 ? t0 : t1, t = own ? far : near;
        int take = (met | own) & (t > 0) & (t < h->t[i]);
        hits_take(h, i, take, t, id);
    }
}

STAGE static void sphere_locate(const surface *base, int n, const rays *x, const real *t, int32_t *part, real *u,
                                real *w)
{
    const sphere f = *(const sphere *)base;
    for (int i = 0; i < n; i++) {
        part[i] = 0;
        double px = (double)(x->r.x[i] + x->s.x[i] * t[i] - f.C[0]);
        double py = (double)(x->r.y[i] + x->s.y[i] * t[i] - f.C[1]);
        double pz = (double)(x->r.z[i] + x->s.z[i] * t[i] - f.C[2]);
        u[i] = (real)km_atan2(pz, px);
        w[i] = (real)km_atan2(sqrt(px * px + pz * pz), py);
    }
}

STAGE static void sphere_eval(const surface *base, int n, const int32_t *part, const real *u, const real *w, int order,
                              partials *q)
{
    const sphere f = *(const sphere *)base;
    (void)part;
    for (int i = 0; i < n; i++) {
        real cu = (real)km_cos((double)u[i]), su = (real)km_sin((double)u[i]);
        real cw = (real)km_cos((double)w[i]), sw = (real)km_sin((double)w[i]);
        real rim = f.R * real_max(sw, R(POLE)), r = f.R * sw, y = f.R * cw;
        q->Q.x[i] = f.C[0] + r * cu;
        q->Q.y[i] = f.C[1] + y;
        q->Q.z[i] = f.C[2] + r * su;
        q->Qu.x[i] = -rim * su;
        q->Qu.y[i] = 0;
        q->Qu.z[i] = rim * cu;
        q->Qw.x[i] = y * cu;
        q->Qw.y[i] = -r;
        q->Qw.z[i] = y * su;
    }
    if (order < 2)
        return;
    for (int i = 0; i < n; i++) {
        real cu = (real)km_cos((double)u[i]), su = (real)km_sin((double)u[i]);
        real r = f.R * (real)km_sin((double)w[i]), y = f.R * (real)km_cos((double)w[i]);
        q->Quu.x[i] = -r * cu;
        q->Quu.y[i] = 0;
        q->Quu.z[i] = -r * su;
        q->Quw.x[i] = -y * su;
        q->Quw.y[i] = 0;
        q->Quw.z[i] = y * cu;
        q->Qww.x[i] = -r * cu;
        q->Qww.y[i] = -y;
        q->Qww.z[i] = -r * su;
    }
}

STAGE static void sphere_occlude(const surface *base, int n, const rays *x, real *lit)
{
    const sphere f = *(const sphere *)base;
    for (int i = 0; i < n; i++) {
        real t0, t1;
        int met = sphere_roots(&f, x->r.x[i], x->r.y[i], x->r.z[i], x->s.x[i], x->s.y[i], x->s.z[i], &t0, &t1);
        lit[i] = (met & (((t0 > 0) & (t0 < 1)) | ((t1 > 0) & (t1 < 1)))) ? 0 : lit[i];
    }
}

STAGE static void sphere_occlude_own(const surface *base, int n, const rays *x, const int32_t *part, real *lit)
{
    const sphere f = *(const sphere *)base;
    (void)part;
    for (int i = 0; i < n; i++) {
        real t = sphere_far(&f, x->r.x[i], x->r.y[i], x->r.z[i], x->s.x[i], x->s.y[i], x->s.z[i]);
        lit[i] = ((t > 0) & (t < 1)) ? 0 : lit[i];
    }
}

/* ---- for true displacement ---- */

/* The stretch within the outer sphere. From within the inner sphere it begins at that one's far side. Other stretches
 * include the inner sphere, since a ray that starts below the displaced surface meets that on the far side only. */
STAGE static void sphere_bound(const surface *base, int part, int n, const rays *x, const real *restrict end, real Pmin,
                               real Pmax, real *restrict t0, real *restrict t1)
{
    sphere outer = *(const sphere *)base, inner = outer;
    (void)part;
    outer.R += Pmax;
    inner.R = real_max(inner.R + Pmin, 0);
    for (int i = 0; i < n; i++) {
        real a, b, c, d, rx = x->r.x[i], ry = x->r.y[i], rz = x->r.z[i], sx = x->s.x[i], sy = x->s.y[i], sz = x->s.z[i];
        int in = sphere_roots(&outer, rx, ry, rz, sx, sy, sz, &a, &b);
        int core = sphere_roots(&inner, rx, ry, rz, sx, sy, sz, &c, &d);
        real from = (core & (c <= 0) & (d > 0)) ? d : real_max(a, 0), to = real_min(b, end[i]);
        t0[i] = in ? from : R(1);
        t1[i] = in ? to : R(-1);
    }
}

STAGE static void sphere_closest(const surface *base, int part, int n, const rays *x, const real *restrict t,
                                 closest_points *restrict p)
{
    const sphere f = *(const sphere *)base;
    (void)part;
    for (int i = 0; i < n; i++) {
        real px = x->r.x[i] + x->s.x[i] * t[i] - f.C[0];
        real py = x->r.y[i] + x->s.y[i] * t[i] - f.C[1];
        real pz = x->r.z[i] + x->s.z[i] * t[i] - f.C[2];
        real d2 = px * px + pz * pz, d = real_sqrt(d2), l = real_sqrt(d2 + py * py);
        real id2 = 1 / real_max(d2, R(1e-30)), id = 1 / real_max(d, R(1e-15)), il = 1 / real_max(l, R(1e-15));
        p->u[i] = (real)km_atan2((double)pz, (double)px);
        p->w[i] = (real)km_atan2((double)d, (double)py);
        p->h[i] = l - f.R;
        p->gh.x[i] = px * il;
        p->gh.y[i] = py * il;
        p->gh.z[i] = pz * il;
        p->gu.x[i] = -pz * id2;
        p->gu.y[i] = 0;
        p->gu.z[i] = px * id2;
        p->gw.x[i] = py * px * id * il * il;
        p->gw.y[i] = -d * il * il;
        p->gw.z[i] = py * pz * id * il * il;
    }
}

/* |grad u| is 1/(distance to the axis), |grad w| 1/(distance to the centre), which is the longer one. So along a unit
 * vector |u''| <= |grad u|^2, |h''| <= |grad w|, and |w''| <= (1 + |cot w|) |grad w|^2 <= |grad w|^2 + |grad u||grad
 * w|.
 */
STAGE static void sphere_bend(const surface *base, int part, int n, const rays *x, const closest_points *restrict p,
                              path_bends *restrict out)
{
    (void)base;
    (void)part;
    for (int i = 0; i < n; i++) {
        real sx = x->s.x[i], sy = x->s.y[i], sz = x->s.z[i], s = real_sqrt(sx * sx + sy * sy + sz * sz);
        real gu = s * real_sqrt(p->gu.x[i] * p->gu.x[i] + p->gu.y[i] * p->gu.y[i] + p->gu.z[i] * p->gu.z[i]);
        real gw = s * real_sqrt(p->gw.x[i] * p->gw.x[i] + p->gw.y[i] * p->gw.y[i] + p->gw.z[i] * p->gw.z[i]);
        real u = R(BEND_MORE) * gu, w = R(BEND_MORE) * gw;
        out->u[i] = u * u;
        out->w[i] = w * (u + w);
        out->h[i] = w * s;
        out->reach[i] = R(BEND_REACH) / real_max(gu, gw);
    }
}

static void sphere_box(const surface *base, double lo[3], double hi[3])
{
    const sphere *f = (const sphere *)base;
    for (int k = 0; k < 3; k++) {
        lo[k] = (double)f->C[k] - (double)f->R;
        hi[k] = (double)f->C[k] + (double)f->R;
    }
}

static const surface_ops sphere_methods = {
    .kind = "sphere",
    .hit = sphere_hit,
    .hit_own = sphere_hit_own,
    .locate = sphere_locate,
    .foot = sphere_locate,
    .eval = sphere_eval,
    .occlude = sphere_occlude,
    .occlude_own = sphere_occlude_own,
    .extent = extent_polar,
    .box = sphere_box,
    .parts = 1,
    .bound = sphere_bound,
    .closest = sphere_closest,
    .bend = sphere_bend,
    .around = AROUND_U,
};

surface *sphere_new(vec3 centre, double radius)
{
    sphere *f = radius > 0 && radius < HUGE_VAL ? calloc(1, sizeof *f) : NULL;
    if (!f)
        return NULL;
    f->base.ops = &sphere_methods;
    vec3_round(f->C, centre);
    f->R = (real)radius;
    return &f->base;
}

/* ---- in the scene file ---- */

static const form_parameter sphere_parameters[] = {
    {"center", FORM_PLACE, 0, "a place [x, y, z]"},
    {"radius", FORM_POSITIVE, 0, NULL},
    {0},
};

static surface *make_sphere(const shape_values *v, form_fault *fault)
{
    (void)fault;
    return sphere_new(v->v[0], v->r[0]);
}

static bool sphere_formula(const shape_values *v, form_formula *out)
{
    const vec3 up = {0, 1, 0};
    char rho[40], y[40];
    snprintf(rho, sizeof rho, "%.17g*sin(w)", v->r[0]);
    snprintf(y, sizeof y, "%.17g*cos(w)", v->r[0]);
    extent_polar(NULL, 0, out->u, out->w);
    formula_revolve(out, frame_about(up), rho, y);
    return true;
}

const closed_form form_sphere = {
    .name = "sphere",
    .parameters = sphere_parameters,
    .make = make_sphere,
    .formula = sphere_formula,
    .solid = true,
    .povray = "sphere {\n  $center, $radius\n",
};
