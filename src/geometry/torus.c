/* Torus: Q(u,w) = C + (M + m cos w) (cos u X + sin u Z) - m sin w Y. */
#include "geometry/torus.h"

#include "base/frame.h"
#include "geometry/closed_form.h"
#include "math/kmath.h"

#include <stdio.h>
#include <stdlib.h>

STAGE static void torus_locate(const surface *base, int n, const rays *x, const real *t, int32_t *part, real *u,
                               real *w)
{
    const torus f = *(const torus *)base;
    for (int i = 0; i < n; i++) {
        torus_place p = torus_place_of(&f, x, i, t[i]);
        part[i] = 0;
        u[i] = (real)km_atan2(p.z, p.x);
        w[i] = (real)km_atan2(-p.y, p.d - f.M);
    }
}

STAGE static void torus_eval(const surface *base, int n, const int32_t *part, const real *u, const real *w, int order,
                             partials *q)
{
    const torus f = *(const torus *)base;
    (void)part;
    for (int i = 0; i < n; i++) {
        double cu = km_cos((double)u[i]), su = km_sin((double)u[i]), c = f.m * km_cos((double)w[i]),
               s = f.m * km_sin((double)w[i]);
        double rho = f.M + c, x = rho * cu, z = rho * su;
        q->Q.x[i] = (real)(f.C[0] + x * f.X[0] - s * f.Y[0] + z * f.Z[0]);
        q->Q.y[i] = (real)(f.C[1] + x * f.X[1] - s * f.Y[1] + z * f.Z[1]);
        q->Q.z[i] = (real)(f.C[2] + x * f.X[2] - s * f.Y[2] + z * f.Z[2]);
        torus_vector(&f, &q->Qu, i, -z, 0, x);
        torus_vector(&f, &q->Qw, i, -s * cu, -c, -s * su);
    }
    if (order < 2)
        return;
    for (int i = 0; i < n; i++) {
        double cu = km_cos((double)u[i]), su = km_sin((double)u[i]), c = f.m * km_cos((double)w[i]),
               s = f.m * km_sin((double)w[i]);
        double rho = f.M + c;
        torus_vector(&f, &q->Quu, i, -rho * cu, 0, -rho * su);
        torus_vector(&f, &q->Quw, i, s * su, 0, -s * cu);
        torus_vector(&f, &q->Qww, i, -c * cu, s, -c * su);
    }
}

/* ---- for true displacement ---- */

/* Where a ray is in the sphere and between the planes about a torus with a tube of radius m. */
STAGE static void torus_bounds(const torus *restrict base, double m, int n, const rays *restrict x,
                               const real *restrict end, real *restrict t0, real *restrict t1)
{
    const torus f = *base;
    for (int i = 0; i < n; i++) {
        torus_ray l = torus_ray_of(&f, x, i);
        double B = sqrt((f.M + m) * (f.M + m) - (l.ox * l.ox + l.oy * l.oy + l.oz * l.oz)); /* NaN beside the sphere */
        double y0 = (-m - l.oy) / l.dy, y1 = (m - l.oy) / l.dy; /* along the planes: as in box.c */
        double from = greater(-l.start, greater(lesser(y0, y1), -B)), to = lesser(greater(y0, y1), B);
        int some = from <= to;
        real last = (real)((to + l.start) / l.speed);
        t0[i] = some ? (real)((from + l.start) / l.speed) : R(1);
        t1[i] = some ? real_min(last, end[i]) : R(-1);
    }
}

/* From outside the shell begins where the outer torus is met first. */
STAGE static void torus_enter(const torus *restrict base, double m, int n, const rays *restrict x,
                              const torus_roots *restrict k, real *restrict t0, real *restrict t1)
{
    const torus f = *base;
    for (int i = 0; i < n; i++) {
        torus_place p = torus_place_of(&f, x, i, 0);
        double c = p.d - f.M;
        int within = c * c + p.y * p.y <= m * m, meets = k->a[i] <= k->b[i];
        real first = (real)((k->way[i] + k->start[i]) / k->speed[i]);
        t0[i] = (within | !meets) ? t0[i] : first;
        t1[i] = (within | meets) ? t1[i] : R(-1);
    }
}

/* The hole or the tube's core, between two stretches in the shell, is included. */
static void torus_bound(const surface *base, int part, int n, const rays *x, const real *end, real Pmin, real Pmax,
                        real *t0, real *t1)
{
    const torus *f = (const torus *)base;
    const double m = f->m + (double)Pmax;
    torus_rays k;
    (void)part;
    (void)Pmin;
    torus_bounds(f, m > 0 ? m : 0, n, x, end, t0, t1);
    if (m > 0 && m < f->M) { /* a fatter tube closes the hole, where G no longer has the quartic's sign */
        torus_search(f, m, n, x, end, &k);
        torus_enter(f, m, n, x, &k.root, t0, t1);
    }
}

STAGE static void torus_closest(const surface *base, int part, int n, const rays *x, const real *t, closest_points *q)
{
    const torus f = *(const torus *)base;
    (void)part;
    for (int i = 0; i < n; i++) {
        torus_place p = torus_place_of(&f, x, i, t[i]);
        double id = 1 / greater(p.d, 1e-15), ex = p.x * id, ez = p.z * id;
        double c = p.d - f.M, rho = sqrt(c * c + p.y * p.y), ir = 1 / greater(rho, 1e-15), nc = c * ir, ny = p.y * ir;
        q->u[i] = (real)km_atan2(p.z, p.x);
        q->w[i] = (real)km_atan2(-p.y, c);
        q->h[i] = (real)(rho - f.m);
        torus_vector(&f, &q->gu, i, -ez * id, 0, ex * id);
        torus_vector(&f, &q->gw, i, ny * ir * ex, -nc * ir, ny * ir * ez);
        torus_vector(&f, &q->gh, i, nc * ex, ny, nc * ez);
    }
}

/* |grad u| is 1/(distance d to the axis), |grad w| 1/(distance to the tube's middle). Along a unit vector |d''| <=
 * |grad u|. Across the tube the path of (d, y) has a speed of at most 1 and bends by |d''|: so |h''| <= |grad w| +
 * |d''| and |w''| <= |grad w| (|grad w| + |d''|). */
STAGE static void torus_bend(const surface *base, int part, int n, const rays *x, const closest_points *restrict p,
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
        out->h[i] = (u + w) * s;
        out->reach[i] = R(BEND_REACH) / real_max(gu, gw);
    }
}

static void torus_extent(const surface *base, int part, double u[2], double w[2])
{
    (void)base;
    (void)part;
    u[0] = w[0] = -KM_PI;
    u[1] = w[1] = KM_PI;
}

/* The circle at the tube's middle reaches M sin(angle) along a coordinate axis, at that angle to Y. */
static void torus_box(const surface *base, double lo[3], double hi[3])
{
    const torus *f = (const torus *)base;
    for (int k = 0; k < 3; k++) {
        const double reach = f->M * sqrt(fmax(1 - f->Y[k] * f->Y[k], 0)) + f->m;
        lo[k] = f->C[k] - reach;
        hi[k] = f->C[k] + reach;
    }
}

static const surface_ops torus_methods = {
    .kind = "torus",
    .hit = torus_hit,
    .hit_own = torus_hit_own,
    .locate = torus_locate,
    .foot = torus_locate,
    .eval = torus_eval,
    .occlude = torus_occlude,
    .occlude_own = torus_occlude_own,
    .extent = torus_extent,
    .box = torus_box,
    .parts = 1,
    .bound = torus_bound,
    .closest = torus_closest,
    .bend = torus_bend,
    .around = AROUND_U | AROUND_W,
};

surface *torus_new(vec3 centre, vec3 axis, double major, double minor)
{
    const double l = vec3_length(axis);
    const bool good = l > 0 && l < HUGE_VAL && minor > 0 && minor < major && major < HUGE_VAL;
    torus *f = good ? calloc(1, sizeof *f) : NULL;
    if (!f)
        return NULL;
    const frame a = frame_about(axis);
    *f = (torus){.base = {&torus_methods, NULL, 0},
                 .C = {centre.x, centre.y, centre.z},
                 .X = {a.x.x, a.x.y, a.x.z},
                 .Y = {a.y.x, a.y.y, a.y.z},
                 .Z = {a.z.x, a.z.y, a.z.z},
                 .M = major,
                 .m = minor};
    return &f->base;
}

/* ---- in the scene file ---- */

static const form_parameter torus_parameters[] = {
    {"center", FORM_PLACE, 0, "a place [x, y, z]"},
    {"axis", FORM_DIRECTION, 1, "the direction of the axis, [x, y, z]"},
    {"major", FORM_POSITIVE, 0, NULL},
    {"minor", FORM_POSITIVE, 1, NULL},
    {0},
};

static surface *make_torus(const shape_values *v, form_fault *fault)
{
    if (v->r[1] < v->r[0])
        return torus_new(v->v[0], v->v[1], v->r[0], v->r[1]);
    *fault = (form_fault){"minor", "a tube that closes the hole, expected 'minor' below 'major'"};
    return NULL;
}

static bool torus_formula(const shape_values *v, form_formula *out)
{
    char rho[64], y[40];
    snprintf(rho, sizeof rho, "%.17g + %.17g*cos(w)", v->r[0], v->r[1]);
    snprintf(y, sizeof y, "-%.17g*sin(w)", v->r[1]);
    torus_extent(NULL, 0, out->u, out->w);
    formula_revolve(out, frame_about(v->v[1]), rho, y);
    return true;
}

const closed_form form_torus = {
    .name = "torus",
    .parameters = torus_parameters,
    .make = make_torus,
    .formula = torus_formula,
    .solid = true,
    .povray = "torus {\n  $major, $minor\n  sturm\n$axes",
};
