/* The hierarchy whose rays can wait: single rays and beams reach every box that they pass, whatever the threads, and
 * from near to far; shortened rays end; rays in all directions make a beam give up. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "bvh/wide.h"
#include "support/check.h"
#include "support/random_in.h"

enum { BOXES = 3000, RAYS = 200 };

typedef struct boxes {
    double lo[BOXES][3], hi[BOXES][3];
    wide_box box[BOXES];
} boxes;

/* Some are flat, and some are in the same place. */
static boxes *random_boxes(void)
{
    boxes *b = malloc(sizeof *b);
    assert_non_null(b);
    for (int i = 0; i < BOXES; i++) {
        for (int a = 0; a < 3; a++) {
            b->lo[i][a] = i % 10 == 0 ? 1 : random_in(-5, 5);
            b->hi[i][a] = b->lo[i][a] + (i % 7 == a ? 0 : random_in(0.01, 0.8));
        }
        b->box[i] = wide_box_of(b->lo[i], b->hi[i]);
    }
    return b;
}

/* Where the ray enters the box, at 0 <= t <= end; negative: it does not. */
static double enters(const boxes *b, int i, const double r[3], const double s[3], double end)
{
    double from = 0, to = end;
    for (int a = 0; a < 3; a++) {
        const double x = (b->lo[i][a] - r[a]) / s[a], y = (b->hi[i][a] - r[a]) / s[a];
        from = fmax(from, fmin(x, y));
        to = fmin(to, fmax(x, y));
    }
    return from <= to ? from : -1;
}

static void random_ray(double r[3], double s[3], double spread)
{
    for (int a = 0; a < 3; a++) {
        r[a] = random_in(-spread, spread) - (a == 2 ? 9 : 0);
        s[a] = random_in(-0.3, 0.3) * spread + (a == 2 ? 1 : 0);
    }
}

static vec3 vector(const double v[3]) { return (vec3){v[0], v[1], v[2]}; }

static void single_rays(void **state)
{
    boxes *b = random_boxes();
    static int32_t order[BOXES], other[BOXES];
    (void)state;
    wide_bvh *w = wide_new(BOXES, b->box, order, 1, NULL), *parallel = wide_new(BOXES, b->box, other, 4, NULL);
    assert_non_null(w);
    assert_non_null(parallel);
    assert_memory_equal(order, other, sizeof order);
    int met = 0;
    for (int k = 0; k < RAYS; k++) {
        double r[3], s[3];
        bool seen[BOXES] = {false};
        wide_walk walk;
        random_ray(r, s, 5);
        wide_begin(&walk, vector(r), vector(s));
        for (int32_t at; (at = wide_next(w, &walk, 12)) >= 0;) {
            assert_false(seen[order[at]]);
            seen[order[at]] = true;
        }
        for (int i = 0; i < BOXES; i++) {
            const double t = enters(b, i, r, s, 12);
            met += t >= 0;
            assert_true(t < 0 || seen[i]);
        }
    }
    CHECK(met, >, RAYS);
    wide_free(w);
    wide_free(parallel);
    free(b);
}

/* After a box, its ray goes no further: then no box is met that begins beyond. */
static void shortened_rays(void **state)
{
    boxes *b = random_boxes();
    static int32_t order[BOXES];
    (void)state;
    wide_bvh *w = wide_new(BOXES, b->box, order, 2, NULL);
    assert_non_null(w);
    for (int k = 0; k < RAYS; k++) {
        double r[3], s[3], end = 12, nearest = 12;
        wide_walk walk;
        random_ray(r, s, 3);
        wide_begin(&walk, vector(r), vector(s));
        for (int32_t at; (at = wide_next(w, &walk, end)) >= 0;) {
            const double t = enters(b, order[at], r, s, 12);
            CHECK(t, <=, end * 1.001 + 1e-3);
            end = t >= 0 && t < end ? t : end;
        }
        for (int i = 0; i < BOXES; i++) {
            const double t = enters(b, i, r, s, 12);
            nearest = t >= 0 && t < nearest ? t : nearest;
        }
        NEAR(end, nearest, 1e-12);
    }
    wide_free(w);
    free(b);
}

/* The same boxes for 16 rays together as for each alone; `ends`: some are done before they begin. */
static int check_beam(const wide_bvh *w, const int32_t *order, const boxes *b, double spread, bool ends)
{
    static real r[3][WIDE_RAYS], s[3][WIDE_RAYS];
    static bool seen[BOXES][WIDE_RAYS];
    real end[WIDE_RAYS];
    int32_t lane[WIDE_RAYS];
    const real *const at[3] = {r[0], r[1], r[2]}, *const way[3] = {s[0], s[1], s[2]};
    double r0[3], s0[3], dr[3], ds[3];
    wide_beam k;
    unsigned rays;
    int met = 0;
    random_ray(r0, s0, 4);
    for (int i = 0; i < WIDE_RAYS; i++) {
        random_ray(dr, ds, 1);
        for (int a = 0; a < 3; a++) {
            r[a][i] = (real)(r0[a] + spread * (dr[a] + (a == 2 ? 9 : 0)));
            s[a][i] = (real)(s0[a] + spread * (ds[a] - (a == 2)));
        }
        lane[i] = WIDE_RAYS - 1 - i;
        end[i] = ends && i % 3 == 0 ? -1 : 12;
    }
    memset(seen, 0, sizeof seen);
    wide_beam_begin(&k, 13, lane, at, way, end);
    for (int32_t item; (item = wide_beam_next(w, &k, &rays)) >= 0;)
        for (int i = 0; i < WIDE_RAYS; i++)
            if (rays >> i & 1)
                seen[order[item]][i] = true;
    if (k.work < 0)
        return -1;
    for (int i = 0; i < WIDE_RAYS; i++)
        for (int j = 0; j < BOXES; j++) {
            const int from = lane[i];
            const double one[3] = {(double)r[0][from], (double)r[1][from], (double)r[2][from]},
                         to[3] = {(double)s[0][from], (double)s[1][from], (double)s[2][from]};
            const bool is_in = i < 13 && end[from] > 0;
            assert_true(is_in || !seen[j][i]);
            if (is_in && enters(b, j, one, to, 12) >= 0) {
                assert_true(seen[j][i]);
                met++;
            }
        }
    return met;
}

static void beams(void **state)
{
    boxes *b = random_boxes();
    static int32_t order[BOXES];
    int met = 0, gave_up = 0;
    (void)state;
    wide_bvh *w = wide_new(BOXES, b->box, order, 2, NULL);
    assert_non_null(w);
    for (int k = 0; k < RAYS; k++) {
        const int found = check_beam(w, order, b, k % 2 ? 0.01 : 0.002, k % 4 == 3);
        CHECK(found, >=, 0);
        met += found;
    }
    CHECK(met, >, RAYS);
    for (int k = 0; k < 20; k++)
        gave_up += check_beam(w, order, b, 4, false) < 0;
    CHECK(gave_up, >, 15);
    wide_free(w);
    free(b);
}

/* One box, and a thousand of the same. */
static void small_and_same(void **state)
{
    static wide_box box[1000];
    static int32_t order[1000];
    const double lo[3] = {-1, -1, -1}, hi[3] = {1, 1, 1};
    (void)state;
    for (int i = 0; i < 1000; i++)
        box[i] = wide_box_of(lo, hi);
    for (int n = 1; n <= 1000; n += 999) {
        wide_bvh *w = wide_new(n, box, order, 1, NULL);
        wide_walk walk;
        int met = 0;
        assert_non_null(w);
        wide_begin(&walk, (vec3){0, 0, -5}, (vec3){0, 0, 1});
        while (wide_next(w, &walk, 100) >= 0)
            met++;
        assert_int_equal(met, n);
        wide_begin(&walk, (vec3){0, 3, -5}, (vec3){0, 0, 1});
        assert_int_equal(wide_next(w, &walk, 100), -1);
        wide_free(w);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(single_rays),
        cmocka_unit_test(shortened_rays),
        cmocka_unit_test(beams),
        cmocka_unit_test(small_and_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
