/* Bounds of value, gradient and Hessian: they hold, they are tight, and infinite where they must be. */
#include "unit/expr/expressions.h"

#include <math.h>

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
        expr_bounds b;
        expr_bound_gradient(e, u0, u1, w0, w1, &b);
        const double lo = b.v[0], hi = b.v[1];
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
    expr_bounds b;
    expr_bound_gradient(e, u0, u1, w0, w1, &b);
    const double l = b.v[0], h = b.v[1];
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
    expr_bound_gradient(e, u[0], u[1], w[0], w[1], &b);
    expr_bound_hessian(e, u[0], u[1], w[0], w[1], &same, &bend);
    assert_memory_equal(&same, &b, sizeof b);
    CHECK(bend.uu[0], <=, bend.uu[1]);
    CHECK(bend.uw[0], <=, bend.uw[1]);
    CHECK(bend.ww[0], <=, bend.ww[1]);
    CHECK(b.v[0], <=, b.v[1]);
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

/* ---- bounds of the Hessian ---- */

static void check_hessian(const char *text, double u0, double u1, double w0, double w1, const double want[6])
{
    expr_bounds b;
    expr_hessians h;
    expr *e = parse(text);
    expr_bound_hessian(e, u0, u1, w0, w1, &b, &h);
    const double got[6] = {h.uu[0], h.uu[1], h.uw[0], h.uw[1], h.ww[0], h.ww[1]};
    for (int k = 0; k < 6; k++) {
        double beyond = k & 1 ? got[k] - want[k] : want[k] - got[k];
        if (got[k] != want[k] && !(beyond >= 0 && beyond <= 1e-13 * (1 + fabs(want[k]))))
            fail_msg("%s: end %d is %.17g, expected %.17g", text, k, got[k], want[k]);
    }
    expr_free(e);
}

static void test_hessian_tight(void **state)
{
    (void)state;
    const double inf = HUGE_VAL;
    check_hessian("3*u-2*w+1", -inf, inf, -inf, inf, (double[]){0, 0, 0, 0, 0, 0});
    check_hessian("u*w", -1, 2, 3, 5, (double[]){0, 0, 1, 1, 0, 0});
    check_hessian("u^2+w^3", -1, 2, 3, 5, (double[]){2, 2, 0, 0, 18, 30});
    check_hessian("0.5*sin(2*u)", -inf, inf, 0, 0, (double[]){-2, 2, 0, 0, 0, 0});
    check_hessian("exp(-w)", 0, 0, 0, inf, (double[]){0, 0, 0, 0, 0, 1});
    check_hessian("1/u", 1, 2, 0, 0, (double[]){0.25, 2, 0, 0, 0, 0});
    check_hessian("sqrt(u)", 1, 4, 0, 0, (double[]){-0.25, -0.03125, 0, 0, 0, 0});
    check_hessian("smoothstep(1,3,u)", 1.5, 2, 0, 0, (double[]){0, 0.75, 0, 0, 0, 0});
    check_hessian("smoothstep(1,3,u)", -inf, inf, 0, 0, (double[]){-1.5, 1.5, 0, 0, 0, 0});
    check_hessian("smoothstep(1,3,u)", 3.5, 4, 0, 0, (double[]){0, 0, 0, 0, 0, 0});
}

static void test_hessian_infinite_where_a_slope_jumps(void **state)
{
    (void)state;
    const double inf = HUGE_VAL;
    check_hessian("abs(u)", -1, 2, 0, 0, (double[]){-inf, inf, 0, 0, 0, 0});
    check_hessian("abs(u)", 0, 2, 0, 0, (double[]){0, 0, 0, 0, 0, 0});
    check_hessian("min(2*u,3*w)", 0, 1, 0, 1, (double[]){-inf, inf, -inf, inf, -inf, inf});
    check_hessian("min(2*u,3*w)", 0, 1, 1, 2, (double[]){0, 0, 0, 0, 0, 0});
    check_hessian("select(u,w*w,w)", -1, 1, 0, 0, (double[]){-inf, inf, -inf, inf, -inf, inf});
    check_hessian("mod(u,2)", 0.5, 1.5, 0, 0, (double[]){0, 0, 0, 0, 0, 0});
    check_hessian("mod(u,2)", 1.5, 2.5, 0, 0, (double[]){-inf, inf, 0, 0, 0, 0});
}

/* ---- noise ---- */

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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_range_holds),
        cmocka_unit_test(test_range_tight),
        cmocka_unit_test(test_gradient_holds),
        cmocka_unit_test(test_gradient_tight),
        cmocka_unit_test(test_gradient_infinite),
        cmocka_unit_test(test_hessian_tight),
        cmocka_unit_test(test_hessian_infinite_where_a_slope_jumps),
        cmocka_unit_test(test_gradient_of_noise),
    };
    return cmocka_run_group_tests_name("bounds", tests, NULL, NULL);
}
