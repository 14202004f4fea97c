/* Bounds of P over rectangles: against dense samples, for maps under each wrap, functions and mirrored textures. */
#include <stdlib.h>

#include "support/check.h"
#include "support/bump_of_map.h"
#include "support/random_in.h"
#include "texture/mirrored_uv.h"

enum { W = 37, H = 23, RECTANGLES = 3000, SAMPLES = 64 };

static float samples[W * H];

static bump *map_of(const map_layout *l)
{
    const image m = {W, H, samples};
    for (int i = 0; i < W * H; i++)
        samples[i] = (float)random_in(0, 1);
    return bump_of_map(&m, l);
}

static bump *function_of(const char *text, const double u[2], const double w[2])
{
    expr_error e;
    return bump_function_new(expr_parse(text, &e), -0.3, u, w);
}

/* n <= LANES random rectangles within `extent`, long and short ones, of a size from 1e-4 of it up. */
typedef struct rectangles {
    real u0[LANES], u1[LANES], w0[LANES], w1[LANES];
} rectangles;

static void random_range(const double extent[2], real *from, real *to)
{
    const double size = (extent[1] - extent[0]) * pow(10, random_in(-4, 0)),
                 at = random_in(extent[0], extent[1] - size);
    *from = (real)at;
    *to = (real)fmin(at + size, extent[1]);
}

static void random_rectangles(const double u[2], const double w[2], rectangles *r)
{
    for (int i = 0; i < LANES; i++) {
        random_range(u, &r->u0[i], &r->u1[i]);
        random_range(w, &r->w0[i], &r->w1[i]);
    }
}

/* P at random places of the rectangle i, its corners among them. */
static void look(const bump *p, const rectangles *r, int i, real *u, real *w, bump_values *h)
{
    for (int k = 0; k < SAMPLES; k++) {
        const double a = k < 4 ? k & 1 : random_in(0, 1), b = k < 4 ? k >> 1 : random_in(0, 1);
        u[k] = real_min(r->u0[i] + (real)a * (r->u1[i] - r->u0[i]), r->u1[i]);
        w[k] = real_min(r->w0[i] + (real)b * (r->w1[i] - r->w0[i]), r->w1[i]);
    }
    p->ops->eval(p, SAMPLES, u, w, 2, h);
}

/* Each sample is within the bounds, and any two are as far apart as the slopes allow. */
static void check_ranges(const bump *p, const double u[2], const double w[2])
{
    static rectangles r;
    static bump_ranges b;
    static bump_values h;
    real x[LANES], y[LANES];
    for (int n = 0; n < RECTANGLES; n += LANES) {
        random_rectangles(u, w, &r);
        p->ops->range(p, LANES, r.u0, r.u1, r.w0, r.w1, &b);
        for (int i = 0; i < LANES; i++) {
            look(p, &r, i, x, y, &h);
            for (int k = 0; k < SAMPLES; k++) {
                BETWEEN(b.lo[i], h.P[k], b.hi[i]);
                const int l = k * 7 % SAMPLES;
                const double way = (double)b.Pu[i] * fabs((double)x[k] - (double)x[l]) +
                                   (double)b.Pw[i] * fabs((double)y[k] - (double)y[l]);
                const double air =
                    16 * EPS *
                    (1 + (double)b.Pu[i] * (1 + fabs((double)x[k])) + (double)b.Pw[i] * (1 + fabs((double)y[k])));
                CHECK(fabs((double)h.P[k] - (double)h.P[l]), <=, way + air);
            }
            CHECK(b.Pu[i], <=, (double)p->Pu_max * (1 + 4 * EPS));
            CHECK(b.Pw[i], <=, (double)p->Pw_max * (1 + 4 * EPS));
        }
    }
}

static const map_layout layouts[] = {
    {{2, 3}, {0, 0}, MAP_REPEAT, false, 0.1, 0.5, 0},     {{2, 3}, {0.3, -0.2}, MAP_CLAMP, false, 0.1, 0.5, 0},
    {{0.7, 0.9}, {-1, 2}, MAP_MIRROR, false, -0.3, 0, 0}, {{2, 3}, {0.5, 0.25}, MAP_REPEAT, true, 0.1, 0.25, 0},
    {{2, -3}, {0, 0}, MAP_CLAMP, true, 0.1, 0.5, 0},      {{-5, 1}, {0, 0}, MAP_MIRROR, true, 2, 1, 0},
};
enum { LAYOUTS = sizeof layouts / sizeof *layouts };

static void bounds_of_maps(void **state)
{
    (void)state;
    const double places[2] = {-4, 7};
    for (int n = 0; n < LAYOUTS; n++) {
        bump *p = map_of(&layouts[n]);
        assert_true(bump_prepare(p, NULL));
        check_ranges(p, places, places);
        bump_free(p);
    }
}

/* Far from the map's own copy coordinates have few digits. */
static void bounds_far_away(void **state)
{
    (void)state;
    const double far[2] = {9000, 9100}, below[2] = {-2200, -2150};
    bump *p = map_of(&layouts[0]);
    assert_true(bump_prepare(p, NULL));
    check_ranges(p, far, below);
    bump_free(p);
}

static const double all[2] = {-HUGE_VAL, HUGE_VAL}, turn[2] = {-3.25, 3.5}, half[2] = {0, 3};

static void bounds_of_functions(void **state)
{
    (void)state;
    bump *p[] = {function_of("sin(6*u)*cos(5*w) + 0.3*abs(u)", turn, half), function_of("sin(u)*cos(3*w)", all, all),
                 function_of("sin(9*u)*tanh(w)", turn, all), function_of("cos(9*w) + u/100", all, half)};
    for (int k = 0; k < 4; k++) {
        check_ranges(p[k], turn, half); /* by the bounds of the whole */
        assert_true(bump_prepare(p[k], NULL));
        check_ranges(p[k], turn, half);
        bump_free(p[k]);
    }
}

static void bounds_of_mirrored_maps(void **state)
{
    (void)state;
    const double places[2] = {-3, 4}, w[2] = {-1, 2};
    bump *p = bump_mirrored_uv(map_of(&layouts[3]), -0.5, 1.25);
    assert_true(bump_prepare(p, NULL));
    check_ranges(p, places, w);
    bump_free(p);
}

/* No wider than the cells within a small multiple of the rectangle's size: the bounds are of use. */
static void bounds_are_close(void **state)
{
    (void)state;
    float ramp[64 * 64];
    for (int i = 0; i < 64 * 64; i++)
        ramp[i] = (float)(i % 64) / 64;
    const image m = {64, 64, ramp};
    const map_layout l = {{64, 64}, {0, 0}, MAP_CLAMP, false, 1, 0, 0};
    bump *p = bump_of_map(&m, &l);
    assert_true(bump_prepare(p, NULL));
    for (int k = 0; k < 200; k++) {
        const double size = random_in(0.1, 20), at = random_in(1, 60 - size);
        const real u0 = (real)at, u1 = (real)(at + size), w0 = 30, w1 = R(30.5);
        static bump_ranges b;
        p->ops->range(p, 1, &u0, &u1, &w0, &w1, &b);
        CHECK((double)(b.hi[0] - b.lo[0]) * 64, <=, 4 * fmax(size, 1) + 0.01);
    }
    bump_free(p);
}

/* Everywhere, at NaN too: nothing beyond the bounds of all, and nothing out of the tables. */
static void any_rectangle(void **state)
{
    (void)state;
    const real odd[] = {0, R(1e9), R(-1e9), R(1e30), R(-1e30), (real)INFINITY, (real)-INFINITY, (real)NAN};
    static bump_ranges b;
    for (int n = 0; n < LAYOUTS; n++) {
        bump *p = map_of(&layouts[n]);
        assert_true(bump_prepare(p, NULL));
        for (int k = 0; k < 8 * 8 * 8; k++) {
            p->ops->range(p, 1, &odd[k & 7], &odd[k >> 3 & 7], &odd[k >> 6], &odd[k & 7], &b);
            BETWEEN((double)p->Pmin - 1e-5, b.lo[0], p->Pmax);
            BETWEEN(p->Pmin, b.hi[0], (double)p->Pmax + 1e-5);
            CHECK(b.Pu[0], <=, (double)p->Pu_max * (1 + 4 * EPS));
        }
        const real from = (real)-INFINITY, to = (real)INFINITY;
        p->ops->range(p, 1, &from, &to, &from, &to, &b);
        CHECK(b.lo[0], <=, p->Pmin);
        CHECK(b.hi[0], >=, p->Pmax);
        bump_free(p);
    }
}

/* P against its expansion at another place. */
static void check_bends(const bump *p, const double u[2], const double w[2])
{
    static rectangles r;
    static bump_values h;
    real x[LANES], y[LANES];
    for (int n = 0; n < 8; n++) {
        random_rectangles(u, w, &r);
        for (int i = 0; i < LANES; i++) {
            look(p, &r, i, x, y, &h);
            for (int k = 1; k < SAMPLES; k++) {
                const double du = (double)x[k] - (double)x[0], dw = (double)y[k] - (double)y[0];
                const double line = (double)h.P[0] + (double)h.Pu[0] * du + (double)h.Pw[0] * dw;
                const double bend = 0.5 * ((double)p->Puu_max * du * du + 2 * (double)p->Puw_max * fabs(du * dw) +
                                           (double)p->Pww_max * dw * dw);
                CHECK(fabs((double)h.P[k] - line), <=, bend + 64 * EPS);
            }
        }
    }
}

static void bends_of_functions(void **state)
{
    (void)state;
    bump *p[] = {function_of("sin(6*u)*cos(5*w) + 0.3*u*u*w", turn, half), function_of("sin(u)*cos(3*w)", all, all)};
    for (int k = 0; k < 2; k++) {
        CHECK(p[k]->Puu_max, ==, HUGE_VAL);
        assert_true(bump_prepare(p[k], NULL));
        CHECK(p[k]->Puu_max, <, k ? 0.31 : 14);
        CHECK(p[k]->Pww_max, <, k ? 2.71 : 9);
        check_bends(p[k], turn, half);
        bump_free(p[k]);
    }
}

static void no_bends_of_maps_and_kinks(void **state)
{
    (void)state;
    bump *p[] = {map_of(&layouts[0]), function_of("abs(u)", turn, half)};
    for (int k = 0; k < 2; k++) {
        assert_true(bump_prepare(p[k], NULL));
        assert_true(bump_prepare(p[k], NULL));
        CHECK(p[k]->Puu_max, ==, HUGE_VAL);
        bump_free(p[k]);
    }
}

static bool go_on(void *user, const char *what, double share)
{
    assert_string_equal(what, "building");
    return ++*(int *)user > 0 && share < 0.5;
}

/* And begin again. */
static void the_caller_may_stop_it(void **state)
{
    (void)state;
    int calls = 0;
    const progress w = {.show = go_on, .user = &calls};
    bump *p = map_of(&(map_layout){.size = {1, 1}, .scale = 1});
    assert_false(bump_prepare(p, &w));
    BETWEEN(H, calls, 2 * H); /* of some 3 H rows of all levels */
    assert_null(p->pyramid);
    assert_true(bump_prepare(p, NULL));
    assert_non_null(p->pyramid);
    bump_free(p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bounds_of_maps),         cmocka_unit_test(bounds_far_away),
        cmocka_unit_test(bounds_of_functions),    cmocka_unit_test(bounds_of_mirrored_maps),
        cmocka_unit_test(bounds_are_close),       cmocka_unit_test(any_rectangle),
        cmocka_unit_test(bends_of_functions),     cmocka_unit_test(no_bends_of_maps_and_kinks),
        cmocka_unit_test(the_caller_may_stop_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
