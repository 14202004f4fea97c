/* The hierarchy against brute force: each box that is met must be among the candidates, and the candidates must not be
 * much more than that. */
#include "support/check.h"

#include <stdlib.h>
#include <string.h>

#include "bvh/bvh.h"
#include "support/random_in.h"

enum { BOXES = 500, TRIES = 400 };

static bvh_box box[BOXES];
static bvh *tree;

static float coordinate(void) { return (float)random_in(-1, 1); }

static int set_up(void **state)
{
    (void)state;
    for (int i = 0; i < BOXES; i++)
        for (int k = 0; k < 3; k++) {
            box[i].lo[k] = coordinate();
            box[i].hi[k] = box[i].lo[k] + (float)random_in(0, 0.5);
        }
    tree = bvh_new(BOXES, box, 1, NULL);
    return tree ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    bvh_free(tree);
    return 0;
}

/* Is some r + s t, 0 <= t <= end, in the box made wider by `margin`? *at: the smallest such t. */
static bool passes(const bvh_box *b, const float r[3], const float s[3], double end, double margin, double *at)
{
    double from = 0, to = end;
    for (int k = 0; k < 3; k++) {
        const double x = ((double)b->lo[k] - margin - (double)r[k]) / (double)s[k];
        const double y = ((double)b->hi[k] + margin - (double)r[k]) / (double)s[k];
        from = fmax(from, fmin(x, y));
        to = fmin(to, fmax(x, y));
    }
    *at = from;
    return from <= to;
}

static double distance(const bvh_box *b, const float p[3])
{
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        const double d = fmax(0, fmax((double)b->lo[k] - (double)p[k], (double)p[k] - (double)b->hi[k]));
        sum += d * d;
    }
    return sqrt(sum);
}

static void count_visit(void *user, int32_t i) { ((int *)user)[i]++; }

static void random_ray(float r[3], float s[3])
{
    for (int k = 0; k < 3; k++) {
        r[k] = 1.2f * coordinate();
        s[k] = coordinate();
    }
}

static void test_along_visits_the_boxes_that_are_passed(void **state)
{
    int met = 0;
    (void)state;
    for (int i = 0; i < TRIES; i++) {
        int seen[BOXES] = {0};
        float r[3], s[3];
        double at;
        random_ray(r, s);
        const float end = (float)random_in(0.1, 3);
        bvh_along(tree, r, s, end, count_visit, seen);
        for (int k = 0; k < BOXES; k++) {
            if (passes(&box[k], r, s, (double)end, -1e-5, &at))
                CHECK(seen[k], ==, 1);
            if (!passes(&box[k], r, s, (double)end, 1e-5, &at))
                CHECK(seen[k], ==, 0);
            met += seen[k];
        }
    }
    CHECK(met, >, 2 * TRIES);
}

/* The nearest box so far. */
typedef struct search {
    const float *r, *s;
    double nearest;
    int visits;
} search;

static float note_nearest(void *user, int32_t i, float end)
{
    search *k = user;
    double at;
    k->visits++;
    if (passes(&box[i], k->r, k->s, (double)end, 0, &at) && at < k->nearest)
        k->nearest = at;
    return k->nearest < (double)end ? (float)k->nearest : end;
}

static void test_toward_finds_the_nearest_box(void **state)
{
    int visits = 0, all = 0;
    (void)state;
    for (int i = 0; i < TRIES; i++) {
        float r[3], s[3];
        double nearest = 4, at;
        random_ray(r, s);
        search k = {r, s, 4, 0};
        bvh_toward(tree, r, s, 4, note_nearest, &k);
        for (int b = 0; b < BOXES; b++)
            if (passes(&box[b], r, s, 4, 0, &at)) {
                nearest = fmin(nearest, at);
                all++;
            }
        NEAR(k.nearest, nearest, 1e-5);
        visits += k.visits;
    }
    CHECK(visits, <, 0.8 * all); /* what lies behind is mostly left out */
}

static float stop(void *user, int32_t i, float end)
{
    (void)i, (void)end;
    ++*(int *)user;
    return -1;
}

static void test_toward_stops(void **state)
{
    (void)state;
    const float r[3] = {-3, 0, 0}, s[3] = {1, 0.01f, 0.02f};
    int visits = 0, seen[BOXES] = {0}, all = 0;
    bvh_along(tree, r, s, 9, count_visit, seen);
    for (int k = 0; k < BOXES; k++)
        all += seen[k];
    bvh_toward(tree, r, s, 9, stop, &visits);
    CHECK(all, >, 4);
    BETWEEN(1, visits, all - 1);
}

static void test_around_visits_the_boxes_within_the_radius(void **state)
{
    int met = 0;
    (void)state;
    for (int i = 0; i < TRIES; i++) {
        int seen[BOXES] = {0};
        const float p[3] = {coordinate(), coordinate(), coordinate()};
        const double radius = random_in(0.05, 0.5);
        bvh_around(tree, p, (float)radius, count_visit, seen);
        for (int k = 0; k < BOXES; k++) {
            if (distance(&box[k], p) < radius - 1e-5)
                CHECK(seen[k], ==, 1);
            met += seen[k];
        }
    }
    CHECK(met, >, 5 * TRIES);
}

static void test_no_boxes(void **state)
{
    (void)state;
    int seen = 0;
    bvh *none = bvh_new(0, NULL, 1, NULL);
    assert_non_null(none);
    bvh_along(none, (float[]){0, 0, 0}, (float[]){1, 0, 0}, 1, count_visit, &seen);
    bvh_around(none, (float[]){0, 0, 0}, 1, count_visit, &seen);
    CHECK(seen, ==, 0);
    bvh_free(none);
}

/* ---- the space ---- */

static const double low[3] = {999, -5, 20}, high[3] = {1003, 3, 26};

static void test_space_has_the_centre_and_the_half_diagonal(void **state)
{
    (void)state;
    const bvh_space p = bvh_space_about(low, high);
    NEAR(p.centre.x, 1001, 1e-12);
    NEAR(p.centre.y, -1, 1e-12);
    NEAR(p.centre.z, 23, 1e-12);
    NEAR(p.radius, sqrt(4 + 16 + 9), 1e-12);
}

static void test_space_makes_boxes_wider(void **state)
{
    (void)state;
    const bvh_space p = bvh_space_about(low, high);
    const bvh_box b = bvh_box_in(&p, low, high);
    CHECK((double)b.lo[0], <, -2 / p.radius);
    CHECK((double)b.hi[1], >, 4 / p.radius);
    NEAR(b.hi[2], 3 / p.radius, 1e-5);
}

static void test_enter_cuts_a_ray_to_the_sphere(void **state)
{
    (void)state;
    const bvh_space p = bvh_space_about(low, high);
    double from = 0, to = 1e9;
    float at[3], way[3], end;
    assert_true(bvh_enter(&p, p.radius, (vec3){1001, -1, -1e6}, (vec3){0, 0, 2}, &from, &to, at, way, &end));
    NEAR(from, 0.5 * (1e6 + 23 - p.radius), 1e-3);
    NEAR(to, 0.5 * (1e6 + 23 + p.radius), 1e-3);
    NEAR(at[2], -1, 2e-5);
    NEAR(way[2], 1, 1e-7);
    NEAR(end, 2, 4e-5);
}

static void test_enter_keeps_the_callers_ends(void **state)
{
    (void)state;
    const bvh_space p = bvh_space_about(low, high);
    double from = 1, to = 1.5;
    float at[3], way[3], end;
    assert_true(bvh_enter(&p, p.radius, (vec3){1001, -1, 22}, (vec3){0, 0, 1}, &from, &to, at, way, &end));
    CHECK(from, ==, 1);
    CHECK(to, ==, 1.5);
    NEAR(at[2], 0, 1e-7);
    NEAR(end, 0.5 / p.radius, 1e-5);
}

static void test_enter_refuses_what_misses(void **state)
{
    (void)state;
    const bvh_space p = bvh_space_about(low, high);
    static const vec3 r[] = {{1001, 5, -9}, {1001, -1, 40}, {1001, -1, -9}, {1001, (double)NAN, -9}};
    static const vec3 s[] = {{0, 0, 1}, {0, 0, 1}, {0, 0, 0}, {0, 0, 1}};
    for (int i = 0; i < 4; i++) { /* beside it, behind it, without direction, NaN */
        double from = 0, to = 1e9;
        float at[3], way[3], end;
        CHECK(bvh_enter(&p, p.radius, r[i], s[i], &from, &to, at, way, &end), ==, 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_along_visits_the_boxes_that_are_passed),
        cmocka_unit_test(test_toward_finds_the_nearest_box),
        cmocka_unit_test(test_toward_stops),
        cmocka_unit_test(test_around_visits_the_boxes_within_the_radius),
        cmocka_unit_test(test_no_boxes),
        cmocka_unit_test(test_space_has_the_centre_and_the_half_diagonal),
        cmocka_unit_test(test_space_makes_boxes_wider),
        cmocka_unit_test(test_enter_cuts_a_ray_to_the_sphere),
        cmocka_unit_test(test_enter_keeps_the_callers_ends),
        cmocka_unit_test(test_enter_refuses_what_misses),
    };
    return cmocka_run_group_tests_name("bvh", tests, set_up, tear_down);
}
