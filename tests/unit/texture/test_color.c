/* Colour textures: where the fields of a checker and the pixels of an image are, and what is between them. */
#include "texture/color.h"

#include "support/check.h"

static vec3 look_up(const color_texture *p, double u, double w)
{
    static vec3s color;
    const real x = (real)u, y = (real)w;
    p->ops->eval(p, 1, &x, &y, &color);
    return vec3s_get(&color, 0);
}

static void same(vec3 got, double x, double y, double z)
{
    NEAR(got.x, x, 8 * EPS);
    NEAR(got.y, y, 8 * EPS);
    NEAR(got.z, z, 8 * EPS);
}

/* ---- checkers ---- */

static const vec3 COLORS[2] = {{1, 0.5, 0}, {0.25, 0, 1}};

static color_texture *checker(void)
{
    return color_checker_new(COLORS, (const double[2]){0.5, 2}, (const double[2]){0.25, -1});
}

static void even(vec3 got) { same(got, 1, 0.5, 0); }
static void odd(vec3 got) { same(got, 0.25, 0, 1); }

static void the_field_at_the_offset_has_the_first_colour(void **state)
{
    (void)state;
    color_texture *p = checker();
    even(look_up(p, 0.26, -0.9));
    even(look_up(p, 0.74, 0.9));
    color_texture_free(p);
}

static void neighbours_have_the_other_colour(void **state)
{
    (void)state;
    color_texture *p = checker();
    odd(look_up(p, 0.76, 0));
    odd(look_up(p, 0.24, 0));
    odd(look_up(p, 0.5, 1.1));
    odd(look_up(p, 0.5, -1.1));
    color_texture_free(p);
}

static void diagonal_neighbours_have_the_same_colour(void **state)
{
    (void)state;
    color_texture *p = checker();
    even(look_up(p, 0.76, 1.1));
    even(look_up(p, 0.24, -1.1));
    even(look_up(p, 0.24, 1.1));
    color_texture_free(p);
}

/* Numbers from REAL_WHOLE / 2 on have halves and no smaller fraction; from REAL_WHOLE on they are whole. */
static void a_distant_field_has_one_of_the_two_colours(void **state)
{
    (void)state;
    color_texture *p = color_checker_new(COLORS, (const double[2]){1, 1}, (const double[2]){0, 0});
    const double half = (double)REAL_WHOLE / 2;
    for (int k = -9; k <= 9; k++)
        for (int side = -1; side <= 1; side += 2) {
            const double field = side * half + k / 2.0;
            const bool is_odd = fmod(floor(field), 2) != 0;
            (is_odd ? odd : even)(look_up(p, field, 0.5));
            (is_odd ? odd : even)(look_up(p, 0.5, field));
            assert_true(real_floor((real)field) == (real)floor(field));
        }
    const double far[] = {2 * half + 1, -2 * half - 1, 1e30, -1e30, HUGE_VAL, -HUGE_VAL, (double)NAN};
    for (int k = 0; k < 7; k++) {
        const vec3 got = look_up(p, far[k], 0.5);
        assert_true((got.x == 1 && got.z == 0) || (got.x == 0.25 && got.z == 1));
    }
    color_texture_free(p);
}

/* ---- images ---- */

enum { WIDTH = 3, HEIGHT = 2 };

/* Pixel (i,j) is (i, j, 10 i + j). */
static texels *pixels(map_wrap wrap, map_layout *l)
{
    static float v[WIDTH * HEIGHT * 4];
    for (int k = 0; k < WIDTH * HEIGHT; k++) {
        v[4 * k] = (float)(k % WIDTH);
        v[4 * k + 1] = (float)(k / WIDTH);
        v[4 * k + 2] = (float)(10 * (k % WIDTH) + k / WIDTH);
        v[4 * k + 3] = 1;
    }
    *l = (map_layout){.size = {3, 2}, .wrap = wrap};
    texels *t = texels_new(&(image){WIDTH, HEIGHT, v}, l, NULL);
    assert_non_null(t);
    return t;
}

static void check_image(map_wrap wrap, bool nearest, double u, double w, double x, double y, double z)
{
    map_layout l;
    texels *t = pixels(wrap, &l);
    color_texture *p = color_image_new(t, &l, nearest);
    const vec3 got = look_up(p, u, w);
    NEAR(got.x, x, 100 * EPS);
    NEAR(got.y, y, 100 * EPS);
    NEAR(got.z, z, 100 * EPS);
    color_texture_free(p);
    texels_free(t);
}

static void each_pixel_in_the_middle_of_its_cell(void **state)
{
    (void)state;
    for (int nearest = 0; nearest < 2; nearest++)
        for (int k = 0; k < WIDTH * HEIGHT; k++) {
            const int i = k % WIDTH, j = k / WIDTH;
            check_image(MAP_REPEAT, nearest, i + 0.5, j + 0.5, i, j, 10 * i + j);
        }
}

static void bilinear_between_pixels(void **state)
{
    (void)state;
    check_image(MAP_REPEAT, false, 1, 0.5, 0.5, 0, 5);
    check_image(MAP_REPEAT, false, 1.75, 1.25, 1.25, 0.75, 13.25);
}

static void nearest_is_constant_on_a_pixel(void **state)
{
    (void)state;
    check_image(MAP_REPEAT, true, 1.01, 1.01, 1, 1, 11);
    check_image(MAP_REPEAT, true, 1.99, 1.99, 1, 1, 11);
    check_image(MAP_REPEAT, true, 2.01, 0.99, 2, 0, 20);
}

static void repeated(void **state)
{
    (void)state;
    check_image(MAP_REPEAT, true, 3.5, -0.5, 0, 1, 1);
    check_image(MAP_REPEAT, false, 3, 0.5, 1, 0, 10); /* between the last and the first */
}

static void mirrored(void **state)
{
    (void)state;
    check_image(MAP_MIRROR, true, 3.5, -0.5, 2, 0, 20);
    check_image(MAP_MIRROR, false, 3, 0.5, 2, 0, 20);
}

static void clamped(void **state)
{
    (void)state;
    for (int nearest = 0; nearest < 2; nearest++) {
        check_image(MAP_CLAMP, nearest, 99, -99, 2, 0, 20);
        check_image(MAP_CLAMP, nearest, -99, 99, 0, 1, 1);
    }
}

static void an_image_of_one_row_is_refused(void **state)
{
    (void)state;
    float v[8] = {0};
    const map_layout l = {.size = {1, 1}};
    assert_null(texels_new(&(image){2, 1, v}, &l, NULL));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_field_at_the_offset_has_the_first_colour),
        cmocka_unit_test(neighbours_have_the_other_colour),
        cmocka_unit_test(diagonal_neighbours_have_the_same_colour),
        cmocka_unit_test(a_distant_field_has_one_of_the_two_colours),
        cmocka_unit_test(each_pixel_in_the_middle_of_its_cell),
        cmocka_unit_test(bilinear_between_pixels),
        cmocka_unit_test(nearest_is_constant_on_a_pixel),
        cmocka_unit_test(repeated),
        cmocka_unit_test(mirrored),
        cmocka_unit_test(clamped),
        cmocka_unit_test(an_image_of_one_row_is_refused),
    };
    return cmocka_run_group_tests_name("colour textures", tests, NULL, NULL);
}
