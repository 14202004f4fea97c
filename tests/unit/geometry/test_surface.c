/* Surfaces: hits lie on Q(u,w), partials are the derivatives of Q, n points outward, shadows agree with hits, and rays
 * without sense do no harm.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "base/frame.h"
#include "wave/lane.h"
#include "support/check.h"
#include "support/random_rays.h"
#include "geometry/surface.h"

/* Digits of a place a few units from the origin. */
enum { PLANE, RECTANGLE, BOX, SPHERE, DISC, DRUM, TUBE, BELL, CUP, HAT, TORUS, THIN, KINDS };

/* The surfaces with an inside that no ray from outside sees, and those of them that never shade themselves from
 * outside. */
static bool is_closed(int kind)
{
    return kind != PLANE && kind != RECTANGLE && kind != DISC && kind != TUBE && kind != CUP;
}
static bool is_convex(int kind) { return is_closed(kind) && kind != TORUS && kind != THIN; }

static surface *make(int kind)
{
    switch (kind) {
    case PLANE:
        return plane_new((vec3){0.1, -0.3, 0.2}, (vec3){0.2, 0.1, 1.4}, (vec3){1.1, -0.2, 0.3}, false);
    case RECTANGLE:
        return plane_new((vec3){-1, 0.1, -1}, (vec3){0.2, 0.1, 2.4}, (vec3){2.1, -0.2, 0.3}, true);
    case BOX:
        return box_new((vec3){0.7, -0.8, 1.1}, (vec3){-0.9, 0.5, -0.6});
    case SPHERE:
        return sphere_new((vec3){0.3, -0.2, 0.1}, 1.2);
    case DISC:
        return disc_new((vec3){0.1, -0.2, 0.1}, (vec3){0.3, 1.5, -0.4}, 1.3);
    case DRUM:
        return cone_new((vec3){-0.1, -0.9, 0.2}, 0.9, (vec3){0.3, 0.8, -0.1}, 0.9, false);
    case TUBE:
        return cone_new((vec3){-0.8, 0.1, 0.2}, 0.8, (vec3){0.8, -0.1, -0.1}, 0.8, true);
    case BELL:
        return cone_new((vec3){-0.1, -0.7, 0.1}, 1.1, (vec3){0.2, 0.7, 0.2}, 0.5, false);
    case CUP:
        return cone_new((vec3){-0.1, -0.2, 0.1}, 0.3, (vec3){0.2, 0.6, 0.2}, 1.2, true);
    case HAT:
        return cone_new((vec3){-0.1, 0.6, 0.1}, 1.2, (vec3){0.2, -0.9, 0.2}, 0, false);
    case TORUS:
        return torus_new((vec3){0.1, -0.1, 0.2}, (vec3){0.3, 1, 0.5}, 0.9, 0.4);
    default:
        return torus_new((vec3){0.1, -0.1, 0.2}, (vec3){1, 0.1, -0.2}, 1.2, 0.05);
    }
}

static double distance(bs_vec3 a, bs_vec3 b)
{
    bs_vec3 d = {a.x - b.x, a.y - b.y, a.z - b.z};
    return sqrt((double)bs_dot(d, d));
}

static void hits_are_on_the_surface(void **state)
{
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        surface *f = make(kind);
        int met = 0;
        for (int round = 0; round < 40; round++) {
            static rays x;
            static hits h;
            static partials q;
            int32_t part[LANES];
            real u[LANES], w[LANES];
            for (int i = 0; i < LANES; i++)
                random_ray(&x, i, 1);
            no_hits(&h, LANES);
            f->ops->hit(f, LANES, &x, 3, &h);
            f->ops->locate(f, LANES, &x, h.t, part, u, w);
            f->ops->eval(f, LANES, part, u, w, 2, &q);
            for (int i = 0; i < LANES; i++) {
                if (h.id[i] < 0)
                    continue;
                met++;
                assert_int_equal(h.id[i], 3);
                CHECK(h.t[i], >, 0);
                CHECK(h.t[i], <, REAL_FAR);
                double far = 1 + distance(lane_at(&x, i, 0), lane_at(&x, i, h.t[i]));
                double off = distance(lane_get(&q.Q, i), lane_at(&x, i, h.t[i]));
                if (!(off <= 24 * EPS * far)) {
                    print_error("%s: Q(u,w) is %g off r + s t\n", f->ops->kind, off);
                    fail();
                }
                /* on what is closed, seen from outside, the first hit's n faces the viewer */
                bs_vec3 n = bs_normal(lane_get(&q.Qu, i), lane_get(&q.Qw, i));
                if (is_closed(kind))
                    CHECK(bs_dot(n, lane_get(&x.s, i)), <, R(1e-4));
            }
        }
        assert_true(met > (kind == THIN ? 200 : 500));
        surface_free(f);
    }
}

static void partials_are_derivatives(void **state)
{
    (void)state;
    const double h = sqrt(EPS) * 0.3; /* balances the curve's error, h^2, and the rounding, EPS/h */
    for (int kind = 0; kind < KINDS; kind++) {
        surface *f = make(kind);
        for (int round = 0; round < 200; round++) {
            static partials q[5];
            real u[1], w[1];
            int32_t part[1] = {round % f->ops->parts};
            double u0 = random_in(0.3, 0.7), w0 = random_in(0.4, 0.6), du[5] = {0, h, -h, 0, 0},
                   dw[5] = {0, 0, 0, h, -h};
            double du_[5], dw_[5];
            if (kind != PLANE) {
                double U[2], W[2];
                f->ops->extent(f, part[0], U, W);
                u0 = random_in(U[0] + 0.1, U[1] - 0.1), w0 = random_in(W[0] + 0.1, W[1] - 0.1);
                if (!(U[0] < U[1])) /* a hat has no upper cap */
                    continue;
            }
            for (int k = 0; k < 5; k++) {
                u[0] = (real)(u0 + du[k]);
                w[0] = (real)(w0 + dw[k]);
                du_[k] = (double)u[0];
                dw_[k] = (double)w[0];
                f->ops->eval(f, 1, part, u, w, 2, &q[k]);
            }
            const struct {
                vec3s *a, *b, *want;
                double step;
            } tests[] = {
                {&q[1].Q, &q[2].Q, &q[0].Qu, du_[1] - du_[2]},    {&q[3].Q, &q[4].Q, &q[0].Qw, dw_[3] - dw_[4]},
                {&q[1].Qu, &q[2].Qu, &q[0].Quu, du_[1] - du_[2]}, {&q[3].Qu, &q[4].Qu, &q[0].Quw, dw_[3] - dw_[4]},
                {&q[1].Qw, &q[2].Qw, &q[0].Quw, du_[1] - du_[2]}, {&q[3].Qw, &q[4].Qw, &q[0].Qww, dw_[3] - dw_[4]},
            };
            for (int k = 0; k < 6; k++) {
                bs_vec3 a = lane_get(tests[k].a, 0), b = lane_get(tests[k].b, 0), c = lane_get(tests[k].want, 0);
                bs_vec3 d = {(real)((double)(a.x - b.x) / tests[k].step), (real)((double)(a.y - b.y) / tests[k].step),
                             (real)((double)(a.z - b.z) / tests[k].step)};
                if (!(distance(d, c) < 20 * sqrt(EPS))) {
                    print_error("%s: derivative %d is off by %g\n", f->ops->kind, k, distance(d, c));
                    fail();
                }
            }
        }
        surface_free(f);
    }
}

/* Every face of the box has its own (u,w) over 0..1 and n outward; the six cover it. */
static void box_faces(void **state)
{
    (void)state;
    surface *f = make(BOX);
    static partials q;
    int32_t part[6] = {0, 1, 2, 3, 4, 5};
    real u[6], w[6];
    for (int i = 0; i < 6; i++)
        u[i] = w[i] = R(0.5);
    f->ops->eval(f, 6, part, u, w, 1, &q);
    const double middle[3] = {-0.1, -0.15, 0.25}, half[3] = {0.8, 0.65, 0.85};
    for (int i = 0; i < 6; i++) {
        bs_vec3 Q = lane_get(&q.Q, i), n = bs_normal(lane_get(&q.Qu, i), lane_get(&q.Qw, i));
        double want[3] = {middle[0], middle[1], middle[2]}, out[3] = {0, 0, 0};
        want[i / 2] += (i % 2 ? 1 : -1) * half[i / 2];
        out[i / 2] = i % 2 ? 1 : -1;
        bs_vec3 place = {(real)want[0], (real)want[1], (real)want[2]}, to = {(real)out[0], (real)out[1], (real)out[2]};
        CHECK(distance(Q, place), <, 1e-6);
        CHECK(distance(lane_unit(n), to), <, 1e-6);
    }
    surface_free(f);
}

/* occlude says 0 just where a hit lies in (0,1). */
static void shadows_agree_with_hits(void **state)
{
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        surface *f = make(kind);
        int dark = 0;
        for (int round = 0; round < 20; round++) {
            static rays x;
            static hits h;
            real lit[LANES];
            for (int i = 0; i < LANES; i++) {
                random_ray(&x, i, 1);
                lit[i] = 1;
            }
            no_hits(&h, LANES);
            f->ops->hit(f, LANES, &x, 0, &h);
            f->ops->occlude(f, LANES, &x, lit);
            for (int i = 0; i < LANES; i++) {
                assert_true(lit[i] == (h.id[i] >= 0 && h.t[i] < 1 ? R(0) : R(1)));
                dark += lit[i] == 0;
            }
            /* what is dark already stays so */
            for (int i = 0; i < LANES; i++)
                lit[i] = 0;
            f->ops->occlude(f, LANES, &x, lit);
            for (int i = 0; i < LANES; i++)
                CHECK(lit[i], ==, 0);
        }
        CHECK(dark, >, 100);
        surface_free(f);
    }
}

/* From the surface itself: rays outward are free, rays inward are blocked by the far side, however slanted, unless they
 * end before it; with no epsilon that a grazing ray could fall under. */
static void own_shadow(void **state)
{
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        if (!is_convex(kind))
            continue;
        surface *f = make(kind);
        for (int round = 0; round < 40; round++) {
            static rays x, out;
            static hits h;
            static partials q;
            int32_t part[LANES];
            real u[LANES], w[LANES], lit[LANES], cosine[LANES];
            int n = 0;
            for (int i = 0; i < LANES; i++)
                random_ray(&x, i, 1);
            no_hits(&h, LANES);
            f->ops->hit(f, LANES, &x, 0, &h);
            for (int i = 0; i < LANES; i++)
                if (h.id[i] >= 0) {
                    bs_vec3 r = lane_at(&x, i, 0), s = lane_get(&x.s, i);
                    lane_set(&x.r, n, r);
                    lane_set(&x.s, n, s);
                    h.t[n++] = h.t[i];
                }
            f->ops->locate(f, n, &x, h.t, part, u, w);
            f->ops->eval(f, n, part, u, w, 1, &q);
            for (int i = 0; i < n; i++) {
                bs_vec3 d = {(real)random_in(-9, 9), (real)random_in(-9, 9), (real)random_in(-9, 9)};
                bs_vec3 nn = lane_unit(bs_normal(lane_get(&q.Qu, i), lane_get(&q.Qw, i)));
                if (round % 4 == 0) { /* grazing: 1e-3 to either side of the tangent plane */
                    real c = bs_dot(d, nn) - (i % 2 ? R(1e-3) : R(-1e-3));
                    d.x -= c * nn.x, d.y -= c * nn.y, d.z -= c * nn.z;
                }
                cosine[i] = bs_dot(d, nn);
                lane_set(&out.r, i, lane_at(&x, i, h.t[i]));
                lane_set(&out.s, i, d);
                lit[i] = 1;
            }
            f->ops->occlude_own(f, n, &out, part, lit);
            for (int i = 0; i < n; i++) {
                double length = (double)real_sqrt(bs_dot(lane_get(&out.s, i), lane_get(&out.s, i)));
                if (cosine[i] > R(1e-4))
                    CHECK(lit[i], ==, 1);
                else if ((double)cosine[i] < -1e-4 && length > 4) /* longer than the surface is wide */
                    CHECK(lit[i], ==, 0);
            }
        }
        surface_free(f);
    }
    for (int kind = 0; kind < KINDS; kind++) {
        surface *f = make(kind);
        CHECK((f->ops->occlude_own == NULL), ==, (kind == PLANE || kind == RECTANGLE || kind == DISC));
        surface_free(f);
    }
}

/* hit_own leaves the own start out: what is met again is met at a place of the surface and not at the start; from a
 * convex one inward the far side is, outward nothing. Other surfaces' rays it treats as hit does. */
static void own_hits(void **state)
{
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        surface *f = make(kind);
        const bool flat = kind == PLANE || kind == RECTANGLE || kind == DISC;
        int inward = 0;
        for (int round = 0; round < 40; round++) {
            static rays x, out;
            static hits h, again, want;
            static partials q;
            static ray_origins from;
            int32_t part[LANES], there[LANES];
            real u[LANES], w[LANES], cosine[LANES];
            int n = 0;
            for (int i = 0; i < LANES; i++)
                random_ray(&x, i, 1);
            no_hits(&h, LANES);
            f->ops->hit(f, LANES, &x, 7, &h);
            for (int i = 0; i < LANES; i++)
                if (h.id[i] >= 0) {
                    bs_vec3 r = lane_at(&x, i, 0), s = lane_get(&x.s, i);
                    lane_set(&x.r, n, r);
                    lane_set(&x.s, n, s);
                    h.t[n++] = h.t[i];
                }
            f->ops->locate(f, n, &x, h.t, part, u, w);
            f->ops->eval(f, n, part, u, w, 1, &q);
            for (int i = 0; i < n; i++) {
                bs_vec3 d = {(real)random_in(-9, 9), (real)random_in(-9, 9), (real)random_in(-9, 9)};
                d.x = round == 1 ? 0 : d.x; /* along a face of the box */
                cosine[i] = bs_dot(lane_unit(d), lane_unit(bs_normal(lane_get(&q.Qu, i), lane_get(&q.Qw, i))));
                lane_set(&out.r, i, lane_at(&x, i, h.t[i] * R(0.9))); /* anywhere: it does not matter */
                lane_set(&from.at, i, lane_at(&x, i, h.t[i]));
                lane_set(&out.s, i, d);
                from.id[i] = 7;
                from.part[i] = part[i];
            }
            no_hits(&again, n);
            f->ops->hit_own(f, n, &out, &from, 7, &again);
            for (int i = 0; i < n; i++) {
                const bool back = again.id[i] == 7;
                if (flat || (is_convex(kind) && cosine[i] > R(1e-4)))
                    assert_false(back);
                else if (is_closed(kind) && cosine[i] < R(-1e-3))
                    assert_true(back);
                assert_true(!back || again.t[i] > 0);
                inward += back;
                again.t[i] = back ? again.t[i] : 1;
            }
            out.r = from.at;
            f->ops->locate(f, n, &out, again.t, there, u, w);
            f->ops->eval(f, n, there, u, w, 1, &q);
            for (int i = 0; i < n; i++)
                if (again.id[i] == 7) {
                    assert_true(distance(lane_get(&q.Q, i), lane_at(&out, i, again.t[i])) <
                                (kind == HAT ? 300 : 60) * EPS); /* a tip */
                    const real pieces = bs_dot(lane_get(&out.s, i), bs_normal(lane_get(&q.Qu, i), lane_get(&q.Qw, i)));
                    assert_true(!is_closed(kind) || (pieces > 0) == (cosine[i] < 0));
                    assert_true(kind != BOX || there[i] != part[i]);
                }
            /* what comes from elsewhere */
            no_hits(&again, n);
            no_hits(&want, n);
            f->ops->hit_own(f, n, &x, &from, 3, &again);
            f->ops->hit(f, n, &x, 3, &want);
            assert_memory_equal(again.t, want.t, (size_t)n * sizeof(real));
            assert_memory_equal(again.id, want.id, (size_t)n * sizeof(int32_t));
        }
        assert_true(flat ? inward == 0 : inward > (is_closed(kind) && kind != THIN ? 500 : 100));
        surface_free(f);
    }
}

/* Rays from within see the inner side. */
static void from_inside(void **state)
{
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        if (!is_convex(kind))
            continue;
        surface *f = make(kind);
        static rays x;
        static hits h;
        for (int i = 0; i < LANES; i++) {
            random_ray(&x, i, 1);
            x.r.x[i] = R(0.1), x.r.y[i] = R(-0.1), x.r.z[i] = R(0.2);
        }
        no_hits(&h, LANES);
        f->ops->hit(f, LANES, &x, 0, &h);
        for (int i = 0; i < LANES; i++)
            assert_true(h.id[i] == 0 && h.t[i] > 0);
        surface_free(f);
    }
}

/* Rays along faces and edges, through corners and poles, of length 0, NaN or infinite: a hit or none, but never a t
 * that is not finite and positive, nor a lane beside it that is touched. */
static void odd_rays(void **state)
{
    (void)state;
    const double nan = (double)NAN, inf = (double)INFINITY;
    const double odd[][6] = {
        {0, 0, 0, 0, 0, 0},
        {nan, 0, 0, 1, 0, 0},
        {0, 0, 0, nan, nan, nan},
        {0, 5, 0, 0, -inf, 0},
        {inf, 0, 0, -1, 0, 0},
        {0.7, -0.8, -3, 0, 0, 1},
        {0.7, 5, 1.1, 0, -1, 0},
        {-0.9, -0.8, -0.6, 1, 1, 1},
        {-3, 0.5, 0, 1, 0, 0},
        {0.7, 0.5, 5, 0, 0, -1},
        {0.3, 5, 0.1, 0, -1, 0},
        {0.3, -5, 0.1, 0, 1, 0},
        {1.5, -5, 0.1, 0, 1, 0},
        {1.5, 0, 0.1, 0, 0, 1},
        {0.1, -0.3, 0.2, 1, 0, 0},
        {1e30, 1e30, 1e30, -1, -1, -1},
        {0, 0, 0, 1e30, 1e30, 1e30},
        {0, 0, 0, 1e-30, 1e-30, 0},
        {0.1, 5, 0.2, 0, -1e-20, 0},
        /* along axes of cylinders, cones and tori, and along their sides */
        {-0.3, -1.75, 0.35, 0.4, 1.7, -0.3},
        {-0.1, -0.9, 0.2, 0.4, 1.7, -0.3},
        {0.1, -0.1, 0.2, 0.3, 1, 0.5},
        {-0.5, -2.1, -0.8, 0.3, 1, 0.5},
        {0.2, -0.9, 0.2, -0.3, 1.5, -0.1},
        {-2.4, 0.3, 0.5, 1.6, -0.2, -0.3},
    };
    enum { ODD = sizeof odd / sizeof *odd };
    for (int kind = 0; kind < KINDS; kind++) {
        surface *f = make(kind);
        static rays x;
        static hits h;
        static partials q;
        static ray_origins from;
        int32_t part[LANES];
        real u[LANES], w[LANES], lit[LANES];
        for (int i = 0; i < ODD; i++) {
            x.r.x[i] = (real)odd[i][0], x.r.y[i] = (real)odd[i][1], x.r.z[i] = (real)odd[i][2];
            x.s.x[i] = (real)odd[i][3], x.s.y[i] = (real)odd[i][4], x.s.z[i] = (real)odd[i][5];
            lit[i] = 1;
        }
        no_hits(&h, ODD + 1);
        f->ops->hit(f, ODD, &x, 0, &h);
        f->ops->occlude(f, ODD, &x, lit);
        from.at = x.r;
        for (int i = 0; i < ODD; i++) {
            from.id[i] = i % 2;
            from.part[i] = i % f->ops->parts;
        }
        f->ops->hit_own(f, ODD, &x, &from, 0, &h);
        f->ops->locate(f, ODD, &x, h.t, part, u, w);
        f->ops->eval(f, ODD, part, u, w, 2, &q);
        assert_int_equal(h.id[ODD], -1);
        for (int i = 0; i < ODD; i++) {
            assert_true(h.id[i] == -1 || h.id[i] == 0);
            CHECK(h.t[i], >, 0);
            CHECK(h.t[i], <=, REAL_FAR);
            assert_true(lit[i] == 0 || lit[i] == 1);
            CHECK(part[i], >=, 0);
            CHECK(part[i], <, f->ops->parts);
        }
        surface_free(f);
    }
}

/* Round surfaces have their seams where the documentation says, and u to the right where w goes down. */
static void ways_around(void **state)
{
    (void)state;
    surface *const f[] = {cone_new((vec3){1, 0, 0}, 2, (vec3){1, 3, 0}, 1, false),
                          torus_new((vec3){0, 1, 0}, (vec3){0, 2, 0}, 2, 0.5),
                          disc_new((vec3){0, 1, 0}, (vec3){0, 3, 0}, 2)};
    const struct {
        int f, part;
        double u, w, Q[3];
    } want[] = {
        {0, 0, 0, 0, {2, 3, 0}},
        {0, 0, 1.5707963, 0, {1, 3, 1}},
        {0, 0, 0, 3.1622777, {3, 0, 0}},
        {0, 0, 3.1415927, 3.1622777, {-1, 0, 0}},
        {0, 1, 0.5, 0.25, {1.5, 3, -0.25}},
        {0, 2, 0.5, 0.25, {1.5, 0, 0.25}},
        {1, 0, 0, 0, {2.5, 1, 0}},
        {1, 0, 0, -1.5707963, {2, 1.5, 0}},
        {1, 0, 1.5707963, 3.1415927, {0, 1, 1.5}},
        {2, 0, 0.5, 0.25, {0.5, 1, -0.25}},
    };
    for (int k = 0; k < (int)(sizeof want / sizeof *want); k++) {
        static partials q;
        int32_t part = want[k].part;
        real u = (real)want[k].u, w = (real)want[k].w;
        f[want[k].f]->ops->eval(f[want[k].f], 1, &part, &u, &w, 1, &q);
        bs_vec3 Q = {(real)want[k].Q[0], (real)want[k].Q[1], (real)want[k].Q[2]};
        CHECK(distance(lane_get(&q.Q, 0), Q), <, 1e-6);
    }
    for (int k = 0; k < 3; k++)
        surface_free(f[k]);
}

/* The frame: unit vectors at right angles, of the scene's hand, about any axis. */
static void frames(void **state)
{
    (void)state;
    const vec3 axes[] = {{0, 1, 0},  {1, 0, 0},       {0, 0, 1},    {0, -2, 0},
                         {-1, 0, 0}, {0.9, 0.1, 0.3}, {1e-6, 0, 0}, {3e5, 2e5, 1e5}};
    for (int k = 0; k < (int)(sizeof axes / sizeof *axes); k++) {
        frame a = frame_about(axes[k]);
        CHECK(vec3_length(vec3_sub(vec3_cross(a.x, a.y), a.z)), <, 1e-15);
        CHECK(vec3_length(vec3_sub(vec3_cross(a.y, a.z), a.x)), <, 1e-15);
        CHECK(vec3_length(vec3_sub(a.y, vec3_unit(axes[k]))), <, 1e-15);
    }
    frame up = frame_about((vec3){0, 7, 0});
    CHECK(up.x.x, ==, 1);
    CHECK(up.y.y, ==, 1);
    CHECK(up.z.z, ==, 1);
}

/* A small ball far away keeps its round shadow: the discriminant does not cancel. */
static void small_and_far(void **state)
{
    (void)state;
    surface *f = sphere_new((vec3){1000, 0, 0}, 0.01);
    static rays x;
    static hits h;
    const double at[5] = {0, 0.005, 0.0099, 0.0101, 0.02};
    for (int i = 0; i < 5; i++) {
        x.r.x[i] = 0, x.r.y[i] = (real)at[i], x.r.z[i] = 0;
        x.s.x[i] = 1, x.s.y[i] = 0, x.s.z[i] = 0;
    }
    no_hits(&h, 5);
    f->ops->hit(f, 5, &x, 0, &h);
    for (int i = 0; i < 5; i++)
        assert_int_equal(h.id[i], i < 3 ? 0 : -1);
    surface_free(f);
}

static void constructors_refuse_nonsense(void **state)
{
    (void)state;
    const vec3 o = {0, 0, 0}, x = {1, 0, 0}, nan = {(double)NAN, 0, 0}, inf = {(double)INFINITY, 0, 0};
    assert_null(plane_new(o, x, x, false));
    assert_null(plane_new(o, x, o, false));
    assert_null(plane_new(o, x, nan, true));
    assert_null(plane_new(o, inf, (vec3){0, 1, 0}, true));
    assert_null(box_new(o, (vec3){1, 0, 1}));
    assert_null(sphere_new(o, 0));
    assert_null(sphere_new(o, -1));
    assert_null(sphere_new(o, (double)NAN));
    assert_null(disc_new(o, o, 1));
    assert_null(disc_new(o, nan, 1));
    assert_null(disc_new(o, x, 0));
    assert_null(cone_new(o, 1, o, 1, false));
    assert_null(cone_new(o, 0, x, 0, false));
    assert_null(cone_new(o, -1, x, 1, true));
    assert_null(cone_new(o, 1, inf, 1, true));
    assert_null(cone_new(o, (double)NAN, x, 1, true));
    assert_null(torus_new(o, x, 1, 1));
    assert_null(torus_new(o, x, 1, 0));
    assert_null(torus_new(o, o, 2, 1));
    assert_null(torus_new(o, x, (double)INFINITY, 1));
    assert_null(torus_new(o, x, (double)NAN, 1));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hits_are_on_the_surface),
        cmocka_unit_test(partials_are_derivatives),
        cmocka_unit_test(box_faces),
        cmocka_unit_test(shadows_agree_with_hits),
        cmocka_unit_test(own_shadow),
        cmocka_unit_test(own_hits),
        cmocka_unit_test(from_inside),
        cmocka_unit_test(odd_rays),
        cmocka_unit_test(ways_around),
        cmocka_unit_test(frames),
        cmocka_unit_test(small_and_far),
        cmocka_unit_test(constructors_refuse_nonsense),
    };
    return cmocka_run_group_tests_name("surfaces", tests, NULL, NULL);
}
