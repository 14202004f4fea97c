/* The text of a POV-Ray file: numbers, names, and what is in the file in the end. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pov_text/text.h"
#include "support/check.h"

static pov_text text;

/* What `put` has written. */
static const char *written(void (*put)(pov_text *t))
{
    static char got[1024];
    char path[] = "/tmp/kage-text-XXXXXX";
    errors e = {0};
    const int file = mkstemp(path);
    assert_true(file >= 0);
    close(file);
    assert_true(pov_begin(&text, path, &e));
    put(&text);
    assert_true(pov_end(&text, NULL, &e));
    FILE *f = fopen(path, "rb");
    assert_non_null(f);
    got[fread(got, 1, sizeof got - 1, f)] = 0;
    fclose(f);
    unlink(path);
    return got;
}

static void numbers_have_no_minus_0(void **state)
{
    (void)state;
    assert_string_equal(pov_number(-0.0, 9).text, "0");
}

static void numbers_are_rounded_to_their_digits(void **state)
{
    (void)state;
    assert_string_equal(pov_number(3.14159265, 3).text, "3.14");
    assert_string_equal(pov_number(1e20, 3).text, "1e+20");
}

static void exact_numbers_give_x_again(void **state)
{
    const double x[] = {0.1, 1.0 / 3, 1e-300, 123456789.123456, -2.5};
    (void)state;
    for (size_t k = 0; k < sizeof x / sizeof *x; k++)
        CHECK(strtod(pov_exact(x[k]).text, NULL), ==, x[k]);
}

static void exact_numbers_are_short(void **state)
{
    (void)state;
    assert_string_equal(pov_exact(0.1).text, "0.1");
}

static void put_all_kinds(pov_text *t) { pov_print(t, "%s %d %g %v", "a", -3, 0.5, (vec3){1, -2, 0.25}); }

static void a_format_takes_strings_integers_numbers_and_vectors(void **state)
{
    (void)state;
    assert_string_equal(written(put_all_kinds), "a -3 0.5 <1, -2, 0.25>");
}

static void put_bytes(pov_text *t) { pov_put(t, "50% of <x>", 5); }

static void bytes_are_put_as_they_are(void **state)
{
    (void)state;
    assert_string_equal(written(put_bytes), "50% o");
}

static void put_matrix(pov_text *t)
{
    pov_matrix(t, (vec3){1, 2, 3}, (vec3){4, 5, 6}, (vec3){7, 8, 9}, (vec3){10, 11, 12}, " // m");
}

static void a_matrix_has_its_origin_last(void **state)
{
    (void)state;
    assert_string_equal(written(put_matrix), "  matrix <1, 2, 3,  4, 5, 6,  7, 8, 9,  10, 11, 12> // m");
}

static void a_name_is_an_identifier(void **state)
{
    (void)state;
    assert_string_equal(pov_identify("Material", "clay", 4).text, "Material_clay");
}

static void names_that_differ_in_a_dash_stay_apart(void **state)
{
    (void)state;
    assert_string_equal(pov_identify("P", "a-b", 1).text, "P1_a_b");
    assert_string_equal(pov_identify("P", "a_b", 2).text, "P_a_b");
}

/* More than the buffer holds comes out whole. */
static void put_much(pov_text *t)
{
    for (int k = 0; k < 20000; k++)
        pov_print(t, "%d\n", k);
}

static void what_is_longer_than_the_buffer_is_whole(void **state)
{
    errors e = {0};
    char path[] = "/tmp/kage-text-XXXXXX";
    const int file = mkstemp(path);
    int k = 0, n;
    (void)state;
    close(file);
    assert_true(pov_begin(&text, path, &e));
    put_much(&text);
    assert_true(pov_end(&text, NULL, &e));
    FILE *f = fopen(path, "rb");
    assert_non_null(f);
    while (k < 20000 && fscanf(f, "%d", &n) == 1 && n == k)
        k++;
    assert_int_equal(k, 20000);
    fclose(f);
    unlink(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_have_no_minus_0),
        cmocka_unit_test(numbers_are_rounded_to_their_digits),
        cmocka_unit_test(exact_numbers_give_x_again),
        cmocka_unit_test(exact_numbers_are_short),
        cmocka_unit_test(a_format_takes_strings_integers_numbers_and_vectors),
        cmocka_unit_test(bytes_are_put_as_they_are),
        cmocka_unit_test(a_matrix_has_its_origin_last),
        cmocka_unit_test(a_name_is_an_identifier),
        cmocka_unit_test(names_that_differ_in_a_dash_stay_apart),
        cmocka_unit_test(what_is_longer_than_the_buffer_is_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
