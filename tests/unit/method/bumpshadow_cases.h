/* bumpshadow.h against the golden vectors, 240 cases on five kinds of surface, computed at 50 digits by a program that
 * shares nothing with this one. Included by a test for float and one for double: the header is for either.
 *
 * tau loses digits where B (the sum of three terms) or B^2 - 4AC cancels; its bound grows by how much smaller the sum
 * is than its terms.
 */
#include "unit/method/golden_values.h"

/* One order, bare, against the golden tau; null where there is no real root on the branch of order 1. */
static void near_tau(int line, struct fy_node *c, const char *key, bs_shift s, double condition, int order)
{
    double want;
    if (!golden_number(golden_get(c, key), &want)) {
        assert_int_not_equal(s.order, order);
        return;
    }
    assert_int_equal(s.order, order);
    near(line, (double)s.tau, want, fabs(want) * condition);
}

static void golden(void **state)
{
    struct fy_document *d = golden_open(KAGE_TESTS_DIR "/golden/method.json");
    struct fy_node *cases = golden_get(fy_document_root(d), "cases");
    const int n = fy_node_sequence_item_count(cases);
    const bs_slab all = {(bs_real)-INFINITY, (bs_real)INFINITY};
    int plain = 0;
    (void)state;
    assert_int_equal(n, 240);
    for (int i = 0; i < n; i++) {
        struct fy_node *c = fy_node_sequence_get_by_index(cases, i);
        const bs_vec3 Qu = vector(c, "Qu"), Qw = vector(c, "Qw"), s = vector(c, "s");
        const bs_bump p = {number(c, "P"),   number(c, "Pu"),  number(c, "Pw"),
                           number(c, "Puu"), number(c, "Puw"), number(c, "Pww")};
        const bs_vec3 nv = bs_normal(Qu, Qw);
        const bs_view v = bs_view_of(s, nv, Qu, Qw);
        near_vector(i, nv, vector(c, "n"));
        near_vector(i, bs_perturbed_normal(nv, Qu, Qw, p.Pu, p.Pw), vector(c, "n_perturbed"));
        /* a and b against |s| times the inverse of the edges: either may vanish by itself */
        near(i, (double)v.a, (double)number(c, "dudt"), sqrt((double)(bs_dot(s, s) / bs_dot(Qu, Qu))));
        near(i, (double)v.b, (double)number(c, "dwdt"), sqrt((double)(bs_dot(s, s) / bs_dot(Qw, Qw))));

        const bs_real k = bs_curvature(v, nv, vector(c, "Quu"), vector(c, "Quw"), vector(c, "Qww"));
        const bs_real B = bs_slope(v, p), A = bs_quadratic(v, p), Aplus = bs_quadratic_plus(v, p, k);
        const double terms = fabs((double)(p.Pu * v.a)) + fabs((double)(p.Pw * v.b)) + fabs((double)v.sn);
        const double one = terms / fabs((double)B);
        const double disc = (double)(B * B - 4 * A * p.P), discplus = (double)(B * B - 4 * Aplus * p.P);
        const double two = one * fmax(1, (double)(B * B) / fabs(disc)) + fabs((double)(4 * A * p.P)) / fabs(disc);
        const double plus =
            one * fmax(1, (double)(B * B) / fabs(discplus)) + 4 * fabs((double)(Aplus * p.P)) / fabs(discplus);
        plain += one < 2 && two < 4 && plus < 4;
        near_tau(i, c, "tau_order0", bs_shift_of(0, 0, v, 0, p, all), 1, 0);
        near_tau(i, c, "tau_order1", bs_shift_of(1, 0, v, 0, p, all), one, 1);
        near_tau(i, c, "tau_order2", bs_shift_of(2, 0, v, 0, p, all), two, 2);
        near_tau(i, c, "tau_order2_full", bs_shift_of(3, 0, v, k, p, all), plus, 3);
    }
    /* the bounds have not been stretched for all */
    CHECK(plain, >, n / 2);
    fy_document_destroy(d);
}

/* The guard keeps what lies in the slab and goes down through the tangent plane, and falls back one order otherwise. */
static void guard(void **state)
{
    (void)state;
    bs_view v = {(bs_real)-0.5, 1, 0};
    bs_slab slab = bs_slab_of(v, (bs_real)-0.1, (bs_real)0.1);
    bs_bump gentle = {(bs_real)0.05, (bs_real)0.1, 0, (bs_real)0.1, 0, 0};
    bs_bump facing_away = {(bs_real)0.05, (bs_real)-0.7, 0, 0, 0, 0}; /* B = -0.7 + 0.5 < 0 */
    bs_bump far_off = {(bs_real)0.05, (bs_real)-0.49, 0, 0, 0, 0};    /* B = 0.01: tau = -5 */
    bs_bump no_root = {(bs_real)0.05, (bs_real)-0.4, 0, 2, 0, 0};     /* B^2 < 4AC; order 1 gives -0.5 */
    CHECK(slab.front, ==, (bs_real)-0.2);
    CHECK(slab.back, ==, (bs_real)0.2);
    for (int order = 0; order <= 3; order++)
        assert_int_equal(bs_shift_of(order, 1, v, 0, gentle, slab).order, order);
    for (int order = 0; order <= 3; order++) {
        const bs_shift a = bs_shift_of(order, 1, v, 0, facing_away, slab),
                       b = bs_shift_of(order, 1, v, 0, far_off, slab);
        const bs_shift c = bs_shift_of(order, 1, v, 0, no_root, slab);
        assert_int_equal(a.order, 0);
        assert_int_equal(b.order, 0);
        assert_int_equal(c.order, 0);
        CHECK(a.tau, ==, bs_tau0(v, (bs_real)0.05));
        CHECK(b.tau, ==, a.tau);
        CHECK(c.tau, ==, a.tau);
    }
    /* a slab that holds order 1 but not the quadratic's root */
    bs_slab wide = bs_slab_of(v, -1, 1);
    assert_int_equal(bs_shift_of(2, 1, v, 0, no_root, wide).order, 1);
    assert_int_equal(bs_shift_of(3, 1, v, 0, no_root, wide).order, 1);
    /* bare, the formulas stand, but for a root that is not there */
    assert_int_equal(bs_shift_of(1, 0, v, 0, far_off, slab).order, 1);
    CHECK(fabs((double)bs_shift_of(1, 0, v, 0, far_off, slab).tau + 5), <, 1e-4);
    assert_int_equal(bs_shift_of(2, 0, v, 0, no_root, slab).order, 1);
}

/* Seen from behind, the same place of the same rough surface is a surface with n and P turned: tau must be the same. */
static void from_behind(void **state)
{
    (void)state;
    const bs_vec3 Qu = {1, (bs_real)0.2, 0}, Qw = {(bs_real)0.1, (bs_real)0.3, (bs_real)1.2},
                  s = {(bs_real)0.3, 1, (bs_real)0.4};
    const bs_vec3 z = {(bs_real)0.1, (bs_real)0.05, 0};
    const bs_bump p = {(bs_real)0.04, (bs_real)0.2, (bs_real)-0.1, (bs_real)0.3, (bs_real)0.2, (bs_real)-0.4};
    /* u and w exchanged: n turns, so P and its partials change their sign */
    const bs_bump turned = {-p.P, -p.Pw, -p.Pu, -p.Pww, -p.Puw, -p.Puu};
    const bs_vec3 n = bs_normal(Qu, Qw), m = bs_normal(Qw, Qu);
    const bs_view v = bs_view_of(s, n, Qu, Qw), x = bs_view_of(s, m, Qw, Qu);
    const bs_slab a = bs_slab_of(v, (bs_real)-0.1, (bs_real)0.2), b = bs_slab_of(x, (bs_real)-0.2, (bs_real)0.1);
    CHECK(v.sn * x.sn, <, 0);
    CHECK(a.front, ==, b.front);
    CHECK(a.back, ==, b.back);
    for (int guarded = 0; guarded < 2; guarded++)
        for (int order = 0; order <= 3; order++) {
            bs_shift one = bs_shift_of(order, guarded, v, bs_curvature(v, n, z, z, z), p, a);
            bs_shift two = bs_shift_of(order, guarded, x, bs_curvature(x, m, z, z, z), turned, b);
            assert_int_equal(one.order, order);
            assert_int_equal(two.order, order);
            near(order, (double)one.tau, (double)two.tau, fabs((double)two.tau));
        }
    for (int N = 1; N <= 16; N *= 2) {
        bs_march f = bs_march_start(a), g = bs_march_start(b);
        for (int i = 0; i <= N; i++) {
            bs_real t = bs_march_tau(a, i, N);
            f = bs_march_step(f, t, bs_gap(v, 0, t, p.P + p.Pu * v.a * t + p.Pw * v.b * t), v);
            g = bs_march_step(g, t, bs_gap(x, 0, t, turned.P + turned.Pu * x.a * t + turned.Pw * x.b * t), x);
        }
        assert_true(f.found && g.found);
        near(N, (double)f.tau, (double)g.tau, fabs((double)f.tau) * 4);
        /* a linear P: the secant is exact */
        near(N, (double)f.tau, (double)bs_tau1(v, p), fabs((double)f.tau) * 4);
    }
}

/* Where P has no bound on one side or on both, every place of a march is finite, and none is taken. */
static void no_end(void **state)
{
    (void)state;
    const bs_real inf = (bs_real)INFINITY, low = (bs_real)-0.1, high = (bs_real)0.2;
    const bs_real bounds[3][2] = {{low, inf}, {-inf, high}, {-inf, inf}};
    for (int k = 0; k < 3 * 2 * 9; k++) {
        const bs_view v = {(bs_real)(k / 3 % 2 ? -0.5 : 0.5), 1, (bs_real)0.5};
        const bs_slab slab = bs_slab_of(v, bounds[k % 3][0], bounds[k % 3][1]);
        const int N = 1 + k / 6;
        bs_march below = bs_march_start(slab), above = below;
        assert_false(bs_slab_ends(slab));
        for (int i = 0; i <= N; i++) {
            const bs_real tau = bs_march_tau(slab, i, N);
            assert_true(isfinite(tau));
            below = bs_march_step(below, tau, bs_gap(v, 0, tau, low), v);
            above = bs_march_step(above, tau, bs_gap(v, 0, tau, high), v);
        }
        assert_false(below.found || above.found);
    }
    const bs_view along = {0, 1, 0}, down = {(bs_real)-0.5, 1, 0};
    assert_false(bs_slab_ends(bs_slab_of(along, low, high)) || bs_slab_ends(bs_slab_of(along, 0, high)));
    assert_true(bs_slab_ends(bs_slab_of(down, low, high)) && bs_slab_ends(bs_slab_of(down, 0, 0)));
}

static void poles(void **state)
{
    (void)state;
    const bs_vec3 e = {1, 0, 0}, thin = {0, (bs_real)1e-8, 0}, slim = {0, (bs_real)1e-5, 0}, zero = {0, 0, 0};
    assert_false(bs_regular(bs_normal(e, thin), e, thin));
    assert_false(bs_regular(bs_normal(e, zero), e, zero));
    assert_false(bs_regular(bs_normal(e, e), e, e));
    assert_true(bs_regular(bs_normal(e, slim), e, slim));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(golden), cmocka_unit_test(guard), cmocka_unit_test(from_behind),
        cmocka_unit_test(no_end), cmocka_unit_test(poles),
    };
    return cmocka_run_group_tests_name(BUMPSHADOW_NAME, tests, NULL, NULL);
}
