/* Horizon maps of functions against the true horizons of tests/golden/make_relief.py, found by brute force at 50
 * digits. */
#include <stdio.h>

#include "support/check.h"
#include "support/golden_json.h"
#include "texture/horizon.h"

enum { COLUMNS = 1200, ROWS = 2, ALL = 32, NUMBERS = 8 };

static double number(struct fy_node *c, const char *key)
{
    double x;
    assert_true(golden_number(golden_get(c, key), &x));
    return x;
}

static void list(struct fy_node *c, const char *key, int n, double *x)
{
    struct fy_node *v = golden_get(c, key);
    assert_int_equal(fy_node_sequence_item_count(v), n);
    for (int i = 0; i < n; i++)
        assert_true(golden_number(fy_node_sequence_get_by_index(v, i), &x[i]));
}

/* P = A (sin(f0 u + p0) cos(f1 w + p1) + sin(f2 u + f3 w + p2)/2), from A, f0 to f3 and p0 to p2. */
static bump *bump_of(const double *x)
{
    char text[400];
    const double all[2] = {-HUGE_VAL, HUGE_VAL};
    expr_error wrong;
    snprintf(text, sizeof text, "sin(%.17g*u+%.17g)*cos(%.17g*w+%.17g)+sin(%.17g*u+%.17g*w+%.17g)/2", x[1], x[5], x[2],
             x[6], x[3], x[4], x[7]);
    bump *p = bump_function_new(expr_parse(text, &wrong), x[0], all, all);
    assert_non_null(p);
    return p;
}

/* A map's samples are the golden place's apart, or `finer` times as near. A walk looks at P by steps, so it finds a
 * horizon that is a little low. The first steps are one sample wide: they miss half of P's second derivative along the
 * way at most. Later ones are 1/16 of the way t: next to the highest place they are off by half of that, and miss 1/2
 * P'' (t/32)^2 of the height there, over t. Besides a walk ends where no more than 1/200 of the steepest slope is to
 * win.
 */
static int case_at(struct fy_node *c, int finer)
{
    double x[NUMBERS], around[ALL];
    list(c, "bumps", NUMBERS, x);
    list(c, "around", ALL, around);
    const double u = number(c, "u"), w = number(c, "w"), ku = finer * number(c, "ku"), kw = finer * number(c, "kw");
    bump *p = bump_of(x);
    const table_grid grid = {.columns = COLUMNS,
                             .rows = ROWS,
                             .ku = (real)ku,
                             .kw = (real)kw,
                             .ou = (real)(COLUMNS / 2 - u * ku),
                             .ow = (real)(ROWS / 2 - w * kw)};
    horizon *h = horizon_new(p, &grid, false, NULL, 1, NULL);
    assert_non_null(h);
    int near = 0;
    for (int k = 0; k < HORIZON_DIRECTIONS; k++) {
        const real U = (real)u, W = (real)w, bearing = (real)(4.0 * k / HORIZON_DIRECTIONS);
        real rise;
        horizon_look(h, 1, &U, &W, &bearing, &rise);
        const double want = around[k * ALL / HORIZON_DIRECTIONS] / finer;
        const double a = fabs(fabs(2 - (double)bearing) - 1) / ku, b = (1 - fabs(fabs(2 - (double)bearing) - 1)) / kw;
        const double f = x[1] * a + x[2] * b, g = x[3] * a + x[4] * b, bend = x[0] * (f * f + g * g / 2);
        const double t = 3 * x[0] / want, least = ((double)p->Pu_max * a + (double)p->Pw_max * b) / 200;
        const double rounding = 1e3 * EPS * x[0], low = want - bend / 2 * (1 + t / 1024) - least - rounding;
        BETWEEN(t < COLUMNS ? low : 0, rise, want + rounding);
        near += t < COLUMNS;
    }
    horizon_free(h);
    bump_free(p);
    return near;
}

static void golden(void **state)
{
    (void)state;
    struct fy_document *d = golden_open(KAGE_TESTS_DIR "/golden/relief.json");
    struct fy_node *cases = golden_get(fy_document_root(d), "horizons");
    const int n = fy_node_sequence_item_count(cases);
    int near = 0;
    CHECK(n, >=, 12);
    for (int i = 0; i < n; i++)
        for (int finer = 1; finer <= 4; finer *= 2)
            near += case_at(fy_node_sequence_get_by_index(cases, i), finer);
    CHECK(near, >, 0.8 * n * 3 * HORIZON_DIRECTIONS);
    fy_document_destroy(d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(golden)};
    return cmocka_run_group_tests_name("horizon maps against golden horizons", tests, NULL, NULL);
}
