/* The rays of pinhole and orthographic cameras. */
#include "support/check.h"
#include "scene/camera.h"
#include "wave/lane.h"

/* From z = -4 to the origin; x to the right. */
static camera pinhole(void)
{
    camera c;
    assert_true(camera_look(&c, (vec3){0, 0, -4}, (vec3){0, 0, 0}, (vec3){0, 1, 0}, 90, 200, 100));
    return c;
}

static void the_middle_is_forward(void **state)
{
    static rays x;
    const camera c = pinhole();
    (void)state;
    camera_ray(&c, 200, 100, 100, 50, &x, 3);
    NEAR(x.r.z[3], -4, 0);
    NEAR(x.s.x[3], 0, EPS);
    NEAR(x.s.y[3], 0, EPS);
    NEAR(x.s.z[3], 1, EPS);
}

/* 90 degrees across: the corner is 1 to the left and 1/2 up at unit depth. */
static void the_corner(void **state)
{
    static rays x;
    const camera c = pinhole();
    (void)state;
    camera_ray(&c, 200, 100, 0, 0, &x, 0);
    NEAR(x.s.x[0], -1, 2 * EPS);
    NEAR(x.s.y[0], 0.5, 2 * EPS);
}

static void orthographic_rays_are_parallel(void **state)
{
    static rays x;
    camera c;
    (void)state;
    assert_true(camera_orthographic(&c, (vec3){0, 0, -4}, (vec3){0, 0, 0}, (vec3){0, 1, 0}, 6, 200, 100));
    camera_ray(&c, 200, 100, 0, 0, &x, 0);
    NEAR(x.s.z[0], 1, EPS);
    NEAR(x.s.x[0], 0, EPS);
    NEAR(x.r.x[0], -3, 4 * EPS);
    NEAR(x.r.y[0], 1.5, 4 * EPS);
}

static void directions_without_sense(void **state)
{
    camera c;
    const vec3 at = {1, 2, 3}, up = {0, 1, 0};
    (void)state;
    assert_false(camera_look(&c, at, at, up, 40, 4, 3));
    assert_false(camera_look(&c, at, (vec3){1, 9, 3}, up, 40, 4, 3));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_middle_is_forward),
        cmocka_unit_test(the_corner),
        cmocka_unit_test(orthographic_rays_are_parallel),
        cmocka_unit_test(directions_without_sense),
    };
    return cmocka_run_group_tests_name("camera", tests, NULL, NULL);
}
