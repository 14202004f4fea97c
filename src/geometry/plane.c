/* Plane, rectangle and disc: Q(u,w) = O + u U + w W, also skewed or scaled. */
#include "geometry/plane.h"

#include "math/slab.h"
#include "geometry/closed_form.h"

#include <stdlib.h>

/* Where the plane ends: a constant in each stage, so that loops have no choice in them. */
enum bounds { NOWHERE, AT_SIDES, AT_RIM };

/* t of the crossing with the plane. A ray along the plane gives an infinite t or NaN, for which every comparison below
 * is false. */
static inline real plane_t(const plane *f, real rx, real ry, real rz, real sx, real sy, real sz)
{
    real d = (f->O[0] - rx) * f->N[0] + (f->O[1] - ry) * f->N[1] + (f->O[2] - rz) * f->N[2];
    return d / (sx * f->N[0] + sy * f->N[1] + sz * f->N[2]);
}

/* A coordinate of the point p, by a vector of the dual basis. */
static inline real plane_coord(const plane *f, const real *D, real px, real py, real pz)
{
    return (px - f->O[0]) * D[0] + (py - f->O[1]) * D[1] + (pz - f->O[2]) * D[2];
}

/* Whether r + s t is within the rectangle, or on the disc. */
static inline int plane_inside(const plane *f, const rays *x, int i, enum bounds end, real t)
{
    real px = x->r.x[i] + x->s.x[i] * t, py = x->r.y[i] + x->s.y[i] * t, pz = x->r.z[i] + x->s.z[i] * t;
    real u = plane_coord(f, f->Du, px, py, pz), w = plane_coord(f, f->Dw, px, py, pz);
    return end == AT_RIM ? u * u + w * w <= f->R * f->R : (u >= 0) & (u <= 1) & (w >= 0) & (w <= 1);
}

/* t of the hit with t in (0, last), or `last` if there is none. */
static inline real plane_cut(const plane *f, const rays *x, int i, enum bounds end, real last)
{
    real t = plane_t(f, x->r.x[i], x->r.y[i], x->r.z[i], x->s.x[i], x->s.y[i], x->s.z[i]);
    int in = end == NOWHERE ? 1 : plane_inside(f, x, i, end, t);
    return (in & (t > 0) & (t < last)) ? t : last;
}

static inline void hit(const surface *base, enum bounds end, int n, const rays *x, int32_t id, hits *h)
{
    const plane f = *(const plane *)base;
    for (int i = 0; i < n; i++) {
        real t = plane_cut(&f, x, i, end, h->t[i]);
        h->id[i] = t < h->t[i] ? id : h->id[i];
        h->t[i] = t;
    }
}

/* A ray from the plane does not come back to it. */
static inline void hit_own(const surface *base, enum bounds end, int n, const rays *x, const ray_origins *from,
                           int32_t id, hits *h)
{
    const plane f = *(const plane *)base;
    for (int i = 0; i < n; i++) {
        real t = plane_t(&f, x->r.x[i], x->r.y[i], x->r.z[i], x->s.x[i], x->s.y[i], x->s.z[i]);
        int in = end == NOWHERE ? 1 : plane_inside(&f, x, i, end, t),
            take = in & (from->id[i] != id) & (t > 0) & (t < h->t[i]);
        hits_take(h, i, take, t, id);
    }
}

static inline void occlude(const surface *base, enum bounds end, int n, const rays *x, real *lit)
{
    const plane f = *(const plane *)base;
    for (int i = 0; i < n; i++)
        lit[i] = plane_cut(&f, x, i, end, 1) < 1 ? 0 : lit[i];
}

/* The three stages of one kind of flat surface, with its bounds as a constant. */
#define FLAT_STAGES(kind, bounds)                                                                                      \
    STAGE static void kind##_hit(const surface *f, int n, const rays *x, int32_t id, hits *h)                          \
    {                                                                                                                  \
        hit(f, bounds, n, x, id, h);                                                                                   \
    }                                                                                                                  \
    STAGE static void kind##_hit_own(const surface *f, int n, const rays *x, const ray_origins *from, int32_t id,      \
                                     hits *h)                                                                          \
    {                                                                                                                  \
        hit_own(f, bounds, n, x, from, id, h);                                                                         \
    }                                                                                                                  \
    STAGE static void kind##_occlude(const surface *f, int n, const rays *x, real *lit)                                \
    {                                                                                                                  \
        occlude(f, bounds, n, x, lit);                                                                                 \
    }

FLAT_STAGES(plane, NOWHERE)
FLAT_STAGES(rectangle, AT_SIDES)
FLAT_STAGES(disc, AT_RIM)

STAGE static void plane_locate(const surface *base, int n, const rays *x, const real *t, int32_t *part, real *u,
                               real *w)
{
    const plane f = *(const plane *)base;
    for (int i = 0; i < n; i++) {
        part[i] = 0;
        real px = x->r.x[i] + x->s.x[i] * t[i], py = x->r.y[i] + x->s.y[i] * t[i], pz = x->r.z[i] + x->s.z[i] * t[i];
        u[i] = plane_coord(&f, f.Du, px, py, pz);
        w[i] = plane_coord(&f, f.Dw, px, py, pz);
    }
}

STAGE static void plane_eval(const surface *base, int n, const int32_t *part, const real *u, const real *w, int order,
                             partials *q)
{
    const plane f = *(const plane *)base;
    (void)part;
    for (int i = 0; i < (order > 0 ? n : 0); i++) {
        q->Q.x[i] = f.O[0] + u[i] * f.U[0] + w[i] * f.W[0];
        q->Q.y[i] = f.O[1] + u[i] * f.U[1] + w[i] * f.W[1];
        q->Q.z[i] = f.O[2] + u[i] * f.U[2] + w[i] * f.W[2];
    }
    vec3s_fill(&q->Qu, n, f.U[0], f.U[1], f.U[2]);
    vec3s_fill(&q->Qw, n, f.W[0], f.W[1], f.W[2]);
    if (order == 2) {
        vec3s_fill(&q->Quu, n, 0, 0, 0);
        vec3s_fill(&q->Quw, n, 0, 0, 0);
        vec3s_fill(&q->Qww, n, 0, 0, 0);
    }
}

/* ---- for true displacement ---- */

/* Narrow t0..t1 to where |(u,w) + t (du,dw)| <= rim: like a sphere's roots, from the foot of the perpendicular. */
static inline void clip_rim(real u, real w, real du, real dw, real rim, real *t0, real *t1)
{
    real a = du * du + dw * dw, tc = -(u * du + w * dw) / a, fu = u + tc * du, fw = w + tc * dw;
    real d = rim * rim - (fu * fu + fw * fw), h = real_sqrt(real_max(d, 0) / a);
    real from = d >= 0 ? tc - h : R(1), to = d >= 0 ? tc + h : R(-1);
    int in = u * u + w * w <= rim * rim; /* a = 0: along the normal all is inside, or nothing */
    from = a > 0 ? from : in ? *t0 : R(1);
    to = a > 0 ? to : in ? *t1 : R(-1);
    *t0 = real_max(from, *t0);
    *t1 = real_min(to, *t1);
}

static inline void shell(const surface *base, enum bounds bound, int n, const rays *x, const real *end, real Pmin,
                         real Pmax, real *restrict t0, real *restrict t1)
{
    const plane f = *(const plane *)base;
    for (int i = 0; i < n; i++) {
        real rx = x->r.x[i] - f.O[0], ry = x->r.y[i] - f.O[1], rz = x->r.z[i] - f.O[2];
        real sx = x->s.x[i], sy = x->s.y[i], sz = x->s.z[i];
        real from = 0, to = end[i];
        clip(rx * f.N[0] + ry * f.N[1] + rz * f.N[2], sx * f.N[0] + sy * f.N[1] + sz * f.N[2], Pmin, Pmax, &from, &to);
        if (bound == AT_SIDES) {
            clip(rx * f.Du[0] + ry * f.Du[1] + rz * f.Du[2], sx * f.Du[0] + sy * f.Du[1] + sz * f.Du[2], 0, 1, &from,
                 &to);
            clip(rx * f.Dw[0] + ry * f.Dw[1] + rz * f.Dw[2], sx * f.Dw[0] + sy * f.Dw[1] + sz * f.Dw[2], 0, 1, &from,
                 &to);
        }
        if (bound == AT_RIM)
            clip_rim(rx * f.Du[0] + ry * f.Du[1] + rz * f.Du[2], rx * f.Dw[0] + ry * f.Dw[1] + rz * f.Dw[2],
                     sx * f.Du[0] + sy * f.Du[1] + sz * f.Du[2], sx * f.Dw[0] + sy * f.Dw[1] + sz * f.Dw[2], f.R, &from,
                     &to);
        t0[i] = from;
        t1[i] = to;
    }
}

#define FLAT_BOUND(kind, bounds)                                                                                       \
    static void kind##_bound(const surface *f, int part, int n, const rays *x, const real *end, real Pmin, real Pmax,  \
                             real *t0, real *t1)                                                                       \
    {                                                                                                                  \
        (void)part;                                                                                                    \
        shell(f, bounds, n, x, end, Pmin, Pmax, t0, t1);                                                               \
    }

FLAT_BOUND(plane, NOWHERE)
FLAT_BOUND(rectangle, AT_SIDES)
FLAT_BOUND(disc, AT_RIM)

/* The dual basis is in the plane, so Du.(X - O) is u of the closest point. */
STAGE static void plane_closest(const surface *base, int part, int n, const rays *x, const real *restrict t,
                                closest_points *restrict p)
{
    const plane f = *(const plane *)base;
    (void)part;
    for (int i = 0; i < n; i++) {
        real px = x->r.x[i] + x->s.x[i] * t[i], py = x->r.y[i] + x->s.y[i] * t[i], pz = x->r.z[i] + x->s.z[i] * t[i];
        p->u[i] = plane_coord(&f, f.Du, px, py, pz);
        p->w[i] = plane_coord(&f, f.Dw, px, py, pz);
        p->h[i] = plane_coord(&f, f.N, px, py, pz);
    }
    vec3s_fill(&p->gu, n, f.Du[0], f.Du[1], f.Du[2]);
    vec3s_fill(&p->gw, n, f.Dw[0], f.Dw[1], f.Dw[2]);
    vec3s_fill(&p->gh, n, f.N[0], f.N[1], f.N[2]);
}

static void plane_extent(const surface *base, int part, double u[2], double w[2])
{
    (void)base;
    (void)part;
    u[0] = w[0] = -HUGE_VAL;
    u[1] = w[1] = HUGE_VAL;
}

static void disc_extent(const surface *base, int part, double u[2], double w[2])
{
    const double R = (double)((const plane *)base)->R;
    (void)part;
    u[0] = w[0] = -R;
    u[1] = w[1] = R;
}

static void plane_box(const surface *base, double lo[3], double hi[3])
{
    (void)base;
    for (int k = 0; k < 3; k++) {
        lo[k] = -HUGE_VAL;
        hi[k] = HUGE_VAL;
    }
}

static void rectangle_box(const surface *base, double lo[3], double hi[3])
{
    const plane *f = (const plane *)base;
    for (int k = 0; k < 3; k++) {
        const double O = (double)f->O[k], U = (double)f->U[k], W = (double)f->W[k];
        lo[k] = O + fmin(U, 0) + fmin(W, 0);
        hi[k] = O + fmax(U, 0) + fmax(W, 0);
    }
}

/* U and W may be oblique, where a disc is an ellipse. */
static void disc_box(const surface *base, double lo[3], double hi[3])
{
    const plane *f = (const plane *)base;
    for (int k = 0; k < 3; k++) {
        const double O = (double)f->O[k], U = (double)f->U[k], W = (double)f->W[k],
                     r = (double)f->R * sqrt(U * U + W * W);
        lo[k] = O - r;
        hi[k] = O + r;
    }
}

#define FLAT_METHODS(name, range)                                                                                      \
    {                                                                                                                  \
        .kind = #name, .hit = name##_hit, .hit_own = name##_hit_own, .locate = plane_locate, .foot = plane_locate,     \
        .eval = plane_eval, .occlude = name##_occlude, .extent = range, .box = name##_box, .flat = true, .parts = 1,   \
        .bound = name##_bound, .closest = plane_closest, .bend = bend_flat                                             \
    }

static const surface_ops plane_methods = FLAT_METHODS(plane, plane_extent);
static const surface_ops rectangle_methods = FLAT_METHODS(rectangle, extent_unit);
static const surface_ops disc_methods = FLAT_METHODS(disc, disc_extent);

/* The squared sine of the angle between U and W below which float has no digits of N: an angle of 1e-6, float's
 * rounding is 1e-7. */
#define PARALLEL2 1e-12

bool plane_place(plane *f, vec3 origin, vec3 U, vec3 W)
{
    vec3 N = vec3_cross(U, W);
    double n2 = vec3_dot(N, N), e2 = vec3_dot(U, U) * vec3_dot(W, W);
    if (!(n2 > PARALLEL2 * e2) || !(e2 < HUGE_VAL))
        return false;
    vec3_round(f->O, origin);
    vec3_round(f->U, U);
    vec3_round(f->W, W);
    vec3_round(f->N, vec3_unit(N));
    vec3_round(f->Du, vec3_scale(vec3_cross(W, N), 1 / n2));
    vec3_round(f->Dw, vec3_scale(vec3_cross(N, U), 1 / n2));
    return true;
}

surface *plane_new(vec3 origin, vec3 U, vec3 W, bool bounded)
{
    plane *f = calloc(1, sizeof *f);
    if (!f || !plane_place(f, origin, U, W)) {
        free(f);
        return NULL;
    }
    f->base.ops = bounded ? &rectangle_methods : &plane_methods;
    return &f->base;
}

void rectangle_set(plane *f) { f->base.ops = &rectangle_methods; }

void disc_set(plane *f, vec3 centre, vec3 U, vec3 W, double radius)
{
    f->base.ops = &disc_methods;
    vec3_round(f->O, centre);
    vec3_round(f->U, U);
    vec3_round(f->W, W);
    vec3_round(f->N, vec3_cross(U, W));
    vec3_round(f->Du, U);
    vec3_round(f->Dw, W);
    f->R = (real)radius;
}

surface *disc_new(vec3 centre, vec3 normal, double radius)
{
    const double l = vec3_length(normal);
    plane *f = l > 0 && l < HUGE_VAL && radius > 0 && radius < HUGE_VAL ? calloc(1, sizeof *f) : NULL;
    if (!f)
        return NULL;
    const frame a = frame_about(normal);
    disc_set(f, centre, a.x, vec3_scale(a.z, -1), radius);
    return &f->base;
}

/* ---- in the scene file ---- */

static const form_parameter edges[] = {
    {"origin", FORM_PLACE, 0, "the place of u = w = 0, [x, y, z]"},
    {"u", FORM_EDGE, 1, "the edge along u, [x, y, z]"},
    {"w", FORM_EDGE, 2, "the edge along w, [x, y, z]"},
    {0},
};

static surface *make_flat(const shape_values *v, bool bounded, form_fault *fault)
{
    plane trial;
    if (!plane_place(&trial, v->v[0], v->v[1], v->v[2]))
        *fault = (form_fault){NULL, "u and w are parallel, expected two directions"};
    return plane_new(v->v[0], v->v[1], v->v[2], bounded);
}

static surface *make_plane(const shape_values *v, form_fault *fault) { return make_flat(v, false, fault); }
static surface *make_rectangle(const shape_values *v, form_fault *fault) { return make_flat(v, true, fault); }

static bool flat_edges(const shape_values *v, int part, flat_part *out)
{
    (void)part;
    *out = (flat_part){v->v[0], v->v[1], v->v[2], -1};
    return true;
}

const closed_form form_plane = {
    .name = "plane",
    .parameters = edges,
    .make = make_plane,
    .flat = flat_edges,
    .solid = true,
    .povray = "plane {\n  $plane\n",
};

const closed_form form_rectangle = {
    .name = "rectangle",
    .parameters = edges,
    .make = make_rectangle,
    .flat = flat_edges,
    .povray = "$rectangle",
};

static const form_parameter disc_parameters[] = {
    {"center", FORM_PLACE, 0, "a place [x, y, z]"},
    {"normal", FORM_DIRECTION, 1, "the direction of n, [x, y, z]"},
    {"radius", FORM_POSITIVE, 0, NULL},
    {0},
};

static surface *make_disc(const shape_values *v, form_fault *fault)
{
    (void)fault;
    return disc_new(v->v[0], v->v[1], v->r[0]);
}

static bool flat_disc(const shape_values *v, int part, flat_part *out)
{
    const frame a = frame_about(v->v[1]);
    (void)part;
    *out = (flat_part){v->v[0], a.x, vec3_scale(a.z, -1), v->r[0]};
    return true;
}

const closed_form form_disc = {
    .name = "disc",
    .parameters = disc_parameters,
    .make = make_disc,
    .flat = flat_disc,
    .povray = "disc {\n  $center, $normal, $radius\n",
};
