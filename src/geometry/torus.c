/* Torus: Q(u,w) = C + (M + m cos w) (cos u X + sin u Z) - m sin w Y.
 *
 * A ray meets it where a quartic is 0, which float does not bear, and whose closed form does not bear rays that graze.
 * So all is in double, and the roots are bracketed: between two places where the quartic's derivative is 0 there is one
 * root, or none. The place of the ray that is nearest to C is the origin, which leaves no cubic term, so that its
 * derivative t^3 + P t + Q has roots in closed form; rounding there can only lose a ray that misses a tangent by it.
 * The root within a bracket is that of
 *
 *     G = (distance to the axis - M)^2 + (height)^2 - m^2,
 *
 * which has the quartic's sign where m < M, and keeps the digits that its fourth powers lose.
 */
#include "base/frame.h"
#include "math/kmath.h"
#include "geometry/closed_form.h"

#include <stdio.h>
#include <stdlib.h>

#ifdef KAGE_DOUBLE
#define CLOSE 1e-15 /* the root is found, as a share of M + m */
#else
#define CLOSE 1e-10
#endif

enum { STEPS = 64 };

typedef struct torus {
    surface base;
    double C[3], X[3], Y[3], Z[3];
    double M, m;
} torus;

/* A ray in the frame, from the place nearest to C on; its direction is a unit vector. r + s t is `way` = t speed -
 * start there. */
typedef struct local {
    double ox, oy, oz, dx, dy, dz, speed, start;
} local;

/* First roots that are searched, side by side; `way` as in `local`. */
typedef struct roots {
    double speed[LANES], start[LANES];
    double a[LANES], b[LANES]; /* the bracket; a > b: there is no root */
    double side[LANES];        /* the function's sign at a */
    double way[LANES];
    double open[LANES]; /* 1: not found yet */
} roots;

KM_INLINE void root_begin(roots *k, int i, int some, double a, double b, int above)
{
    k->open[i] = some ? 1 : 0;
    k->a[i] = some ? a : 1;
    k->b[i] = some ? b : -1;
    k->side[i] = above ? 1 : -1; /* up to the first change of it */
    k->way[i] = 0.5 * (a + b);
}

/* A step of Newton's iteration for a function with that value and slope, or to the bracket's middle where that would
 * leave it. */
KM_INLINE void root_step(roots *k, int i, double value, double slope, double close)
{
    double way = k->way[i], a = k->a[i], b = k->b[i], before = value * k->side[i];
    a = before > 0 ? way : a;
    b = before > 0 ? b : way;
    double next = way - value / slope, middle = 0.5 * (a + b);
    next = next > a ? next : middle;
    next = next < b ? next : middle;
    next = k->open[i] > 0 ? next : way;
    k->way[i] = next;
    k->a[i] = k->open[i] > 0 ? a : k->a[i];
    k->b[i] = k->open[i] > 0 ? b : k->b[i];
    k->open[i] = fabs(next - way) > close ? 1 : 0;
}

/* Rays that are searched, side by side. */
typedef struct search {
    double ox[LANES], oy[LANES], oz[LANES], dx[LANES], dy[LANES], dz[LANES];
    roots root;
} search;

KM_INLINE local local_of(const torus *f, const rays *x, int i)
{
    double rx = (double)x->r.x[i] - f->C[0], ry = (double)x->r.y[i] - f->C[1], rz = (double)x->r.z[i] - f->C[2];
    double sx = (double)x->s.x[i], sy = (double)x->s.y[i], sz = (double)x->s.z[i];
    double speed = sqrt(sx * sx + sy * sy + sz * sz), k = 1 / speed;
    double px = rx * f->X[0] + ry * f->X[1] + rz * f->X[2], py = rx * f->Y[0] + ry * f->Y[1] + rz * f->Y[2];
    double pz = rx * f->Z[0] + ry * f->Z[1] + rz * f->Z[2];
    double dx = k * (sx * f->X[0] + sy * f->X[1] + sz * f->X[2]), dy = k * (sx * f->Y[0] + sy * f->Y[1] + sz * f->Y[2]);
    double dz = k * (sx * f->Z[0] + sy * f->Z[1] + sz * f->Z[2]);
    double start = -(px * dx + py * dy + pz * dz);
    local l = {px + start * dx, py + start * dy, pz + start * dz, dx, dy, dz, speed, start};
    return l;
}

static inline double least(double x, double y) { return x < y ? x : y; }
static inline double most(double x, double y) { return x > y ? x : y; }

/* G at a place of the ray. */
KM_INLINE double tube(double M, double m, local l, double way)
{
    double x = l.ox + way * l.dx, y = l.oy + way * l.dy, z = l.oz + way * l.dz, d = sqrt(x * x + z * z) - M;
    return d * d + y * y - m * m;
}

/* Where the quartic t^4 + p t^2 + q t + r is level, from the least on; three times the same where there is but one such
 * place. */
typedef struct levels {
    double x[3];
} levels;

KM_INLINE levels level_places(double M, double m, local l)
{
    double oo = l.ox * l.ox + l.oy * l.oy + l.oz * l.oz, ee = l.dx * l.dx + l.dz * l.dz, oe = l.ox * l.dx + l.oz * l.dz;
    double P = oo + M * M - m * m - 2 * M * M * ee, Q = -2 * M * M * oe; /* p/2 and q/4 */
    double A = sqrt(most(-P / 3, 0)), A3 = A * A * A, half = 0.5 * Q;
    double d = half * half + P * P * P / 27;
    /* three: 2 A cos of a third of an angle, and of that a third of a turn on and back */
    double c = km_cos(km_acos(most(-1, least(1, -half / most(A3, 1e-300)))) / 3), s = sqrt(most(1 - c * c, 0));
    /* one: Cardano's */
    double k = fabs(half) + sqrt(most(d, 0)), S = k > 0 ? km_copysign(km_pow(k, 1. / 3), -half) : 1;
    double one = k > 0 ? S - P / (3 * S) : 0;
    levels z = {{d > 0 ? one : -A * (c + 1.7320508075688772 * s), d > 0 ? one : -A * (c - 1.7320508075688772 * s),
                 d > 0 ? one : 2 * A * c}};
    return z;
}

/* The places between which each root of a ray is alone, from way `from` to `to`; all in a sphere about the torus, so
 * large that its surface is outside. */
typedef struct stretches {
    double e[5];
} stretches;

KM_INLINE stretches stretches_of(double M, double m, local l, double from, double to)
{
    double B2 = 1.1 * (M + m) * (M + m) - (l.ox * l.ox + l.oy * l.oy + l.oz * l.oz), B = sqrt(most(B2, 0));
    double lo = most(from, -B), hi = least(to, B);
    hi = B2 >= 0 ? most(hi, lo) : lo; /* nothing */
    levels z = level_places(M, m, l);
    stretches e = {{lo, least(most(z.x[0], lo), hi), least(most(z.x[1], lo), hi), least(most(z.x[2], lo), hi), hi}};
    return e;
}

/* Bracket the first root with 0 < t < end[i], of a torus with a tube of radius m. */
STAGE static void torus_bracket(const torus *restrict base, double m, int n, const rays *restrict x,
                                const real *restrict end, search *restrict k)
{
    const torus f = *base;
    for (int i = 0; i < n; i++) {
        local l = local_of(&f, x, i);
        stretches e = stretches_of(f.M, m, l, -l.start, (double)end[i] * l.speed - l.start);
        int in0 = tube(f.M, m, l, e.e[0]) > 0, in1 = tube(f.M, m, l, e.e[1]) > 0, in2 = tube(f.M, m, l, e.e[2]) > 0;
        int in3 = tube(f.M, m, l, e.e[3]) > 0, in4 = tube(f.M, m, l, e.e[4]) > 0;
        int first = in0 != in1, second = in1 != in2, third = in2 != in3, last = in3 != in4;
        double a = first ? e.e[0] : second ? e.e[1] : third ? e.e[2] : e.e[3];
        double b = first ? e.e[1] : second ? e.e[2] : third ? e.e[3] : e.e[4];
        k->ox[i] = l.ox, k->oy[i] = l.oy, k->oz[i] = l.oz;
        k->dx[i] = l.dx, k->dy[i] = l.dy, k->dz[i] = l.dz;
        k->root.speed[i] = l.speed, k->root.start[i] = l.start;
        root_begin(&k->root, i, first | second | third | last, a, b, in0);
    }
}

STAGE static void torus_step(double M, double m, double close, int n, search *restrict k)
{
    for (int i = 0; i < n; i++) {
        double way = k->root.way[i];
        double x = k->ox[i] + way * k->dx[i], y = k->oy[i] + way * k->dy[i], z = k->oz[i] + way * k->dz[i];
        double r = sqrt(x * x + z * z), d = r - M, g = d * d + y * y - m * m;
        double slope = 2 * (d * (x * k->dx[i] + z * k->dz[i]) / most(r, 1e-300) + y * k->dy[i]);
        root_step(&k->root, i, g, slope, close);
    }
}

static int any(int n, const double *open)
{
    for (int i = 0; i < n; i++)
        if (open[i] > 0)
            return 1;
    return 0;
}

/* Rays end where they have met something else: a tile that the torus is not in takes no step. */
static void torus_search(const torus *f, double m, int n, const rays *x, const real *end, search *k)
{
    torus_bracket(f, m, n, x, end, k);
    for (int step = 0; step < STEPS && any(n, k->root.open); step++)
        torus_step(f->M, m, CLOSE * (f->M + m), n, k);
}

STAGE static void torus_take(int n, const roots *restrict k, int32_t id, hits *restrict h)
{
    for (int i = 0; i < n; i++) {
        real t = (real)((k->way[i] + k->start[i]) / k->speed[i]);
        int take = (k->a[i] <= k->b[i]) & (t > 0) & (t < h->t[i]);
        h->t[i] = take ? t : h->t[i];
        h->id[i] = take ? id : h->id[i];
    }
}

static void torus_hit(const surface *base, int n, const rays *x, int32_t id, hits *h)
{
    const torus *f = (const torus *)base;
    search k;
    torus_search(f, f->m, n, x, h->t, &k);
    torus_take(n, &k.root, id, h);
}

/* A place r + s t in the frame. */
typedef struct place {
    double x, y, z, d; /* d: from the axis */
} place;

KM_INLINE place place_of(const torus *f, const rays *v, int i, real t)
{
    double rx = (double)v->r.x[i] + (double)v->s.x[i] * (double)t - f->C[0];
    double ry = (double)v->r.y[i] + (double)v->s.y[i] * (double)t - f->C[1];
    double rz = (double)v->r.z[i] + (double)v->s.z[i] * (double)t - f->C[2];
    place p = {rx * f->X[0] + ry * f->X[1] + rz * f->X[2], rx * f->Y[0] + ry * f->Y[1] + rz * f->Y[2],
               rx * f->Z[0] + ry * f->Z[1] + rz * f->Z[2], 0};
    p.d = sqrt(p.x * p.x + p.z * p.z);
    return p;
}

STAGE static void torus_locate(const surface *base, int n, const rays *x, const real *t, int32_t *part, real *u,
                               real *w)
{
    const torus f = *(const torus *)base;
    for (int i = 0; i < n; i++) {
        place p = place_of(&f, x, i, t[i]);
        part[i] = 0;
        u[i] = (real)km_atan2(p.z, p.x);
        w[i] = (real)km_atan2(-p.y, p.d - f.M);
    }
}

/* A vector of the frame: x and z along the radius and across it, y along the axis. */
static inline void put(const torus *f, vec3s *v, int i, double x, double y, double z)
{
    v->x[i] = (real)(x * f->X[0] + y * f->Y[0] + z * f->Z[0]);
    v->y[i] = (real)(x * f->X[1] + y * f->Y[1] + z * f->Z[1]);
    v->z[i] = (real)(x * f->X[2] + y * f->Y[2] + z * f->Z[2]);
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
        put(&f, &q->Qu, i, -z, 0, x);
        put(&f, &q->Qw, i, -s * cu, -c, -s * su);
    }
    if (order < 2)
        return;
    for (int i = 0; i < n; i++) {
        double cu = km_cos((double)u[i]), su = km_sin((double)u[i]), c = f.m * km_cos((double)w[i]),
               s = f.m * km_sin((double)w[i]);
        double rho = f.M + c;
        put(&f, &q->Quu, i, -rho * cu, 0, -rho * su);
        put(&f, &q->Quw, i, s * su, 0, -s * cu);
        put(&f, &q->Qww, i, -c * cu, s, -c * su);
    }
}

/* Whether there is a root needs no root: only signs, where each could be. */
STAGE static void torus_occlude(const surface *base, int n, const rays *x, real *lit)
{
    const torus f = *(const torus *)base;
    for (int i = 0; i < n; i++) {
        local l = local_of(&f, x, i);
        stretches e = stretches_of(f.M, f.m, l, -l.start, l.speed - l.start);
        double g0 = tube(f.M, f.m, l, e.e[0]), g1 = tube(f.M, f.m, l, e.e[1]), g2 = tube(f.M, f.m, l, e.e[2]);
        double g3 = tube(f.M, f.m, l, e.e[3]), g4 = tube(f.M, f.m, l, e.e[4]);
        double low = least(least(least(g0, g1), least(g2, g3)), g4), high = most(most(most(g0, g1), most(g2, g3)), g4);
        lit[i] = ((low <= 0) & (high > 0)) ? 0 : lit[i];
    }
}

/* From a place of the torus one root is 0. What is left is the cubic t^3 + A t^2 + B t + C, C = 8 M m (distance to the
 * axis) n.s, with t a length of the ray; it is level at t0 <= t1, which a quadratic tells. */
typedef struct cubic {
    double A, B, C, t0, t1, T; /* T: of the whole s */
} cubic;

/* The place is first moved onto the torus as double has it, so that the root is 0 and not nearly so. */
KM_INLINE cubic cubic_of(const torus *f, const rays *v, int i)
{
    double sx = (double)v->s.x[i], sy = (double)v->s.y[i], sz = (double)v->s.z[i];
    double T = sqrt(sx * sx + sy * sy + sz * sz), k = 1 / T;
    double dx = k * (sx * f->X[0] + sy * f->X[1] + sz * f->X[2]), dy = k * (sx * f->Y[0] + sy * f->Y[1] + sz * f->Y[2]);
    double dz = k * (sx * f->Z[0] + sy * f->Z[1] + sz * f->Z[2]);
    place p = place_of(f, v, i, 0);
    double id = 1 / p.d, ex = p.x * id, ez = p.z * id, c = p.d - f->M, ic = 1 / sqrt(c * c + p.y * p.y);
    double nc = c * ic, ny = p.y * ic,
           d = f->M + f->m * nc; /* n, and the place on the torus: away from and along the axis */
    double along = ex * dx + ez * dz, pd = d * along + f->m * ny * dy;
    double A = 4 * pd, B = 4 * pd * pd + 4 * f->M * d - 4 * f->M * f->M * (dx * dx + dz * dz);
    double C = 8 * f->M * f->m * d * (nc * along + ny * dy);
    double h = sqrt(most(A * A - 3 * B, 0));
    cubic q = {A, B, C, (-A - h) / 3, (-A + h) / 3, T};
    return q;
}

KM_INLINE double cubic_at(double A, double B, double C, double t) { return ((t + A) * t + B) * t + C; }

/* Its sign at 0, at the end and where it is level says whether it has a root between. */
STAGE static void torus_occlude_own(const surface *base, int n, const rays *v, const int32_t *part, real *lit)
{
    const torus f = *(const torus *)base;
    (void)part;
    for (int i = 0; i < n; i++) {
        cubic q = cubic_of(&f, v, i);
        double t0 = least(most(q.t0, 0), q.T), t1 = least(most(q.t1, 0), q.T);
        double k0 = cubic_at(q.A, q.B, q.C, t0), k1 = cubic_at(q.A, q.B, q.C, t1), k2 = cubic_at(q.A, q.B, q.C, q.T);
        double low = least(least(k0, k1), least(k2, q.C)), high = most(most(k0, k1), most(k2, q.C));
        lit[i] = ((low < 0) & (high > 0)) ? 0 : lit[i];
    }
}

/* Cubics whose first root above 0 is searched, side by side. */
typedef struct cubics {
    double A[LANES], B[LANES], C[LANES];
    roots root;
} cubics;

/* As far as the torus is wide, beyond which there is no root. */
STAGE static void torus_own_bracket(const torus *restrict base, int n, const rays *restrict v, const real *restrict end,
                                    cubics *restrict k)
{
    const torus f = *base;
    const double wide = 2.1 * (f.M + f.m);
    for (int i = 0; i < n; i++) {
        cubic q = cubic_of(&f, v, i);
        double last = most(least((double)end[i] * q.T, wide), 0);
        double t0 = least(most(q.t0, 0), last), t1 = least(most(q.t1, 0), last);
        int in0 = q.C > 0, in1 = cubic_at(q.A, q.B, q.C, t0) > 0, in2 = cubic_at(q.A, q.B, q.C, t1) > 0;
        int in3 = cubic_at(q.A, q.B, q.C, last) > 0, first = in0 != in1, second = in1 != in2, third = in2 != in3;
        double a = first ? 0 : second ? t0 : t1, b = first ? t0 : second ? t1 : last;
        k->A[i] = q.A, k->B[i] = q.B, k->C[i] = q.C;
        k->root.speed[i] = q.T, k->root.start[i] = 0;
        root_begin(&k->root, i, first | second | third, a, b, in0);
    }
}

STAGE static void torus_own_step(double close, int n, cubics *restrict k)
{
    for (int i = 0; i < n; i++) {
        double way = k->root.way[i], A = k->A[i], B = k->B[i];
        root_step(&k->root, i, cubic_at(A, B, k->C[i], way), (3 * way + 2 * A) * way + B, close);
    }
}

/* Those from elsewhere by the quartic, those from the torus itself by the cubic; each kind has no way to go in the
 * other's search. */
static void torus_hit_own(const surface *base, int n, const rays *x, const ray_origins *from, int32_t id, hits *h)
{
    const torus *f = (const torus *)base;
    const double close = CLOSE * (f->M + f->m);
    rays own = {.r = from->at, .s = x->s};
    real other_end[LANES], own_end[LANES];
    search k;
    cubics q;
    for (int i = 0; i < n; i++) {
        other_end[i] = from->id[i] == id ? R(-1) : h->t[i];
        own_end[i] = from->id[i] == id ? h->t[i] : R(-1);
    }
    torus_search(f, f->m, n, x, other_end, &k);
    torus_take(n, &k.root, id, h);
    torus_own_bracket(f, n, &own, own_end, &q);
    for (int step = 0; step < STEPS && any(n, q.root.open); step++)
        torus_own_step(close, n, &q);
    torus_take(n, &q.root, id, h);
}

/* ---- for true displacement ---- */

/* Where a ray is in the sphere and between the planes about a torus with a tube of radius m. */
STAGE static void torus_bounds(const torus *restrict base, double m, int n, const rays *restrict x,
                               const real *restrict end, real *restrict t0, real *restrict t1)
{
    const torus f = *base;
    for (int i = 0; i < n; i++) {
        local l = local_of(&f, x, i);
        double B = sqrt((f.M + m) * (f.M + m) - (l.ox * l.ox + l.oy * l.oy + l.oz * l.oz)); /* NaN beside the sphere */
        double y0 = (-m - l.oy) / l.dy, y1 = (m - l.oy) / l.dy; /* along the planes: as in box.c */
        double from = most(-l.start, most(least(y0, y1), -B)), to = least(most(y0, y1), B);
        int some = from <= to;
        real last = (real)((to + l.start) / l.speed);
        t0[i] = some ? (real)((from + l.start) / l.speed) : R(1);
        t1[i] = some ? real_min(last, end[i]) : R(-1);
    }
}

/* From outside the shell begins where the outer torus is met first. */
STAGE static void torus_enter(const torus *restrict base, double m, int n, const rays *restrict x,
                              const roots *restrict k, real *restrict t0, real *restrict t1)
{
    const torus f = *base;
    for (int i = 0; i < n; i++) {
        place p = place_of(&f, x, i, 0);
        double c = p.d - f.M;
        int within = c * c + p.y * p.y <= m * m, meets = k->a[i] <= k->b[i];
        real first = (real)((k->way[i] + k->start[i]) / k->speed[i]);
        t0[i] = (within | !meets) ? t0[i] : first;
        t1[i] = (within | meets) ? t1[i] : R(-1);
    }
}

/* What lies between two places of the shell, the hole or the tube's core, is left to the search. */
static void torus_shell(const surface *base, int part, int n, const rays *x, const real *end, real Pmin, real Pmax,
                        real *t0, real *t1)
{
    const torus *f = (const torus *)base;
    const double m = f->m + (double)Pmax;
    search k;
    (void)part;
    (void)Pmin;
    torus_bounds(f, m > 0 ? m : 0, n, x, end, t0, t1);
    if (m > 0 && m < f->M) { /* a fatter tube closes the hole, where G no longer has the quartic's sign */
        torus_search(f, m, n, x, end, &k);
        torus_enter(f, m, n, x, &k.root, t0, t1);
    }
}

STAGE static void torus_foot(const surface *base, int part, int n, const rays *x, const real *t, closest_points *q)
{
    const torus f = *(const torus *)base;
    (void)part;
    for (int i = 0; i < n; i++) {
        place p = place_of(&f, x, i, t[i]);
        double id = 1 / most(p.d, 1e-15), ex = p.x * id, ez = p.z * id;
        double c = p.d - f.M, rho = sqrt(c * c + p.y * p.y), ir = 1 / most(rho, 1e-15), nc = c * ir, ny = p.y * ir;
        q->u[i] = (real)km_atan2(p.z, p.x);
        q->w[i] = (real)km_atan2(-p.y, c);
        q->h[i] = (real)(rho - f.m);
        put(&f, &q->gu, i, -ez * id, 0, ex * id);
        put(&f, &q->gw, i, ny * ir * ex, -nc * ir, ny * ir * ez);
        put(&f, &q->gh, i, nc * ex, ny, nc * ez);
    }
}

/* The directions of h, u and w are at right angles, so that the ray's way is shared between them (Cauchy and Schwarz).
 * |grad u| is 1/(distance to the axis), |grad w| 1/(distance to the tube's middle): within half of either they at most
 * double. */
STAGE static void torus_steep(const surface *base, int part, int n, const rays *x, const closest_points *p, real Pu_max,
                              real Pw_max, real *restrict rate, real *restrict reach)
{
    (void)base;
    (void)part;
    for (int i = 0; i < n; i++) {
        real sx = x->s.x[i], sy = x->s.y[i], sz = x->s.z[i], s = real_sqrt(sx * sx + sy * sy + sz * sz);
        real u2 = p->gu.x[i] * p->gu.x[i] + p->gu.y[i] * p->gu.y[i] + p->gu.z[i] * p->gu.z[i];
        real w2 = p->gw.x[i] * p->gw.x[i] + p->gw.y[i] * p->gw.y[i] + p->gw.z[i] * p->gw.z[i];
        rate[i] = s * real_sqrt(1 + 4 * (u2 * Pu_max * Pu_max + w2 * Pw_max * Pw_max));
        reach[i] = R(0.5) / (real_sqrt(real_max(u2, w2)) * s);
    }
}

static void torus_extent(const surface *base, int part, double u[2], double w[2])
{
    const double pi = 3.14159265358979323846;
    (void)base;
    (void)part;
    u[0] = w[0] = -pi;
    u[1] = w[1] = pi;
}

/* The circle that the tube is about reaches as far along an axis as that is across its own. */
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
    "torus",   torus_hit, torus_hit_own, torus_locate, torus_eval,  torus_occlude, torus_occlude_own, torus_extent,
    torus_box, 1,         torus_shell,   torus_foot,   torus_steep, false,
};

static void store(double to[3], vec3 v)
{
    to[0] = v.x;
    to[1] = v.y;
    to[2] = v.z;
}

surface *torus_new(vec3 centre, vec3 axis, double major, double minor)
{
    const double l = vec3_length(axis);
    const bool good = l > 0 && l < HUGE_VAL && minor > 0 && minor < major && major < HUGE_VAL;
    torus *f = good ? calloc(1, sizeof *f) : NULL;
    if (!f)
        return NULL;
    const frame a = frame_about(axis);
    f->base.ops = &torus_methods;
    store(f->C, centre);
    store(f->X, a.x);
    store(f->Y, a.y);
    store(f->Z, a.z);
    f->M = major;
    f->m = minor;
    return &f->base;
}

/* ---- as the scene file has it ---- */

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
