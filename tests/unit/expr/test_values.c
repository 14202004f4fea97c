/* Values and derivatives: against golden ones, against differences, at edges, and the same bytes in every batch. */
#include "unit/expr/expressions.h"

#include <libfyaml.h>
#include <math.h>

/* ---- golden values ---- */

static double number_in(struct fy_node *row, int i)
{
    return strtod(fy_node_get_scalar0(fy_node_sequence_get_by_index(row, i)), NULL);
}

/* Each part within 1e-13 of the largest part of its jet. The elementary functions err by up to 3 ulp, 7e-16;
 * an intermediate argument of size x is off by x ulps of 1 before the next function magnifies that, and a
 * partial sums some ten products: the worst seen here is 1.5e-14. */
static void test_golden(void **state)
{
    (void)state;
    struct fy_parse_cfg cfg = {.flags = FYPCF_QUIET};
    struct fy_document *doc = fy_document_build_from_file(&cfg, KAGE_TESTS_DIR "/golden/expr.json");
    assert_non_null(doc);
    struct fy_node *cases = fy_node_mapping_lookup_by_string(fy_document_root(doc), "cases", (size_t)-1);
    int count = fy_node_sequence_item_count(cases), rows_seen = 0;
    CHECK(count, >, 40);
    double worst = 0;
    for (int c = 0; c < count; c++) {
        struct fy_node *one = fy_node_sequence_get_by_index(cases, c);
        const char *text = fy_node_get_scalar0(fy_node_mapping_lookup_by_string(one, "text", (size_t)-1));
        struct fy_node *rows = fy_node_mapping_lookup_by_string(one, "rows", (size_t)-1);
        expr *e = parse(text);
        for (int r = 0; r < fy_node_sequence_item_count(rows); r++, rows_seen++) {
            struct fy_node *row = fy_node_sequence_get_by_index(rows, r);
            double u = number_in(row, 0), w = number_in(row, 1), want[JET], got[JET], scale = 0;
            for (int i = 0; i < JET; i++) {
                want[i] = number_in(row, 2 + i);
                scale = fmax(scale, fabs(want[i]));
            }
            jet_at(e, u, w, got);
            for (int i = 0; i < JET; i++) {
                worst = fmax(worst, fabs(got[i] - want[i]) / scale);
                if (!(fabs(got[i] - want[i]) <= 1e-13 * scale))
                    fail_msg("%s at %.17g %.17g, part %d: %.17g, golden %.17g", text, u, w, i, got[i], want[i]);
            }
        }
        expr_free(e);
    }
    print_message("%d golden jets, worst error %.2g of the scale\n", rows_seen, worst);
    fy_document_destroy(doc);
}

/* Central differences, extrapolated twice (Richardson), of part `from` in u or w. */
static double difference(const expr *e, int from, bool in_u, double u, double w, double h)
{
    double d[3];
    for (int k = 0; k < 3; k++, h /= 2) {
        double a[JET], b[JET];
        jet_at(e, u + (in_u ? h : 0), w + (in_u ? 0 : h), a);
        jet_at(e, u - (in_u ? h : 0), w - (in_u ? 0 : h), b);
        d[k] = (a[from] - b[from]) / (2 * h);
    }
    double e1 = (4 * d[1] - d[0]) / 3, e2 = (4 * d[2] - d[1]) / 3;
    return (16 * e2 - e1) / 15;
}

/* First partials against differences of the value, second ones against differences of the first (which the
 * first part has just confirmed). The error of the differences is h^6 times a seventh derivative plus
 * rounding, 1e-16/h: with h = 1e-3, about 1e-7 of the scale for the wildest of these expressions. */
static void test_differences(void **state)
{
    (void)state;
    static const struct {
        int part, from;
        bool in_u;
    } checks[] = {{1, 0, true}, {2, 0, false}, {3, 1, true}, {4, 1, false}, {4, 2, true}, {5, 2, false}};
    draw_state = 1;
    int checked = 0, skipped = 0;
    for (int i = 0; i < 3000; i++) {
        char text[4096];
        expr *e = random_parsed(text, 1 + i % 4, true);
        double u = draw_in(-1.5, 1.5), w = draw_in(-1.5, 1.5), jet[JET], scale = 1;
        jet_at(e, u, w, jet);
        for (int k = 0; k < JET; k++)
            scale = fmax(scale, fabs(jet[k]));
        if (scale < 1e3)
            for (int k = 0; k < 6; k++) {
                double d = difference(e, checks[k].from, checks[k].in_u, u, w, 1e-3);
                double finer = difference(e, checks[k].from, checks[k].in_u, u, w, 5e-4);
                if (fabs(d - finer) > 1e-8 * scale) { /* the differences themselves have not converged */
                    skipped++;
                    continue;
                }
                checked++;
                if (!(fabs(finer - jet[checks[k].part]) <= 1e-6 * scale))
                    fail_msg("%s at %g %g, part %d: %.12g, differences %.12g", text, u, w, checks[k].part,
                             jet[checks[k].part], finer);
            }
        expr_free(e);
    }
    CHECK(checked, >, 15000);
    CHECK(skipped, <, checked / 20);
}

/* ---- batches, orders ---- */

/* The same bytes, except that a NaN is a NaN: which operand's sign it takes is the compiler's choice. */
static void assert_same(const char *text, const double *a, const double *b, int n)
{
    for (int i = 0; i < n; i++)
        if (memcmp(&a[i], &b[i], sizeof *a) != 0 && !(isnan(a[i]) && isnan(b[i])))
            fail_msg("not the same bytes: %s: %.17g, %.17g", text, a[i], b[i]);
}

/* Any batch size gives the bytes of single points; lower orders give those of order 2 and leave the rest. */
static void test_same_bytes(void **state)
{
    (void)state;
    draw_state = 2;
    for (int i = 0; i < 600; i++) {
        char text[4096];
        expr *e = random_parsed(text, 1 + i % 4, false);
        double u[EXPR_BATCH], w[EXPR_BATCH];
        for (int k = 0; k < EXPR_BATCH; k++) {
            u[k] = draw_in(-3, 3);
            w[k] = draw_in(-3, 3);
        }
        expr_jets one[EXPR_BATCH], batch, lower, untouched;
        for (int k = 0; k < EXPR_BATCH; k++)
            expr_eval(e, 1, &u[k], &w[k], 2, &one[k]);
        memset(&untouched, 0x5a, sizeof untouched);
        int n = 1 + i % EXPR_BATCH;
        batch = untouched;
        expr_eval(e, n, u, w, 2, &batch);
        for (int k = 0; k < n; k++) {
            double a[JET], b[JET];
            part_of(&one[k], 0, a);
            part_of(&batch, k, b);
            assert_same(text, a, b, JET);
        }
        lower = untouched;
        expr_eval(e, n, u, w, 1, &lower);
        assert_same(text, lower.v, batch.v, n);
        assert_same(text, lower.u, batch.u, n);
        assert_same(text, lower.w, batch.w, n);
        assert_memory_equal(lower.uu, untouched.uu, sizeof lower.uu);
        assert_memory_equal(lower.uw, untouched.uw, sizeof lower.uw);
        assert_memory_equal(lower.ww, untouched.ww, sizeof lower.ww);
        lower = untouched;
        expr_eval(e, n, u, w, 0, &lower);
        assert_same(text, lower.v, batch.v, n);
        assert_memory_equal(lower.u, untouched.u, sizeof lower.u);
        assert_memory_equal(lower.w, untouched.w, sizeof lower.w);
        expr_free(e);
    }
}

/* ---- particular values ---- */

static void check_jet(const char *text, double u, double w, double v, double fu, double fw, double uu, double uw,
                      double ww)
{
    const double want[JET] = {v, fu, fw, uu, uw, ww};
    double got[JET];
    expr *e = parse(text);
    jet_at(e, u, w, got);
    for (int i = 0; i < JET; i++)
        if (!(got[i] == want[i] || (got[i] != got[i] && want[i] != want[i])))
            fail_msg("%s at %g %g, part %d: %.17g, expected %.17g", text, u, w, i, got[i], want[i]);
    expr_free(e);
}

static void test_edges(void **state)
{
    (void)state;
    const double inf = HUGE_VAL, nan_ = (double)NAN;
    check_jet("u^2", 0, 0, 0, 0, 0, 2, 0, 0);
    check_jet("u^2", -3, 0, 9, -6, 0, 2, 0, 0);
    check_jet("u^3", -2, 0, -8, 12, 0, -12, 0, 0);
    check_jet("u^1", 0, 0, 0, 1, 0, 0, 0, 0);
    check_jet("u^0", 0, 0, 1, 0, 0, 0, 0, 0);
    check_jet("pow(0,0)", 0, 0, 1, 0, 0, 0, 0, 0);
    check_jet("u^2.5", 0, 0, 0, 0, 0, 0, 0, 0);
    check_jet("u^1.5", 0, 0, 0, 0, 0, inf, 0, 0);
    check_jet("u^17", 0, 0, 0, 0, 0, 0, 0, 0);
    check_jet("u^-1", 2, 0, 0.5, -0.25, 0, 0.25, 0, 0);
    check_jet("-u^2", 3, 0, -9, -6, 0, -2, 0, 0);
    check_jet("2^3^2", 0, 0, 512, 0, 0, 0, 0, 0);
    check_jet("2^-2", 0, 0, 0.25, 0, 0, 0, 0, 0);
    check_jet("--u", 3, 0, 3, 1, 0, 0, 0, 0);
    check_jet("1-2-3", 0, 0, -4, 0, 0, 0, 0, 0);
    check_jet("8/4/2", 0, 0, 1, 0, 0, 0, 0, 0);
    check_jet(" .5e1 + 1.E0\t*\n2 ", 0, 0, 7, 0, 0, 0, 0, 0);
    check_jet("abs(u)", 0, 0, 0, 0, 0, 0, 0, 0);
    check_jet("abs(u*w)", -2, 3, 6, -3, 2, 0, -1, 0);
    check_jet("sqrt(u)", 0, 0, 0, inf, 0, -inf, 0, 0);
    check_jet("sqrt(u^2+w^2)", 0, 0, 0, 0, 0, inf, 0, inf);
    check_jet("sqrt(u*0+4)", 0, 0, 2, 0, 0, 0, 0, 0);
    check_jet("sqrt(u)*w", 0, 0, 0, 0, 0, 0, inf, 0);
    check_jet("floor(u)", 1.5, 0, 1, 0, 0, 0, 0, 0);
    check_jet("mod(u,3)", 7.5, 0, 1.5, 1, 0, 0, 0, 0);
    check_jet("mod(u,3)", -7.5, 0, -1.5, 1, 0, 0, 0, 0);
    check_jet("mod(u,w)", 7.5, -3, 1.5, 1, 2, 0, 0, 0);
    check_jet("mod(u,0)", 1, 0, nan_, 1, 0, 0, 0, 0);
    check_jet("min(u,w)", 1, 2, 1, 1, 0, 0, 0, 0);
    check_jet("max(u,w,1.5)", 1, 2, 2, 0, 1, 0, 0, 0);
    check_jet("clamp(u,-1,1)", 3, 0, 1, 0, 0, 0, 0, 0);
    check_jet("clamp(u,-1,1)", 0.5, 0, 0.5, 1, 0, 0, 0, 0);
    check_jet("select(u,1,w)", -1, 7, 1, 0, 0, 0, 0, 0);
    check_jet("select(u,1,w)", 0, 7, 7, 0, 1, 0, 0, 0);
    check_jet("select(u,1,w,u*u)", -2, 7, 1, 0, 0, 0, 0, 0);
    check_jet("select(u,1,w,u*u)", 0, 7, 7, 0, 1, 0, 0, 0);
    check_jet("select(u,1,w,u*u)", 2, 7, 4, 4, 0, 2, 0, 0);
    check_jet("smoothstep(1,3,u)", 2, 0, 0.5, 0.75, 0, 0, 0, 0);
    check_jet("smoothstep(1,3,u)", 1.5, 0, 0.15625, 0.5625, 0, 0.75, 0, 0);
    check_jet("smoothstep(1,3,u)", 1, 0, 0, 0, 0, 0, 0, 0);
    check_jet("smoothstep(1,3,u)", 3, 0, 1, 0, 0, 0, 0, 0);
    check_jet("smoothstep(u,w,2)", 1, 3, 0.5, -0.375, -0.375, -0.375, 0, 0.375);
    check_jet("smoothstep(w,u,3)", 1, 1, 1, 0, 0, 0, 0, 0); /* b = a: a step */
    check_jet("smoothstep(w,u,0)", 1, 1, 0, 0, 0, 0, 0, 0);
    check_jet("smoothstep(1,3,log(u))", -1, 0, nan_, nan_, 0, nan_, 0, 0);
    check_jet("log(u)", -1, 0, nan_, -1, 0, -1, 0, 0);
    check_jet("max(log(u),0)", -1, 0, nan_, nan_, 0, nan_, 0, 0);
    check_jet("select(log(u),0,1)", -1, 0, nan_, 0, 0, 0, 0, 0);
}

static void test_noise_is_bounded(void **state)
{
    (void)state;
    draw_state = 4;
    expr *e = parse("noise(u,w)");
    double lo = 0, hi = 0;
    for (int i = 0; i < 200000; i++) {
        double span = i % 2 ? 50 : 1e12, v = value_at(e, draw_in(-span, span), draw_in(-span, span));
        BETWEEN(-1, v, 1);
        lo = fmin(lo, v);
        hi = fmax(hi, v);
    }
    CHECK(lo, <, -0.8);
    CHECK(hi, >, 0.8);
    CHECK(value_at(e, 5, -7), ==, 0);
    static const double huge[] = {2147483647.5, -2147483648.5, 4294967295.5, 1e15, -1e18, 1e300, -1e308};
    for (size_t i = 0; i < sizeof huge / sizeof huge[0]; i++)
        for (size_t k = 0; k < sizeof huge / sizeof huge[0]; k++)
            CHECK(fabs(value_at(e, huge[i], huge[k])), <=, 1);
    expr_free(e);
}

/* No finite argument, however large, takes sin and cos out of [-1, 1]. */
static void test_large_angles(void **state)
{
    (void)state;
    expr *s = parse("sin(u)"), *c = parse("cos(u)");
    for (double x = 1; x < 1e308; x *= 1.37) {
        CHECK(fabs(value_at(s, x, 0)), <=, 1);
        CHECK(fabs(value_at(s, -x, 0)), <=, 1);
        CHECK(fabs(value_at(c, x, 0)), <=, 1);
        CHECK(fabs(value_at(c, -x, 0)), <=, 1);
    }
    expr_free(s);
    expr_free(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_golden), cmocka_unit_test(test_differences),      cmocka_unit_test(test_same_bytes),
        cmocka_unit_test(test_edges),  cmocka_unit_test(test_noise_is_bounded), cmocka_unit_test(test_large_angles),
    };
    return cmocka_run_group_tests_name("values", tests, NULL, NULL);
}
