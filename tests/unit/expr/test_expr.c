/* The expression language: golden values, derivatives against differences, bounds, and every error. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka needs the four above */
#include <cmocka.h>

#include <float.h>
#include <libfyaml.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "expr/expr.h"
#include "support/check.h"

#ifndef KAGE_TESTS_DIR
#define KAGE_TESTS_DIR "tests"
#endif

enum { JET = 6 };

static expr *parse(const char *text)
{
    expr_error error;
    expr *e = expr_parse(text, &error);
    if (!e)
        fail_msg("%s: %zu: %s", text, error.offset, error.message);
    return e;
}

static void part_of(const expr_jets *j, int i, double jet[JET])
{
    const double all[JET] = {j->v[i], j->u[i], j->w[i], j->uu[i], j->uw[i], j->ww[i]};
    memcpy(jet, all, sizeof all);
}

static void jet_at(const expr *e, double u, double w, double jet[JET])
{
    expr_jets out;
    expr_eval(e, 1, &u, &w, 2, &out);
    part_of(&out, 0, jet);
}

static double value_at(const expr *e, double u, double w)
{
    expr_jets out;
    expr_eval(e, 1, &u, &w, 0, &out);
    return out.v[0];
}

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

/* ---- random expressions ---- */

static uint64_t draw_state;

static uint32_t draw(uint32_t n)
{
    draw_state = draw_state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(draw_state >> 33) % n;
}

static double draw_in(double lo, double hi) { return lo + (hi - lo) * draw(1u << 30) / (double)(1u << 30); }

/* Append a random expression to `text`; smooth ones leave out what has edges. */
static void random_expr(char *text, size_t size, int depth, bool smooth)
{
    static const char *const forms[] = {"(%+%)",
                                        "(%-%)",
                                        "%*%",
                                        "%/(2+%^2)",
                                        "sin(%)",
                                        "cos(%)",
                                        "-(%)",
                                        "(%)^2",
                                        "(%)^3",
                                        "exp(sin(%))",
                                        "tanh(%)",
                                        "atan(%)",
                                        "sqrt(1+(%)^2)",
                                        "log(2+sin(%))",
                                        "sinh(sin(%))",
                                        "cosh(cos(%))",
                                        "noise(%,%)",
                                        "atan2(%,3+sin(%))",
                                        "asin(0.9*sin(%))",
                                        "acos(0.9*cos(%))",
                                        "tan(cos(%))",
                                        "(1.5+cos(%))^sin(%)",
                                        "(2+sin(%))^-1.5",
                                        "(1+(%)^2)^-2",
                                        "abs(%)",
                                        "floor(%)",
                                        "min(%,%,%)",
                                        "max(%,%)",
                                        "mod(%,2+sin(%))",
                                        "clamp(%,-1,sin(%))",
                                        "select(%,%,%)",
                                        "select(%,%,%,%)",
                                        "sqrt(%)",
                                        "log(%)",
                                        "%/%",
                                        "(%)^(%)",
                                        "asin(%)",
                                        "acos(%)",
                                        "tan(%)",
                                        "exp(%)",
                                        "(%)^-3",
                                        "(%)^0.7",
                                        "atan2(%,%)",
                                        "mod(%,%)",
                                        "smoothstep(%,%,%)",
                                        "cosh(%)",
                                        "sinh(%)"};
    size_t n = strlen(text);
    if (depth == 0 || n > 1500) {
        static const char *const pieces[] = {"u", "w", "u", "w", "(u-w)"};
        if (draw(3) == 0)
            snprintf(text + n, size - n, "%.3f", draw_in(0, 3));
        else
            snprintf(text + n, size - n, "%s", pieces[draw(5)]);
        return;
    }
    const char *form = forms[draw(smooth ? 24 : (uint32_t)(sizeof forms / sizeof forms[0]))];
    for (const char *f = form; *f; f++)
        if (*f == '%')
            random_expr(text, size, depth - 1, smooth);
        else {
            n = strlen(text);
            text[n] = *f;
            text[n + 1] = 0;
        }
}

static expr *random_parsed(char text[4096], int depth, bool smooth)
{
    text[0] = 0;
    random_expr(text, 4096, depth, smooth);
    return parse(text);
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

/* ---- bounds ---- */

static void test_range_holds(void **state)
{
    (void)state;
    draw_state = 3;
    int inside = 0, finite = 0;
    for (int i = 0; i < 4000; i++) {
        char text[4096];
        expr *e = random_parsed(text, 1 + i % 4, false);
        double size = i % 3 == 0 ? 0.05 : i % 3 == 1 ? 1 : 30;
        double u0 = draw_in(-2, 2), w0 = draw_in(-2, 2), u1 = u0 + draw_in(0, size), w1 = w0 + draw_in(0, size);
        double lo, hi;
        expr_bound_value(e, u0, u1, w0, w1, &lo, &hi);
        CHECK(lo, <=, hi);
        finite += isfinite(lo) && isfinite(hi);
        for (int k = 0; k < 40; k++) {
            double u = k & 1 ? draw_in(u0, u1) : k & 2 ? u0 : u1, w = k & 4 ? draw_in(w0, w1) : k & 8 ? w0 : w1;
            double v = value_at(e, u, w);
            if (!isfinite(v))
                continue;
            inside++;
            if (!(lo <= v && v <= hi))
                fail_msg("%s at %.17g %.17g is %.17g, outside %.17g .. %.17g", text, u, w, v, lo, hi);
        }
        expr_free(e);
    }
    CHECK(inside, >, 80000);
    CHECK(finite, >, 2000);
}

static void check_range(const char *text, double u0, double u1, double w0, double w1, double lo, double hi)
{
    expr *e = parse(text);
    double l, h;
    expr_bound_value(e, u0, u1, w0, w1, &l, &h);
    double slack = 1e-13;
    bool low = l == lo || (l <= lo && l >= lo - slack * (1 + fabs(lo)));
    bool high = h == hi || (h >= hi && h <= hi + slack * (1 + fabs(hi)));
    if (!low || !high)
        fail_msg("%s: %.17g .. %.17g, expected %.17g .. %.17g", text, l, h, lo, hi);
    expr_free(e);
}

static void test_range_tight(void **state)
{
    (void)state;
    const double inf = HUGE_VAL, pi = 3.141592653589793;
    check_range("u", -1, 2, 0, 0, -1, 2);
    check_range("1.5", -1, 2, 0, 0, 1.5, 1.5);
    check_range("u+2*w-1", -1, 2, 0, 3, -2, 7);
    check_range("sin(u)", 0, 1, 0, 0, 0, 0.84147098480789651);
    check_range("sin(u)", 0, 2, 0, 0, 0, 1);
    check_range("sin(u)", 4, 5, 0, 0, -1, -0.75680249530792820);
    check_range("sin(u)", 100, 107, 0, 0, -1, 1);
    check_range("sin(u)", -inf, inf, 0, 0, -1, 1);
    check_range("cos(u)", -0.5, 0.25, 0, 0, 0.87758256189037276, 1);
    check_range("cos(u)", 2, 4, 0, 0, -1, -0.41614683654714241);
    check_range("tan(u)", -1, 1, 0, 0, -1.5574077246549023, 1.5574077246549023);
    check_range("tan(u)", 1, 2, 0, 0, -inf, inf);
    check_range("u^2", -1, 2, 0, 0, 0, 4);
    check_range("u*u", -3, 2, 0, 0, 0, 9);
    check_range("u^3", -1, 2, 0, 0, -1, 8);
    check_range("u^-2", -1, 2, 0, 0, 0.25, inf);
    check_range("u^0.5", -1, 4, 0, 0, 0, 2);
    check_range("2^u", -1, 3, 0, 0, 0.5, 8);
    check_range("1/u", 0, 2, 0, 0, 0.5, inf);
    check_range("1/u", -1, 2, 0, 0, -inf, inf);
    check_range("exp(-u^2)", -inf, inf, 0, 0, 0, 1);
    check_range("log(u)", -1, 1, 0, 0, -inf, 0);
    check_range("log(u)", -2, -1, 0, 0, -inf, inf);
    check_range("abs(u)", -3, 2, 0, 0, 0, 3);
    check_range("floor(u)", -0.5, 2.5, 0, 0, -1, 2);
    check_range("mod(u,2)", -0.5, 7, 0, 0, -0.5, 2);
    check_range("mod(u,2)", 0.25, 1.5, 0, 0, 0.25, 1.5);
    check_range("min(u,w)", 0, 3, 1, 2, 0, 2);
    check_range("clamp(u,-1,1)", -inf, inf, 0, 0, -1, 1);
    check_range("select(u,5,w)", 1, 2, 0, 1, 0, 1);
    check_range("select(u,5,w)", -1, 2, 0, 1, 0, 5);
    check_range("select(u,5,w,9)", 0, 2, 0, 1, 0, 9);
    check_range("smoothstep(0,1,u)", -1, 2, 0, 0, 0, 1);
    check_range("smoothstep(0,1,u)", 0.25, 0.5, 0, 0, 0.15625, 0.5);
    check_range("smoothstep(3,1,u)", 1.5, 2, 0, 0, 0.5, 0.84375);
    check_range("smoothstep(0,1,u)", 2, 3, 0, 0, 1, 1);
    check_range("smoothstep(w,1,u)", 2, 3, 0, 1, 0, 1); /* where w = 1 it is a step */
    check_range("atan2(w,u)", -1, 1, 1, 2, pi / 4, 3 * pi / 4);
    check_range("atan2(w,u)", -1, 1, -1, 1, -pi, pi);
    check_range("noise(u,w)", -inf, inf, -inf, inf, -1, 1);
    check_range("0*u", -inf, inf, 0, 0, 0, 0);
    check_range("u-w", -inf, inf, -inf, inf, -inf, inf);
    check_range("0.03*(sin(6*u)*cos(5.4*w)+0.5*sin(10.2*u+6.6*w))", -inf, inf, -inf, inf, -0.045, 0.045);
}

/* ---- bounds of the gradient ---- */

static double steepest(const double range[2]) { return fmax(fabs(range[0]), fabs(range[1])); }

/* A coordinate in lo..hi, often an end: that is where jumps and kinks are overlooked. */
static double draw_place(double lo, double hi)
{
    uint32_t k = draw(8);
    return k == 0 ? lo : k == 1 ? hi : draw_in(lo, hi);
}

/* slope |d|, where what does not depend on a coordinate does not for infinite bounds either. */
static double rise(double slope, double d) { return d == 0 ? 0 : slope * fabs(d); }

/* The size of the numbers that the evaluation of e near here passes through is not known; what the value does between
 * two neighbours in floating point is a fair measure of their rounding. */
static double noise_of_evaluation(const expr *e, double u, double w)
{
    double v = value_at(e, u, w), worst = 0;
    for (int k = 0; k < 4; k++) {
        double to = k & 1 ? 9 : -9, x = k & 2 ? nextafter(u, to) : u, y = k & 2 ? w : nextafter(w, to);
        double d = fabs(value_at(e, x, y) - v);
        worst = isfinite(d) ? fmax(worst, d) : worst;
    }
    return 64 * worst + 1e-12 * (1 + fabs(v));
}

static bool inside(const double range[2], double x) { return isnan(x) || (range[0] <= x && x <= range[1]); }

static void check_gradient_in(const char *text, const expr *e, const double u[2], const double w[2], int *pairs)
{
    expr_bounds b, same;
    expr_hessians bend;
    double lo, hi;
    expr_bound_gradient(e, u[0], u[1], w[0], w[1], &b);
    expr_bound_hessian(e, u[0], u[1], w[0], w[1], &same, &bend);
    assert_memory_equal(&same, &b, sizeof b);
    CHECK(bend.uu[0], <=, bend.uu[1]);
    CHECK(bend.uw[0], <=, bend.uw[1]);
    CHECK(bend.ww[0], <=, bend.ww[1]);
    expr_bound_value(e, u[0], u[1], w[0], w[1], &lo, &hi);
    CHECK(b.v[0], ==, lo);
    CHECK(b.v[1], ==, hi);
    CHECK(b.u[0], <=, b.u[1]);
    CHECK(b.w[0], <=, b.w[1]); /* so none is NaN */
    for (int k = 0; k < 40; k++) {
        double x = draw_place(u[0], u[1]), y = draw_place(w[0], w[1]), jet[JET];
        /* the other end of the pair: anywhere, near, or straight along one coordinate */
        double reach = draw(2) ? 1 : 1e-4, X = draw(4) ? x + reach * (draw_place(u[0], u[1]) - x) : x;
        double Y = draw(4) ? y + reach * (draw_place(w[0], w[1]) - y) : y;
        jet_at(e, x, y, jet);
        double far = value_at(e, X, Y);
        if (!isfinite(jet[0]))
            continue;
        if (!inside(b.u, jet[1]) || !inside(b.w, jet[2]))
            fail_msg("%s at %.17g %.17g: partials %.17g %.17g, outside %.17g .. %.17g, %.17g .. %.17g", text, x, y,
                     jet[1], jet[2], b.u[0], b.u[1], b.w[0], b.w[1]);
        if (!inside(bend.uu, jet[3]) || !inside(bend.uw, jet[4]) || !inside(bend.ww, jet[5]))
            fail_msg("%s at %.17g %.17g: %.17g %.17g %.17g, outside %.17g .. %.17g, %.17g .. %.17g, %.17g .. %.17g",
                     text, x, y, jet[3], jet[4], jet[5], bend.uu[0], bend.uu[1], bend.uw[0], bend.uw[1], bend.ww[0],
                     bend.ww[1]);
        double bound = rise(steepest(b.u), X - x) + rise(steepest(b.w), Y - y);
        if (!isfinite(far) || !isfinite(bound))
            continue;
        ++*pairs;
        if (fabs(far - jet[0]) > bound * (1 + 1e-12) + 1e-14 &&
            fabs(far - jet[0]) > bound + noise_of_evaluation(e, x, y) + noise_of_evaluation(e, X, Y))
            fail_msg("%s in %.17g .. %.17g, %.17g .. %.17g rises by %.17g from %.17g %.17g to %.17g %.17g, bound %.17g",
                     text, u[0], u[1], w[0], w[1], fabs(far - jet[0]), x, y, X, Y, bound);
    }
}

static void test_gradient_holds(void **state)
{
    (void)state;
    draw_state = 5;
    int pairs = 0;
    for (int i = 0; i < 12000; i++) {
        char text[4096];
        expr *e = random_parsed(text, 1 + i % 4, i % 2);
        double size = i % 3 == 0 ? 0.05 : i % 3 == 1 ? 1 : 30;
        double u[2] = {draw_in(-2, 2)}, w[2] = {draw_in(-2, 2)};
        if (i % 5 == 0) { /* where floor jumps and abs bends */
            u[0] = floor(u[0]);
            w[0] = floor(w[0]);
        }
        u[1] = u[0] + (i % 7 ? draw_in(0, size) : 1);
        w[1] = w[0] + (i % 7 ? draw_in(0, size) : 1);
        check_gradient_in(text, e, u, w, &pairs);
        expr_free(e);
    }
    print_message("%d pairs under a finite bound\n", pairs);
    CHECK(pairs, >, 150000);
}

static void check_gradient(const char *text, double u0, double u1, double w0, double w1, double fu0, double fu1,
                           double fw0, double fw1)
{
    const double want[4] = {fu0, fu1, fw0, fw1};
    expr_bounds b;
    expr *e = parse(text);
    expr_bound_gradient(e, u0, u1, w0, w1, &b);
    const double got[4] = {b.u[0], b.u[1], b.w[0], b.w[1]};
    for (int k = 0; k < 4; k++) {
        double beyond = k & 1 ? got[k] - want[k] : want[k] - got[k];
        if (got[k] != want[k] && !(beyond >= 0 && beyond <= 1e-13 * (1 + fabs(want[k]))))
            fail_msg("%s: u %.17g .. %.17g, w %.17g .. %.17g, expected %.17g .. %.17g, %.17g .. %.17g", text, got[0],
                     got[1], got[2], got[3], fu0, fu1, fw0, fw1);
    }
    expr_free(e);
}

static void test_gradient_tight(void **state)
{
    (void)state;
    const double inf = HUGE_VAL;
    check_gradient("1.5", -1, 2, 0, 1, 0, 0, 0, 0);
    check_gradient("u", -inf, inf, -inf, inf, 1, 1, 0, 0);
    check_gradient("3*u-2*w+1", -inf, inf, -inf, inf, 3, 3, -2, -2);
    check_gradient("0.03*sin(6*u)", -inf, inf, -inf, inf, -0.18, 0.18, 0, 0);
    check_gradient("0.03*sin(6*u)*cos(5*w)", -inf, inf, -inf, inf, -0.18, 0.18, -0.15, 0.15);
    check_gradient("sin(u)", -0.5, 0.25, 0, 0, 0.87758256189037276, 1, 0, 0);
    check_gradient("tan(u)", -1, 1, 0, 0, 1, 3.4255188208147597, 0, 0);
    check_gradient("u^2", -1, 2, 0, 0, -2, 4, 0, 0);
    check_gradient("u*u", -1, 2, 0, 0, -2, 4, 0, 0);
    check_gradient("u^3", -1, 2, 0, 0, 0, 12, 0, 0);
    check_gradient("u^-1", 1, 2, 0, 0, -1, -0.25, 0, 0);
    check_gradient("u^2.5", 0, 4, 0, 0, 0, 20, 0, 0);
    check_gradient("u^17", -1, 1, 0, 0, 0, 17, 0, 0);
    check_gradient("2^u", 0, 1, 0, 0, 0.69314718055994531, 1.3862943611198906, 0, 0);
    check_gradient("u*w", -1, 2, 3, 5, 3, 5, -1, 2);
    check_gradient("sqrt(u)", 0.25, 4, 0, 0, 0.25, 1, 0, 0);
    check_gradient("log(u)", 0.5, 4, 0, 0, 0.25, 2, 0, 0);
    check_gradient("exp(u)", -inf, 0, 0, 0, 0, 1, 0, 0);
    check_gradient("atan(u)", -inf, inf, 0, 0, 0, 1, 0, 0);
    check_gradient("tanh(2*u)", -inf, inf, 0, 0, 0, 2, 0, 0);
    check_gradient("asin(u)", 0, 0.6, 0, 0, 1, 1.25, 0, 0);
    check_gradient("acos(u)", 0, 0.6, 0, 0, -1.25, -1, 0, 0);
    check_gradient("atan2(w,u)", 1, 2, 0, 0, 0, 0, 0.25, 1);
    check_gradient("atan2(w,u)", -inf, inf, 2, inf, -0.5, 0, -0.5, 0.5);
    check_gradient("noise(2*u,w)", -inf, inf, -inf, inf, -5.86, 5.86, -2.93, 2.93);
    check_gradient("smoothstep(1,3,u)", -inf, inf, 0, 0, 0, 0.75, 0, 0);
    check_gradient("smoothstep(1,3,u)", 1, 1.5, 0, 0, 0, 0.5625, 0, 0);
    check_gradient("smoothstep(1,3,u)", 3, 4, 0, 0, 0, 0, 0, 0);
    check_gradient("smoothstep(w,3,u)", 2, 2, 1, 1, 0.75, 0.75, -0.375, -0.375);
    check_gradient("smoothstep(1,w,u)", 2, 2, 3, 3, 0.75, 0.75, -0.375, -0.375);
    /* kinks: the slopes of both sides */
    check_gradient("abs(u)", -1, 2, 0, 0, -1, 1, 0, 0);
    check_gradient("abs(u)", 0, 2, 0, 0, 0, 1, 0, 0);
    check_gradient("abs(u)", -3, -2, 0, 0, -1, -1, 0, 0);
    check_gradient("min(2*u,3*w)", 0, 1, 0, 1, 0, 2, 0, 3);
    check_gradient("min(2*u,3*w)", 0, 1, 1, 2, 2, 2, 0, 0);
    check_gradient("max(2*u,3*w)", 0, 1, 1, 2, 0, 0, 3, 3);
    check_gradient("clamp(5*u,-1,1)", -inf, inf, 0, 0, 0, 5, 0, 0);
    check_gradient("clamp(5*u,-1,1)", 1, inf, 0, 0, 0, 0, 0, 0);
    check_gradient("select(w+1,u,9)", 0, 1, -3, -2, 1, 1, 0, 0);
    check_gradient("select(w,5*u,7*u)", 0, 1, 0, 1, 7, 7, 0, 0);
    check_gradient("select(u,w,w)", -1, 1, 0, 1, 0, 0, 1, 1);
    check_gradient("select(u,4,4)", -1, 1, 0, 1, 0, 0, 0, 0);
    check_gradient("select(u,4,4,4)", -1, 1, 0, 1, 0, 0, 0, 0);
}

static void test_gradient_infinite(void **state)
{
    (void)state;
    const double inf = HUGE_VAL;
    /* jumps: along the coordinate that crosses them, also where they are on the far edge of the box */
    check_gradient("floor(u)", 0.25, 0.75, 0, 0, 0, 0, 0, 0);
    check_gradient("floor(u)", 0.25, 1.25, 0, 0, -inf, inf, 0, 0);
    check_gradient("floor(u)", 0.25, 1, 0, 0, -inf, inf, 0, 0);
    check_gradient("floor(u)", 1, 1.5, 0, 0, 0, 0, 0, 0);
    check_gradient("floor(w)+3*u", 0, 9, 0, 9, 3, 3, -inf, inf);
    check_gradient("0*floor(u)", 0, 9, 0, 0, 0, 0, 0, 0);
    check_gradient("mod(u,2)", -1.9, 1.9, 0, 0, 1, 1, 0, 0);
    check_gradient("mod(u,2)", 2.1, 3.9, 0, 0, 1, 1, 0, 0);
    check_gradient("mod(u,2)", 1, 3, 0, 0, -inf, inf, 0, 0);
    check_gradient("mod(u,2)", -3, -1, 0, 0, -inf, inf, 0, 0);
    check_gradient("mod(7,w)", 0, 1, 2.5, 3, 0, 0, -2, -2);
    check_gradient("mod(u,w)", 7, 7.5, 2, 3, -inf, inf, -inf, inf);
    check_gradient("mod(u,w)", 0, 1, -1, 1, -inf, inf, -inf, inf);
    check_gradient("select(u,2,3)", -1, 1, 0, 0, -inf, inf, 0, 0);
    check_gradient("smoothstep(1,1,u)", 0, 2, 0, 0, -inf, inf, 0, 0);
    check_gradient("select(u,2,3)", -1, 0, 0, 0, -inf, inf, 0, 0);
    check_gradient("select(u,2*w,3*w)", -1, 1, 0, 1, -inf, inf, 2, 3);
    check_gradient("select(u,4,5,4)", -1, 1, 0, 0, -inf, inf, 0, 0);
    check_gradient("select(u,5,4,4)", 0, 1, 0, 0, 0, 0, 0, 0);
    check_gradient("atan2(w,u)", -2, -1, -1, 1, -inf, inf, -inf, inf);
    check_gradient("atan2(w,u)", -2, -1, 0, 1, -inf, inf, -inf, inf); /* w may be -0 */
    check_gradient("atan(1/u)", -1, 1, 0, 0, -inf, inf, 0, 0);
    check_gradient("tan(u)", 1, 2, 0, 0, 1, inf, 0, 0); /* through the pole */
    check_gradient("1/u", -1, 1, 0, 1, -inf, inf, 0, 0);
    /* slopes without bound */
    check_gradient("u^2", -inf, inf, 0, 0, -inf, inf, 0, 0);
    check_gradient("sqrt(u)", 0, 4, 0, 0, 0.25, inf, 0, 0);
    check_gradient("sqrt(w)+u", 0, 4, 0, 1, 1, 1, 0.5, inf);
    check_gradient("log(u)", 0, 4, 0, 0, 0.25, inf, 0, 0);
    check_gradient("asin(u)", 0, 1, 0, 0, 1, inf, 0, 0);
    check_gradient("u^0.7", 0, 1, 0, 0, 0.7, inf, 0, 0);
    check_gradient("u^w", -1, 1, 0, 1, -inf, inf, -inf, inf);
}

/* The bound of noise's slope is one that noise comes near. */
static void test_gradient_of_noise(void **state)
{
    (void)state;
    draw_state = 6;
    expr *e = parse("noise(u,w)");
    double top = 0;
    for (int i = 0; i < 400000; i++) {
        double jet[JET], span = i % 2 ? 0.5 : 0.05;
        double u = draw(1u << 20) + 0.5, w = draw(1u << 20) + 0.5, du = draw_in(-span, span), dw = draw_in(-span, span);
        jet_at(e, u + du, w + dw, jet);
        top = fmax(top, fmax(fabs(jet[1]), fabs(jet[2])));
    }
    print_message("steepest noise %.4f\n", top);
    CHECK(top, >, 2.6);
    CHECK(top, <, 2.93);
    expr_free(e);
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

/* ---- errors ---- */

static void check_error(const char *text, size_t offset, const char *message)
{
    expr_error error = {0};
    expr *e = expr_parse(text, &error);
    if (e || error.offset != offset || strcmp(error.message, message) != 0)
        fail_msg("%.40s: %s %zu: %s\nexpected %zu: %s", text, e ? "accepted" : "", error.offset, error.message, offset,
                 message);
}

static void test_errors(void **state)
{
    (void)state;
    check_error("", 0, "empty expression, expected a function of u and w");
    check_error("  ", 2, "empty expression, expected a function of u and w");
    check_error("sine(u)", 0, "unknown function 'sine', did you mean 'sin'?");
    check_error("1+Sqrt(u)", 2, "unknown function 'Sqrt', did you mean 'sqrt'?");
    check_error("frob(u)", 0, "unknown function 'frob', expected one of those of the language");
    check_error("u+x", 2, "unknown name 'x', expected u, w, pi or a function");
    check_error("nan", 0, "unknown name 'nan', did you mean 'tan'?");
    check_error("inf", 0, "unknown name 'inf', expected u, w, pi or a function");
    check_error("2*abcdefghijklmnopqrstuvwxyz", 2,
                "unknown name 'abcdefghijklmnopqrstuvwx', expected u, w, pi or a function");
    check_error("sin u", 4, "found 'u', expected '(' after the function 'sin'");
    check_error("sin", 3, "found the end, expected '(' after the function 'sin'");
    check_error("sin()", 0, "'sin' takes 1 argument, found 0");
    check_error("2*sin(u,w)", 2, "'sin' takes 1 argument, found 2");
    check_error("atan2(u)", 0, "'atan2' takes 2 arguments, found 1");
    check_error("clamp(u,w)", 0, "'clamp' takes 3 arguments, found 2");
    check_error("select(u,w)", 0, "'select' takes 3 or 4 arguments, found 2");
    check_error("select(u,1,2,3,4)", 0, "'select' takes 3 or 4 arguments, found 5");
    check_error("min(u)", 0, "'min' takes 2 or more arguments, found 1");
    check_error("sin(u", 5, "found the end, expected an operator, ',' or ')'");
    check_error("sin(u,)", 6, "found ')', expected a number, a name or '('");
    check_error("(u+1", 4, "found the end, expected an operator or ')'");
    check_error("(u,w)", 2, "found ',', expected an operator or ')'");
    check_error("u)", 1, "')' without '('");
    check_error("u,w", 1, "found ',', expected an operator or the end");
    check_error("u+", 2, "found the end, expected a number, a name or '('");
    check_error("u**2", 2, "found '*', expected a number, a name or '('");
    check_error("()", 1, "found ')', expected a number, a name or '('");
    check_error("u $ w", 2, "found '$', expected an operator or the end");
    check_error("u+\xc3\xa9", 2, "found the byte 0xC3, expected a number, a name or '('");
    check_error("u\x01", 1, "found the byte 0x01, expected an operator or the end");
    check_error("2u", 1, "missing operator before 'u': a product is written with '*'");
    check_error("3 sin(u)", 2, "missing operator before 'sin': a product is written with '*'");
    check_error("u(3)", 1, "missing operator before '(': a product is written with '*'");
    check_error("(2 u)", 3, "missing operator before 'u': a product is written with '*'");
    check_error("1.2.3", 3, "missing operator before '.': a product is written with '*'");
    check_error("0x10", 1, "missing operator before 'x10': a product is written with '*'");
    check_error("1+.", 2, "'.' without a digit, expected a number such as 0.5");
    check_error("1+2e", 2, "number with an exponent that has no digits, expected one such as 1e-3");
    check_error("1+2e+u", 2, "number with an exponent that has no digits, expected one such as 1e-3");
    check_error("1e309", 0, "number out of range, expected at most 1.79e308");
}

/* ---- limits ---- */

/* `count` copies of `piece` after `head`, before `tail`; the caller frees. */
static char *repeat(const char *head, const char *piece, int count, const char *tail)
{
    size_t size = strlen(head) + strlen(piece) * (size_t)count + strlen(tail) + 1;
    char *text = malloc(size);
    assert_non_null(text);
    strcpy(text, head);
    for (int i = 0; i < count; i++)
        strcat(text, piece);
    return strcat(text, tail);
}

static void check_limit(char *text, size_t offset, const char *message)
{
    if (message)
        check_error(text, offset, message);
    else
        expr_free(parse(text));
    free(text);
}

static char *nested(const char *open, int levels)
{
    char *close = repeat("", ")", levels, ""), *text = repeat("", open, levels, "u");
    char *all = repeat(text, close, 1, "");
    free(close);
    free(text);
    return all;
}

static void test_limits(void **state)
{
    (void)state;
    const char *deep = "nesting too deep, expected at most 64 levels";
    check_limit(nested("(", 63), 0, NULL);
    check_limit(nested("(", 64), 64, deep);
    check_limit(nested("(", 2000), 64, deep);
    check_limit(nested("sin(", 800), 256, deep);
    check_limit(repeat("", "2^", 63, "u"), 0, NULL);
    check_limit(repeat("", "2^", 1500, "u"), 128, deep);
    check_limit(repeat("", "-", 4000, "u"), 0, NULL);
    check_limit(repeat("u", "+u", 1024, ""), 0, NULL);
    check_limit(repeat("u", "+u", 1025, ""), 2049, "expression too long, expected at most 1024 operations");
    check_limit(nested("u+sin(", 29), 0, NULL);
    check_limit(nested("sin(u)+(", 60), 30 * 8,
                "too many intermediate results at a time, expected at most 30: nest the other way round");
    check_limit(repeat("u", " ", 4095, ""), 0, NULL);
    check_limit(repeat("u", " ", 4096, ""), 4096, "text too long, expected at most 4096 bytes");
    check_limit(repeat("min(u", ",w", 900, ")"), 0, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_golden),
        cmocka_unit_test(test_differences),
        cmocka_unit_test(test_same_bytes),
        cmocka_unit_test(test_range_holds),
        cmocka_unit_test(test_range_tight),
        cmocka_unit_test(test_edges),
        cmocka_unit_test(test_gradient_holds),
        cmocka_unit_test(test_gradient_tight),
        cmocka_unit_test(test_gradient_infinite),
        cmocka_unit_test(test_gradient_of_noise),
        cmocka_unit_test(test_noise_is_bounded),
        cmocka_unit_test(test_large_angles),
        cmocka_unit_test(test_errors),
        cmocka_unit_test(test_limits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
