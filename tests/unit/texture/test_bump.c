/* Heights: maps as in section 4.1 of the paper (central differences at the samples, bilinear between), how they lie on
 * (u,w), and functions with their bounds.
 */
#include <stdio.h>
#include <stdlib.h>

#include "support/check.h"
#include "support/bump_of_map.h"
#include "texture/bump.h"

#ifdef KAGE_DOUBLE
#define TOLERANCE 1e-12
#else
#define TOLERANCE 2e-5
#endif

enum { W = 7, H = 5 };

static float samples[W * H];

static image *data(void)
{
    static image m = {W, H, samples};
    uint32_t state = 12345;
    for (int i = 0; i < W * H; i++) {
        state = state * 1664525u + 1013904223u;
        samples[i] = (float)(state >> 8) / 16777216.0f;
    }
    return &m;
}

/* All six values at one place. */
static void look(const bump *p, double u, double w, double out[6])
{
    static bump_values h;
    real U[1] = {(real)u}, V[1] = {(real)w};
    p->ops->eval(p, 1, U, V, 3, &h);
    const real v[6] = {h.P[0], h.Pu[0], h.Pw[0], h.Puu[0], h.Puw[0], h.Pww[0]};
    for (int k = 0; k < 6; k++)
        out[k] = (double)v[k];
}

static void near(double got, double want, double size)
{
    if (!(fabs(got - want) <= TOLERANCE * size)) {
        print_error("%.12g, expected %.12g within %g\n", got, want, TOLERANCE * size);
        fail();
    }
}

/* An independent reading of the paper: the height of sample (i,j) under a wrap, and the differences there. */
static int index_of(int i, int n, map_wrap wrap, bool corners)
{
    if (wrap == MAP_CLAMP)
        return i < 0 ? 0 : i >= n ? n - 1 : i;
    if (wrap == MAP_REPEAT) {
        int period = corners ? n - 1 : n;
        while (i < 0)
            i += period;
        return i % period;
    }
    for (;;) { /* reflect until it is inside */
        if (i < 0)
            i = corners ? -i : -1 - i;
        else if (i >= n)
            i = corners ? 2 * (n - 1) - i : 2 * n - 1 - i;
        else
            return i;
    }
}

static double height(const map_layout *l, int i, int j)
{
    double v = (double)samples[index_of(j, H, l->wrap, l->corners) * W + index_of(i, W, l->wrap, l->corners)];
    return l->scale * (v - l->zero);
}

static void differences(const map_layout *l, int i, int j, double d[6])
{
    double du = l->size[0] / (W - l->corners), dw = l->size[1] / (H - l->corners);
    d[0] = height(l, i, j);
    d[1] = (height(l, i + 1, j) - height(l, i - 1, j)) / (2 * du);
    d[2] = (height(l, i, j + 1) - height(l, i, j - 1)) / (2 * dw);
    d[3] = (height(l, i + 1, j) - 2 * d[0] + height(l, i - 1, j)) / (du * du);
    d[4] = (height(l, i + 1, j + 1) - height(l, i + 1, j - 1) - height(l, i - 1, j + 1) + height(l, i - 1, j - 1)) /
           (4 * du * dw);
    d[5] = (height(l, i, j + 1) - 2 * d[0] + height(l, i, j - 1)) / (dw * dw);
}

static const map_layout layouts[] = {
    {{2, 3}, {0, 0}, MAP_REPEAT, false, 0.1, 0.5, 0},     {{2, 3}, {0.3, -0.2}, MAP_CLAMP, false, 0.1, 0.5, 0},
    {{0.7, 0.9}, {-1, 2}, MAP_MIRROR, false, -0.3, 0, 0}, {{2, 3}, {0.5, 0.25}, MAP_REPEAT, true, 0.1, 0.25, 0},
    {{2, 3}, {0, 0}, MAP_CLAMP, true, 0.1, 0.5, 0},       {{5, 1}, {0, 0}, MAP_MIRROR, true, 2, 1, 0},
    {{-2, 3}, {0, 0}, MAP_REPEAT, false, 0.1, 0.5, 0},    {{2, -3}, {0.3, -0.2}, MAP_CLAMP, false, 0.1, 0.5, 0},
    {{-0.7, -3}, {0, 1}, MAP_MIRROR, true, 0.1, 0.5, 0},
};
enum { LAYOUTS = sizeof layouts / sizeof *layouts };

/* The scale of each value: the height's, over the sample distance to the power of the derivative. */
static void sizes(const map_layout *l, double s[6])
{
    double du = fabs(l->size[0]) / W, dw = fabs(l->size[1]) / H, k = fabs(l->scale);
    const double v[6] = {k, k / du, k / dw, k / du / du, k / du / dw, k / dw / dw};
    for (int i = 0; i < 6; i++)
        s[i] = 4 * v[i];
}

static void at_the_samples(void **state)
{
    (void)state;
    for (int n = 0; n < LAYOUTS; n++) {
        const map_layout *l = &layouts[n];
        bump *p = bump_of_map(data(), l);
        double got[6], want[6], size[6];
        sizes(l, size);
        for (int j = -2; j < H + 2; j++)
            for (int i = -2; i < W + 2; i++) {
                if (l->wrap == MAP_CLAMP && (i < 0 || j < 0 || i >= W || j >= H))
                    continue;
                double half = l->corners ? 0 : 0.5, x = i, y = j;
                if (l->wrap == MAP_CLAMP) { /* no rounding puts it beyond */
                    x = fmin(fmax(x, TOLERANCE), W - 1 - TOLERANCE);
                    y = fmin(fmax(y, TOLERANCE), H - 1 - TOLERANCE);
                }
                look(p, l->offset[0] + (x + half) * l->size[0] / (W - l->corners),
                     l->offset[1] + (y + half) * l->size[1] / (H - l->corners), got);
                differences(l, i, j, want);
                for (int k = 0; k < 6; k++)
                    near(got[k], want[k], size[k] * 8); /* the place itself is rounded: slopes of the interpolation */
            }
        bump_free(p);
    }
}

static void bilinear_between(void **state)
{
    (void)state;
    for (int n = 0; n < LAYOUTS; n++) {
        const map_layout *l = &layouts[n];
        bump *p = bump_of_map(data(), l);
        double got[6], c[4][6], size[6];
        sizes(l, size);
        for (int k = 0; k < 500; k++) {
            /* a place by cell and fraction */
            int i = k % (W - 1), j = k / 7 % (H - 1);
            double a = (k * 37 % 100 + 0.5) / 100, b = (k * 61 % 100 + 0.5) / 100, half = l->corners ? 0 : 0.5;
            look(p, l->offset[0] + (i + a + half) * l->size[0] / (W - l->corners),
                 l->offset[1] + (j + b + half) * l->size[1] / (H - l->corners), got);
            for (int m = 0; m < 4; m++)
                differences(l, i + m % 2, j + m / 2, c[m]);
            for (int m = 0; m < 6; m++)
                near(got[m], (c[0][m] * (1 - a) + c[1][m] * a) * (1 - b) + (c[2][m] * (1 - a) + c[3][m] * a) * b,
                     size[m] * 8);
        }
        bump_free(p);
    }
}

/* P a sample's distance around a place, [w][u], as it is looked up; and the differences in the order of look. */
static void differences_of_P(const bump *p, double u, double w, double du, double dw, double d[6])
{
    double P[3][3], v[6];
    for (int y = 0; y < 3; y++)
        for (int x = 0; x < 3; x++) {
            look(p, u + (x - 1) * du, w + (y - 1) * dw, v);
            P[y][x] = v[0];
        }
    d[0] = P[1][1];
    d[1] = (P[1][2] - P[1][0]) / (2 * du);
    d[2] = (P[2][1] - P[0][1]) / (2 * dw);
    d[3] = (P[1][2] - 2 * P[1][1] + P[1][0]) / (du * du);
    d[4] = (P[2][2] - P[2][0] - P[0][2] + P[0][0]) / (4 * du * dw);
    d[5] = (P[2][1] - 2 * P[1][1] + P[0][1]) / (dw * dw);
}

/* Whether sample number x is well beyond the outermost of n, or well within: not so near that rounding decides. */
static int beyond(double x, int n) { return x < -1e-3 || x > n - 1 + 1e-3 ? 1 : x > 1e-3 && x < n - 1 - 1e-3 ? 0 : -1; }

/* The derivatives at any place, on a sample or between, are the differences of P itself over a sample to either side:
 * bilinear interpolation and differences at such a distance can be exchanged. So the tolerance is for rounding alone:
 * of the place, and of P. Where a clamped map is level its derivatives that way are exactly 0, and the others are those
 * of the border. */
static void derivatives_are_differences(void **state)
{
    (void)state;
    for (int n = 0; n < LAYOUTS; n++) {
        const map_layout *l = &layouts[n];
        const double du = l->size[0] / (W - l->corners), dw = l->size[1] / (H - l->corners),
                     half = l->corners ? 0 : 0.5;
        bump *p = bump_of_map(data(), l);
        double got[6], want[6], size[6];
        int level[3] = {0, 0, 0};
        sizes(l, size);
        for (int k = 0; k < 5000; k++) {
            const double x = (k * 37 % 1009 / 1009.0 * 2 - 0.5) * W, y = (k * 61 % 1013 / 1013.0 * 2 - 0.5) * H;
            const int clamped = l->wrap == MAP_CLAMP, past_u = clamped ? beyond(x, W) : 0,
                      past_w = clamped ? beyond(y, H) : 0;
            const double u = l->offset[0] + (x + half) * du, w = l->offset[1] + (y + half) * dw;
            if (past_u < 0 || past_w < 0)
                continue;
            look(p, u, w, got);
            differences_of_P(p, u, w, du, dw, want);
            if (past_u)
                want[1] = want[3] = want[4] = 0;
            if (past_w)
                want[2] = want[4] = want[5] = 0;
            for (int m = 0; m < 6; m++)
                near(got[m], want[m], want[m] != 0 ? size[m] * 8 : 0); /* level: exactly 0 */
            level[past_u + past_w]++;
        }
        assert_true(level[0] > 500 && (l->wrap != MAP_CLAMP || (level[1] > 1000 && level[2] > 500)));
        bump_free(p);
    }
}

/* A ramp between two levels as a clamped map and as a function: P and its gradient are the same but for a cell next to
 * the bends, where a map's are means. */
static void clamped_ramp(void **state)
{
    (void)state;
    enum { SIDE = 17 };
    float ramp[SIDE * SIDE];
    for (int i = 0; i < SIDE * SIDE; i++)
        ramp[i] = (float)(i % SIDE) / (SIDE - 1); /* exact in float, too */
    image m = {SIDE, SIDE, ramp};
    for (int corners = 0; corners < 2; corners++) {
        const double cell = 1.0 / (SIDE - corners), lo = corners ? 0 : cell / 2, hi = 1 - lo,
                     all[2] = {-HUGE_VAL, HUGE_VAL};
        const map_layout l = {{1, 1}, {0, 0}, MAP_CLAMP, corners, 0.5, 0, 0};
        char text[99];
        expr_error e;
        snprintf(text, sizeof text, "clamp((u-%.17g)/%.17g,0,1)", lo, hi - lo);
        bump *map = bump_of_map(&m, &l), *function = bump_function_new(expr_parse(text, &e), 0.5, all, all);
        for (int k = 0; k < 3000; k++) {
            const double u = k * 0.001 - 1, w = k % 17 * 0.1 - 0.3;
            double a[6], b[6];
            look(map, u, w, a);
            look(function, u, w, b);
            near(a[0], b[0], 8);
            if (u < lo - 1e-5 || u > hi + 1e-5 || (u > lo + cell && u < hi - cell))
                for (int i = 1; i < 3; i++)
                    near(a[i], b[i], b[i] != 0 ? 32 : 0);
        }
        bump_free(map);
        bump_free(function);
    }
}

/* Far out, at NaN and at infinity something is looked up, within the map's bounds. */
static void anywhere(void **state)
{
    (void)state;
    const double far[] = {1e4, -1e4, 1e9, -1e9, 1e30, -1e30, (double)INFINITY, (double)NAN};
    for (int n = 0; n < LAYOUTS; n++) {
        bump *p = bump_of_map(data(), &layouts[n]);
        for (size_t i = 0; i < 8; i++)
            for (size_t j = 0; j < 8; j++) {
                double v[6];
                look(p, far[i], far[j], v);
                BETWEEN((double)p->Pmin - 1e-6, v[0], (double)p->Pmax + 1e-6);
            }
        bump_free(p);
    }
}

static void map_bounds(void **state)
{
    (void)state;
    for (int n = 0; n < LAYOUTS; n++) {
        const map_layout *l = &layouts[n];
        bump *p = bump_of_map(data(), l);
        double lo = HUGE_VAL, hi = -HUGE_VAL;
        for (int i = 0; i < W * H; i++) {
            int column = i % W, row = i / W;
            if (l->corners && l->wrap == MAP_REPEAT && (column == W - 1 || row == H - 1))
                continue; /* stands for the first one */
            double z = l->scale * ((double)samples[i] - l->zero);
            lo = fmin(lo, z);
            hi = fmax(hi, z);
        }
        near((double)p->Pmin, lo, 1);
        near((double)p->Pmax, hi, 1);
        bump_free(p);
    }
}

/* Lower orders give the same bytes, and leave the rest alone. */
static void orders(void **state)
{
    (void)state;
    static bump_values all, some;
    real u[LANES], w[LANES];
    const double extent[2] = {-HUGE_VAL, HUGE_VAL};
    expr_error e;
    bump *ps[2] = {bump_of_map(data(), &layouts[0]),
                   bump_function_new(expr_parse("sin(3*u)*cos(w) + u*w", &e), -0.3, extent, extent)};
    for (int i = 0; i < LANES; i++) {
        u[i] = (real)(i * 0.037 - 3);
        w[i] = (real)(i * 0.021 - 1);
    }
    for (int k = 0; k < 2; k++) {
        ps[k]->ops->eval(ps[k], LANES, u, w, 3, &all);
        for (int order = 0; order < 3; order++) {
            for (int i = 0; i < LANES; i++)
                some.Pu[i] = some.Pw[i] = some.Puu[i] = some.Puw[i] = some.Pww[i] = 77;
            ps[k]->ops->eval(ps[k], LANES, u, w, order, &some);
            for (int i = 0; i < LANES; i++) {
                CHECK(some.P[i], ==, all.P[i]);
                assert_true(order >= 1 ? some.Pu[i] == all.Pu[i] && some.Pw[i] == all.Pw[i]
                                       : some.Pu[i] == 77 && some.Pw[i] == 77);
                assert_true(order == 2 ? some.Puu[i] == all.Puu[i] && some.Pww[i] == all.Pww[i]
                                       : some.Puu[i] == 77 && some.Puw[i] == 77 && some.Pww[i] == 77);
            }
        }
        bump_free(ps[k]);
    }
}

static void functions(void **state)
{
    (void)state;
    const double u[2] = {-1, 1}, w[2] = {0, 2}, all[2] = {-HUGE_VAL, HUGE_VAL};
    expr_error e;
    bump *p = bump_function_new(expr_parse("u^2 - w*u", &e), -0.5, u, w);
    double v[6];
    look(p, 0.5, 0.25, v);
    const double want[6] = {-0.5 * (0.25 - 0.125), -0.5 * (1 - 0.25), 0.25, -1, 0.5, 0};
    for (int k = 0; k < 6; k++)
        near(v[k], want[k], 1);
    /* the true range of u^2 - w u here is -1 .. 3; times -0.5 */
    CHECK(p->Pmin, <=, -1.5);
    CHECK(p->Pmin, >, -1.6);
    CHECK(p->Pmax, >=, 0.5);
    CHECK(p->Pmax, <, 0.6);
    bump_free(p);

    p = bump_function_new(expr_parse("u", &e), 1, all, all);
    assert_true(isinf(p->Pmin) && isinf(p->Pmax));
    bump_free(p);
    p = bump_function_new(expr_parse("u", &e), 0, all, all);
    CHECK(p->Pmin, ==, 0);
    CHECK(p->Pmax, ==, 0);
    bump_free(p);
    p = bump_function_new(expr_parse("sin(u)*cos(w)", &e), 0.2, all, all);
    near((double)p->Pmin, -0.2, 1);
    near((double)p->Pmax, 0.2, 1);
    bump_free(p);
}

static uint32_t draw_state = 7;

static double draw_in(double lo, double hi)
{
    draw_state = draw_state * 1664525u + 1013904223u;
    return lo + (hi - lo) * (draw_state >> 8) / 16777216.0;
}

/* Pairs anywhere on several copies of the map, across cells and wraps, half of them near, some along one coordinate
 * only: none rises by more than the bounds allow, and along each coordinate some pair rises by as much. */
static void map_slopes(void **state)
{
    (void)state;
    for (int n = 0; n < LAYOUTS; n++) {
        const map_layout *l = &layouts[n];
        bump *p = bump_of_map(data(), l);
        const double top[2] = {(double)p->Pu_max, (double)p->Pw_max};
        double steepest[2] = {0, 0}, size[6];
        sizes(l, size);
        /* a place rounds as its sample number does: up to 3 copies of W samples */
        const double rounding = TOLERANCE * (size[0] + (top[0] * fabs(l->size[0]) + top[1] * fabs(l->size[1])) * 3);
        for (int k = 0; k < 100000; k++) {
            double u = l->offset[0] + l->size[0] * draw_in(-1.2, 2.2),
                   w = l->offset[1] + l->size[1] * draw_in(-1.2, 2.2);
            double reach = k % 2 ? 0.03 : 1, a[6], b[6];
            double du = k % 3 == 0 ? 0 : reach * l->size[0] * draw_in(-1, 1);
            double dw = k % 3 == 1 ? 0 : reach * l->size[1] * draw_in(-1, 1);
            look(p, u, w, a);
            look(p, u + du, w + dw, b);
            double rise = fabs(b[0] - a[0]), allowed = top[0] * fabs(du) + top[1] * fabs(dw);
            if (!(rise <= allowed + rounding))
                fail_msg("layout %d at %g %g, by %g %g: rises by %.9g, allowed %.9g", n, u, w, du, dw, rise, allowed);
            CHECK(fabs(a[1]), <=, top[0] * (1 + TOLERANCE));
            CHECK(fabs(a[2]), <=, top[1] * (1 + TOLERANCE));
        }
        /* from each sample to the next; those beyond the last are the first's copies or mirrored */
        for (int j = 0; j < 2 * H; j++)
            for (int i = 0; i < 2 * W; i++) {
                double half = l->corners ? 0 : 0.5,
                       d[2] = {l->size[0] / (W - l->corners), l->size[1] / (H - l->corners)};
                double u = l->offset[0] + (i + half) * d[0], w = l->offset[1] + (j + half) * d[1], a[6], b[6];
                look(p, u, w, a);
                look(p, u + d[0], w, b);
                steepest[0] = fmax(steepest[0], fabs((b[0] - a[0]) / d[0]));
                look(p, u, w + d[1], b);
                steepest[1] = fmax(steepest[1], fabs((b[0] - a[0]) / d[1]));
            }
        for (int k = 0; k < 2; k++)
            near(top[k], steepest[k], size[1 + k] * 8);
        bump_free(p);
    }
}

/* Turned over, flat, of no scale, broken. */
static void odd_map_slopes(void **state)
{
    (void)state;
    map_layout l = layouts[0];
    bump *p = bump_of_map(data(), &l), *q;
    l.scale = -l.scale;
    l.size[0] = -l.size[0];
    q = bump_of_map(data(), &l);
    CHECK(q->Pu_max, ==, p->Pu_max);
    CHECK(q->Pw_max, ==, p->Pw_max);
    CHECK(p->Pu_max, >, 0);
    bump_free(p);
    bump_free(q);
    l.scale = 0;
    p = bump_of_map(data(), &l);
    CHECK(p->Pu_max, ==, 0);
    CHECK(p->Pw_max, ==, 0);
    bump_free(p);

    /* a step along w alone; the last row's is across the wrap */
    float steps[6] = {0, 0, 1, 1, 3, 3};
    image m = {2, 3, steps};
    const map_layout plain = {{1, 0.5}, {0, 0}, MAP_REPEAT, false, 2, 0, 0},
                     clamped = {{1, 0.5}, {0, 0}, MAP_CLAMP, false, 2, 0, 0};
    p = bump_of_map(&m, &plain);
    CHECK(p->Pu_max, ==, 0);
    near((double)p->Pw_max, 3 * 2 * 6, 36); /* a difference of 3, scale 2, 6 samples per unit */
    bump_free(p);
    p = bump_of_map(&m, &clamped);
    near((double)p->Pw_max, 2 * 2 * 6, 24);
    bump_free(p);
    steps[3] = (float)NAN;
    p = bump_of_map(&m, &plain);
    assert_true(isinf(p->Pu_max) && isinf(p->Pw_max));
    bump_free(p);
}

static void check_function(const char *text, double scale, double u0, double u1, double Pu, double Pw, double slack)
{
    const double u[2] = {u0, u1}, w[2] = {0, 2};
    expr_error e;
    bump *p = bump_function_new(expr_parse(text, &e), scale, u, w);
    const double got[2] = {(double)p->Pu_max, (double)p->Pw_max}, want[2] = {Pu, Pw};
    for (int k = 0; k < 2; k++)
        if (got[k] != want[k] && !(got[k] >= want[k] && got[k] <= want[k] * (1 + slack)))
            fail_msg("%s: %.17g, expected %.17g", text, got[k], want[k]);
    bump_free(p);
}

static void function_slopes(void **state)
{
    (void)state;
    const double ulps = sizeof(real) == 4 ? 3e-7 : 1e-14, inf = HUGE_VAL;
    check_function("0.1*sin(7*u)", 1, -inf, inf, 0.1 * 7, 0, ulps);
    check_function("sin(7*u)+cos(3*w)", -0.3, -2, 2, 2.1, 0.9, ulps);
    check_function("3*u-w", -0.7, -1, 1, 3 * 0.7, 0.7, ulps);
    check_function("u^2-w*u", 0.5, -1, 1, 2, 0.5, 0.03); /* 2u - w, in parts */
    check_function("u^2", 0, -inf, inf, 0, 0, 0);
    check_function("floor(u)", 0, -1, 1, 0, 0, 0);
    check_function("u^2", 1, -inf, inf, inf, 0, 0);
    check_function("sqrt(u)", 1, 0, 1, inf, 0, 0);
    check_function("5", 1, -1, 1, 0, 0, 0);
    /* 64 parts of 0..64: each jump is on an edge between two */
    check_function("floor(u)", 1, 0, 64, inf, 0, 0);
    check_function("floor(w)", 1, 0.25, 0.75, 0, inf, 0);
    check_function("select(u,0,1)+w", 1, -1, 1, inf, 1, ulps);
    check_function("w+abs(u)", 1, -1, 1, 1, 1, ulps);
}

/* peaked: no two neighbours are both the highest or the lowest samples, also across the wrap. */
static void peaks(void **state)
{
    (void)state;
    static const struct {
        int i, j; /* these samples become */
        float to; /* this */
        bool repeated, clamped;
    } cases[] = {
        {8, 8, 9, true, true},           /* one */
        {8, 9, 9, false, false},         /* beside each other */
        {8, 8 + W, -9, false, false},    /* one below the other */
        {8, 8 + W + 1, 9, true, true},   /* across a corner: between them P is lower */
        {W, 2 * W - 1, 9, false, false}, /* at both ends of a row */
        {W, W, 9, true, false},          /* one at an end, beyond which a clamped P is constant */
        {2 * W - 1, 2 * W - 1, 9, true, false},
        {5, 5, -9, true, false},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++)
        for (int clamp = 0; clamp < 2; clamp++) {
            const map_layout l = {.size = {1, 1}, .wrap = clamp ? MAP_CLAMP : MAP_REPEAT, .scale = 0.1, .zero = 0.5};
            image *m = data();
            samples[2 * W + 3] = -8; /* the lowest is not at an end, beyond which a clamped P is constant */
            samples[cases[n].i] = samples[cases[n].j] = cases[n].to;
            bump *p = bump_of_map(m, &l);
            assert_int_equal(p->peaked, clamp ? cases[n].clamped : cases[n].repeated);
            bump_free(p);
        }
}

static void too_small(void **state)
{
    (void)state;
    image one = {1, 5, samples}, two = {5, 1, samples};
    assert_null(bump_of_map(&one, &layouts[0]));
    assert_null(bump_of_map(&two, &layouts[0]));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(at_the_samples),
        cmocka_unit_test(bilinear_between),
        cmocka_unit_test(anywhere),
        cmocka_unit_test(map_bounds),
        cmocka_unit_test(orders),
        cmocka_unit_test(functions),
        cmocka_unit_test(map_slopes),
        cmocka_unit_test(odd_map_slopes),
        cmocka_unit_test(function_slopes),
        cmocka_unit_test(too_small),
        cmocka_unit_test(peaks),
        cmocka_unit_test(clamped_ramp),
        cmocka_unit_test(derivatives_are_differences),
    };
    return cmocka_run_group_tests_name("heights", tests, NULL, NULL);
}
