/* Interval arithmetic: every value of a function at random places of random intervals is in its range, and the range is
 * not much wider than the values. */
#include "support/check.h"

#include "math/interval.h"
#include "math/noise.h"
#include "support/random_in.h"

enum { TRIES = 3000, PLACES = 60 };

static interval random_interval(double lo, double hi, double widest)
{
    const double a = random_in(lo, hi), b = fmin(hi, a + random_in(0, widest));
    return (interval){a, b};
}

static double place(interval a, int k) { return k == 0 ? a.lo : k == 1 ? a.hi : random_in(a.lo, a.hi); }

/* The least and greatest values seen are in the range; where many places lie in a small interval they nearly fill it.
 */
static void expect_range(const char *name, interval a, interval range, interval seen, double slack)
{
    if (!(range.lo <= seen.lo && seen.hi <= range.hi))
        fail_msg("%s over %.17g .. %.17g: %.17g .. %.17g, but values %.17g .. %.17g", name, a.lo, a.hi, range.lo,
                 range.hi, seen.lo, seen.hi);
    if (!(seen.lo - range.lo <= slack && range.hi - seen.hi <= slack))
        fail_msg("%s over %.17g .. %.17g: %.17g .. %.17g, but values only %.17g .. %.17g", name, a.lo, a.hi, range.lo,
                 range.hi, seen.lo, seen.hi);
}

static void check(const char *name, interval (*range)(interval), double (*f)(double), double lo, double hi)
{
    for (int i = 0; i < TRIES; i++) {
        const interval a = random_interval(lo, hi, i % 2 ? 0.1 : hi - lo);
        interval seen = {HUGE_VAL, -HUGE_VAL};
        double steps = 0, last = f(a.lo);
        for (int k = 0; k <= PLACES; k++) {
            const double v = f(fmin(a.hi, a.lo + (a.hi - a.lo) * k / PLACES));
            seen = (interval){fmin(seen.lo, v), fmax(seen.hi, v)};
            steps = fmax(steps, fabs(v - last));
            last = v;
        }
        expect_range(name, a, range(a), seen, steps + 1e-13);
    }
}

static double at_sin(double x) { return km_sin(x); }
static double at_cos(double x) { return km_cos(x); }
static double at_tan(double x) { return km_tan(x); }
static double at_asin(double x) { return km_asin(x); }
static double at_acos(double x) { return km_acos(x); }
static double at_atan(double x) { return km_atan(x); }
static double at_sinh(double x) { return km_sinh(x); }
static double at_cosh(double x) { return km_cosh(x); }
static double at_tanh(double x) { return km_tanh(x); }
static double at_exp(double x) { return km_exp(x); }
static double at_log(double x) { return km_log(x); }

static void test_trigonometric(void **state)
{
    (void)state;
    check("sin", interval_sin, at_sin, -10, 10);
    check("cos", interval_cos, at_cos, -10, 10);
    check("tan", interval_tan, at_tan, -1.5, 1.5);
}

static void test_inverse(void **state)
{
    (void)state;
    check("asin", interval_asin, at_asin, -1, 1);
    check("acos", interval_acos, at_acos, -1, 1);
    check("atan", interval_atan, at_atan, -9, 9);
}

static void test_hyperbolic(void **state)
{
    (void)state;
    check("sinh", interval_sinh, at_sinh, -4, 4);
    check("cosh", interval_cosh, at_cosh, -4, 4);
    check("tanh", interval_tanh, at_tanh, -4, 4);
}

static void test_exponential(void **state)
{
    (void)state;
    check("exp", interval_exp, at_exp, -5, 5);
    check("log", interval_log, at_log, 0.01, 5);
    check("sqrt", interval_sqrt, sqrt, 0, 5);
}

static void test_abs_and_floor(void **state)
{
    (void)state;
    check("abs", interval_abs, fabs, -3, 3);
    check("floor", interval_floor, floor, -3, 3);
}

/* ---- two operands ---- */

static void check2(const char *name, interval (*range)(interval, interval), double (*f)(double, double), double lo,
                   double hi)
{
    for (int i = 0; i < TRIES; i++) {
        const interval a = random_interval(lo, hi, 1), b = random_interval(lo, hi, 1), z = range(a, b);
        for (int k = 0; k < PLACES; k++) {
            const double x = place(a, k % 7), y = place(b, k % 5), v = f(x, y);
            if (!isnan(v) && !(z.lo <= v && v <= z.hi))
                fail_msg("%s of %.17g and %.17g is %.17g, outside %.17g .. %.17g", name, x, y, v, z.lo, z.hi);
        }
    }
}

static double at_add(double x, double y) { return x + y; }
static double at_multiply(double x, double y) { return x * y; }
static double at_mod(double x, double y) { return km_mod(x, y); }
static double at_pow(double x, double y) { return km_pow(x, y); }
static double at_atan2(double x, double y) { return km_atan2(x, y); }

static void test_two_operands(void **state)
{
    (void)state;
    check2("add", interval_add, at_add, -3, 3);
    check2("multiply", interval_multiply, at_multiply, -3, 3);
    check2("mod", interval_mod, at_mod, -3, 3);
    check2("pow", interval_pow, at_pow, -2, 2);
    check2("atan2", interval_atan2, at_atan2, -2, 2);
}

static void expect(interval z, double lo, double hi)
{
    CHECK(z.lo, ==, lo);
    CHECK(z.hi, ==, hi);
}

/* ---- edges ---- */

static void test_zero_stays_zero(void **state)
{
    (void)state;
    expect(interval_multiply(interval_zero, interval_all), 0, 0);
    CHECK(interval_square((interval){-1, 2}).lo, ==, 0);
    expect(interval_widen(interval_zero, 1), 0, 0);
}

static void test_an_underflow_is_not_zero(void **state)
{
    (void)state;
    CHECK(interval_multiply(interval_at(1e-200), interval_at(1e-200)).hi, >, 0);
    CHECK(interval_multiply(interval_at(1e-200), interval_at(-1e-200)).lo, <, 0);
    CHECK(interval_exp(interval_at(-1000)).hi, >, 0);
}

/* -0 is 0 as a base: 0^-1 is beyond all bounds, 0^0 is 1. */
static void test_powers_of_zero(void **state)
{
    (void)state;
    CHECK(km_pow(-0.0, -1), ==, HUGE_VAL);
    const interval z = interval_pow(interval_at(-0.0), (interval){-1, 1});
    CHECK(z.lo, <=, 0);
    CHECK(z.hi, >=, 1);
}

static void test_reciprocal_at_zero(void **state)
{
    (void)state;
    expect(interval_reciprocal((interval){-1, 1}), -HUGE_VAL, HUGE_VAL);
    expect(interval_reciprocal(interval_zero), -HUGE_VAL, HUGE_VAL);
    CHECK(interval_reciprocal((interval){0, 2}).hi, ==, HUGE_VAL);
    NEAR(interval_reciprocal((interval){0, 2}).lo, 0.5, 1e-15);
}

static void test_infinities_that_cancel_are_unknown(void **state)
{
    (void)state;
    expect(interval_add(interval_at(HUGE_VAL), interval_at(-HUGE_VAL)), -HUGE_VAL, HUGE_VAL);
}

static void test_outside_the_domain(void **state)
{
    (void)state;
    expect(interval_clip((interval){2, 3}, -1, 1), -1, 1);
    expect(interval_clip((interval){0.5, 3}, -1, 1), 0.5, 1);
}

static void test_large_angles(void **state)
{
    (void)state;
    expect(interval_sin((interval){1e6, 1e6 + 0.1}), -1, 1);
    expect(interval_tan((interval){1e6, 1e6 + 0.1}), -HUGE_VAL, HUGE_VAL);
}

/* ---- noise ---- */

static void expect_in(const char *name, interval z, double v)
{
    if (!interval_has(z, v))
        fail_msg("%s is %.17g, outside %.17g .. %.17g", name, v, z.lo, z.hi);
}

static void test_noise(void **state)
{
    (void)state;
    for (int i = 0; i < TRIES; i++) {
        const double size = i % 3 == 0 ? 0.01 : i % 3 == 1 ? 0.3 : 3;
        const interval x = random_interval(-9, 9, size), y = random_interval(-9, 9, size);
        const noise_bounds b = noise_bounds_over(x, y);
        for (int k = 0; k < PLACES; k++) {
            const noise_jet n = noise_at(place(x, k % 6), place(y, k % 4));
            expect_in("noise", b.f, n.f);
            expect_in("its slope along x", b.x, n.x);
            expect_in("its slope along y", b.y, n.y);
            expect_in("its second partial xx", b.xx, n.xx);
            expect_in("its second partial xy", b.xy, n.xy);
            expect_in("its second partial yy", b.yy, n.yy);
        }
    }
}

static void test_noise_bounds_of_a_point_are_close(void **state)
{
    (void)state;
    const noise_bounds b = noise_bounds_over(interval_at(0.3), interval_at(7.8));
    NEAR(b.f.lo, b.f.hi, 1e-11);
    NEAR(b.xx.lo, b.xx.hi, 1e-11);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_trigonometric),
        cmocka_unit_test(test_inverse),
        cmocka_unit_test(test_hyperbolic),
        cmocka_unit_test(test_exponential),
        cmocka_unit_test(test_abs_and_floor),
        cmocka_unit_test(test_two_operands),
        cmocka_unit_test(test_zero_stays_zero),
        cmocka_unit_test(test_an_underflow_is_not_zero),
        cmocka_unit_test(test_powers_of_zero),
        cmocka_unit_test(test_reciprocal_at_zero),
        cmocka_unit_test(test_infinities_that_cancel_are_unknown),
        cmocka_unit_test(test_outside_the_domain),
        cmocka_unit_test(test_large_angles),
        cmocka_unit_test(test_noise),
        cmocka_unit_test(test_noise_bounds_of_a_point_are_close),
    };
    return cmocka_run_group_tests_name("interval", tests, NULL, NULL);
}
