/* bumpshadow.glsl: shadows of other objects on a bump-mapped surface.
 * SPDX-License-Identifier: MIT (the text is at the end)
 *
 * Made from bumpshadow.h by scripts/glsl.py: change that file, not this one. The formulas of K. Sumi and T. Noma, "A
 * Shadowing Method for Bump-Mapped Surfaces", and kage's additions (marked "ours"). For GLSL ES 3.00, GLSL 3.30 and
 * later, and Vulkan's GLSL 4.50; paste it below #version, or include it. It declares structs, functions and
 * BS_INFINITY, no uniform and no extension.
 *
 * A ray r + s t meets the smooth surface Q(u,w) at t_hit. Shade there, with the perturbed normal n'. But
 * start the shadow rays at r + s (t_hit + tau), near the point where the ray meets the rough surface
 * Q + P n/|n|:
 *
 *     vec3 n = bs_normal(Qu, Qw);
 *     vec3 np = bs_perturbed_normal(n, Qu, Qw, Pu, Pw); // shade with this
 *     bs_view v = bs_view_of(s, n, Qu, Qw);
 *     bs_bump p = bs_bump(P, Pu, Pw, 0.0, 0.0, 0.0);
 *     bs_slab b = bs_slab_of(v, Pmin, Pmax);
 *     t0 = t_hit + bs_shift_of(0, true, v, 0.0, p, b).tau; // order 0, with the guard
 *
 * Test shadows of the receiver itself from the smooth hit, those of every other object from r + s t0: a point
 * below its own smooth surface (P < 0) must not be shadowed by that surface.
 *
 * Symbols and units: Q in scene units; P the height along the unit normal n/|n|, in scene units; n = Qu x Qw
 * points to the side of +P (otherwise swap u and w); s need not be a unit vector; tau is in units of t, like
 * t_hit. The formulas hold for rays from the front (s.n < 0) and from behind. Where bs_regular does not hold (a
 * sphere's pole) use the smooth normal and tau = 0.
 */
#ifndef BUMPSHADOW_GLSL
#define BUMPSHADOW_GLSL

#ifdef GL_ES
precision highp float;
precision highp int;
#endif

/* GLSL need not have infinities. What is as large counts as infinite: where P has no bounds, give -1e38 and 1e38. */
const float BS_INFINITY = 1e30;

/* The smooth normal n = Qu x Qw, not normalised. Section 6. */
vec3 bs_normal(vec3 Qu, vec3 Qw) { return cross(Qu, Qw); }

/* Not where Qu and Qw are nearly parallel or 0, as at a sphere's pole: P has no gradient there. (Ours. The bound is on
 * |n| relative to Qu and Qw, so it does not depend on the scene's scale; below it float has no correct digit.) */
bool bs_regular(vec3 n, vec3 Qu, vec3 Qw)
{
    float e = dot(Qu, Qu) + dot(Qw, Qw);
    return dot(n, n) > 1e-14 * e * e;
}

/* The perturbed normal [Rogers 1985], not normalised. Section 6:
 *     n' = Qu x Qw + Pu (n x Qw)/|n| + Pw (Qu x n)/|n| */
vec3 bs_perturbed_normal(vec3 n, vec3 Qu, vec3 Qw, float Pu, float Pw)
{
    float il = 1.0 / sqrt(dot(n, n));
    vec3 x = cross(n, Qw), y = cross(Qu, n);
    return n + (Pu * x + Pw * y) * il;
}

/* The ray relative to the surface, per unit of t. */
struct bs_view {
    float sn;   /* s.n/|n|: towards the surface, negative from outside */
    float a, b; /* du/dt and dw/dt in the tangent plane */
};

/* a = s.(Qw x n)/|n|^2,  b = s.(n x Qu)/|n|^2 */
bs_view bs_view_of(vec3 s, vec3 n, vec3 Qu, vec3 Qw)
{
    float i2 = 1.0 / dot(n, n);
    bs_view v;
    v.sn = dot(s, n) * sqrt(i2);
    v.a = dot(s, cross(Qw, n)) * i2;
    v.b = dot(s, cross(n, Qu)) * i2;
    return v;
}

/* A place (u,w) of the surface. */
struct bs_place {
    float u, w;
};

/* The place to shade (ours), instead of the smooth hit (u0,w0): below r + s (t_hit + tau), where the shadow ray starts.
 *     (u,w) = (u0,w0) + (a,b) tau
 * Evaluate Q, P and n' there. Exact on a plane. On a curved surface take a step more: evaluate Q, Qu and Qw there, and
 * add the a and b of bs_view_of(r + s (t_hit + tau) - Q, ...). */
bs_place bs_place_of(bs_view v, float u0, float w0, float tau)
{
    bs_place p;
    p.u = u0 + v.a * tau;
    p.w = w0 + v.b * tau;
    return p;
}

/* The partials of the offset surface Q + h n/|n|, h constant (ours). With these in place of Qu and Qw, and P for h,
 * bs_perturbed_normal is the normal of the rough surface itself; with Qu and Qw it leaves out the smooth surface's
 * curvature. Nothing to do on a plane. */
struct bs_offset {
    vec3 Qu, Qw;
};

bs_offset bs_offset_of(vec3 n, vec3 Qu, vec3 Qw, vec3 Quu, vec3 Quw, vec3 Qww, float h)
{
    vec3 a = cross(Quu, Qw), b = cross(Qu, Quw), c = cross(Quw, Qw), d = cross(Qu, Qww);
    vec3 nu = a + b, nw = c + d; /* the partials of n */
    float i2 = 1.0 / dot(n, n), k = h * sqrt(i2), pu = dot(nu, n) * i2, pw = dot(nw, n) * i2;
    bs_offset o;
    o.Qu = Qu + k * (nu - pu * n);
    o.Qw = Qw + k * (nw - pw * n);
    return o;
}

/* The smooth surface's curvature along the ray, L a^2 + 2 M a b + N b^2 with the second fundamental form
 * L = Quu.n/|n|, M = Quw.n/|n|, N = Qww.n/|n|. (Ours: the paper leaves it out, section 6.) */
float bs_curvature(bs_view v, vec3 n, vec3 Quu, vec3 Quw, vec3 Qww)
{
    return (dot(Quu, n) * v.a * v.a + 2.0 * dot(Quw, n) * v.a * v.b + dot(Qww, n) * v.b * v.b) / sqrt(dot(n, n));
}

/* The perturbation and its partials at (u,w). */
struct bs_bump {
    float P, Pu, Pw, Puu, Puw, Pww;
};

/* The one equation behind every method (ours): the gap between the ray and the rough surface,
 *     gap(tau) = tau (s.n/|n|) - 1/2 (L a^2 + 2 M a b + N b^2) tau^2 - P(u0 + a tau, w0 + b tau),
 * is 0 at the shift sought. Order k replaces P by its k-th Taylor polynomial. `P` is the height looked up at
 * (u0 + a tau, w0 + b tau), `curvature` is bs_curvature or 0. */
float bs_gap(bs_view v, float curvature, float tau, float P) { return tau * v.sn - 0.5 * curvature * tau * tau - P; }

/* Order 0, a plane at height P, parallel to the tangent plane. Section 6:
 *     t0 = ((Q + P n/|n| - r).n)/(s.n),  that is  tau = P |n|/(s.n) */
float bs_tau0(bs_view v, float P) { return P / v.sn; }

/* The linear coefficient of gap, negated: Pu a + Pw b - s.n/|n| = -(s.n')/|n|. From the front it is positive where
 * the ray enters the rough surface's tangent plane. */
float bs_slope(bs_view v, bs_bump p) { return p.Pu * v.a + p.Pw * v.b - v.sn; }

/* Order 1, the tangent plane of the rough surface at Q + P n/|n|. Section 6:
 *     t0 = ((Q + P n/|n| - r).n')/(s.n'),  that is  tau = P |n|/(s.n'),
 * as Q - r = s t_hit, and n.n' = |n|^2. */
float bs_tau1(bs_view v, bs_bump p) { return -p.P / bs_slope(v, p); }

/* The quadratic of order 2,  A tau^2 + B tau + P = 0, with B = bs_slope and
 *     A = 1/2 (Puu a^2 + Pww b^2)                   in the paper (section 4.1 drops Puw), and
 *     A = 1/2 (Puu a^2 + 2 Puw a b + Pww b^2 + L a^2 + 2 M a b + N b^2)   in 2+ (ours). */
float bs_quadratic(bs_view v, bs_bump p) { return 0.5 * (p.Puu * v.a * v.a + p.Pww * v.b * v.b); }

float bs_quadratic_plus(bs_view v, bs_bump p, float curvature)
{
    return bs_quadratic(v, p) + p.Puw * v.a * v.b + 0.5 * curvature;
}

/* B^2 - 4 A P: negative where the ray does not meet the quadric. */
float bs_discriminant(float A, float B, float P) { return B * B - 4.0 * A * P; }

/* The root that tends to order 1 as A -> 0, without cancellation:
 *     tau = -2 P/(B + sqrt(B^2 - 4 A P)),
 * with a minus before the square root where the ray comes from behind. */
float bs_tau2(bs_view v, float B, float discriminant, float P)
{
    float root = sqrt(discriminant);
    return -2.0 * P / (B + (v.sn < 0.0 ? root : -root));
}

/* The slab (ours): the true hit lies between the surfaces offset by Pmin and by Pmax, so tau lies between the
 * ray's hits of these. */
struct bs_slab {
    float front, back; /* as tau; front is the viewer's side */
};

bs_slab bs_slab_of(bs_view v, float Pmin, float Pmax)
{
    float x = Pmin / v.sn, y = Pmax / v.sn;
    bs_slab b;
    b.front = x < y ? x : y;
    b.back = x < y ? y : x;
    return b;
}

/* A shift and its order. */
struct bs_shift {
    float tau;
    int order; /* the order really used: 0, 1, 2, or 3 for 2+ */
};

/* The shift by order 0, 1, 2 or 3 (2+). `guard` (ours, the default of kage): where the result is outside the
 * slab, or the ray does not enter the tangent plane (s.n' >= 0 from the front, that is B <= 0), 3 and 2 fall back to 1,
 * 1 to 0; order 0 is always inside. Without the guard only order 2 falls back, to 1, where it has no real root near
 * that of order 1 (B <= 0, or B^2 < 4 A P). Only order 3 uses `curvature`. Call it with a constant order and guard, so
 * that the rest is compiled away. */
bs_shift bs_shift_of(int order, bool guard, bs_view v, float curvature, bs_bump p, bs_slab slab)
{
    float B = bs_slope(v, p), down = v.sn < 0.0 ? B : -B;
    bs_shift s;
    s.tau = bs_tau0(v, p.P);
    s.order = 0;
    if (order >= 1) {
        float tau = bs_tau1(v, p);
        bool good = !guard || (down > 0.0 && tau >= slab.front && tau <= slab.back);
        s.tau = good ? tau : s.tau;
        s.order = good ? 1 : s.order;
    }
    if (order >= 2) {
        float A = order == 3 ? bs_quadratic_plus(v, p, curvature) : bs_quadratic(v, p);
        float discriminant = bs_discriminant(A, B, p.P), tau = bs_tau2(v, B, discriminant, p.P);
        /* there is a real root, and it is the one near order 1's */
        bool good = discriminant >= 0.0 && down > 0.0;
        good = guard ? good && tau >= slab.front && tau <= slab.back : good;
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
 *         float tau = bs_march_tau(slab, i, N);
 *         m = bs_march_step(m, tau, bs_gap(v, curvature, tau, height(u0 + v.a * tau, w0 + v.b * tau)), v);
 *     }
 *     // m.found: m.tau is the shift. Otherwise use order 0: the slab is infinite, or the smooth surface curves
 *     // away from it, or P is flat at Pmin, where order 0 is exact.
 */
struct bs_march {
    float tau; /* the last point above the surface; once found, the shift; infinite where the slab is */
    float gap; /* at that point */
    bool found;
};

/* Whether the slab is finite. It is not where P has no bounds or s.n is 0. */
bool bs_slab_ends(bs_slab slab) { return slab.back - slab.front < BS_INFINITY; }

bs_march bs_march_start(bs_slab slab)
{
    bs_march m;
    m.tau = bs_slab_ends(slab) ? slab.front : BS_INFINITY;
    m.gap = 0.0;
    m.found = false;
    return m;
}

/* Step i of 0..N; the last is exactly slab.back. In an infinite slab all are 0, where P can be evaluated; nothing is
 * found then. */
float bs_march_tau(bs_slab slab, int i, int N)
{
    float tau = i == N ? slab.back : slab.front + (slab.back - slab.front) * (float(i) / float(N));
    return bs_slab_ends(slab) ? tau : 0.0;
}

bs_march bs_march_step(bs_march m, float tau, float gap, bs_view v)
{
    float above = v.sn < 0.0 ? gap : -gap; /* from behind the gap has the opposite sign */
    bool looking = !m.found && m.tau < BS_INFINITY, hit = looking && above <= 0.0;
    float rise = m.gap - above; /* > 0 at a hit, except at step 0, where m.tau is tau */
    float secant = m.tau + (tau - m.tau) * (rise > 0.0 ? m.gap / rise : 0.0);
    m.tau = hit ? secant : looking ? tau : m.tau;
    m.gap = m.found ? m.gap : above;
    m.found = m.found || hit;
    return m;
}

/* ---- what a place leaves (ours) ----
 *
 * How far is a shift, by whichever method, from the rough surface? Look P, Pu and Pw up once more, at bs_place_of(v,
 * u0, w0, tau). There bs_gap is the height that is left. Over the gap's slope it is what tau lacks: */
float bs_residual(bs_view v, float curvature, float tau, bs_bump there)
{
    return bs_gap(v, curvature, tau, there.P) / (bs_slope(v, there) + curvature * tau);
}

/* Added to tau it is Newton's step. So many pixels is the shadow's edge off by it, where s is the viewing ray's
 * direction, d that to the light, and `pixel` the size of a pixel at the hit, in scene units: |s| times the sine
 * between view and light, over that size, for each unit of tau. */
float bs_pixels(vec3 s, vec3 d, float pixel, float residual)
{
    vec3 across = cross(s, d);
    return abs(residual) * sqrt(dot(across, across) / dot(d, d)) / pixel;
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
 *     bs_way y = bs_way_of(v.sn < 0.0 ? 1.0 : -1.0, d, bs_curvature(d, n, Quu, Quw, Qww), P, Pmin, Pmax);
 *     bool dark = y.side * dot(np, light - X) <= 0.0;
 *     for (int i = 1; i <= N; i++) {
 *         float t = bs_way_step(y.end, i, N);
 *         dark = dark || bs_way_below(y, t, height(u + y.d.a * t, w + y.d.b * t));
 *     }
 *
 * It starts on the rough surface itself, and needs no epsilon: it compares the way's rise since X with P's, and both
 * are 0 at t = 0. Which side the way leaves to is known from n'.
 */
struct bs_way {
    float side;      /* of the viewer, 1: the front, -1: the back. What follows is as seen from that side: */
    bs_view d;       /* to the light; d.sn > 0: the light is above the tangent plane */
    float curvature; /* along d */
    float P;         /* at X, from the front */
    float end;       /* t at which the way leaves the slab, at most 1 */
};

/* The t at which a way has risen by D >= 0, or is highest, where the surface rises more and it never gets there. At
 * most 1, the light. */
float bs_way_to(bs_view d, float curvature, float D)
{
    float k = -0.5 * curvature, q = d.sn * d.sn + 4.0 * k * D, root = sqrt(q > 0.0 ? q : 0.0);
    float rising = q >= 0.0 ? 2.0 * D / (d.sn + root) : d.sn / curvature; /* the first root of k t^2 + sn t = D */
    float dipping = k > 0.0 ? (root - d.sn) / (2.0 * k) : 1.0;
    float t = d.sn > 0.0 ? rising : dipping;
    return t < 1.0 ? t : 1.0;
}

bs_way bs_way_of(float side, bs_view d, float curvature, float P, float Pmin, float Pmax)
{
    bs_way y;
    y.side = side;
    y.d = d;
    y.d.sn = side * d.sn;
    y.curvature = side * curvature;
    y.P = P;
    y.end = bs_way_to(y.d, y.curvature, side > 0.0 ? Pmax - P : P - Pmin);
    return y;
}

/* On a curved surface a straight way is a curve in (u,w), to second order (u + a t + A t^2, w + b t + B t^2): Q + h
 * n/|n| does not accelerate, so what the partials of Q and of n/|n| add along (a,b) is made up for. a and b are best
 * those of bs_view_of at X's own height, with bs_offset_of's Qu and Qw. On a plane A = B = 0. */
struct bs_turn {
    float A, B;
};

bs_turn bs_turn_of(bs_view d, vec3 n, vec3 Qu, vec3 Qw, vec3 Quu, vec3 Quw, vec3 Qww)
{
    bs_offset o = bs_offset_of(n, Qu, Qw, Quu, Quw, Qww, 1.0); /* less Qu and Qw: the partials of n/|n| */
    float aa = d.a * d.a, ab = 2.0 * d.a * d.b, bb = d.b * d.b, ua = 2.0 * d.sn * d.a, wb = 2.0 * d.sn * d.b;
    vec3 x = Quu * aa + Quw * ab + Qww * bb + (o.Qu - Qu) * ua + (o.Qw - Qw) * wb;
    bs_view v = bs_view_of(x, n, Qu, Qw);
    bs_turn r;
    r.A = -0.5 * v.a;
    r.B = -0.5 * v.b;
    return r;
}

/* The place of step i of 1..N: near X they are denser, as there P is nearest to the way. */
float bs_way_step(float end, int i, int N)
{
    float x = float(i) / float(N);
    return end * x * x;
}

/* Whether the way is below P at t. */
bool bs_way_below(bs_way y, float t, float P) { return bs_gap(y.d, y.curvature, t, y.side * (P - y.P)) < 0.0; }

/* Max's horizon map. For K directions in (u,w), bearing k of which is 4 k/K, a table holds for each place the horizon:
 * the most that P rises from there, per unit of the way. Directions and ways are measured in samples, by their sum:
 * with ku and kw samples per u and per w,
 *     x = ku a, y = kw b, per unit of |x| + |y|,
 * so that a bearing needs no angle, a map on a sphere needs no scene units, and between two directions next to each
 * other a slope that is the same all around is interpolated exactly. bearing: 0 along +u, 1 along +w, 2 and 3 against
 * them, less than 4. rise: of the way to the light. The light is seen where its rise is above the horizon. */
struct bs_bearing {
    float bearing, rise;
};

bs_bearing bs_bearing_of(bs_view d, float ku, float kw)
{
    float x = d.a * ku, y = d.b * kw, way = abs(x) + abs(y) + 1e-20; /* straight up: any bearing */
    float q = y / way, right = y < 0.0 ? 4.0 + q : q;
    bs_bearing r;
    r.bearing = x < 0.0 ? 2.0 - q : right;
    r.bearing = r.bearing < 4.0 ? r.bearing : 0.0; /* rounding */
    r.rise = d.sn / way;
    return r;
}

/* Between the horizons of directions k and k + 1, where K bearing/4 = k + fraction; bilinear over (u,w) before. */
float bs_horizon(float at_k, float at_next, float fraction) { return at_k + (at_next - at_k) * fraction; }

/* The mean of max(y + e q, 0) over q in -1..1. */
float bs_mean_above(float y, float e)
{
    float rest = y > e ? y - e : 0.0, part = (y < e ? y : e) + e, inside = part > 0.0 ? part : 0.0;
    return rest + inside * inside / (4.0 * e);
}

/* The share of an area light above the horizon, 0..1 (ours): `above` is the rise minus the horizon in the light's
 * middle, and `u` and `w` what it changes by from there to the edge, along the light's two sides. It is the part of the
 * square -1..1 where above + u x + w y > 0; the larger of |u| and |w| counts as at least `least` > 0. */
float bs_horizon_share(float above, float u, float w, float least)
{
    float U = abs(u), W = abs(w), large = U > W ? U : W, small = U > W ? W : U;
    float by = large > least ? large : least, x = above / by, e = small / by; /* where x + p + e q > 0 */
    float X = x < 3.0 ? x : 3.0, E = e > 1e-3 ? e : 1e-3;
    float share = (bs_mean_above(X + 1.0, E) - bs_mean_above(X - 1.0, E)) / 2.0;
    return share < 1.0 ? share : 1.0;
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
