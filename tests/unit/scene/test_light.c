/* Area lights: where their samples are, and their shares. */
#include "support/check.h"
#include "scene/light.h"

static light area(int across, int down)
{
    return (light){.at = {1, 2, 3}, .u = {4, 0, 0}, .w = {0, 0, 2}, .samples = {across, down}};
}

static void shares_sum_to_1(void **state)
{
    (void)state;
    for (int across = 1; across <= 9; across++)
        for (int down = 1; down <= 5; down++) {
            const light l = area(across, down);
            double sum = 0;
            for (int k = 0; k < across * down; k++) {
                real share;
                light_sample(&l, k, &share);
                CHECK(share, >, 0);
                sum += (double)share;
            }
            NEAR(sum, 1, 20 * EPS);
        }
}

/* The samples in the middle of an odd row belong to both halves: 1/4, 1/2, 1/4. */
static void the_middle_counts_twice(void **state)
{
    const light l = area(3, 1);
    const double want[] = {0.25, 0.5, 0.25};
    (void)state;
    for (int k = 0; k < 3; k++) {
        real share;
        light_sample(&l, k, &share);
        CHECK(share, ==, want[k]);
    }
}

static void first_and_last_are_on_the_edge(void **state)
{
    const light l = area(4, 3);
    real share;
    (void)state;
    const light first = light_sample(&l, 0, &share), last = light_sample(&l, 11, &share);
    NEAR(first.at.x, -1, 1e-15);
    NEAR(first.at.z, 2, 1e-15);
    NEAR(last.at.x, 3, 1e-15);
    NEAR(last.at.z, 4, 1e-15);
}

static void corners_are_the_ends(void **state)
{
    const light l = area(2, 2), point = area(1, 1);
    (void)state;
    assert_int_equal(light_corners(&l), 4);
    assert_int_equal(light_corners(&point), 1);
    NEAR(light_corner(&l, 3, (vec3){0, 0, 0}).x, 3, 1e-15);
    NEAR(light_corner(&l, 3, (vec3){0, 0, 0}).z, 4, 1e-15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shares_sum_to_1),
        cmocka_unit_test(the_middle_counts_twice),
        cmocka_unit_test(first_and_last_are_on_the_edge),
        cmocka_unit_test(corners_are_the_ends),
    };
    return cmocka_run_group_tests_name("area lights", tests, NULL, NULL);
}
