/* The shape of cones and cylinders: (u,w) of a hit, Q and its partials, range and bounding box. */
#include "geometry/cone.h"
#include "math/kmath.h"

/* The part of a hit is the one whose plane or side it is farthest beyond, or least within. */
STAGE static void cone_part(const cone *restrict base, int n, const rays *restrict x, const real *restrict t,
                            int32_t *restrict part)
{
    const cone f = *base;
    const real none = (real)HUGE_VAL;
    const real top = (f.capped & (f.to > 0)) ? f.length : none, bottom = (f.capped & (f.from > 0)) ? 0 : -none;
    for (int i = 0; i < n; i++) {
        cone_ray l = cone_local_of(&f, x, i);
        real px = l.ox + l.sx * t[i], py = l.oy + l.sy * t[i], pz = l.oz + l.sz * t[i];
        real out = (real_sqrt(px * px + pz * pz) - f.from - f.rise * py) * f.cos;
        int32_t end = py - top > bottom - py ? 1 : 2;
        part[i] = real_max(py - top, bottom - py) > out ? end : 0;
    }
}

STAGE static void cone_place(const cone *restrict base, int n, const rays *restrict x, const real *restrict t,
                             const int32_t *restrict part, real *restrict u, real *restrict w)
{
    const cone f = *base;
    for (int i = 0; i < n; i++) {
        cone_ray l = cone_local_of(&f, x, i);
        real px = l.ox + l.sx * t[i], py = l.oy + l.sy * t[i], pz = l.oz + l.sz * t[i];
        real turn = (real)km_atan2((double)pz, (double)px);
        real down = (real_sqrt(px * px + pz * pz) - f.to) * f.sin + (f.length - py) * f.cos;
        u[i] = part[i] == 0 ? turn : px;
        w[i] = part[i] == 0 ? down : part[i] == 1 ? -pz : pz;
    }
}

void cone_locate(const surface *base, int n, const rays *x, const real *t, int32_t *part, real *u, real *w)
{
    cone_part((const cone *)base, n, x, t, part);
    cone_place((const cone *)base, n, x, t, part, u, w);
}

void cone_foot(const surface *base, int n, const rays *x, const real *t, int32_t *part, real *u, real *w)
{
    cone_place((const cone *)base, n, x, t, part, u, w);
}

STAGE static void cone_side_eval(const cone *restrict base, int n, const real *restrict u, const real *restrict w,
                                 int order, partials *restrict q)
{
    const cone f = *base;
    const real least = R(1e-12) * f.side; /* keeps the direction of n at an apex, as POLE does in sphere.c */
    for (int i = 0; i < n; i++) {
        real cu = (real)km_cos((double)u[i]), su = (real)km_sin((double)u[i]);
        real rho = f.to + w[i] * f.sin, y = f.length - w[i] * f.cos, rim = real_max(rho, least);
        cone_vector(&f, &q->Q, i, rho * cu, y, rho * su);
        q->Q.x[i] += f.F[0];
        q->Q.y[i] += f.F[1];
        q->Q.z[i] += f.F[2];
        cone_vector(&f, &q->Qu, i, -rim * su, 0, rim * cu);
        cone_vector(&f, &q->Qw, i, f.sin * cu, -f.cos, f.sin * su);
    }
    if (order < 2)
        return;
    for (int i = 0; i < n; i++) {
        real cu = (real)km_cos((double)u[i]), su = (real)km_sin((double)u[i]);
        real rho = f.to + w[i] * f.sin;
        cone_vector(&f, &q->Quu, i, -rho * cu, 0, -rho * su);
        cone_vector(&f, &q->Quw, i, -f.sin * su, 0, f.sin * cu);
    }
    vec3s_fill(&q->Qww, n, 0, 0, 0);
}

/* The lanes on caps. The two caps differ in their height and in the direction of w. */
STAGE static void cone_caps_eval(const cone *restrict base, int n, const int32_t *restrict part, const real *restrict u,
                                 const real *restrict w, partials *restrict q)
{
    const cone f = *base;
    for (int k = 0; k < 3; k++) {
        real *restrict Q = k == 0 ? q->Q.x : k == 1 ? q->Q.y : q->Q.z;
        real *restrict Qu = k == 0 ? q->Qu.x : k == 1 ? q->Qu.y : q->Qu.z;
        real *restrict Qw = k == 0 ? q->Qw.x : k == 1 ? q->Qw.y : q->Qw.z;
        const real X = f.X[k], Z = f.Z[k], low = f.F[k], high = low + f.length * f.Y[k];
        for (int i = 0; i < n; i++) {
            real W = part[i] == 1 ? -Z : Z, O = part[i] == 1 ? high : low, at = O + u[i] * X + w[i] * W;
            Q[i] = part[i] == 0 ? Q[i] : at;
            Qu[i] = part[i] == 0 ? Qu[i] : X;
            Qw[i] = part[i] == 0 ? Qw[i] : W;
        }
    }
}

/* Set a second partial to 0 on caps. */
STAGE static void cone_caps_flatten(int n, const int32_t *restrict part, vec3s *restrict v)
{
    for (int i = 0; i < n; i++) {
        v->x[i] = part[i] == 0 ? v->x[i] : 0;
        v->y[i] = part[i] == 0 ? v->y[i] : 0;
        v->z[i] = part[i] == 0 ? v->z[i] : 0;
    }
}

void cone_eval(const surface *base, int n, const int32_t *part, const real *u, const real *w, int order, partials *q)
{
    const cone *f = (const cone *)base;
    cone_side_eval(f, n, u, w, order, q);
    if (!f->capped)
        return;
    cone_caps_eval(f, n, part, u, w, q);
    if (order == 2) {
        cone_caps_flatten(n, part, &q->Quu);
        cone_caps_flatten(n, part, &q->Quw);
    }
}

void cone_extent(const surface *base, int part, double u[2], double w[2])
{
    if (part == 0) {
        u[0] = -KM_PI;
        u[1] = KM_PI;
        w[0] = 0;
        w[1] = (double)((const cone *)base)->side;
    } else
        cone_cap(base, part)->ops->extent(cone_cap(base, part), 0, u, w);
}

/* The box of the discs at the ends. */
void cone_box(const surface *base, double lo[3], double hi[3])
{
    const cone *f = (const cone *)base;
    for (int k = 0; k < 3; k++) {
        const double Y = (double)f->Y[k], across = sqrt(fmax(1 - Y * Y, 0));
        const double a = (double)f->F[k], b = a + (double)f->length * Y, ra = (double)f->from * across,
                     rb = (double)f->to * across;
        lo[k] = fmin(a - ra, b - rb);
        hi[k] = fmax(a + ra, b + rb);
    }
}
