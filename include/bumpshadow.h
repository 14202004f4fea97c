/* bumpshadow.h: shadows of other objects on a bump-mapped surface.
 * SPDX-License-Identifier: MIT (the text is at the end)
 *
 * The formulas of K. Sumi and T. Noma, "A Shadowing Method for Bump-Mapped Surfaces", and kage's additions
 * (marked "ours"). One header without dependencies, C99 and C++17, to copy into any renderer. float; #define
 * BS_DOUBLE before the inclusion for double. Every function is a few multiplications without a branch, so a
 * loop over it vectorises.
 *
 * A ray r + s t meets the smooth surface Q(u,w) at t_hit. Shade there, with the perturbed normal n'. But
 * start the shadow rays at r + s (t_hit + tau), near the point where the ray meets the rough surface
 * Q + P n/|n|:
 *
 *     bs_vec3 n  = bs_normal(Qu, Qw);
 *     bs_vec3 np = bs_perturbed_normal(n, Qu, Qw, Pu, Pw);          // shade with this
 *     bs_view v  = bs_view_of(s, n, Qu, Qw);
 *     bs_bump p  = {P, Pu, Pw, 0, 0, 0};
 *     bs_slab b  = bs_slab_of(v, Pmin, Pmax);
 *     t0 = t_hit + bs_shift_of(0, 1, v, 0, p, b).tau;               // order 0, with the guard
 *
 * Test shadows of the receiver itself from the smooth hit, those of every other object from r + s t0: a point
 * below its own smooth surface (P < 0) must not be shadowed by that surface.
 *
 * Symbols and units: Q in scene units; P the height along the unit normal n/|n|, in scene units; n = Qu x Qw
 * points to the side of +P (otherwise swap u and w); s need not be a unit vector; tau is in units of t, like
 * t_hit. The formulas hold for rays from the front (s.n < 0) and from behind. Where bs_regular does not hold (a
 * sphere's pole) use the smooth normal and tau = 0.
 */
#ifndef BUMPSHADOW_H
#define BUMPSHADOW_H

#include <math.h>

#ifdef BS_DOUBLE
typedef double bs_real;
#define BS_SQRT(x) sqrt(x)
#define BS_ABS(x) fabs(x)
#else
typedef float bs_real;
#define BS_SQRT(x) sqrtf(x)
#define BS_ABS(x) fabsf(x)
#endif

typedef int bs_bool; /* 0 or 1 */

typedef struct bs_vec3 {
    bs_real x, y, z;
} bs_vec3;

static inline bs_vec3 bs_cross(bs_vec3 a, bs_vec3 b)
{
    bs_vec3 c;
    c.x = a.y * b.z - a.z * b.y;
    c.y = a.z * b.x - a.x * b.z;
    c.z = a.x * b.y - a.y * b.x;
    return c;
}

static inline bs_real bs_dot(bs_vec3 a, bs_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/* The smooth normal n = Qu x Qw, not normalised. Section 6. */
static inline bs_vec3 bs_normal(bs_vec3 Qu, bs_vec3 Qw) { return bs_cross(Qu, Qw); }

/* Not where Qu and Qw are nearly parallel or 0, as at a sphere's pole: P has no gradient there. (Ours. The bound is on
 * |n| relative to Qu and Qw, so it does not depend on the scene's scale; below it float has no correct digit.) */
static inline bs_bool bs_regular(bs_vec3 n, bs_vec3 Qu, bs_vec3 Qw)
{
    bs_real e = bs_dot(Qu, Qu) + bs_dot(Qw, Qw);
    return bs_dot(n, n) > (bs_real)1e-14 * e * e;
}

/* The perturbed normal [Rogers 1985], not normalised. Section 6:
 *     n' = Qu x Qw + Pu (n x Qw)/|n| + Pw (Qu x n)/|n| */
static inline bs_vec3 bs_perturbed_normal(bs_vec3 n, bs_vec3 Qu, bs_vec3 Qw, bs_real Pu, bs_real Pw)
{
    bs_real il = 1 / BS_SQRT(bs_dot(n, n));
    bs_vec3 x = bs_cross(n, Qw), y = bs_cross(Qu, n), np;
    np.x = n.x + (Pu * x.x + Pw * y.x) * il;
    np.y = n.y + (Pu * x.y + Pw * y.y) * il;
    np.z = n.z + (Pu * x.z + Pw * y.z) * il;
    return np;
}

/* The ray relative to the surface, per unit of t. */
typedef struct bs_view {
    bs_real sn;   /* s.n/|n|: towards the surface, negative from outside */
    bs_real a, b; /* du/dt and dw/dt in the tangent plane */
} bs_view;

/* a = s.(Qw x n)/|n|^2,  b = s.(n x Qu)/|n|^2 */
static inline bs_view bs_view_of(bs_vec3 s, bs_vec3 n, bs_vec3 Qu, bs_vec3 Qw)
{
    bs_real i2 = 1 / bs_dot(n, n);
    bs_view v;
    v.sn = bs_dot(s, n) * BS_SQRT(i2);
    v.a = bs_dot(s, bs_cross(Qw, n)) * i2;
    v.b = bs_dot(s, bs_cross(n, Qu)) * i2;
    return v;
}

/* A place (u,w) of the surface. */
typedef struct bs_place {
    bs_real u, w;
} bs_place;

/* The place to shade (ours), instead of the smooth hit (u0,w0): below r + s (t_hit + tau), where the shadow ray starts.
 *     (u,w) = (u0,w0) + (a,b) tau
 * Evaluate Q, P and n' there. Exact on a plane. On a curved surface take a step more: evaluate Q, Qu and Qw there, and
 * add the a and b of bs_view_of(r + s (t_hit + tau) - Q, ...). */
static inline bs_place bs_place_of(bs_view v, bs_real u0, bs_real w0, bs_real tau)
{
    bs_place p;
    p.u = u0 + v.a * tau;
    p.w = w0 + v.b * tau;
    return p;
}

/* The partials of the offset surface Q + h n/|n|, h constant (ours). With these in place of Qu and Qw, and P for h,
 * bs_perturbed_normal is the normal of the rough surface itself; with Qu and Qw it leaves out the smooth surface's
 * curvature. Nothing to do on a plane. */
typedef struct bs_offset {
    bs_vec3 Qu, Qw;
} bs_offset;

static inline bs_offset bs_offset_of(bs_vec3 n, bs_vec3 Qu, bs_vec3 Qw, bs_vec3 Quu, bs_vec3 Quw, bs_vec3 Qww,
                                     bs_real h)
{
    bs_vec3 a = bs_cross(Quu, Qw), b = bs_cross(Qu, Quw), c = bs_cross(Quw, Qw), d = bs_cross(Qu, Qww);
    bs_vec3 nu = {a.x + b.x, a.y + b.y, a.z + b.z}, nw = {c.x + d.x, c.y + d.y, c.z + d.z}; /* the partials of n */
    bs_real i2 = 1 / bs_dot(n, n), k = h * BS_SQRT(i2), pu = bs_dot(nu, n) * i2, pw = bs_dot(nw, n) * i2;
    bs_offset o;
    o.Qu.x = Qu.x + k * (nu.x - pu * n.x);
    o.Qu.y = Qu.y + k * (nu.y - pu * n.y);
    o.Qu.z = Qu.z + k * (nu.z - pu * n.z);
    o.Qw.x = Qw.x + k * (nw.x - pw * n.x);
    o.Qw.y = Qw.y + k * (nw.y - pw * n.y);
    o.Qw.z = Qw.z + k * (nw.z - pw * n.z);
    return o;
}

/* The smooth surface's curvature along the ray, L a^2 + 2 M a b + N b^2 with the second fundamental form
 * L = Quu.n/|n|, M = Quw.n/|n|, N = Qww.n/|n|. (Ours: the paper leaves it out, section 6.) */
static inline bs_real bs_curvature(bs_view v, bs_vec3 n, bs_vec3 Quu, bs_vec3 Quw, bs_vec3 Qww)
{
    return (bs_dot(Quu, n) * v.a * v.a + 2 * bs_dot(Quw, n) * v.a * v.b + bs_dot(Qww, n) * v.b * v.b) /
           BS_SQRT(bs_dot(n, n));
}

/* The perturbation and its partials at (u,w). */
typedef struct bs_bump {
    bs_real P, Pu, Pw, Puu, Puw, Pww;
} bs_bump;

/* The one equation behind every method (ours): the gap between the ray and the rough surface,
 *     gap(tau) = tau (s.n/|n|) - 1/2 (L a^2 + 2 M a b + N b^2) tau^2 - P(u0 + a tau, w0 + b tau),
 * is 0 at the shift sought. Order k replaces P by its k-th Taylor polynomial. `P` is the height looked up at
 * (u0 + a tau, w0 + b tau), `curvature` is bs_curvature or 0. */
static inline bs_real bs_gap(bs_view v, bs_real curvature, bs_real tau, bs_real P)
{
    return tau * v.sn - (bs_real)0.5 * curvature * tau * tau - P;
}

/* Order 0, a plane at height P, parallel to the tangent plane. Section 6:
 *     t0 = ((Q + P n/|n| - r).n)/(s.n),  that is  tau = P |n|/(s.n) */
static inline bs_real bs_tau0(bs_view v, bs_real P) { return P / v.sn; }

/* The linear coefficient of gap, negated: Pu a + Pw b - s.n/|n| = -(s.n')/|n|. From the front it is positive where
 * the ray enters the rough surface's tangent plane. */
static inline bs_real bs_slope(bs_view v, bs_bump p) { return p.Pu * v.a + p.Pw * v.b - v.sn; }

/* Order 1, the tangent plane of the rough surface at Q + P n/|n|. Section 6:
 *     t0 = ((Q + P n/|n| - r).n')/(s.n'),  that is  tau = P |n|/(s.n'),
 * as Q - r = s t_hit, and n.n' = |n|^2. */
static inline bs_real bs_tau1(bs_view v, bs_bump p) { return -p.P / bs_slope(v, p); }

/* The quadratic of order 2,  A tau^2 + B tau + P = 0, with B = bs_slope and
 *     A = 1/2 (Puu a^2 + Pww b^2)                   in the paper (section 4.1 drops Puw), and
 *     A = 1/2 (Puu a^2 + 2 Puw a b + Pww b^2 + L a^2 + 2 M a b + N b^2)   in 2+ (ours). */
static inline bs_real bs_quadratic(bs_view v, bs_bump p)
{
    return (bs_real)0.5 * (p.Puu * v.a * v.a + p.Pww * v.b * v.b);
}

static inline bs_real bs_quadratic_plus(bs_view v, bs_bump p, bs_real curvature)
{
    return bs_quadratic(v, p) + p.Puw * v.a * v.b + (bs_real)0.5 * curvature;
}

/* B^2 - 4 A P: negative where the ray does not meet the quadric. */
static inline bs_real bs_discriminant(bs_real A, bs_real B, bs_real P) { return B * B - 4 * A * P; }

/* The root that tends to order 1 as A -> 0, without cancellation:
 *     tau = -2 P/(B + sqrt(B^2 - 4 A P)),
 * with a minus before the square root where the ray comes from behind. */
static inline bs_real bs_tau2(bs_view v, bs_real B, bs_real discriminant, bs_real P)
{
    bs_real root = BS_SQRT(discriminant);
    return -2 * P / (B + (v.sn < 0 ? root : -root));
}

/* The slab (ours): the true hit lies between the surfaces offset by Pmin and by Pmax, so tau lies between the
 * ray's hits of these. */
typedef struct bs_slab {
    bs_real front, back; /* as tau; front is the viewer's side */
} bs_slab;

static inline bs_slab bs_slab_of(bs_view v, bs_real Pmin, bs_real Pmax)
{
    bs_real x = Pmin / v.sn, y = Pmax / v.sn;
    bs_slab b;
    b.front = x < y ? x : y;
    b.back = x < y ? y : x;
    return b;
}

/* A shift and its order. */
typedef struct bs_shift {
    bs_real tau;
    int order; /* the order really used: 0, 1, 2, or 3 for 2+ */
} bs_shift;

/* The shift by order 0, 1, 2 or 3 (2+). `guard` (ours, the default of kage): where the result is outside the
 * slab, or the ray does not enter the tangent plane (s.n' >= 0 from the front, that is B <= 0), 3 and 2 fall back to 1,
 * 1 to 0; order 0 is always inside. Without the guard only order 2 falls back, to 1, where it has no real root near
 * that of order 1 (B <= 0, or B^2 < 4 A P). Only order 3 uses `curvature`. Call it with a constant order and guard, so
 * that the rest is compiled away. */
static inline bs_shift bs_shift_of(int order, bs_bool guard, bs_view v, bs_real curvature, bs_bump p, bs_slab slab)
{
    bs_real B = bs_slope(v, p), down = v.sn < 0 ? B : -B;
    bs_shift s;
    s.tau = bs_tau0(v, p.P);
    s.order = 0;
    if (order >= 1) {
        bs_real tau = bs_tau1(v, p);
        bs_bool good = (guard == 0) | ((down > 0) & (tau >= slab.front) & (tau <= slab.back));
        s.tau = good ? tau : s.tau;
        s.order = good ? 1 : s.order;
    }
    if (order >= 2) {
        bs_real A = order == 3 ? bs_quadratic_plus(v, p, curvature) : bs_quadratic(v, p);
        bs_real discriminant = bs_discriminant(A, B, p.P), tau = bs_tau2(v, B, discriminant, p.P);
        /* there is a real root, and it is the one near order 1's */
        bs_bool good = (discriminant >= 0) & (down > 0);
        good = guard ? good & (tau >= slab.front) & (tau <= slab.back) : good;
        s.tau = good ? tau : s.tau;
        s.order = good ? order : s.order;
    }
    return s;
}

/* iter:K (ours): order 0, repeated. Start with tau = 0; K times evaluate P at (u0 + a tau, w0 + b tau) and set tau =
 * bs_tau0(v, P). K = 1 is order 0. */

/* march:N (ours): N equal steps through the slab from the viewer's side, to the first point where the ray is not
 * above the rough surface, then one secant step back.
 *
 *     bs_march m = bs_march_start(slab);
 *     for (int i = 0; i <= N; i++) {
 *         bs_real tau = bs_march_tau(slab, i, N);
 *         m = bs_march_step(m, tau, bs_gap(v, curvature, tau, height(u0 + v.a * tau, w0 + v.b * tau)), v);
 *     }
 *     // m.found: m.tau is the shift. Otherwise use order 0: the slab is infinite, or the smooth surface curves
 *     // away from it, or P is flat at Pmin, where order 0 is exact.
 */
typedef struct bs_march {
    bs_real tau; /* the last point above the surface; once found, the shift; infinite where the slab is */
    bs_real gap; /* at that point */
    bs_bool found;
} bs_march;

/* Whether the slab is finite. It is not where P has no bounds or s.n is 0. */
static inline bs_bool bs_slab_ends(bs_slab slab) { return slab.back - slab.front < (bs_real)INFINITY; }

static inline bs_march bs_march_start(bs_slab slab)
{
    bs_march m;
    m.tau = bs_slab_ends(slab) ? slab.front : (bs_real)INFINITY;
    m.gap = 0;
    m.found = 0;
    return m;
}

/* Step i of 0..N; the last is exactly slab.back. In an infinite slab all are 0, where P can be evaluated; nothing is
 * found then. */
static inline bs_real bs_march_tau(bs_slab slab, int i, int N)
{
    bs_real tau = i == N ? slab.back : slab.front + (slab.back - slab.front) * ((bs_real)i / (bs_real)N);
    return bs_slab_ends(slab) ? tau : 0;
}

static inline bs_march bs_march_step(bs_march m, bs_real tau, bs_real gap, bs_view v)
{
    bs_real above = v.sn < 0 ? gap : -gap; /* from behind the gap has the opposite sign */
    bs_bool looking = (m.found == 0) & (m.tau < (bs_real)INFINITY), hit = looking & (above <= 0);
    bs_real rise = m.gap - above; /* > 0 at a hit, except at step 0, where m.tau is tau */
    bs_real secant = m.tau + (tau - m.tau) * (rise > 0 ? m.gap / rise : 0);
    m.tau = hit ? secant : looking ? tau : m.tau;
    m.gap = m.found ? m.gap : above;
    m.found = m.found | hit;
    return m;
}

/* ---- what a place leaves (ours) ----
 *
 * How far is a shift, by whichever method, from the rough surface? Look P, Pu and Pw up once more, at bs_place_of(v,
 * u0, w0, tau). There bs_gap is the height that is left. Over the gap's slope it is what tau lacks: */
static inline bs_real bs_residual(bs_view v, bs_real curvature, bs_real tau, bs_bump there)
{
    return bs_gap(v, curvature, tau, there.P) / (bs_slope(v, there) + curvature * tau);
}

/* Added to tau it is Newton's step. So many pixels is the shadow's edge off by it, where s is the viewing ray's
 * direction, d that to the light, and `pixel` the size of a pixel at the hit, in scene units: |s| times the sine
 * between view and light, over that size, for each unit of tau. */
static inline bs_real bs_pixels(bs_vec3 s, bs_vec3 d, bs_real pixel, bs_real residual)
{
    bs_vec3 across = bs_cross(s, d);
    return BS_ABS(residual) * BS_SQRT(bs_dot(across, across) / bs_dot(d, d)) / pixel;
}

/* ---- the bumps' own shadows ----
 *
 * N. Max, "Shadows for bump-mapped surfaces", 1986 (the paper's case 1); the march is ours. Is a
 * place of the rough surface, X = Q + P n/|n| over the (u,w) that is shaded, in the shadow of the bumps around it?
 * With d = light - X, so that the light is at t = 1, the height of X + d t over the smooth surface is
 *     P + t (d.n/|n|) - 1/2 (L a^2 + 2 M a b + N b^2) t^2,
 * and P's own there is P(u + a t, w + b t), with (a,b) of bs_view_of(d, n, Qu, Qw). The march looks P up on the way,
 * until it leaves the slab:
 *
 *     bs_view d = bs_view_of(light - X, n, Qu, Qw);
 *     bs_way y = bs_way_of(v.sn < 0 ? 1 : -1, d, bs_curvature(d, n, Quu, Quw, Qww), P, Pmin, Pmax);
 *     bs_bool dark = y.side * bs_dot(np, light - X) <= 0;
 *     for (int i = 1; i <= N; i++) {
 *         bs_real t = bs_way_step(y.end, i, N);
 *         dark |= bs_way_below(y, t, height(u + y.d.a * t, w + y.d.b * t));
 *     }
 *
 * It starts on the rough surface itself, and needs no epsilon: it compares the way's rise since X with P's, and both
 * are 0 at t = 0. Which side the way leaves to is known from n'.
 */
typedef struct bs_way {
    bs_real side;      /* of the viewer, 1: the front, -1: the back. What follows is as seen from that side: */
    bs_view d;         /* to the light; d.sn > 0: the light is above the tangent plane */
    bs_real curvature; /* along d */
    bs_real P;         /* at X, from the front */
    bs_real end;       /* t at which the way leaves the slab, at most 1 */
} bs_way;

/* The t at which a way has risen by D >= 0, or is highest, where the surface rises more and it never gets there. At
 * most 1, the light. */
static inline bs_real bs_way_to(bs_view d, bs_real curvature, bs_real D)
{
    bs_real k = (bs_real)-0.5 * curvature, q = d.sn * d.sn + 4 * k * D, root = BS_SQRT(q > 0 ? q : 0);
    bs_real rising = q >= 0 ? 2 * D / (d.sn + root) : d.sn / curvature; /* the first root of k t^2 + sn t = D */
    bs_real dipping = k > 0 ? (root - d.sn) / (2 * k) : 1;
    bs_real t = d.sn > 0 ? rising : dipping;
    return t < 1 ? t : 1;
}

static inline bs_way bs_way_of(bs_real side, bs_view d, bs_real curvature, bs_real P, bs_real Pmin, bs_real Pmax)
{
    bs_way y;
    y.side = side;
    y.d = d;
    y.d.sn = side * d.sn;
    y.curvature = side * curvature;
    y.P = P;
    y.end = bs_way_to(y.d, y.curvature, side > 0 ? Pmax - P : P - Pmin);
    return y;
}

/* On a curved surface a straight way is a curve in (u,w), to second order (u + a t + A t^2, w + b t + B t^2): Q + h
 * n/|n| does not accelerate, so what the partials of Q and of n/|n| add along (a,b) is made up for. a and b are best
 * those of bs_view_of at X's own height, with bs_offset_of's Qu and Qw. On a plane A = B = 0. */
typedef struct bs_turn {
    bs_real A, B;
} bs_turn;

static inline bs_turn bs_turn_of(bs_view d, bs_vec3 n, bs_vec3 Qu, bs_vec3 Qw, bs_vec3 Quu, bs_vec3 Quw, bs_vec3 Qww)
{
    bs_offset o = bs_offset_of(n, Qu, Qw, Quu, Quw, Qww, 1); /* less Qu and Qw: the partials of n/|n| */
    bs_real aa = d.a * d.a, ab = 2 * d.a * d.b, bb = d.b * d.b, ua = 2 * d.sn * d.a, wb = 2 * d.sn * d.b;
    bs_vec3 x;
    x.x = Quu.x * aa + Quw.x * ab + Qww.x * bb + (o.Qu.x - Qu.x) * ua + (o.Qw.x - Qw.x) * wb;
    x.y = Quu.y * aa + Quw.y * ab + Qww.y * bb + (o.Qu.y - Qu.y) * ua + (o.Qw.y - Qw.y) * wb;
    x.z = Quu.z * aa + Quw.z * ab + Qww.z * bb + (o.Qu.z - Qu.z) * ua + (o.Qw.z - Qw.z) * wb;
    bs_view v = bs_view_of(x, n, Qu, Qw);
    bs_turn r;
    r.A = (bs_real)-0.5 * v.a;
    r.B = (bs_real)-0.5 * v.b;
    return r;
}

/* The place of step i of 1..N: near X they are denser, as there P is nearest to the way. */
static inline bs_real bs_way_step(bs_real end, int i, int N)
{
    bs_real x = (bs_real)i / (bs_real)N;
    return end * x * x;
}

/* Whether the way is below P at t. */
static inline bs_bool bs_way_below(bs_way y, bs_real t, bs_real P)
{
    return bs_gap(y.d, y.curvature, t, y.side * (P - y.P)) < 0;
}

/* Max's horizon map. For K directions in (u,w), bearing k of which is 4 k/K, a table holds for each place the horizon:
 * the most that P rises from there, per unit of the way. Directions and ways are measured in samples, by their sum:
 * with ku and kw samples per u and per w,
 *     x = ku a, y = kw b, per unit of |x| + |y|,
 * so that a bearing needs no angle, a map on a sphere needs no scene units, and between two directions next to each
 * other a slope that is the same all around is interpolated exactly. bearing: 0 along +u, 1 along +w, 2 and 3 against
 * them, less than 4. rise: of the way to the light. The light is seen where its rise is above the horizon. */
typedef struct bs_bearing {
    bs_real bearing, rise;
} bs_bearing;

static inline bs_bearing bs_bearing_of(bs_view d, bs_real ku, bs_real kw)
{
    bs_real x = d.a * ku, y = d.b * kw, way = BS_ABS(x) + BS_ABS(y) + (bs_real)1e-20; /* straight up: any bearing */
    bs_real q = y / way, right = y < 0 ? 4 + q : q;
    bs_bearing r;
    r.bearing = x < 0 ? 2 - q : right;
    r.bearing = r.bearing < 4 ? r.bearing : 0; /* rounding */
    r.rise = d.sn / way;
    return r;
}

/* Between the horizons of directions k and k + 1, where K bearing/4 = k + fraction; bilinear over (u,w) before. */
static inline bs_real bs_horizon(bs_real at_k, bs_real at_next, bs_real fraction)
{
    return at_k + (at_next - at_k) * fraction;
}

/* The mean of max(y + e q, 0) over q in -1..1. */
static inline bs_real bs_mean_above(bs_real y, bs_real e)
{
    bs_real rest = y > e ? y - e : 0, part = (y < e ? y : e) + e, inside = part > 0 ? part : 0;
    return rest + inside * inside / (4 * e);
}

/* The share of an area light above the horizon, 0..1 (ours): `above` is the rise minus the horizon in the light's
 * middle, and `u` and `w` what it changes by from there to the edge, along the light's two sides. It is the part of the
 * square -1..1 where above + u x + w y > 0; the larger of |u| and |w| counts as at least `least` > 0. */
static inline bs_real bs_horizon_share(bs_real above, bs_real u, bs_real w, bs_real least)
{
    bs_real U = BS_ABS(u), W = BS_ABS(w), large = U > W ? U : W, small = U > W ? W : U;
    bs_real by = large > least ? large : least, x = above / by, e = small / by; /* where x + p + e q > 0 */
    bs_real X = x < 3 ? x : 3, E = e > (bs_real)1e-3 ? e : (bs_real)1e-3;
    bs_real share = (bs_mean_above(X + 1, E) - bs_mean_above(X - 1, E)) / 2;
    return share < 1 ? share : 1;
}

/* MIT License. Copyright (c) 2026 The kage authors
 *
 * Permission is hereby granted, free of charge, to any person obtaining a copy
 * of this software and associated documentation files (the "Software"), to deal
 * in the Software without restriction, including without limitation the rights
 * to use, copy, modify, merge, publish, distribute, sublicense, and/or sell
 * copies of the Software, and to permit persons to whom the Software is
 * furnished to do so, subject to the following conditions:
 *
 * The above copyright notice and this permission notice shall be included in all
 * copies or substantial portions of the Software.
 *
 * THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR
 * IMPLIED, INCLUDING BUT NOT LIMITED TO THE WARRANTIES OF MERCHANTABILITY,
 * FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE
 * AUTHORS OR COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER
 * LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM,
 * OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE
 * SOFTWARE. */

#endif
