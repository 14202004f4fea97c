/* Rays against a torus.
 *
 * A ray meets it at the roots of a quartic. Float has too few digits for it, and its closed form fails for rays that
 * graze. So all is in double, and roots are bracketed: between two places where the quartic's derivative is 0 there is
 * one root, or none. Ways along the ray are measured from its point closest to C, so that the quartic has no cubic
 * term, and its derivative t^3 + P t + Q has roots in closed form. Rounding there can only lose a root of a ray that
 * touches the torus within a rounding. The root within a bracket is found as that of
 *
 *     G = (distance to the axis - M)^2 + (height)^2 - m^2,
 *
 * which has the quartic's sign where m < M, and keeps the digits that the quartic's fourth powers lose.
 */
#include "geometry/torus.h"

/* The last step of the iteration, as a share of M + m: below the rounding of t. */
#ifdef KAGE_DOUBLE
#define CONVERGED 1e-15
#else
#define CONVERGED 1e-10
#endif

enum { STEPS = 64 }; /* bisection alone reaches double's rounding by then */

KM_INLINE void root_begin(torus_roots *k, int i, int some, double a, double b, int above)
{
    k->open[i] = some ? 1 : 0;
    k->a[i] = some ? a : 1;
    k->b[i] = some ? b : -1;
    k->side[i] = above ? 1 : -1; /* up to the first change of it */
    k->way[i] = 0.5 * (a + b);
}

/* A step of Newton's iteration for a function with that value and slope, or to the bracket's middle where that would
 * leave it. */
KM_INLINE void root_step(torus_roots *k, int i, double value, double slope, double close)
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

/* G at a point of the ray. */
KM_INLINE double tube(double M, double m, torus_ray l, double way)
{
    double x = l.ox + way * l.dx, y = l.oy + way * l.dy, z = l.oz + way * l.dz, d = sqrt(x * x + z * z) - M;
    return d * d + y * y - m * m;
}

/* The places where the quartic t^4 + p t^2 + q t + r has the derivative 0, in order; three times the same where there
 * is only one. */
typedef struct levels {
    double x[3];
} levels;

#define SQRT3 1.7320508075688772

KM_INLINE levels level_places(double M, double m, torus_ray l)
{
    double oo = l.ox * l.ox + l.oy * l.oy + l.oz * l.oz, ee = l.dx * l.dx + l.dz * l.dz, oe = l.ox * l.dx + l.oz * l.dz;
    double P = oo + M * M - m * m - 2 * M * M * ee, Q = -2 * M * M * oe; /* p/2 and q/4 */
    double A = sqrt(greater(-P / 3, 0)), A3 = A * A * A, half = 0.5 * Q;
    double d = half * half + P * P * P / 27;
    /* three: 2 A times the cosine of a third of an angle, and of that +- 120 degrees */
    double c = km_cos(km_acos(greater(-1, lesser(1, -half / greater(A3, 1e-300)))) / 3),
           s = sqrt(greater(1 - c * c, 0));
    /* one: Cardano's */
    double k = fabs(half) + sqrt(greater(d, 0)), S = k > 0 ? km_copysign(km_pow(k, 1. / 3), -half) : 1;
    double one = k > 0 ? S - P / (3 * S) : 0;
    levels z = {{d > 0 ? one : -A * (c + SQRT3 * s), d > 0 ? one : -A * (c - SQRT3 * s), d > 0 ? one : 2 * A * c}};
    return z;
}

/* The ends of the intervals that hold at most one root each, from `from` to `to`, and within a sphere about the torus,
 * a little larger than it, so that the ends are outside. */
typedef struct intervals {
    double e[5];
} intervals;

KM_INLINE intervals intervals_of(double M, double m, torus_ray l, double from, double to)
{
    double B2 = 1.1 * (M + m) * (M + m) - (l.ox * l.ox + l.oy * l.oy + l.oz * l.oz), B = sqrt(greater(B2, 0));
    double lo = greater(from, -B), hi = lesser(to, B);
    hi = B2 >= 0 ? greater(hi, lo) : lo; /* nothing */
    levels z = level_places(M, m, l);
    intervals e = {
        {lo, lesser(greater(z.x[0], lo), hi), lesser(greater(z.x[1], lo), hi), lesser(greater(z.x[2], lo), hi), hi}};
    return e;
}

/* Bracket the first root with 0 < t < end[i], of a torus with a tube of radius m. */
STAGE static void torus_bracket(const torus *restrict base, double m, int n, const rays *restrict x,
                                const real *restrict end, torus_rays *restrict k)
{
    const torus f = *base;
    for (int i = 0; i < n; i++) {
        torus_ray l = torus_ray_of(&f, x, i);
        intervals e = intervals_of(f.M, m, l, -l.start, (double)end[i] * l.speed - l.start);
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

STAGE static void torus_step(double M, double m, double close, int n, torus_rays *restrict k)
{
    for (int i = 0; i < n; i++) {
        double way = k->root.way[i];
        double x = k->ox[i] + way * k->dx[i], y = k->oy[i] + way * k->dy[i], z = k->oz[i] + way * k->dz[i];
        double r = sqrt(x * x + z * z), d = r - M, g = d * d + y * y - m * m;
        double slope = 2 * (d * (x * k->dx[i] + z * k->dz[i]) / greater(r, 1e-300) + y * k->dy[i]);
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

void torus_search(const torus *f, double m, int n, const rays *x, const real *end, torus_rays *k)
{
    torus_bracket(f, m, n, x, end, k);
    for (int step = 0; step < STEPS && any(n, k->root.open); step++)
        torus_step(f->M, m, CONVERGED * (f->M + m), n, k);
}

STAGE static void torus_take(int n, const torus_roots *restrict k, int32_t id, hits *restrict h)
{
    for (int i = 0; i < n; i++) {
        real t = (real)((k->way[i] + k->start[i]) / k->speed[i]);
        int take = (k->a[i] <= k->b[i]) & (t > 0) & (t < h->t[i]);
        hits_take(h, i, take, t, id);
    }
}

void torus_hit(const surface *base, int n, const rays *x, int32_t id, hits *h)
{
    const torus *f = (const torus *)base;
    torus_rays k;
    torus_search(f, f->m, n, x, h->t, &k);
    torus_take(n, &k.root, id, h);
}

/* Whether there is a root needs only the signs of G at the ends of the intervals. */
STAGE static void occlude_by_quartic(const surface *base, int n, const rays *x, real *lit)
{
    const torus f = *(const torus *)base;
    for (int i = 0; i < n; i++) {
        torus_ray l = torus_ray_of(&f, x, i);
        intervals e = intervals_of(f.M, f.m, l, -l.start, l.speed - l.start);
        double g0 = tube(f.M, f.m, l, e.e[0]), g1 = tube(f.M, f.m, l, e.e[1]), g2 = tube(f.M, f.m, l, e.e[2]);
        double g3 = tube(f.M, f.m, l, e.e[3]), g4 = tube(f.M, f.m, l, e.e[4]);
        double low = lesser(lesser(lesser(g0, g1), lesser(g2, g3)), g4),
               high = greater(greater(greater(g0, g1), greater(g2, g3)), g4);
        lit[i] = ((low <= 0) & (high > 0)) ? 0 : lit[i];
    }
}

/* A ray from the torus: one root is 0. What is left is the cubic t^3 + A t^2 + B t + C in the length t along the ray,
 * with C = 8 M m (distance to the axis) n.s. Its derivative, a quadratic, is 0 at t0 <= t1. */
typedef struct cubic {
    double A, B, C, t0, t1, T; /* T: the length of s */
} cubic;

/* The start is first moved onto the torus in double, so that its root is exactly 0. */
KM_INLINE cubic cubic_of(const torus *f, const rays *v, int i)
{
    double sx = (double)v->s.x[i], sy = (double)v->s.y[i], sz = (double)v->s.z[i];
    double T = sqrt(sx * sx + sy * sy + sz * sz), k = 1 / T;
    vec3 s = torus_frame(f, sx, sy, sz);
    double dx = k * s.x, dy = k * s.y, dz = k * s.z;
    torus_place p = torus_place_of(f, v, i, 0);
    double id = 1 / p.d, ex = p.x * id, ez = p.z * id, c = p.d - f->M, ic = 1 / sqrt(c * c + p.y * p.y);
    double nc = c * ic, ny = p.y * ic,
           d = f->M + f->m * nc; /* n, and the place on the torus: away from and along the axis */
    double along = ex * dx + ez * dz, pd = d * along + f->m * ny * dy;
    double A = 4 * pd, B = 4 * pd * pd + 4 * f->M * d - 4 * f->M * f->M * (dx * dx + dz * dz);
    double C = 8 * f->M * f->m * d * (nc * along + ny * dy);
    double h = sqrt(greater(A * A - 3 * B, 0));
    cubic q = {A, B, C, (-A - h) / 3, (-A + h) / 3, T};
    return q;
}

KM_INLINE double cubic_at(double A, double B, double C, double t) { return ((t + A) * t + B) * t + C; }

/* Whether there is a root shows in the signs at 0, at the end and between, at t0 and t1. */
STAGE static void occlude_by_cubic(const surface *base, int n, const rays *v, const int32_t *part, real *lit)
{
    const torus f = *(const torus *)base;
    (void)part;
    for (int i = 0; i < n; i++) {
        cubic q = cubic_of(&f, v, i);
        double t0 = lesser(greater(q.t0, 0), q.T), t1 = lesser(greater(q.t1, 0), q.T);
        double k0 = cubic_at(q.A, q.B, q.C, t0), k1 = cubic_at(q.A, q.B, q.C, t1), k2 = cubic_at(q.A, q.B, q.C, q.T);
        double low = lesser(lesser(k0, k1), lesser(k2, q.C)), high = greater(greater(k0, k1), greater(k2, q.C));
        lit[i] = ((low < 0) & (high > 0)) ? 0 : lit[i];
    }
}

/* Cubics, side by side, and their first roots above 0. */
typedef struct cubics {
    double A[LANES], B[LANES], C[LANES];
    torus_roots root;
} cubics;

/* Bracket the first root with 0 < t < end[i]. No root is farther than the torus is wide. */
STAGE static void torus_own_bracket(const torus *restrict base, int n, const rays *restrict v, const real *restrict end,
                                    cubics *restrict k)
{
    const torus f = *base;
    const double wide = 2.1 * (f.M + f.m);
    for (int i = 0; i < n; i++) {
        cubic q = cubic_of(&f, v, i);
        double last = greater(lesser((double)end[i] * q.T, wide), 0);
        double t0 = lesser(greater(q.t0, 0), last), t1 = lesser(greater(q.t1, 0), last);
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

/* Rays from elsewhere by the quartic, rays from the torus itself by the cubic. In the other search the range of each is
 * empty. */
void torus_hit_own(const surface *base, int n, const rays *x, const ray_origins *from, int32_t id, hits *h)
{
    const torus *f = (const torus *)base;
    const double close = CONVERGED * (f->M + f->m);
    rays own = {.r = from->at, .s = x->s};
    real other_end[LANES], own_end[LANES];
    torus_rays k;
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

void torus_occlude(const surface *base, int n, const rays *x, real *lit) { occlude_by_quartic(base, n, x, lit); }

void torus_occlude_own(const surface *base, int n, const rays *x, const int32_t *part, real *lit)
{
    occlude_by_cubic(base, n, x, part, lit);
}
