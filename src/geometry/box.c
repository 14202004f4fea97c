/* Box with sides along the axes: six faces, each a plane with its own (u,w). */
#include "math/slab.h"
#include "geometry/closed_form.h"

#include <stdlib.h>

typedef struct box {
    surface base;
    real lo[3], hi[3];
} box;

/* Where the line r + s t enters and leaves the box: in <= out where it meets the box. A line in the plane of a face
 * gives 0 * inf: it counts as inside or outside that slab, never as a hit at NaN. */
static inline void box_crossing(const box *f, real rx, real ry, real rz, real sx, real sy, real sz, real *in, real *out)
{
    real ix = 1 / sx, iy = 1 / sy, iz = 1 / sz;
    real ax = (f->lo[0] - rx) * ix, bx = (f->hi[0] - rx) * ix;
    real ay = (f->lo[1] - ry) * iy, by = (f->hi[1] - ry) * iy;
    real az = (f->lo[2] - rz) * iz, bz = (f->hi[2] - rz) * iz;
    *in = real_max(real_max(real_min(ax, bx), real_min(ay, by)), real_min(az, bz));
    *out = real_min(real_min(real_max(ax, bx), real_max(ay, by)), real_max(az, bz));
}

/* t at which a ray from within a slab leaves it; REAL_FAR where it runs along the slab. */
static inline real box_exit(real r, real s, real lo, real hi)
{
    real t = ((s > 0 ? hi : lo) - r) / s;
    return s == 0 ? REAL_FAR : t;
}

/* The same for the box, from (x,y,z). */
static inline real box_first_exit(const box *f, real x, real y, real z, real sx, real sy, real sz)
{
    real ex = box_exit(x, sx, f->lo[0], f->hi[0]), ey = box_exit(y, sy, f->lo[1], f->hi[1]);
    return real_min(real_min(ex, ey), box_exit(z, sz, f->lo[2], f->hi[2]));
}

STAGE static void box_hit(const surface *base, int n, const rays *x, int32_t id, hits *h)
{
    const box f = *(const box *)base;
    for (int i = 0; i < n; i++) {
        real in, out;
        box_crossing(&f, x->r.x[i], x->r.y[i], x->r.z[i], x->s.x[i], x->s.y[i], x->s.z[i], &in, &out);
        real t = in > 0 ? in : out;
        int take = (in <= out) & (t > 0) & (t < h->t[i]);
        hits_take(h, i, take, t, id);
    }
}

/* A ray from a point of a face into the box leaves it through the first of the other five faces; a ray outward meets
 * nothing. */
STAGE static void box_hit_own(const surface *base, int n, const rays *x, const ray_origins *from, int32_t id, hits *h)
{
    const box f = *(const box *)base;
    for (int i = 0; i < n; i++) {
        real in, out, sx = x->s.x[i], sy = x->s.y[i], sz = x->s.z[i];
        box_crossing(&f, x->r.x[i], x->r.y[i], x->r.z[i], sx, sy, sz, &in, &out);
        real near = in > 0 ? in : out;
        real far = box_first_exit(&f, from->at.x[i], from->at.y[i], from->at.z[i], sx, sy, sz);
        int part = from->part[i], k = part >> 1, high = part & 1, own = from->id[i] == id;
        real along = k == 0 ? sx : k == 1 ? sy : sz, inward = high ? -along : along;
        real t = own ? far : near;
        int take = (own ? inward > 0 : in <= out) & (t > 0) & (t < h->t[i]);
        hits_take(h, i, take, t, id);
    }
}

/* On the face across axis k, u and w go along the two next axes (cyclic) on the high side, swapped on the low side, so
 * that U x W points outward. */

/* A point of a ray in the box's own coordinates: 0 and 1 at its sides. */
typedef struct box_point {
    real x, y, z;
} box_point;

static inline box_point box_point_of(const box *f, const rays *x, int i, real t)
{
    box_point p = {(x->r.x[i] + x->s.x[i] * t - f->lo[0]) / (f->hi[0] - f->lo[0]),
                   (x->r.y[i] + x->s.y[i] * t - f->lo[1]) / (f->hi[1] - f->lo[1]),
                   (x->r.z[i] + x->s.z[i] * t - f->lo[2]) / (f->hi[2] - f->lo[2])};
    return p;
}

STAGE static void box_locate(const surface *base, int n, const rays *x, const real *restrict t, int32_t *restrict part,
                             real *restrict u, real *restrict w)
{
    const box f = *(const box *)base;
    for (int i = 0; i < n; i++) {
        box_point p = box_point_of(&f, x, i, t[i]);
        /* the face is the one across the axis along which the hit is farthest from the middle */
        real ox = real_abs(p.x - R(0.5)), oy = real_abs(p.y - R(0.5)), oz = real_abs(p.z - R(0.5));
        int on_x = (ox >= oy) & (ox >= oz), on_y = (oy > ox) & (oy >= oz);
        real out = on_x ? p.x : on_y ? p.y : p.z;
        int high = out > R(0.5);
        real a = on_x ? p.y : on_y ? p.z : p.x, b = on_x ? p.z : on_y ? p.x : p.y;
        part[i] = (on_x ? 0 : on_y ? 2 : 4) + high;
        u[i] = high ? a : b;
        w[i] = high ? b : a;
    }
}

STAGE static void box_foot(const surface *base, int n, const rays *x, const real *restrict t, int32_t *restrict part,
                           real *restrict u, real *restrict w)
{
    const box f = *(const box *)base;
    for (int i = 0; i < n; i++) {
        box_point p = box_point_of(&f, x, i, t[i]);
        /* sums with weights of 0 and 1, as choices would be branches */
        real on_x = (real)(part[i] < 2), on_z = (real)(part[i] > 3), on_y = 1 - on_x - on_z, high = (real)(part[i] & 1);
        real a = on_x * p.y + on_y * p.z + on_z * p.x, b = on_x * p.z + on_y * p.x + on_z * p.y;
        u[i] = high * a + (1 - high) * b;
        w[i] = high * b + (1 - high) * a;
    }
}

/* One coordinate of Q, Qu and Qw on a face across axis k: the coordinate along axis c of the box from lo to hi. */
static inline real box_coordinate(int c, int k, int high, real u, real w, real lo, real hi, real *U, real *W)
{
    int across = k == c, by_w = (k == (c + 1) % 3) == high;
    real d = across ? 0 : hi - lo;
    *U = by_w ? 0 : d;
    *W = by_w ? d : 0;
    return (across & high ? hi : lo) + u * *U + w * *W;
}

STAGE static void box_eval(const surface *base, int n, const int32_t *restrict part, const real *restrict u,
                           const real *restrict w, int order, partials *restrict q)
{
    const box f = *(const box *)base;
    for (int i = 0; i < n; i++) {
        int k = part[i] >> 1, high = part[i] & 1;
        q->Q.x[i] = box_coordinate(0, k, high, u[i], w[i], f.lo[0], f.hi[0], &q->Qu.x[i], &q->Qw.x[i]);
        q->Q.y[i] = box_coordinate(1, k, high, u[i], w[i], f.lo[1], f.hi[1], &q->Qu.y[i], &q->Qw.y[i]);
        q->Q.z[i] = box_coordinate(2, k, high, u[i], w[i], f.lo[2], f.hi[2], &q->Qu.z[i], &q->Qw.z[i]);
    }
    if (order == 2) {
        vec3s_fill(&q->Quu, n, 0, 0, 0);
        vec3s_fill(&q->Quw, n, 0, 0, 0);
        vec3s_fill(&q->Qww, n, 0, 0, 0);
    }
}

STAGE static void box_occlude(const surface *base, int n, const rays *x, real *lit)
{
    const box f = *(const box *)base;
    for (int i = 0; i < n; i++) {
        real in, out;
        box_crossing(&f, x->r.x[i], x->r.y[i], x->r.z[i], x->s.x[i], x->s.y[i], x->s.z[i], &in, &out);
        int met = (in <= out) & (((in > 0) & (in < 1)) | ((out > 0) & (out < 1)));
        lit[i] = met ? 0 : lit[i];
    }
}

/* As box_hit_own. */
STAGE static void box_occlude_own(const surface *base, int n, const rays *x, const int32_t *restrict part,
                                  real *restrict lit)
{
    const box f = *(const box *)base;
    for (int i = 0; i < n; i++) {
        real sx = x->s.x[i], sy = x->s.y[i], sz = x->s.z[i];
        int k = part[i] >> 1, high = part[i] & 1;
        real along = k == 0 ? sx : k == 1 ? sy : sz;
        real away = high ? along : -along;
        real out = box_first_exit(&f, x->r.x[i], x->r.y[i], x->r.z[i], sx, sy, sz);
        lit[i] = ((away < 0) & (out < 1)) ? 0 : lit[i];
    }
}

/* ---- for true displacement ---- */

/* Each face by itself, as a rectangle. At the box's edges displaced faces leave a gap or cross. */

/* A face: the axis across it and the place there, the axes of u and w, and the direction of n. */
typedef struct face {
    int k, a, b;
    real at, side;
} face;

static face box_face(const box *f, int part)
{
    int k = part >> 1, high = part & 1;
    face c = {k, (k + (high ? 1 : 2)) % 3, (k + (high ? 2 : 1)) % 3, high ? f->hi[k] : f->lo[k], high ? R(1) : R(-1)};
    return c;
}

static const real *axis(const vec3s *v, int k) { return k == 0 ? v->x : k == 1 ? v->y : v->z; }
static real *component(vec3s *v, int k) { return k == 0 ? v->x : k == 1 ? v->y : v->z; }

static void box_bound(const surface *base, int part, int n, const rays *x, const real *end, real Pmin, real Pmax,
                      real *t0, real *t1)
{
    const box *f = (const box *)base;
    const face c = box_face(f, part);
    const real *r = axis(&x->r, c.k), *s = axis(&x->s, c.k), *ra = axis(&x->r, c.a), *sa = axis(&x->s, c.a);
    const real *rb = axis(&x->r, c.b), *sb = axis(&x->s, c.b);
    for (int i = 0; i < n; i++) {
        real from = 0, to = end[i];
        clip(c.side * (r[i] - c.at), c.side * s[i], Pmin, Pmax, &from, &to);
        clip(ra[i], sa[i], f->lo[c.a], f->hi[c.a], &from, &to);
        clip(rb[i], sb[i], f->lo[c.b], f->hi[c.b], &from, &to);
        t0[i] = from;
        t1[i] = to;
    }
}

static void box_closest(const surface *base, int part, int n, const rays *x, const real *t, closest_points *p)
{
    const box *f = (const box *)base;
    const face c = box_face(f, part);
    const real *r = axis(&x->r, c.k), *s = axis(&x->s, c.k), *ra = axis(&x->r, c.a), *sa = axis(&x->s, c.a);
    const real *rb = axis(&x->r, c.b), *sb = axis(&x->s, c.b);
    const real iu = 1 / (f->hi[c.a] - f->lo[c.a]), iw = 1 / (f->hi[c.b] - f->lo[c.b]);
    vec3s_fill(&p->gu, n, 0, 0, 0);
    vec3s_fill(&p->gw, n, 0, 0, 0);
    vec3s_fill(&p->gh, n, 0, 0, 0);
    for (int i = 0; i < n; i++) {
        p->h[i] = c.side * (r[i] + s[i] * t[i] - c.at);
        p->u[i] = (ra[i] + sa[i] * t[i] - f->lo[c.a]) * iu;
        p->w[i] = (rb[i] + sb[i] * t[i] - f->lo[c.b]) * iw;
        component(&p->gu, c.a)[i] = iu;
        component(&p->gw, c.b)[i] = iw;
        component(&p->gh, c.k)[i] = c.side;
    }
}

static void box_box(const surface *base, double lo[3], double hi[3])
{
    const box *f = (const box *)base;
    for (int k = 0; k < 3; k++) {
        lo[k] = (double)f->lo[k];
        hi[k] = (double)f->hi[k];
    }
}

static const surface_ops box_methods = {
    .kind = "box",
    .hit = box_hit,
    .hit_own = box_hit_own,
    .locate = box_locate,
    .foot = box_foot,
    .eval = box_eval,
    .occlude = box_occlude,
    .occlude_own = box_occlude_own,
    .extent = extent_unit,
    .box = box_box,
    .flat = true,
    .parts = 6,
    .bound = box_bound,
    .closest = box_closest,
    .bend = bend_flat,
};

/* Whether no side is 0 once rounded to `real`. */
static bool is_thick(vec3 from, vec3 to)
{
    return (real)from.x != (real)to.x && (real)from.y != (real)to.y && (real)from.z != (real)to.z;
}

surface *box_new(vec3 from, vec3 to)
{
    const double a[3] = {from.x, from.y, from.z}, b[3] = {to.x, to.y, to.z};
    box *f = is_thick(from, to) ? calloc(1, sizeof *f) : NULL;
    if (!f)
        return NULL;
    f->base.ops = &box_methods;
    for (int k = 0; k < 3; k++) {
        f->lo[k] = (real)(a[k] < b[k] ? a[k] : b[k]);
        f->hi[k] = (real)(a[k] < b[k] ? b[k] : a[k]);
    }
    return &f->base;
}

/* ---- in the scene file ---- */

static const form_parameter box_parameters[] = {
    {"from", FORM_PLACE, 0, "a corner [x, y, z]"},
    {"to", FORM_PLACE, 1, "the opposite corner [x, y, z]"},
    {0},
};

static surface *make_box(const shape_values *v, form_fault *fault)
{
    if (!is_thick(v->v[0], v->v[1]))
        *fault = (form_fault){"to", "a box without thickness, expected 'to' apart from 'from' along x, y and z"};
    return box_new(v->v[0], v->v[1]);
}

static double *coordinate(vec3 *v, int k) { return k == 0 ? &v->x : k == 1 ? &v->y : &v->z; }

static bool flat_face(const shape_values *v, int part, flat_part *out)
{
    const int k = part >> 1, high = part & 1, a = (k + (high ? 1 : 2)) % 3, b = (k + (high ? 2 : 1)) % 3;
    const vec3 p = v->v[0], q = v->v[1];
    vec3 lo = {fmin(p.x, q.x), fmin(p.y, q.y), fmin(p.z, q.z)}, hi = {fmax(p.x, q.x), fmax(p.y, q.y), fmax(p.z, q.z)};
    *out = (flat_part){.O = lo, .rim = -1};
    if (high)
        *coordinate(&out->O, k) = *coordinate(&hi, k);
    *coordinate(&out->U, a) = *coordinate(&hi, a) - *coordinate(&lo, a);
    *coordinate(&out->W, b) = *coordinate(&hi, b) - *coordinate(&lo, b);
    return true;
}

const closed_form form_box = {
    .name = "box",
    .parameters = box_parameters,
    .make = make_box,
    .flat = flat_face,
    .solid = true,
    .povray = "box {\n  $from, $to\n",
};
