/* The small readers: what they take, what they refuse and where, and that an absent key changes nothing. */
#include "support/reading.h"

static void a_vector_is_three_numbers(void **state)
{
    reading *t = reading_of("v: [1, -2, 3.5]\n");
    vec3 v = {9, 9, 9};
    (void)state;
    assert_true(reader_vector(&t->r, yaml_root(t->r.y), "v", "a place", &v));
    NEAR(v.x, 1, 0);
    NEAR(v.y, -2, 0);
    NEAR(v.z, 3.5, 0);
    reading_told(t, NULL);
    reading_end(t);
}

static void an_absent_vector_stays_as_it_is(void **state)
{
    reading *t = reading_of("v: [1, 2, 3]\n");
    vec3 v = {9, 8, 7};
    (void)state;
    assert_true(reader_vector(&t->r, yaml_root(t->r.y), "w", "a place", &v));
    NEAR(v.y, 8, 0);
    reading_told(t, NULL);
    reading_end(t);
}

static void a_wrong_vector_stays_as_it_is(void **state)
{
    reading *t = reading_of("v: [1, 2]\n");
    vec3 v = {9, 8, 7};
    (void)state;
    assert_false(reader_vector(&t->r, yaml_root(t->r.y), "v", "a place [x, y, z]", &v));
    NEAR(v.y, 8, 0);
    reading_told(t, ":1:4: 2 values, expected a place [x, y, z]");
    reading_end(t);
}

static void a_vector_is_not_farther_than_a_million(void **state)
{
    reading *t = reading_of("v: [1, 2, 1000001]\n");
    vec3 v = {0, 0, 0};
    (void)state;
    assert_false(reader_vector(&t->r, yaml_root(t->r.y), "v", "a place", &v));
    reading_told(t, ":1:11: ");
    reading_end(t);
}

static void a_color_is_not_negative(void **state)
{
    reading *t = reading_of("c: [0, 0.5, -0.1]\n");
    vec3 c = {0, 0, 0};
    (void)state;
    assert_false(reader_color(&t->r, yaml_root(t->r.y), "c", &c));
    reading_told(t, ":1:13: ");
    reading_end(t);
}

static void an_open_range_excludes_its_end(void **state)
{
    reading *t = reading_of("x: 0\n");
    double x = 5;
    (void)state;
    assert_true(reader_number(&t->r, yaml_root(t->r.y), "x", 0, false, 1, "a share", &x));
    NEAR(x, 0, 0);
    assert_false(reader_number(&t->r, yaml_root(t->r.y), "x", 0, true, 1, "a share", &x));
    reading_told(t, ":1:4: ");
    reading_end(t);
}

static void all_needed_keys_are_asked_for(void **state)
{
    reading *t = reading_of("from: 1\n");
    (void)state;
    assert_true(reader_need_all(&t->r, yaml_root(t->r.y), "from", "the thing"));
    reading_told(t, NULL);
    assert_false(reader_need_all(&t->r, yaml_root(t->r.y), "from at up", "the thing"));
    assert_int_equal(t->e.count, 2);
    assert_non_null(strstr(t->e.text, "the thing lacks its 'at'"));
    assert_non_null(strstr(t->e.text, "the thing lacks its 'up'"));
    reading_end(t);
}

static void a_direction_has_a_length(void **state)
{
    reading *t = reading_of("n: [0, 0, 0]\n");
    const vec3 none = {0, 0, 0}, some = {0, 0, 1e-3};
    (void)state;
    assert_true(reader_has_length(&t->r, yaml_root(t->r.y), "n", "a vector", some));
    assert_false(reader_has_length(&t->r, yaml_root(t->r.y), "n", "a vector", none));
    reading_told(t, ":1:4: no direction, expected a vector with a length");
    reading_end(t);
}

static char *name_at(reading *t, int i)
{
    node *key;
    yaml_pair(yaml_root(t->r.y), i, &key);
    return reader_name(&t->r, yaml_root(t->r.y), key);
}

static void a_name_is_letters_digits_and_two_signs(void **state)
{
    reading *t = reading_of("a-B_9: 1\na b: 2\n");
    (void)state;
    char *good = name_at(t, 0);
    assert_string_equal(good, "a-B_9");
    free(good);
    assert_null(name_at(t, 1));
    reading_told(t, ":2:1: 'a b' can't be a name");
    reading_end(t);
}

static void named_things_are_counted(void **state)
{
    reading *t = reading_of("lights: {a: {}, b: {}, c: {}}\n");
    double *things = NULL;
    int n = 0;
    (void)state;
    assert_non_null(reader_named(&t->r, "lights", (cap){4096, ""}, sizeof *things, &things, &n));
    assert_int_equal(n, 3);
    NEAR(things[2], 0, 0);
    free(things);
    assert_null(reader_named(&t->r, "objects", (cap){4096, ""}, sizeof *things, &things, &n));
    assert_int_equal(n, 3);
    reading_told(t, "the scene lacks its 'objects'");
    reading_end(t);
}

static void assert_beside(reading *t, const char *file, const char *path)
{
    char *got = reader_beside(&t->r, file);
    assert_string_equal(got, path);
    free(got);
}

static void files_are_beside_the_scene(void **state)
{
    reading *t = reading_of("x: 1\n");
    (void)state;
    assert_beside(t, "maps/hill.png", "/scenes/maps/hill.png");
    reading_end(t);
}

static void files_are_in_the_folder_that_is_given(void **state)
{
    reading *t = reading_of("x: 1\n");
    (void)state;
    t->from.folder = "/other";
    assert_beside(t, "hill.png", "/other/hill.png");
    t->from.folder = "/other/";
    assert_beside(t, "hill.png", "/other/hill.png");
    reading_end(t);
}

static void a_full_path_stays_as_it_is(void **state)
{
    reading *t = reading_of("x: 1\n");
    (void)state;
    assert_beside(t, "/maps/hill.png", "/maps/hill.png");
    reading_end(t);
}

static void a_wrong_function_is_told_where_it_is_wrong(void **state)
{
    reading *t = reading_of("f: sin(u) + w\ng: sin(u + 1\n");
    (void)state;
    expr *f = reader_expr(&t->r, reading_at(t, "f"), "a function");
    assert_non_null(f);
    expr_free(f);
    assert_null(reader_expr(&t->r, reading_at(t, "g"), "a function"));
    reading_told(t, ":2:13: ");
    reading_end(t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_vector_is_three_numbers),
        cmocka_unit_test(an_absent_vector_stays_as_it_is),
        cmocka_unit_test(a_wrong_vector_stays_as_it_is),
        cmocka_unit_test(a_vector_is_not_farther_than_a_million),
        cmocka_unit_test(a_color_is_not_negative),
        cmocka_unit_test(an_open_range_excludes_its_end),
        cmocka_unit_test(all_needed_keys_are_asked_for),
        cmocka_unit_test(a_direction_has_a_length),
        cmocka_unit_test(a_name_is_letters_digits_and_two_signs),
        cmocka_unit_test(named_things_are_counted),
        cmocka_unit_test(files_are_beside_the_scene),
        cmocka_unit_test(files_are_in_the_folder_that_is_given),
        cmocka_unit_test(a_full_path_stays_as_it_is),
        cmocka_unit_test(a_wrong_function_is_told_where_it_is_wrong),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
