/* Smoothing of a map's steps: within its bound, over the seams of its wrap, the same for any number of threads. */
#include "support/check.h"

#include <stdlib.h>

#include "texture/bump.h"
#include "texture/heights.h"

enum { WIDTH = 40, HEIGHT = 24, N = WIDTH * HEIGHT };
#define STEP (1.0 / 255)
#define PI 3.14159265358979323846

/* Slow waves that tile, in steps of 8 bits; moved by (dx, dy) samples. */
static float sample(int x, int y, int dx, int dy)
{
    const double a = 2 * PI * (x + dx) / WIDTH, b = 2 * PI * (y + dy) / HEIGHT;
    return (float)(floor(255 * (0.5031 + 0.016 * sin(a) * cos(b)) + 0.5) / 255);
}

static heights map_of(map_wrap wrap, bool corners, int dx, int dy)
{
    const map_layout l = {.size = {1, 1}, .wrap = wrap, .corners = corners, .scale = 1};
    heights h;
    float row[WIDTH];
    assert_true(heights_new(&h, WIDTH, HEIGHT, &l, NULL));
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++)
            row[x] = sample(x, y, dx, dy);
        heights_put(&h, 0, y, WIDTH, row);
    }
    return h;
}

static double at(const heights *h, int x, int y) { return (double)*heights_at(h, y, x); }

static void no_height_moves_by_more_than_the_bound(void **state)
{
    (void)state;
    for (int wrap = MAP_REPEAT; wrap <= MAP_MIRROR; wrap++)
        for (int corners = 0; corners <= 1; corners++) {
            heights h = map_of((map_wrap)wrap, corners, 0, 0);
            double moved = 0;
            assert_true(heights_smooth(&h, 3, STEP / 3, 1, NULL));
            for (int k = 0; k < N; k++)
                moved = fmax(moved, fabs(at(&h, k % WIDTH, k / WIDTH) - (double)sample(k % WIDTH, k / WIDTH, 0, 0)));
            CHECK(moved, <=, STEP / 3 + 1e-7);
            CHECK(moved, >, STEP / 4);
            memory_free(h.v);
        }
}

/* A map that repeats has no edge: it is smoothed alike wherever its samples begin. */
static void a_seam_is_no_edge(void **state)
{
    (void)state;
    heights a = map_of(MAP_REPEAT, false, 0, 0), b = map_of(MAP_REPEAT, false, 17, 9);
    assert_true(heights_smooth(&a, 2.5, STEP, 1, NULL) && heights_smooth(&b, 2.5, STEP, 1, NULL));
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            CHECK(fabs(at(&b, x, y) - at(&a, (x + 17) % WIDTH, (y + 9) % HEIGHT)), <, 1e-7);
    memory_free(a.v);
    memory_free(b.v);
}

/* Closer to the waves than the steps are, by far where slopes are concerned. */
static void slopes_come_back(void **state)
{
    (void)state;
    heights h = map_of(MAP_REPEAT, false, 0, 0);
    double before = 0, after = 0;
    assert_true(heights_smooth(&h, 2, STEP, 2, NULL));
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 1; x < WIDTH - 1; x++) {
            const double a = 2 * PI / WIDTH, b = 2 * PI * y / HEIGHT,
                         truth = 0.016 * (sin(a * (x + 1)) - sin(a * (x - 1))) * cos(b);
            before += fabs((double)sample(x + 1, y, 0, 0) - (double)sample(x - 1, y, 0, 0) - truth);
            after += fabs(at(&h, x + 1, y) - at(&h, x - 1, y) - truth);
        }
    CHECK(after, <, before / 2.5);
    memory_free(h.v);
}

static void threads_change_nothing(void **state)
{
    (void)state;
    heights a = map_of(MAP_MIRROR, true, 0, 0), b = map_of(MAP_MIRROR, true, 0, 0);
    assert_true(heights_smooth(&a, 4, STEP, 1, NULL) && heights_smooth(&b, 4, STEP, 5, NULL));
    for (int k = 0; k < N; k++)
        CHECK(at(&a, k % WIDTH, k / WIDTH), ==, at(&b, k % WIDTH, k / WIDTH));
    memory_free(a.v);
    memory_free(b.v);
}

/* The bounds that methods rely on are those of the smoothed heights. */
static void bounds_are_of_what_is_left(void **state)
{
    (void)state;
    const map_layout l = {.size = {1, 1}, .scale = 1};
    const float spike[9] = {0, 0, 0, 0, 1, 0, 0, 0, 0};
    bump *p = bump_map_new(3, 3, &l, NULL);
    assert_non_null(p);
    for (int y = 0; y < 3; y++)
        bump_map_put(p, 0, y, 3, spike + 3 * y);
    assert_true(bump_map_smooth(p, 1, 0.25, 1, NULL));
    bump_map_end(p, 1);
    CHECK(fabs((double)p->Pmax - 0.75), <, 1e-6);
    CHECK((double)p->Pmin, >, 0.05);
    bump_free(p);
}

/* The caller ends it in its last third. */
static bool go_on(void *user, const char *what, double share)
{
    assert_string_equal(what, "smoothing");
    return ++*(int *)user > 0 && share < 0.7;
}

static void the_caller_may_stop_it(void **state)
{
    (void)state;
    int calls = 0;
    const progress w = {.show = go_on, .user = &calls};
    heights h = map_of(MAP_REPEAT, false, 0, 0);
    assert_false(heights_smooth(&h, 3, STEP, 1, &w));
    BETWEEN(2 * HEIGHT / 2, calls, 2 * HEIGHT - 10);
    memory_free(h.v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_height_moves_by_more_than_the_bound),
        cmocka_unit_test(a_seam_is_no_edge),
        cmocka_unit_test(slopes_come_back),
        cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(bounds_are_of_what_is_left),
        cmocka_unit_test(the_caller_may_stop_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
