/* Cylinders, cones and tori against brute force in long double: where a ray meets them first, and what shades what.
 * Rays of every kind: anyhow, through holes, along axes and sides, grazing, from inside, from far away.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/frame.h"
#include "wave/lane.h"
#include "support/check.h"
#include "support/random_in.h"
#include "geometry/surface.h"

typedef long double wide;

/* ---- the surfaces, and the same as functions of space ---- */

typedef struct shape {
    const char *name;
    vec3 a, b;     /* the ends of the axis; a torus: centre and axis */
    double r0, r1; /* radii there; a torus: major, minor */
    bool open, torus;
} shape;

static const shape shapes[] = {
    {"cylinder", {-0.1, -0.9, 0.2}, {0.3, 0.8, -0.1}, 0.9, 0.9, false, false},
    {"open cylinder", {-0.8, 0.1, 0.2}, {0.8, -0.1, -0.1}, 0.8, 0.8, true, false},
    {"upright cylinder", {0, -1, 0}, {0, 1, 0}, 1, 1, false, false},
    {"cone", {-0.1, -0.7, 0.1}, {0.2, 0.7, 0.2}, 1.1, 0.5, false, false},
    {"pointed cone", {-0.1, 0.6, 0.1}, {0.2, -0.9, 0.2}, 1.2, 0, false, false},
    {"open cone", {-0.1, -0.2, 0.1}, {0.2, 0.6, 0.2}, 0, 1.2, true, false},
    {"torus", {0.1, -0.1, 0.2}, {0.3, 1, 0.5}, 0.9, 0.4, true, true},
    {"upright torus", {0, 0, 0}, {0, 1, 0}, 1, 0.5, true, true},
    {"thin torus", {0.1, -0.1, 0.2}, {1, 0.1, -0.2}, 1.2, 0.05, true, true},
    {"fat torus", {0.1, -0.1, 0.2}, {1, 0.1, -0.2}, 0.7, 0.69, true, true},
};
enum { SHAPES = sizeof shapes / sizeof *shapes };

static surface *make(const shape *f)
{
    return f->torus ? torus_new(f->a, f->b, f->r0, f->r1) : cone_new(f->a, f->r0, f->b, f->r1, f->open);
}

static wide dot(const wide a[3], const wide b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* How far a place is outside the side (or the torus), and how far beyond the nearer end. */
static wide outside(const shape *f, const wide X[3], wide *beyond)
{
    const vec3 v = f->torus ? f->b : vec3_sub(f->b, f->a);
    wide axis[3] = {(wide)v.x, (wide)v.y, (wide)v.z},
         d[3] = {X[0] - (wide)f->a.x, X[1] - (wide)f->a.y, X[2] - (wide)f->a.z};
    wide length = sqrtl(dot(axis, axis)), y = dot(d, axis) / length, across = dot(d, d) - y * y,
         r = sqrtl(across > 0 ? across : 0);
    *beyond = -1;
    if (f->torus)
        return hypotl(r - (wide)f->r0, y) - (wide)f->r1;
    wide rise = ((wide)f->r1 - (wide)f->r0) / length;
    *beyond = fmaxl(-y, y - length);
    return (r - (wide)f->r0 - rise * y) / sqrtl(1 + rise * rise);
}

/* 0 on the surface, and a change of sign where a ray passes through it: a solid's signed distance, or so. For an open
 * one, *counts says whether the crossing is between its ends. */
static wide gap(const shape *f, const wide r[3], const wide s[3], wide t, bool *counts)
{
    wide X[3] = {r[0] + s[0] * t, r[1] + s[1] * t, r[2] + s[2] * t}, beyond, g = outside(f, X, &beyond);
    *counts = !f->open || beyond <= 0;
    return f->open ? g : fmaxl(g, beyond);
}

/* The first crossing in from..end; -1: none. *doubt: there is nearly one before, or it is near an edge. */
static wide first_crossing(const shape *f, const wide r[3], const wide s[3], wide from, wide end, bool *doubt)
{
    enum { FINE = 6000 };
    bool counts;
    wide step = (end - from) / FINE, near = 2 * step * sqrtl(dot(s, s)), before = gap(f, r, s, from, &counts),
         last = before;
    *doubt = false;
    for (int k = 1; k <= FINE; k++) {
        wide t = from + step * k, g = gap(f, r, s, t, &counts);
        if ((g > 0) != (before > 0)) {
            wide a = t - step, b = t, X[3], beyond;
            for (int m = 0; m < 70; m++) {
                wide c = (a + b) / 2;
                if ((gap(f, r, s, c, &counts) > 0) == (before > 0))
                    a = c;
                else
                    b = c;
            }
            gap(f, r, s, a, &counts);
            for (int m = 0; m < 3; m++)
                X[m] = r[m] + s[m] * a;
            outside(f, X, &beyond);
            *doubt = *doubt || (f->open && fabsl(beyond) < 1e-5L);
            if (counts)
                return a;
        } else if (k > 1 && counts && fabsl(before) < near && fabsl(g) >= fabsl(before) && fabsl(last) >= fabsl(before))
            *doubt = true; /* a touch, or two crossings between two steps */
        last = before;
        before = g;
    }
    return -1;
}

static void widen(const rays *x, int i, wide r[3], wide s[3])
{
    r[0] = (wide)x->r.x[i], r[1] = (wide)x->r.y[i], r[2] = (wide)x->r.z[i];
    s[0] = (wide)x->s.x[i], s[1] = (wide)x->s.y[i], s[2] = (wide)x->s.z[i];
}

static vec3 somewhere(double within)
{
    return (vec3){random_in(-within, within), random_in(-within, within), random_in(-within, within)};
}

/* A ray of the kind: 0 anyhow, 1 nearly along the axis, 2 from within the shape's reach, 3 nearly across the axis, 4
 * along the coordinate axes. */
static void make_ray(const shape *f, int kind, rays *x, int i)
{
    const vec3 axis = vec3_unit(f->torus ? f->b : vec3_sub(f->b, f->a)), to = somewhere(1);
    vec3 from = vec3_scale(vec3_unit(somewhere(1)), 4);
    if (kind == 1)
        from = vec3_add(to, vec3_add(vec3_scale(axis, 3), somewhere(random_in(0, 1) < 0.5 ? 1e-3 : 0.3)));
    if (kind == 2)
        from = somewhere(0.8);
    if (kind == 3)
        from = vec3_add(to, vec3_add(vec3_scale(vec3_unit(vec3_cross(axis, somewhere(1))), 3), somewhere(1e-3)));
    if (kind == 4)
        from = vec3_add(to, i % 3 == 0 ? (vec3){3, 0, 0} : i % 3 == 1 ? (vec3){0, 3, 0} : (vec3){0, 0, -3});
    const vec3 s = vec3_scale(vec3_sub(to, from), random_in(0.3, 2));
    lane_set(&x->r, i, (bs_vec3){(real)from.x, (real)from.y, (real)from.z});
    lane_set(&x->s, i, (bs_vec3){(real)s.x, (real)s.y, (real)s.z});
}

enum { RAY_KINDS = 5 };

static void first_hits(void **state)
{
    (void)state;
    for (int k = 0; k < SHAPES; k++) {
        const shape *f = &shapes[k];
        surface *q = make(f);
        int met = 0, doubts = 0;
        double worst = 0;
        for (int kind = 0; kind < RAY_KINDS; kind++) {
            static rays x;
            static hits h;
            real lit[LANES];
            for (int i = 0; i < LANES; i++) {
                make_ray(f, kind, &x, i);
                h.t[i] = R(8);
                h.id[i] = -1;
                lit[i] = 1;
            }
            q->ops->hit(q, LANES, &x, 7, &h);
            q->ops->occlude(q, LANES, &x, lit);
            for (int i = 0; i < LANES; i++) {
                wide r[3], s[3];
                bool doubt, c;
                widen(&x, i, r, s);
                wide t = first_crossing(f, r, s, 0, 8, &doubt);
                if (doubt) {
                    doubts++;
                    continue;
                }
                wide speed = sqrtl(dot(s, s));
                wide rate =
                    t < 0 ? 1 : fabsl(gap(f, r, s, t + 1e-7L, &c) - gap(f, r, s, t - 1e-7L, &c)) / 2e-7L / speed;
                double off = (h.id[i] < 0) != (t < 0) ? 1
                             : t < 0                  ? 0
                                                      : fabs((double)(((wide)h.t[i] - t) * speed * rate));
                if (!(off <= 60 * EPS * (1 + (double)(speed * fmaxl(t, 0))))) {
                    print_error("%s: ray %d of kind %d is %g off (t %.9g, bisection %.9g)\n", f->name, i, kind, off,
                                (double)h.t[i], (double)t);
                    fail();
                }
                if (t < 0 || fabsl(t - 1) > 1e-4L)
                    assert_true(lit[i] == (t >= 0 && t < 1 ? R(0) : R(1)));
                met += t >= 0;
                worst = fmax(worst, off);
            }
        }
        print_message("%s: %d hits, farthest %.2g, %d left out near tangents and rims\n", f->name, met, worst, doubts);
        assert_true(met > (f->torus && f->r1 < 0.1 ? 30 : 250));
        CHECK(doubts, <, RAY_KINDS * LANES / 10);
        surface_free(q);
    }
}

enum { DOUBT = 9, FREE = -1, INSIDE = -2 }; /* beside the t of a crossing, which is 0 .. 1 */

/* Is the shadow ray i lit, and where does it meet the surface again, as bisection has it? The t of the crossing. */
static wide judge(const shape *f, const rays *away, int i, real lit, real again, double *worst)
{
    wide r[3], s[3];
    bool doubt, c;
    widen(away, i, r, s);
    /* from a little way off: where the gap still is small there, or has turned, nothing is said */
    wide off = 0.002L / sqrtl(dot(s, s)), g = gap(f, r, s, off, &c), slope = gap(f, r, s, off * 1.01L, &c) - g;
    wide found = first_crossing(f, r, s, off, 1, &doubt), beyond, beside = outside(f, r, &beyond);
    bool rim = fabsl(beside) < 0.003L && fabsl(beyond) < 0.003L;
    if (doubt || rim || fabsl(g) < 3e-5L || (slope > 0) != (g > 0))
        return DOUBT;
    if (!f->open && g < 0 && found < 0)
        return INSIDE; /* the light is inside */
    if (lit != (found < 0 ? R(1) : R(0))) {
        print_error("%s: from %g %g %g along %g %g %g: %g, crossing at %g\n", f->name, (double)r[0], (double)r[1],
                    (double)r[2], (double)s[0], (double)s[1], (double)s[2], (double)lit, (double)found);
        fail();
    }
    if (found >= 0) {
        const wide speed = sqrtl(dot(s, s));
        const wide rate = fabsl(gap(f, r, s, found + 1e-7L, &c) - gap(f, r, s, found - 1e-7L, &c)) / 2e-7L / speed;
        const double far = fabs((double)(((wide)again - found) * speed * rate * fminl(1, fabsl(g) * 500)));
        *worst = fmax(*worst, far);
        if (!(far <= 60 * EPS * (1 + (double)(speed * found)))) {
            print_error("%s: met again %g off (t %.9g, bisection %.9g)\n", f->name, far, (double)again, (double)found);
            fail();
        }
    }
    return found >= 0 ? found : FREE;
}

/* From hits outward and inward: the surface's shadow on itself, and where it is met again, by the crossings after the
 * start. */
static void own_shadows(void **state)
{
    (void)state;
    for (int k = 0; k < SHAPES; k++) {
        const shape *f = &shapes[k];
        surface *q = make(f);
        int dark = 0, free = 0, doubts = 0;
        double worst = 0;
        for (int round = 0; round < 8; round++) {
            static rays x, away, nowhere;
            static hits h, again;
            static ray_origins from;
            int32_t part[LANES], on[LANES];
            real t[LANES], u[LANES], w[LANES], lit[LANES];
            int n = 0;
            for (int i = 0; i < LANES; i++) {
                make_ray(f, round % RAY_KINDS, &x, i);
                h.t[i] = REAL_FAR;
                h.id[i] = -1;
            }
            q->ops->hit(q, LANES, &x, 0, &h);
            for (int i = 0; i < LANES; i++)
                t[i] = h.id[i] == 0 ? h.t[i] : R(1);
            q->ops->locate(q, LANES, &x, t, part, u, w);
            for (int i = 0; i < LANES; i++)
                if (h.id[i] == 0) {
                    const vec3 light = vec3_scale(vec3_unit(somewhere(1)), random_in(1.5, 5));
                    bs_vec3 p = lane_at(&x, i, h.t[i]);
                    lane_set(&away.r, n, p);
                    lane_set(&away.s, n, (bs_vec3){(real)light.x - p.x, (real)light.y - p.y, (real)light.z - p.z});
                    lit[n] = again.t[n] = 1;
                    again.id[n] = -1;
                    from.id[n] = 7;
                    from.part[n] = part[i];
                    on[n++] = part[i];
                }
            q->ops->occlude_own(q, n, &away, on, lit);
            from.at = away.r;
            nowhere.s = away.s;
            vec3s_fill(&nowhere.r, n, 9, 9, 9); /* it does not matter */
            q->ops->hit_own(q, n, &nowhere, &from, 7, &again);
            for (int i = 0; i < n; i++) {
                CHECK(again.id[i] == 7, ==, lit[i] == 0);
                const wide found = judge(f, &away, i, lit[i], again.t[i], &worst);
                dark += found >= 0 && found < DOUBT;
                free += found == FREE;
                doubts += found == DOUBT;
            }
        }
        print_message("%s: %d dark, met again at most %.2g off, %d lit, %d left out\n", f->name, dark, worst, free,
                      doubts);
        CHECK(dark, >, 20);
        CHECK(free, >, 20);
        CHECK(doubts, <, (dark + free) / 4);
        surface_free(q);
    }
}

/* The torus' hole is open, the ray along its axis free; one that touches the top ring along a tangent, or runs in the
 * plane that does, harms nothing; one a little below meets it. */
static void around_a_torus(void **state)
{
    (void)state;
    surface *q = torus_new((vec3){0, 0, 0}, (vec3){0, 1, 0}, 1, 0.25);
    const struct {
        double r[6];
        int met;
        double t;
    } rays_of[] = {
        {{0, 3, 0, 0, -1, 0}, 0, 0},           {{0.74, 3, 0, 0, -1, 0}, 0, 0},   {{0.76, 3, 0, 0, -1, 0}, 1, 0},
        {{1, 3, 0, 0, -2, 0}, 1, 1.375},       {{1.26, 3, 0, 0, -1, 0}, 0, 0},   {{-3, 0, 0, 1, 0, 0}, 1, 1.75},
        {{0, 0, 0, 1, 0, 0}, 1, 0.75},         {{1, 0, 0, 1, 0, 0}, 1, 0.25},    {{1, 0, 0, 0, 0, 1}, 1, 0.75},
        {{1.001, 0, -3, 0, 0, 4}, 1, 0},       {{-3, 0.2499, 0, 1, 0, 0}, 1, 0}, {{-3, 0.2501, 0, 1, 0, 0}, 0, 0},
        {{-3, 0, 1.2499, 1, 0, 0}, 1, 0},      {{-3, 0, 1.2501, 1, 0, 0}, 0, 0}, {{-3, 0, 0.7499, 1, 0, 0}, 1, 0},
        {{-3, 0.2499, 1, 1, 0, 0}, 1, 0},      {{-3, 0.2501, 1, 1, 0, 0}, 0, 0}, {{-3, 0.25, 0.9, 1, 0, 0}, -1, 0},
        {{-3, 0.25, 1, 1, 0, 0}, -1, 0},       {{0, 0, 0, 0, 1, 0}, 0, 0},       {{-3, 0, 1.25, 1, 0, 0}, -1, 0},
        {{-1e4, 0, 0, 1e3, 0, 0}, 1, 9.99875},
    };
    enum { N = sizeof rays_of / sizeof *rays_of };
    static rays x;
    static hits h;
    for (int i = 0; i < N; i++) {
        const double *r = rays_of[i].r;
        lane_set(&x.r, i, (bs_vec3){(real)r[0], (real)r[1], (real)r[2]});
        lane_set(&x.s, i, (bs_vec3){(real)r[3], (real)r[4], (real)r[5]});
        h.t[i] = REAL_FAR;
        h.id[i] = -1;
    }
    q->ops->hit(q, N, &x, 0, &h);
    for (int i = 0; i < N; i++) {
        if (rays_of[i].met >= 0)
            assert_int_equal(h.id[i] == 0, rays_of[i].met);
        if (rays_of[i].t > 0)
            NEAR((double)h.t[i], rays_of[i].t, 8 * EPS * (1 + rays_of[i].t));
        if (h.id[i] == 0) {
            bs_vec3 p = lane_at(&x, i, h.t[i]);
            double d = hypot((double)p.x, (double)p.z) - 1;
            NEAR(hypot(d, (double)p.y), 0.25, 1e-6 + 4 * EPS * fabs(rays_of[i].r[0]));
        }
    }
    surface_free(q);
}

/* What is small and far keeps its outline: no discriminant cancels. */
static void small_and_far(void **state)
{
    (void)state;
    surface *f[3] = {cone_new((vec3){1000, -0.01, 0}, 0.01, (vec3){1000, 0.01, 0}, 0.01, true),
                     cone_new((vec3){1000, 0, -0.01}, 0.0099, (vec3){1000, 0, 0.01}, 0.0101, false),
                     torus_new((vec3){1000, 0, 0}, (vec3){1, 0, 0}, 0.008, 0.002)};
    const double at[5] = {0.0061, 0.0075, 0.0099, 0.0102, 0.02};
    for (int k = 0; k < 3; k++) {
        static rays x;
        static hits h;
        for (int i = 0; i < 5; i++) {
            lane_set(&x.r, i, (bs_vec3){0, k == 0 ? 0 : (real)at[i], k == 0 ? (real)at[i] : 0});
            lane_set(&x.s, i, (bs_vec3){1, 0, 0});
            h.t[i] = REAL_FAR;
            h.id[i] = -1;
        }
        f[k]->ops->hit(f[k], 5, &x, 0, &h);
        for (int i = 0; i < 5; i++)
            assert_int_equal(h.id[i], i < 3 ? 0 : -1);
        surface_free(f[k]);
    }
}

/* From a place that is on the surface but for rounding, a light on the horizon: just over it is free, just below it
 * dark. */
static void horizons(void **state)
{
    (void)state;
    for (int k = 0; k < SHAPES; k++) {
        const shape *f = &shapes[k];
        surface *q = make(f);
        static rays x;
        static partials p;
        int32_t part[LANES];
        real u[LANES], w[LANES], lit[LANES];
        double U[2], W[2];
        q->ops->extent(q, 0, U, W);
        for (int i = 0; i < LANES; i++) {
            part[i] = 0;
            u[i] = (real)random_in(U[0], U[1]);
            w[i] = f->torus ? (real)random_in(-1, 1)
                            : (real)random_in(0.3 * W[1], 0.7 * W[1]); /* a torus bends away there */
            lit[i] = 1;
        }
        q->ops->eval(q, LANES, part, u, w, 1, &p);
        for (int i = 0; i < LANES; i++) {
            bs_vec3 n = lane_unit(bs_normal(lane_get(&p.Qu, i), lane_get(&p.Qw, i))), e = lane_unit(lane_get(&p.Qu, i));
            real tilt = i % 2 ? R(1e-3) : R(-1e-3), far = i % 3 ? R(0.3) : R(30);
            lane_set(&x.r, i, lane_get(&p.Q, i));
            lane_set(&x.s, i, (bs_vec3){far * (e.x + tilt * n.x), far * (e.y + tilt * n.y), far * (e.z + tilt * n.z)});
        }
        q->ops->occlude_own(q, LANES, &x, part, lit);
        for (int i = 0; i < LANES; i++)
            if (lit[i] != (i % 2 ? R(1) : R(0))) {
                print_error("%s: lane %d, u %g, w %g: %g\n", f->name, i, (double)u[i], (double)w[i], (double)lit[i]);
                fail();
            }
        surface_free(q);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(first_hits),    cmocka_unit_test(own_shadows), cmocka_unit_test(around_a_torus),
        cmocka_unit_test(small_and_far), cmocka_unit_test(horizons),
    };
    return cmocka_run_group_tests_name("surfaces turned about an axis", tests, NULL, NULL);
}
