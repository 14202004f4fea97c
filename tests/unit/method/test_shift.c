/* The method's stages over whole waves, in the build's own precision: P = 0, constant, linear, quadratic; march and
 * iter against their header; the stages against the header, lane by lane.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "wave/lane.h"
#include "support/check.h"
#include "support/function_bump.h"
#include "support/random_in.h"
#include "method/shift.h"
#include "geometry/surface.h"

/* A wave of rays that come down, or up from behind, onto a skewed plane near (u,w) = 0..1; all that precedes the shift.
 */
static hit_group *wave(const bump *P, double side)
{
    static hit_group g;
    surface *f = plane_new((vec3){0.1, 0.2, -0.3}, (vec3){0.1, 0.05, 1.3}, (vec3){0.9, 0.1, 0.2}, false);
    hits h;
    assert_non_null(f);
    g.n = LANES;
    hit_group_picked(&g);
    for (int i = 0; i < LANES; i++) {
        double px = random_in(0, 1), pz = random_in(0, 1);
        g.picked.x.s.x[i] = (real)random_in(-1, 1);
        g.picked.x.s.y[i] = (real)(-side * random_in(0.5, 1.5));
        g.picked.x.s.z[i] = (real)random_in(-1, 1);
        g.picked.x.r.x[i] = (real)px - 3 * g.x->s.x[i];
        g.picked.x.r.y[i] = (real)0.2 - 3 * g.x->s.y[i];
        g.picked.x.r.z[i] = (real)pz - 3 * g.x->s.z[i];
        h.t[i] = REAL_FAR;
        h.id[i] = -1;
    }
    f->ops->hit(f, LANES, g.x, 7, &h);
    for (int i = 0; i < LANES; i++)
        assert_int_equal(h.id[i], 7);
    memcpy(g.picked.t, h.t, sizeof g.picked.t);
    f->ops->locate(f, LANES, g.x, g.t, g.part, g.u, g.w);
    f->ops->eval(f, LANES, g.part, g.u, g.w, 2, &g.q);
    P->ops->eval(P, LANES, g.u, g.w, 3, &g.bump);
    shift_normals(&g, P);
    surface_free(f);
    return &g;
}

/* |gap| at the shift found, in scene units: how far r + s t0 is from the rough surface along the normal. */
static double miss(const hit_group *g, int i, const bump *P)
{
    bs_view v =
        bs_view_of(lane_get(&g->x->s, i), lane_get(&g->n_smooth, i), lane_get(&g->q.Qu, i), lane_get(&g->q.Qw, i));
    real u[LANES], w[LANES];
    static bump_values h;
    u[0] = g->u[i] + v.a * g->tau[i];
    w[0] = g->w[i] + v.b * g->tau[i];
    P->ops->eval(P, 1, u, w, 0, &h);
    return fabs((double)bs_gap(v, 0, g->tau[i], h.P[0]));
}

static const method every[] = {{METHOD_NONE, 0},  {METHOD_ORDER, 0}, {METHOD_ORDER, 1}, {METHOD_ORDER, 2},
                               {METHOD_ORDER, 3}, {METHOD_ITER, 1},  {METHOD_ITER, 4},  {METHOD_MARCH, 1},
                               {METHOD_MARCH, 4}, {METHOD_MARCH, 9}};
enum { EVERY = sizeof every / sizeof *every };

/* By these methods the shift must be exact for P: the ray's point is on the rough surface to rounding. `flat`: also
 * where they fall back to order 0. */
static void exact(const char *text, const int *ks, int n, bool flat)
{
    bump *P = function(text);
    for (int behind = 0; behind < 2; behind++) {
        hit_group *g = wave(P, behind ? -1 : 1);
        for (int k = 0; k < n; k++)
            for (int guard = 0; guard < 2; guard++) {
                shift_group(g, P, every[ks[k]], guard);
                int back = 0;
                for (int i = 0; i < LANES; i++) {
                    if (g->order[i] != method_code(every[ks[k]])) {
                        back++; /* a ray that this quadratic does not meet near order 1 */
                        if (!flat)
                            continue;
                    }
                    double m = miss(g, i, P);
                    if (!(m <= 32 * EPS)) {
                        char name[METHOD_NAME_SIZE];
                        method_name(every[ks[k]], name);
                        print_error("P = %s, method %s, lane %d: off by %g\n", text, name, i, m);
                        fail();
                    }
                }
                assert_true(back < LANES / 4 || flat);
            }
    }
    bump_free(P);
}

static void constant_is_exact_for_all(void **state)
{
    static const int ks[] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
    (void)state;
    exact("0.07", ks, 9, true);
    exact("-0.04", ks, 9, true);
}

static void linear_is_exact_from_order_1(void **state)
{
    static const int ks[] = {2, 3, 4};
    (void)state;
    exact("0.02 + 0.1*u - 0.07*w", ks, 3, false);
}

static void quadratic_is_exact_for_order_2(void **state)
{
    static const int two[] = {3, 4}, plus[] = {4};
    (void)state;
    exact("0.02 + 0.1*u - 0.07*w + 0.2*u^2 - 0.15*w^2", two, 2, false);
    exact("0.02 + 0.1*u - 0.07*w + 0.2*u^2 - 0.15*w^2 + 0.25*u*w", plus, 1, false);
}

/* And not exact for those that it is not for: a test of the test. */
static void lower_orders_are_not_exact(void **state)
{
    (void)state;
    bump *P = function("0.02 + 0.1*u - 0.07*w + 0.2*u^2 - 0.15*w^2 + 0.25*u*w");
    hit_group *g = wave(P, 1);
    for (int k = 1; k <= 3; k++) {
        int off = 0;
        shift_group(g, P, every[k], false);
        for (int i = 0; i < LANES; i++)
            off += miss(g, i, P) > 1e-4;
        CHECK(off, >, LANES / 2);
    }
    bump_free(P);
}

static void no_bump_no_shift(void **state)
{
    (void)state;
    bump *P = function("0");
    hit_group *g = wave(P, 1);
    for (int k = 0; k < EVERY; k++)
        for (int guard = 0; guard < 2; guard++) {
            shift_group(g, P, every[k], guard);
            for (int i = 0; i < LANES; i++) {
                real t = g->t[i] + g->tau[i];
                CHECK(g->tau[i], ==, 0);
                CHECK(memcmp(&t, &g->t[i], sizeof t), ==, 0);
                bs_vec3 n = lane_unit(lane_get(&g->n_smooth, i));
                bs_vec3 np = lane_get(&g->n_bump, i);
                CHECK(memcmp(&n, &np, sizeof n), ==, 0);
            }
        }
    bump_free(P);
}

/* march:N against the true first crossing, found by many small steps: within a step's secant error, and better with N;
 * iter converges where the slope is gentle. */
static void march_and_iter_come_near(void **state)
{
    (void)state;
    bump *P = function("0.05*sin(5*u)*cos(4*w) + 0.02*sin(11*u + 3*w)");
    hit_group *g = wave(P, 1);
    double before = 1;
    for (int N = 2; N <= 64; N *= 2) {
        double sum = 0;
        shift_group(g, P, (method){METHOD_MARCH, N}, true);
        for (int i = 0; i < LANES; i++) {
            assert_int_equal(g->order[i], 5);
            sum += miss(g, i, P);
        }
        CHECK(sum / LANES, <, before / 2.5);
        before = fmax(sum / LANES, 1e-6);
    }
    shift_group(g, P, (method){METHOD_ITER, 32}, true);
    int good = 0;
    for (int i = 0; i < LANES; i++)
        good += miss(g, i, P) < 1e-6;
    CHECK(good, >, LANES * 9 / 10);
    bump_free(P);
}

/* The order used and the number of look-ups are told as they are. */
static void counts(void **state)
{
    (void)state;
    bump *P = function("0.05*sin(5*u)*cos(4*w)");
    hit_group *g = wave(P, 1);
    assert_int_equal(shift_group(g, P, (method){METHOD_NONE, 0}, true), 0);
    assert_int_equal(shift_group(g, P, (method){METHOD_ORDER, 2}, true), 0);
    assert_int_equal(shift_group(g, P, (method){METHOD_ITER, 1}, true), 0);
    assert_int_equal(shift_group(g, P, (method){METHOD_ITER, 4}, true), 3 * LANES);
    BETWEEN(3 * LANES, shift_group(g, P, (method){METHOD_MARCH, 4}, true), 5 * LANES); /* until all have found it */
    bump_free(P);
    /* without bounds there is no slab to march through */
    P = function("0.1*u");
    g = wave(P, 1);
    shift_group(g, P, (method){METHOD_MARCH, 4}, true);
    for (int i = 0; i < LANES; i++) {
        bs_view v =
            bs_view_of(lane_get(&g->x->s, i), lane_get(&g->n_smooth, i), lane_get(&g->q.Qu, i), lane_get(&g->q.Qw, i));
        assert_int_equal(g->order[i], 0);
        assert_true(fabs((double)(g->tau[i] - bs_tau0(v, g->bump.P[i]))) < 1e-6);
    }
    bump_free(P);
}

/* Where P does not reach the top of the slab, march leaves step 0 out, to the same bytes. */
static void march_below_the_top(void **state)
{
    (void)state;
    int few = 0;
    bump *P = function("0.05*sin(5*u)*cos(4*w) + 0.02*sin(11*u + 3*w)");
    for (int round = 0; round < 16; round++)
        for (int N = 1; N <= 8; N++) {
            const method m = {METHOD_MARCH, N};
            hit_group *g = wave(P, round % 2 ? 1 : -1);
            real tau[LANES];
            int32_t order[LANES];
            P->peaked = false;
            const long all = shift_group(g, P, m, true);
            memcpy(tau, g->tau, sizeof tau);
            memcpy(order, g->order, sizeof order);
            P->peaked = true;
            few += shift_group(g, P, m, true) < all;
            assert_memory_equal(tau, g->tau, sizeof tau);
            assert_memory_equal(order, g->order, sizeof order);
        }
    CHECK(few, >, 0);
    bump_free(P);
}

/* What starts at the shifted place does not start on the surface that the ray comes from, nor before it. */
static void shifts_end_behind_the_rays_start(void **state)
{
    (void)state;
    bump *P = function("0.1*u");
    hit_group *g = wave(P, 1);
    for (int i = 0; i < LANES; i++)
        g->tau[i] = R(0.6) * (real)(i % 5 - 3) * g->t[i];
    shift_within(g);
    shift_origins(g);
    for (int i = 0; i < LANES; i++) {
        const double t = g->t[i], tau = 0.6 * (i % 5 - 3) * t;
        NEAR(g->t0[i], fmax(t + tau, t / 1024), 4 * EPS * t);
        CHECK(g->t0[i], >, 0);
    }
    bump_free(P);
}

/* The guard keeps every shift within the slab. */
static void guarded_shifts_stay_in_the_slab(void **state)
{
    (void)state;
    bump *P = function("0.2*sin(9*u)*cos(7*w)");
    int back = 0;
    for (int round = 0; round < 16; round++) {
        hit_group *g = wave(P, round % 2 ? 1 : -1);
        for (int order = 0; order <= 3; order++) {
            shift_group(g, P, (method){METHOD_ORDER, order}, true);
            for (int i = 0; i < LANES; i++) {
                bs_view v = bs_view_of(lane_get(&g->x->s, i), lane_get(&g->n_smooth, i), lane_get(&g->q.Qu, i),
                                       lane_get(&g->q.Qw, i));
                bs_slab slab = bs_slab_of(v, P->Pmin, P->Pmax);
                double slack = 4 * EPS * (double)real_abs(slab.back);
                BETWEEN((double)slab.front - slack, g->tau[i], (double)slab.back + slack);
                back += g->order[i] != order;
            }
        }
    }
    CHECK(back, >, 0);
    bump_free(P);
}

/* At a pole: order none, and the smooth normal. */
static void pole(void **state)
{
    (void)state;
    static hit_group g;
    surface *f = sphere_new((vec3){0, 0, 0}, 2);
    bump *P = function("0.1*sin(3*u)");
    g.n = 1;
    hit_group_picked(&g);
    g.picked.x.r.x[0] = 0, g.picked.x.r.y[0] = 5, g.picked.x.r.z[0] = 0;
    g.picked.x.s.x[0] = 0, g.picked.x.s.y[0] = -1, g.picked.x.s.z[0] = 0;
    g.picked.t[0] = 3;
    f->ops->locate(f, 1, g.x, g.t, g.part, g.u, g.w);
    f->ops->eval(f, 1, g.part, g.u, g.w, 2, &g.q);
    P->ops->eval(P, 1, g.u, g.w, 3, &g.bump);
    shift_normals(&g, P);
    for (int k = 0; k < EVERY; k++) {
        shift_group(&g, P, every[k], true);
        assert_int_equal(g.order[0], -1);
        CHECK(g.tau[0], ==, 0);
        CHECK(g.n_bump.y[0], >, R(0.999999));
    }
    bump_free(P);
    surface_free(f);
}

/* Second partials of Q cost; only 2+ and march use the curvature. */
static void curvature_is_asked_for(void **state)
{
    (void)state;
    for (int k = 0; k < EVERY; k++) {
        const bool uses = every[k].kind == METHOD_MARCH || (every[k].kind == METHOD_ORDER && every[k].n == 3);
        assert_int_equal(method_bends(every[k]), uses);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(curvature_is_asked_for),
        cmocka_unit_test(no_bump_no_shift),
        cmocka_unit_test(constant_is_exact_for_all),
        cmocka_unit_test(linear_is_exact_from_order_1),
        cmocka_unit_test(quadratic_is_exact_for_order_2),
        cmocka_unit_test(lower_orders_are_not_exact),
        cmocka_unit_test(march_and_iter_come_near),
        cmocka_unit_test(counts),
        cmocka_unit_test(guarded_shifts_stay_in_the_slab),
        cmocka_unit_test(shifts_end_behind_the_rays_start),
        cmocka_unit_test(pole),
        cmocka_unit_test(march_below_the_top),
    };
    return cmocka_run_group_tests_name("the method over waves", tests, NULL, NULL);
}
