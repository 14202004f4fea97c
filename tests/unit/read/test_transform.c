/* Transforms: where steps bring a place, in the order in which they stand, and what is no step. */
#include "read/parts.h"
#include "support/reading.h"

/* The steps of a text, after the identity; the error that they must have. */
static affine transform_of(const char *text, const char *error)
{
    reading *t = reading_of(text);
    affine m = affine_identity();
    assert_int_equal(reader_transform(&t->r, reading_at(t, "t"), &m), !error);
    reading_told(t, error);
    reading_end(t);
    return m;
}

static void assert_goes(const affine *m, vec3 from, vec3 to)
{
    const vec3 p = affine_point(m, from);
    NEAR(p.x, to.x, 1e-15);
    NEAR(p.y, to.y, 1e-15);
    NEAR(p.z, to.z, 1e-15);
}

static void no_steps_leave_a_place_where_it_is(void **state)
{
    const affine m = transform_of("t: []\n", NULL);
    (void)state;
    assert_goes(&m, (vec3){1, 2, 3}, (vec3){1, 2, 3});
}

static void translate_adds(void **state)
{
    const affine m = transform_of("t: [{translate: [10, 20, 30]}]\n", NULL);
    (void)state;
    assert_goes(&m, (vec3){1, 2, 3}, (vec3){11, 22, 33});
}

static void scale_takes_one_factor_or_three(void **state)
{
    const affine one = transform_of("t: [{scale: 2}]\n", NULL),
                 three = transform_of("t: [{scale: [2, -1, 3]}]\n", NULL);
    (void)state;
    assert_goes(&one, (vec3){1, 2, 3}, (vec3){2, 4, 6});
    assert_goes(&three, (vec3){1, 2, 3}, (vec3){2, -2, 9});
}

/* The thumb of the left hand along the axis: about y from z to x. */
static void rotate_turns_as_the_left_hand(void **state)
{
    const affine x = transform_of("t: [{rotate: [90, 0, 0]}]\n", NULL),
                 y = transform_of("t: [{rotate: [0, 90, 0]}]\n", NULL),
                 z = transform_of("t: [{rotate: [0, 0, 90]}]\n", NULL);
    (void)state;
    assert_goes(&x, (vec3){0, 1, 0}, (vec3){0, 0, 1});
    assert_goes(&y, (vec3){0, 0, 1}, (vec3){1, 0, 0});
    assert_goes(&z, (vec3){1, 0, 0}, (vec3){0, 1, 0});
}

static void right_angles_are_exact(void **state)
{
    const affine m = transform_of("t: [{rotate: [0, 450, 0]}]\n", NULL);
    const vec3 p = affine_point(&m, (vec3){0, 0, 1});
    (void)state;
    CHECK(p.x, ==, 1);
    CHECK(p.z, ==, 0);
}

static void rotate_is_about_x_then_y_then_z(void **state)
{
    const affine m = transform_of("t: [{rotate: [90, 90, 0]}]\n", NULL);
    (void)state;
    assert_goes(&m, (vec3){0, 1, 0}, (vec3){1, 0, 0});
}

static void steps_are_made_in_their_order(void **state)
{
    const affine m = transform_of("t: [{scale: 2}, {translate: [1, 0, 0]}]\n", NULL),
                 n = transform_of("t: [{translate: [1, 0, 0]}, {scale: 2}]\n", NULL);
    (void)state;
    assert_goes(&m, (vec3){1, 0, 0}, (vec3){3, 0, 0});
    assert_goes(&n, (vec3){1, 0, 0}, (vec3){4, 0, 0});
}

static void look_stands_as_a_camera(void **state)
{
    const affine m = transform_of("t: [{look: {from: [1, 2, 3], at: [5, 2, 3]}}]\n", NULL);
    (void)state;
    assert_goes(&m, (vec3){0, 0, 0}, (vec3){1, 2, 3});
    assert_goes(&m, (vec3){0, 0, 1}, (vec3){2, 2, 3});
    assert_goes(&m, (vec3){0, 1, 0}, (vec3){1, 3, 3});
}

static void a_step_is_one_key(void **state)
{
    (void)state;
    transform_of("t: [{scale: 2, translate: [1, 0, 0]}]\n", ":1:5: a step with 2 keys, expected one");
}

static void no_scale_is_0(void **state)
{
    (void)state;
    transform_of("t: [{scale: [1, 0, 1]}]\n", ":1:17: a scale of 0 has no extent");
}

static void look_needs_a_direction(void **state)
{
    (void)state;
    transform_of("t: [{look: {from: [1, 2, 3], at: [1, 2, 3]}}]\n", ":1:34: it looks at its own place");
}

static void up_is_not_along_the_view(void **state)
{
    (void)state;
    transform_of("t: [{look: {from: [0, 0, 0], at: [0, 1, 0]}}]\n", "'up' is along the view");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_steps_leave_a_place_where_it_is),
        cmocka_unit_test(translate_adds),
        cmocka_unit_test(scale_takes_one_factor_or_three),
        cmocka_unit_test(rotate_turns_as_the_left_hand),
        cmocka_unit_test(right_angles_are_exact),
        cmocka_unit_test(rotate_is_about_x_then_y_then_z),
        cmocka_unit_test(steps_are_made_in_their_order),
        cmocka_unit_test(look_stands_as_a_camera),
        cmocka_unit_test(a_step_is_one_key),
        cmocka_unit_test(no_scale_is_0),
        cmocka_unit_test(look_needs_a_direction),
        cmocka_unit_test(up_is_not_along_the_view),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
