/* True displacement: the first hits against bisection in long double, on every surface, for functions and maps; normals
 * against differences; shadows of a rough surface on itself.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "support/check.h"
#include "support/bump_of_map.h"
#include "base/frame.h"
#include "wave/lane.h"
#include "method/method.h"
#include "support/displace.h"
#include "support/random_in.h"

/* The agreement asked for, in scene units; the scenes are about 6 wide. */
#ifdef KAGE_DOUBLE
#define AGREE (1e-10 * 6)
#else
#define AGREE (1e-5 * 6)
#endif

typedef long double wide;

/* ---- an independent reading of the surfaces and bumps, in long double ---- */

enum { PLANE, RECTANGLE, BOX, SPHERE, DISC, DRUM, TUBE, BELL, CUP, TORUS, SURFACES };
static const char *const names[] = {"plane",    "rectangle",     "box",  "sphere",    "disc",
                                    "cylinder", "open cylinder", "cone", "open cone", "torus"};
static const int parts[] = {1, 1, 6, 1, 1, 3, 1, 3, 1, 1};
enum { SMOOTH_BUMP, MAP_BUMP, BUMPS };
enum { MAP = 16 };
static float samples[MAP * MAP];

static const double plane_O[3] = {-2, 0.1, -2}, plane_U[3] = {0.3, 0.1, 4}, plane_W[3] = {4, -0.1, 0.5};
static const double box_lo[3] = {-1.2, -0.9, -1}, box_hi[3] = {1.1, 1, 1.2};
static const double sphere_C[3] = {0.1, -0.2, 0.3}, sphere_R = 1.6;

/* The ends of the axes and their radii (a torus: centre and axis, major and minor; a disc: centre and normal, radius),
 * from DISC on. */
typedef struct turned {
    vec3 a, b;
    double r[2];
} turned;
static const turned turns[] = {
    {{0.1, -0.1, 0.2}, {0.3, 1, -0.2}, {1.7, 0}},     {{0.2, -1.1, 0.1}, {-0.1, 1, 0.2}, {1.2, 1.2}},
    {{-1.2, -0.1, 0.1}, {1.1, 0.3, 0.2}, {1.1, 1.1}}, {{0.2, -1, 0.1}, {-0.1, 0.9, 0.2}, {1.5, 0.8}},
    {{0.1, -0.9, 0.1}, {-0.1, 0.9, 0.2}, {0.7, 1.6}}, {{0.1, 0.1, -0.1}, {0.3, 1, 0.2}, {1.3, 0.5}},
};

/* P, (u,w) scaled so that each kind of surface has some bumps. */
static wide bump_at(int kind, int bumped, wide u, wide w)
{
    wide k = kind == SPHERE ? 1 : kind >= DISC ? 2 : 6;
    if (bumped == SMOOTH_BUMP)
        return 0.06L * (sinl(2 * k * u) * cosl(k * w) + 0.5L * sinl(k * w + 1));
    /* the bilinear surface through the samples, repeated 2 x 1 over the extent */
    const wide pi = 3.14159265358979323846L;
    wide eu = kind >= SPHERE ? pi : 0.5L,
         ew = kind == SPHERE ? pi
              : kind >= DISC ? pi / 2
                             : 1,
         u0 = kind >= SPHERE ? -pi : 0;
    wide x = (u - u0) / eu * MAP - 0.5L, y = w / ew * MAP - 0.5L;
    wide fx = floorl(x), fy = floorl(y), a = x - fx, b = y - fy;
    int i = (int)(((long)fx % MAP + MAP) % MAP), j = (int)(((long)fy % MAP + MAP) % MAP), i1 = (i + 1) % MAP,
        j1 = (j + 1) % MAP;
    wide top = (wide)samples[j * MAP + i] * (1 - a) + (wide)samples[j * MAP + i1] * a;
    wide low = (wide)samples[j1 * MAP + i] * (1 - a) + (wide)samples[j1 * MAP + i1] * a;
    return 0.15L * (top * (1 - b) + low * b - 0.5L);
}

/* The foot of X on a part of a surface about an axis, and the height over it. */
static wide turned_closest(int kind, int part, const wide X[3], wide *u, wide *w, int *inside)
{
    const turned *f = &turns[kind - DISC];
    const vec3 axis = kind == DISC || kind == TORUS ? f->b : vec3_sub(f->b, f->a);
    const frame a = frame_about(axis);
    const vec3 unit[3] = {a.x, a.y, a.z};
    const wide R0 = (wide)f->r[0], R1 = (wide)f->r[1];
    wide p[3], l = sqrtl((wide)axis.x * (wide)axis.x + (wide)axis.y * (wide)axis.y + (wide)axis.z * (wide)axis.z);
    for (int k = 0; k < 3; k++)
        p[k] = (X[0] - (wide)f->a.x) * (wide)unit[k].x + (X[1] - (wide)f->a.y) * (wide)unit[k].y +
               (X[2] - (wide)f->a.z) * (wide)unit[k].z;
    const wide d = hypotl(p[0], p[2]);
    if (kind == TORUS) {
        *u = atan2l(p[2], p[0]);
        *w = atan2l(-p[1], d - R0);
        return hypotl(d - R0, p[1]) - R1;
    }
    if (kind == DISC || part > 0) {
        const bool low = part == 2;
        *u = p[0];
        *w = low ? p[2] : -p[2];
        *inside = d <= (part == 1 ? R1 : R0);
        return kind == DISC ? p[1] : low ? -p[1] : p[1] - l;
    }
    const wide side = hypotl(l, R0 - R1), s = (R0 - R1) / side, c = l / side;
    *u = atan2l(p[2], p[0]);
    *w = (d - R1) * s + (l - p[1]) * c;
    *inside = *w >= 0 && *w <= side;
    return (d - R1) * c - (l - p[1]) * s;
}

/* Height over a part less P, and whether the foot is on it. */
static wide gap_at(int kind, int bumped, int part, const wide X[3], int *inside)
{
    wide u, w, h;
    *inside = 1;
    if (kind == SPHERE) {
        wide d[3] = {X[0] - (wide)sphere_C[0], X[1] - (wide)sphere_C[1], X[2] - (wide)sphere_C[2]};
        u = atan2l(d[2], d[0]);
        w = atan2l(hypotl(d[0], d[2]), d[1]);
        h = sqrtl(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) - (wide)sphere_R;
    } else if (kind >= DISC) {
        h = turned_closest(kind, part, X, &u, &w, inside);
    } else if (kind == BOX) {
        int k = part / 2, high = part % 2, a = (k + (high ? 1 : 2)) % 3, b = (k + (high ? 2 : 1)) % 3;
        u = (X[a] - (wide)box_lo[a]) / ((wide)box_hi[a] - (wide)box_lo[a]);
        w = (X[b] - (wide)box_lo[b]) / ((wide)box_hi[b] - (wide)box_lo[b]);
        h = high ? X[k] - (wide)box_hi[k] : (wide)box_lo[k] - X[k];
        *inside = u >= 0 && u <= 1 && w >= 0 && w <= 1;
    } else {
        /* least squares: the foot of X in the plane of U and W */
        wide uu = 0, uw = 0, ww = 0, du = 0, dw = 0, n[3], l = 0;
        for (int k = 0; k < 3; k++) {
            wide d = X[k] - (wide)plane_O[k], U = (wide)plane_U[k], W = (wide)plane_W[k];
            uu += U * U, uw += U * W, ww += W * W, du += d * U, dw += d * W;
        }
        wide det = uu * ww - uw * uw;
        u = (du * ww - dw * uw) / det;
        w = (dw * uu - du * uw) / det;
        for (int k = 0; k < 3; k++) {
            int i = (k + 1) % 3, j = (k + 2) % 3;
            n[k] = (wide)plane_U[i] * (wide)plane_W[j] - (wide)plane_U[j] * (wide)plane_W[i];
            l += n[k] * n[k];
        }
        h = 0;
        for (int k = 0; k < 3; k++)
            h += (X[k] - (wide)plane_O[k]) * n[k] / sqrtl(l);
        *inside = kind == PLANE || (u >= 0 && u <= 1 && w >= 0 && w <= 1);
    }
    return h - bump_at(kind, bumped, u, w);
}

static wide gap_on_ray(int kind, int bumped, int part, const wide r[3], const wide s[3], wide t, int *inside)
{
    wide X[3] = {r[0] + s[0] * t, r[1] + s[1] * t, r[2] + s[2] * t};
    return gap_at(kind, bumped, part, X, inside);
}

/* The first crossing in 0..end by many small steps and bisection; -1: none. *doubt: the gap is nearly 0 somewhere
 * without crossing before, or crosses twice within a few steps, so that rounding may decide otherwise. */
static wide first_crossing(int kind, int bumped, const wide r[3], const wide s[3], wide end, int *doubt)
{
    enum { FINE = 3000 };
    const wide NEAR = 0.006L; /* what the gap changes within a step */
    wide best = -1, touch = end;
    *doubt = 0;
    for (int part = 0; part < parts[kind]; part++) {
        int in, was_in = 0;
        wide before = 0;
        for (int k = 0; k <= FINE; k++) {
            wide t = end * k / FINE, g = gap_on_ray(kind, bumped, part, r, s, t, &in);
            if (in && was_in && (g > 0) != (before > 0)) {
                wide a = end * (k - 1) / FINE, b = t;
                for (int m = 0; m < 80; m++) {
                    wide c = (a + b) / 2;
                    int x;
                    if ((gap_on_ray(kind, bumped, part, r, s, c, &x) > 0) == (before > 0))
                        a = c;
                    else
                        b = c;
                }
                if (best < 0 || a < best)
                    best = a;
                break;
            }
            if (in != was_in && k > 0 && fabsl(g) < 0.01L)
                touch = t < touch ? t : touch; /* crosses near an edge of the part */
            if (in && was_in && fabsl(before) < NEAR && fabsl(g) > fabsl(before))
                touch = t < touch ? t : touch; /* turns back before it, or dips through it between two steps */
            before = g;
            was_in = in;
        }
    }
    *doubt = touch < end && (best < 0 || touch < best);
    return best;
}

/* ---- the same in kage ---- */

static surface *make_surface(int surface_kind)
{
    const vec3 O = {plane_O[0], plane_O[1], plane_O[2]}, U = {plane_U[0], plane_U[1], plane_U[2]};
    const vec3 W = {plane_W[0], plane_W[1], plane_W[2]};
    if (surface_kind == BOX)
        return box_new((vec3){box_lo[0], box_lo[1], box_lo[2]}, (vec3){box_hi[0], box_hi[1], box_hi[2]});
    const turned *t = &turns[surface_kind < DISC ? 0 : surface_kind - DISC];
    if (surface_kind == DISC)
        return disc_new(t->a, t->b, t->r[0]);
    if (surface_kind == TORUS)
        return torus_new(t->a, t->b, t->r[0], t->r[1]);
    if (surface_kind > DISC)
        return cone_new(t->a, t->r[0], t->b, t->r[1], surface_kind == TUBE || surface_kind == CUP);
    if (surface_kind == SPHERE)
        return sphere_new((vec3){sphere_C[0], sphere_C[1], sphere_C[2]}, sphere_R);
    return plane_new(O, U, W, surface_kind == RECTANGLE);
}

static bump *make_bump(int surface_kind, int bumped, const surface *f)
{
    double u[2], w[2];
    f->ops->extent(f, 0, u, w);
    if (f->ops->parts > 1 && surface_kind != BOX) { /* more than its side has */
        u[0] = w[0] = -HUGE_VAL;
        u[1] = w[1] = HUGE_VAL;
    }
    if (bumped == SMOOTH_BUMP) {
        expr_error e;
        return bump_function_new(expr_parse(surface_kind == SPHERE ? "0.06*(sin(2*u)*cos(w) + 0.5*sin(w+1))"
                                            : surface_kind >= DISC ? "0.06*(sin(4*u)*cos(2*w) + 0.5*sin(2*w+1))"
                                                                   : "0.06*(sin(12*u)*cos(6*w) + 0.5*sin(6*w+1))",
                                            &e),
                                 1, u, w);
    }
    uint32_t state = 4711;
    for (int i = 0; i < MAP * MAP; i++) {
        state = state * 1664525u + 1013904223u;
        samples[i] = (float)(state >> 8) / 16777216.0f;
    }
    image m = {MAP, MAP, samples};
    const double pi = 3.14159265358979323846;
    map_layout l = {.size = {surface_kind >= SPHERE ? pi : 0.5, surface_kind == SPHERE ? pi
                                                                : surface_kind >= DISC ? pi / 2
                                                                                       : 1},
                    .scale = 0.15,
                    .zero = 0.5};
    l.offset[0] = surface_kind >= SPHERE ? -pi : 0;
    return bump_of_map(&m, &l);
}

static void random_ray(rays *x, int i, wide r[3], wide s[3])
{
    double a = random_in(0, 6.283), y = random_in(-0.9, 0.9), l = 3.5 * sqrt(1 - y * y), k = random_in(0.3, 2);
    double from[3] = {l * cos(a), 3.5 * y, l * sin(a)};
    x->r.x[i] = (real)from[0], x->r.y[i] = (real)from[1], x->r.z[i] = (real)from[2];
    x->s.x[i] = (real)(k * (random_in(-1.3, 1.3) - from[0]));
    x->s.y[i] = (real)(k * (random_in(-1, 1) - from[1]));
    x->s.z[i] = (real)(k * (random_in(-1.3, 1.3) - from[2]));
    bs_vec3 R = lane_get(&x->r, i), S = lane_get(&x->s, i);
    r[0] = (wide)R.x, r[1] = (wide)R.y, r[2] = (wide)R.z;
    s[0] = (wide)S.x, s[1] = (wide)S.y, s[2] = (wide)S.z;
}

static void random_wave(rays *x, hits *h, wide r[LANES][3], wide s[LANES][3])
{
    for (int i = 0; i < LANES; i++) {
        random_ray(x, i, r[i], s[i]);
        h->t[i] = R(3);
        h->id[i] = -1;
    }
}

static void hits_agree_with_bisection(void **state)
{
    (void)state;
    for (int kind = 0; kind < SURFACES; kind++)
        for (int bumped = 0; bumped < BUMPS; bumped++) {
            surface *f = make_surface(kind);
            bump *P = make_bump(kind, bumped, f);
            assert_true(displaced_has_bounds(P));
            displaced_counts counts = {0};
            surface *bumpy = displace(f, P, &counts);
            int met = 0, passed = 0, doubts = 0;
            double worst = 0;
            for (int round = 0; round < 4; round++) {
                static rays x;
                static hits h;
                wide r[LANES][3], s[LANES][3];
                random_wave(&x, &h, r, s);
                bumpy->ops->hit(bumpy, LANES, &x, 5, &h);
                for (int i = 0; i < LANES; i++) {
                    int doubt;
                    wide t = first_crossing(kind, bumped, r[i], s[i], 3, &doubt);
                    double length = sqrt((double)(s[i][0] * s[i][0] + s[i][1] * s[i][1] + s[i][2] * s[i][2]));
                    double off = h.id[i] < 0 || t < 0 ? ((h.id[i] < 0) == (t < 0) ? 0 : 1)
                                                      : fabs((double)((wide)h.t[i] - t)) * length;
                    if (doubt) {
                        doubts++;
                        continue;
                    }
                    /* where the ray hits at a flat angle the gap is 0 to rounding over a longer stretch */
                    int x1, x2;
                    int part = h.id[i] < 0 ? 0 : h.part[i];
                    wide rate = fabsl(gap_on_ray(kind, bumped, part, r[i], s[i], t + 1e-6L, &x1) -
                                      gap_on_ray(kind, bumped, part, r[i], s[i], t - 1e-6L, &x2)) /
                                2e-6L / (wide)length;
                    if (!(off * fmin(1, (double)rate * 4) <= AGREE)) {
                        print_error(
                            "%s, %s: ray %d of round %d is %g off (t %.9g, bisection %.9g, gap per length %g)\n",
                            names[kind], bumped ? "map" : "function", i, round, off, (double)h.t[i], (double)t,
                            (double)rate);
                        fail();
                    }
                    if (off < 1)
                        worst = fmax(worst, off);
                    met += t >= 0;
                    passed += t < 0;
                }
            }
            print_message(
                "%s, %s: %d hits, %d misses, farthest %.2g, %d left out near edges and tangents, %ld uncertain\n",
                names[kind], bumped ? "map" : "function", met, passed, worst, doubts, counts.uncertain);
            CHECK(met, >, 150);
            CHECK(doubts, <, 4 * LANES / 8);
            assert_int_equal(counts.uncertain, 0);
            surface_free(bumpy);
            bump_free(P);
            surface_free(f);
        }
}

/* The normal is the gradient of the gap in space. */
static void normals_are_gradients(void **state)
{
    (void)state;
    for (int kind = 0; kind < SURFACES; kind++) {
        surface *f = make_surface(kind);
        bump *P = make_bump(kind, SMOOTH_BUMP, f);
        static hit_group g;
        static hits h;
        displaced_counts counts = {0};
        surface *bumpy = displace(f, P, &counts);
        wide r[LANES][3], s[LANES][3];
        hit_group_picked(&g);
        random_wave(&g.picked.x, &h, r, s);
        bumpy->ops->hit(bumpy, LANES, g.x, 0, &h);
        g.n = LANES;
        for (int i = 0; i < LANES; i++) {
            g.picked.t[i] = h.id[i] == 0 ? h.t[i] : R(1);
            g.part[i] = h.id[i] == 0 ? h.part[i] : 0;
        }
        displaced_shape(bumpy, &g);
        for (int i = 0; i < LANES; i++) {
            if (h.id[i] < 0)
                continue;
            bs_vec3 X = lane_get(&g.q.Q, i), n = lane_get(&g.n_bump, i);
            wide d[3], l = 0;
            for (int k = 0; k < 3; k++) {
                int in;
                wide a[3] = {(wide)X.x, (wide)X.y, (wide)X.z}, b[3] = {(wide)X.x, (wide)X.y, (wide)X.z};
                a[k] += 1e-6L;
                b[k] -= 1e-6L;
                d[k] = gap_at(kind, SMOOTH_BUMP, g.part[i], a, &in) - gap_at(kind, SMOOTH_BUMP, g.part[i], b, &in);
                l += d[k] * d[k];
            }
            l = sqrtl(l);
            double off = fabs((double)(d[0] / l - (wide)n.x)) + fabs((double)(d[1] / l - (wide)n.y)) +
                         fabs((double)(d[2] / l - (wide)n.z));
            CHECK(off, <, 2e-5);
            CHECK(g.order[i], ==, ORDER_EXACT);
            CHECK(g.tau[i], ==, 0);
        }
        surface_free(bumpy);
        bump_free(P);
        surface_free(f);
    }
}

/* From hits towards a light: the rough surface's own shadow against bisection, beginning at the hit; and rays that
 * leave it towards the light meet it again where it shades itself. */
static void own_shadows(void **state)
{
    (void)state;
    for (int kind = 0; kind < SURFACES; kind++) {
        surface *f = make_surface(kind);
        bump *P = make_bump(kind, MAP_BUMP, f);
        static rays x, up;
        static hits h, again;
        static ray_origins from;
        displaced_counts counts = {0};
        surface *bumpy = displace(f, P, &counts);
        int dark = 0, lights = 0, wrong = 0, n = 0;
        int32_t on[LANES];
        wide r[LANES][3], s[LANES][3];
        real lit[LANES];
        random_wave(&x, &h, r, s);
        bumpy->ops->hit(bumpy, LANES, &x, 0, &h);
        for (int i = 0; i < LANES; i++)
            if (h.id[i] == 0) {
                bs_vec3 X = lane_at(&x, i, h.t[i]), d = {R(-5) - X.x, R(1.2) - X.y, R(-3) - X.z};
                lane_set(&up.r, n, X);
                lane_set(&up.s, n, d);
                wide near_by[3] = {(wide)X.x + (wide)d.x * 1e-4L, (wide)X.y + (wide)d.y * 1e-4L,
                                   (wide)X.z + (wide)d.z * 1e-4L};
                int in;
                on[n] = from.part[n] = h.part[i];
                from.id[n] = 5;
                again.id[n] = -1;
                again.t[n] = 1;
                lit[n++] = gap_at(kind, MAP_BUMP, h.part[i], near_by, &in) > 0 ? R(1) : R(0); /* turned to the light */
            }
        bumpy->ops->hit_own(bumpy, n, &up, &from, 5, &again);
        for (int i = 0; i < n; i++)
            from.at.x[i] = lit[i]; /* no more needed as a place: whether it is turned to the light */
        bumpy->ops->occlude_own(bumpy, n, &up, on, lit);
        for (int i = 0; i < n; i++) {
            bs_vec3 X = lane_get(&up.r, i), D = lane_get(&up.s, i);
            wide o[3] = {(wide)X.x, (wide)X.y, (wide)X.z}, d[3] = {(wide)D.x, (wide)D.y, (wide)D.z};
            int doubt, want = 1;
            /* a little off the surface, and what is left of the segment */
            wide off = 0.004L;
            for (int k = 0; k < 3; k++) {
                o[k] += d[k] * off;
            }
            int in, below = gap_at(kind, MAP_BUMP, on[i], o, &in) < 0 && in;
            want = !(below || first_crossing(kind, MAP_BUMP, o, d, 1 - off, &doubt) >= 0);
            if (from.at.x[i] > 0)
                wrong += (again.id[i] == 5) != (lit[i] == 0);
            wrong += (lit[i] > 0) != want;
            dark += !want;
            lights += want;
        }
        print_message("%s: %d lit, %d dark, %d otherwise than by bisection\n", names[kind], lights, dark, wrong);
        assert_true(dark > 10 && lights > 5);
        assert_true(wrong <= n / 20); /* the bisection's own start, 0.004 off */
        surface_free(bumpy);
        bump_free(P);
        surface_free(f);
    }
}

/* ---- rays that leave a rough surface ---- */

/* Where a ray is clearly off the surface that it has left, and the gap's least change from there back to it, in scene
 * units: float's hit is within 5e-6 of the surface. */
#define CLEAR 2e-4L

/* As first_crossing, for a ray that starts on `own`'s rough surface: from where it has clearly left that. *doubt, too:
 * it turns back or goes through to the other side before, or begins near an edge. */
static wide next_crossing(int kind, int bumped, int own, const wide r[3], const wide s[3], wide end, int *doubt)
{
    enum { FINE = 1500 };
    const wide NEAR = 0.012L;
    wide best = -1, touch = end;
    for (int part = 0; part < parts[kind]; part++) {
        int in, was_in = 0, left = part != own;
        wide before = 0, last = 0;
        const wide way_off =
            gap_on_ray(kind, bumped, part, r, s, 1e-6L, &in) - gap_on_ray(kind, bumped, part, r, s, -1e-6L, &in);
        if (!left && !in)
            touch = 0;
        for (int k = 0; k <= FINE; k++) {
            wide t = end * k / FINE * k / FINE, a = end * (k - 1) / FINE * (k - 1) / FINE,
                 g = gap_on_ray(kind, bumped, part, r, s, t, &in);
            if (!left) {
                left = fabsl(g) > CLEAR;
                if (left && (!in || (g > 0) != (way_off > 0)))
                    touch = 0;
            } else if (in && was_in && (g > 0) != (before > 0)) {
                for (int m = 0; m < 80; m++) {
                    wide c = (a + t) / 2;
                    int x;
                    if ((gap_on_ray(kind, bumped, part, r, s, c, &x) > 0) == (before > 0))
                        a = c;
                    else
                        t = c;
                }
                if (best < 0 || a < best)
                    best = a;
                break;
            } else {
                if (in != was_in && k > 0 && fabsl(g) < 0.01L)
                    touch = t < touch ? t : touch;
                if (in && was_in && fabsl(before) < NEAR && fabsl(before) < fabsl(last) && fabsl(g) > fabsl(before))
                    touch = t < touch ? t : touch;
            }
            last = before;
            before = g;
            was_in = in && left;
        }
    }
    *doubt = touch < end && (best < 0 || touch < best);
    return best;
}

/* From the hits with object 5 on in random directions, 4 long. Returns how many they are. */
static int leave(const rays *x, const hits *h, rays *y, ray_origins *from, hits *again, real *lit)
{
    int n = 0;
    for (int i = 0; i < LANES; i++) {
        if (h->id[i] != 5)
            continue;
        double c = random_in(-1, 1), a = random_in(0, 6.283), l = sqrt(1 - c * c);
        bs_vec3 X = lane_at(x, i, h->t[i]), d = {(real)(4 * l * cos(a)), (real)(4 * c), (real)(4 * l * sin(a))};
        lane_set(&y->r, n, X);
        lane_set(&y->s, n, d);
        lane_set(&from->at, n, X);
        from->part[n] = h->part[i];
        from->id[n] = 5;
        again->id[n] = -1;
        lit[n] = 1;
        again->t[n++] = 1;
    }
    return n;
}

/* From hits to all sides: away from what was met, as mirrored rays go, and into it, as refracted ones do. Each meets
 * what bisection does, and not the place that it has left. */
static void leaving(void **state)
{
    (void)state;
    int faults = 0;
    for (int kind = 0; kind < SURFACES; kind++)
        for (int bumped = 0; bumped < BUMPS; bumped++) {
            surface *f = make_surface(kind);
            bump *P = make_bump(kind, bumped, f);
            static rays x, y;
            static hits h, again;
            static ray_origins from;
            displaced_counts counts = {0};
            surface *bumpy = displace(f, P, &counts);
            int met = 0, passed = 0, doubts = 0, wrong = 0, n = 0;
            wide r[LANES][3], s[LANES][3];
            real lit[LANES];
            random_wave(&x, &h, r, s);
            bumpy->ops->hit(bumpy, LANES, &x, 5, &h);
            n = leave(&x, &h, &y, &from, &again, lit);
            bumpy->ops->hit_own(bumpy, n, &y, &from, 5, &again);
            bumpy->ops->occlude_own(bumpy, n, &y, from.part, lit);
            for (int i = 0; i < n; i++) {
                bs_vec3 X = lane_get(&y.r, i), D = lane_get(&y.s, i);
                const wide o[3] = {(wide)X.x, (wide)X.y, (wide)X.z}, d[3] = {(wide)D.x, (wide)D.y, (wide)D.z};
                int doubt, x1;
                wide t = next_crossing(kind, bumped, from.part[i], o, d, 1, &doubt);
                if (doubt) {
                    doubts++;
                    continue;
                }
                met += t >= 0;
                passed += t < 0;
                const int part = again.id[i] < 0 ? 0 : again.part[i];
                double off = again.id[i] < 0 || t < 0 ? ((again.id[i] < 0) == (t < 0) ? 0 : 1)
                                                      : 4 * fabs((double)((wide)again.t[i] - t));
                wide rate = fabsl(gap_on_ray(kind, bumped, part, o, d, t + 1e-6L, &x1) -
                                  gap_on_ray(kind, bumped, part, o, d, t - 1e-6L, &x1)) /
                            8e-6L;
                if (!(off * fmin(1, (double)rate * 4) <= AGREE) || (lit[i] > 0) != (t < 0)) {
                    wrong++;
                    print_message("%s, %s: ray %d from part %d: t %.9g, bisection %.9g\n", names[kind],
                                  bumped ? "map" : "function", i, from.part[i],
                                  again.id[i] < 0 ? -1. : (double)again.t[i], (double)t);
                }
            }
            print_message("%s, %s: %d hits, %d misses, %d left out, %d wrong, %ld uncertain\n", names[kind],
                          bumped ? "map" : "function", met, passed, doubts, wrong, counts.uncertain);
            CHECK(met + passed, >, 50);
            CHECK(doubts, <=, LANES / 8);
            faults += wrong;
            surface_free(bumpy);
            bump_free(P);
            surface_free(f);
        }
    assert_int_equal(faults, 0);
}

/* Rays that begin anywhere in and about a surface, as where the eye or another thing is in it: in the shell between the
 * lowest and the highest P, too, on either side of the rough surface, and in what that encloses. */
static void from_within(void **state)
{
    (void)state;
    int faults = 0;
    for (int kind = 0; kind < SURFACES; kind++) {
        surface *f = make_surface(kind);
        bump *P = make_bump(kind, SMOOTH_BUMP, f);
        static rays x;
        static hits h;
        displaced_counts counts = {0};
        surface *bumpy = displace(f, P, &counts);
        int met = 0, doubts = 0, wrong = 0;
        real lit[LANES];
        for (int i = 0; i < LANES; i++) {
            double c = random_in(-1, 1), a = random_in(0, 6.283), l = sqrt(1 - c * c);
            bs_vec3 X = {(real)random_in(-1.3, 1.3), (real)random_in(-1.3, 1.3), (real)random_in(-1.3, 1.3)};
            bs_vec3 d = {(real)(4 * l * cos(a)), (real)(4 * c), (real)(4 * l * sin(a))};
            lane_set(&x.r, i, X);
            lane_set(&x.s, i, d);
            h.t[i] = lit[i] = 1;
            h.id[i] = -1;
        }
        bumpy->ops->hit(bumpy, LANES, &x, 5, &h);
        bumpy->ops->occlude(bumpy, LANES, &x, lit);
        for (int i = 0; i < LANES; i++) {
            bs_vec3 X = lane_get(&x.r, i), D = lane_get(&x.s, i);
            const wide o[3] = {(wide)X.x, (wide)X.y, (wide)X.z}, d[3] = {(wide)D.x, (wide)D.y, (wide)D.z};
            int doubt;
            wide t = first_crossing(kind, SMOOTH_BUMP, o, d, 1, &doubt);
            if (doubt) {
                doubts++;
                continue;
            }
            met += t >= 0;
            if ((h.id[i] == 5) != (t >= 0) || (lit[i] > 0) != (t < 0) ||
                (t >= 0 && !(fabs((double)((wide)h.t[i] - t)) < 1e-4))) {
                wrong++;
                print_message("%s: ray %d: t %.9g, bisection %.9g\n", names[kind], i,
                              h.id[i] < 0 ? -1. : (double)h.t[i], (double)t);
            }
        }
        print_message("%s: %d hits, %d left out, %d wrong\n", names[kind], met, doubts, wrong);
        assert_int_equal(counts.uncertain, 0);
        faults += wrong;
        surface_free(bumpy);
        bump_free(P);
        surface_free(f);
    }
    assert_int_equal(faults, 0);
}

/* A flat bump is the offset surface; exact's tau leads to it; a ray beside the silhouette falls back. */
static void flat_and_exact(void **state)
{
    (void)state;
    const double all[2] = {-HUGE_VAL, HUGE_VAL};
    expr_error e;
    bump *P = bump_function_new(expr_parse("0.1", &e), 1, all, all);
    surface *f = plane_new((vec3){0, 0, 0}, (vec3){0, 0, 1}, (vec3){1, 0, 0}, false);
    static hit_group g;
    displaced_counts counts = {0};
    surface *bumpy = displace(f, P, &counts);
    g.n = LANES;
    hit_group_picked(&g);
    for (int i = 0; i < LANES; i++) {
        g.picked.x.r.x[i] = (real)(i * 0.1), g.picked.x.r.y[i] = R(2), g.picked.x.r.z[i] = R(-1);
        g.picked.x.s.x[i] = R(0.1), g.picked.x.s.y[i] = (real)(-0.2 - 0.01 * i), g.picked.x.s.z[i] = R(0.7);
        g.picked.t[i] = -2 / g.x->s.y[i];
    }
    f->ops->locate(f, LANES, g.x, g.t, g.part, g.u, g.w);
    f->ops->eval(f, LANES, g.part, g.u, g.w, 1, &g.q);
    P->ops->eval(P, LANES, g.u, g.w, 1, &g.bump);
    for (int i = 0; i < LANES; i++)
        lane_set(&g.n_smooth, i, bs_normal(lane_get(&g.q.Qu, i), lane_get(&g.q.Qw, i)));
    displaced_shift(bumpy, &g);
    for (int i = 0; i < LANES; i++) {
        double y = (double)(g.x->r.y[i] + g.x->s.y[i] * (g.t[i] + g.tau[i]));
        assert_int_equal(g.order[i], ORDER_EXACT);
        NEAR(y, 0.1, 1e-6);
    }
    assert_int_equal(counts.uncertain, 0);
    surface_free(bumpy);
    bump_free(P);
    surface_free(f);
    P = bump_function_new(expr_parse("u", &e), 1, all, all);
    assert_false(displaced_has_bounds(P));
    bump_free(P);
    P = bump_function_new(expr_parse("floor(sin(u))", &e), 1, all, all);
    assert_false(displaced_has_bounds(P));
    bump_free(P);
}

/* A surface with a constant P = h is a wider one. */
static surface *widened(int kind, double h)
{
    const turned *t = &turns[kind < DISC ? 0 : kind - DISC];
    if (kind == SPHERE)
        return sphere_new((vec3){sphere_C[0], sphere_C[1], sphere_C[2]}, sphere_R + h);
    return kind == TORUS ? torus_new(t->a, t->b, t->r[0], t->r[1] + h)
                         : cone_new(t->a, t->r[0] + h, t->b, t->r[1] + h, true);
}

/* The shorter the way of a ray that has left it is, the flatter it is to the surface: rounding is divided by that
 * angle. */
static int differ(int n, const hits *rough, const hits *smooth, int *met)
{
    int other = 0;
    for (int i = 0; i < n; i++) {
        const double off = fabs((double)(rough->t[i] - smooth->t[i]));
        *met += smooth->id[i] == 0;
        other += rough->id[i] != smooth->id[i] || !(off < AGREE || off * (double)smooth->t[i] < AGREE / 10);
    }
    return other;
}

/* Its shell has no thickness; and rays that leave it within meet its far side. */
static void constant_bumps(void **state)
{
    (void)state;
    const double all[2] = {-HUGE_VAL, HUGE_VAL}, levels[] = {0.1, -0.1, 1e-6, 0};
    const int kinds[] = {SPHERE, TUBE, TORUS};
    for (int which = 0; which < 3; which++)
        for (int k = 0; k < 4; k++) {
            const int kind = kinds[which];
            expr_error e;
            bump *P = bump_function_new(expr_parse("1", &e), levels[k], all, all);
            surface *f = make_surface(kind), *wider = widened(kind, levels[k]);
            int met = 0, other = 0, met_again = 0, other_again = 0;
            for (int round = 0; round < 8; round++) {
                static rays x, y;
                static hits rough, smooth;
                static ray_origins from;
                displaced_counts counts = {0};
                surface *bumpy = displace(f, P, &counts);
                wide r[3], s[3];
                int n = 0;
                for (int i = 0; i < LANES; i++) {
                    random_ray(&x, i, r, s);
                    if (round % 2) /* from within, where a tube is open */
                        lane_set(&x.r, i, (bs_vec3){R(0.1), R(0.1), R(0.1)});
                    rough.t[i] = smooth.t[i] = R(3);
                    rough.id[i] = smooth.id[i] = -1;
                }
                bumpy->ops->hit(bumpy, LANES, &x, 0, &rough);
                wider->ops->hit(wider, LANES, &x, 0, &smooth);
                other += differ(LANES, &rough, &smooth, &met);
                for (int i = 0; i < LANES; i++)
                    if (smooth.id[i] == 0 && rough.id[i] == 0) { /* through it, a little bent */
                        bs_vec3 d = lane_get(&x.s, i), bent = {d.x + R(0.3) * d.y, d.y - R(0.2) * d.z, d.z};
                        lane_set(&y.r, n, lane_at(&x, i, smooth.t[i]));
                        lane_set(&y.s, n, bent);
                        lane_set(&from.at, n, lane_get(&y.r, n));
                        from.id[n] = 0;
                        from.part[n++] = 0;
                    }
                for (int i = 0; i < n; i++) {
                    rough.t[i] = smooth.t[i] = R(3);
                    rough.id[i] = smooth.id[i] = -1;
                }
                bumpy->ops->hit_own(bumpy, n, &y, &from, 0, &rough);
                wider->ops->hit_own(wider, n, &y, &from, 0, &smooth);
                other_again += differ(n, &rough, &smooth, &met_again);
                assert_int_equal(counts.uncertain, 0);
                surface_free(bumpy);
            }
            print_message("%s, P = %g: %d hits, %d otherwise; %d more from there, %d otherwise\n", names[kind],
                          levels[k], met, other, met_again, other_again);
            CHECK(met, >, 300);
            CHECK(other, <=, 2); /* at a rim or tangent */
            CHECK(met_again, >, 100);
            CHECK(other_again, <=, 2);
            bump_free(P);
            surface_free(f);
            surface_free(wider);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hits_agree_with_bisection),
        cmocka_unit_test(normals_are_gradients),
        cmocka_unit_test(own_shadows),
        cmocka_unit_test(leaving),
        cmocka_unit_test(from_within),
        cmocka_unit_test(flat_and_exact),
        cmocka_unit_test(constant_bumps),
    };
    return cmocka_run_group_tests_name("true displacement", tests, NULL, NULL);
}
