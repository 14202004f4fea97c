/* Distances between words, and the word that was meant. */
#include "support/check.h"

#include <string.h>

#include "base/spelling.h"

static int distance(const char *a, const char *b) { return spelling_distance(a, strlen(a), b, strlen(b)); }

static const char *nearest(const char *text, const char *words)
{
    static char out[64];
    spelling_nearest(text, words, out, sizeof out);
    return out;
}

static void test_distance_of_the_same_word(void **state)
{
    (void)state;
    CHECK(distance("sphere", "sphere"), ==, 0);
    CHECK(distance("", ""), ==, 0);
}

static void test_distance_counts_each_kind_of_slip(void **state)
{
    (void)state;
    CHECK(distance("spere", "sphere"), ==, 1);   /* left out */
    CHECK(distance("spheree", "sphere"), ==, 1); /* inserted */
    CHECK(distance("sphare", "sphere"), ==, 1);  /* replaced */
    CHECK(distance("shpere", "sphere"), ==, 1);  /* swapped */
}

static void test_distance_adds_up(void **state)
{
    (void)state;
    CHECK(distance("kitten", "sitting"), ==, 3);
    CHECK(distance("", "abc"), ==, 3);
    CHECK(distance("abc", ""), ==, 3);
}

static void test_distance_ignores_case(void **state)
{
    (void)state;
    CHECK(distance("SPHERE", "sphere"), ==, 0);
    CHECK(distance("sRGB", "rsgb"), ==, 1);
}

static void test_distance_of_the_longest_words(void **state)
{
    (void)state;
    char a[SPELLING_LONGEST + 1], b[SPELLING_LONGEST + 1];
    memset(a, 'a', SPELLING_LONGEST);
    memset(b, 'b', SPELLING_LONGEST);
    CHECK(spelling_distance(a, SPELLING_LONGEST, b, SPELLING_LONGEST), ==, SPELLING_LONGEST);
}

static void test_nearest_word(void **state)
{
    (void)state;
    assert_string_equal(nearest("colour", "color filter ior"), "color");
    assert_string_equal(nearest("oir", "color filter ior"), "ior");
}

static void test_nearest_of_two_is_the_first(void **state)
{
    (void)state;
    assert_string_equal(nearest("bat", "cat rat"), "cat");
}

static void test_nothing_is_near(void **state)
{
    (void)state;
    assert_string_equal(nearest("reflection", "color filter ior"), "");
    assert_string_equal(nearest("color", ""), "");
    assert_string_equal(nearest("a name of more than thirty-one letters", "color"), "");
}

static void test_among_words(void **state)
{
    (void)state;
    CHECK(spelling_among("repeat", "repeat clamp mirror"), ==, 0);
    CHECK(spelling_among("mirror", "repeat clamp mirror"), ==, 2);
    CHECK(spelling_among("clam", "repeat clamp mirror"), ==, -1);
    CHECK(spelling_among("clamps", "repeat clamp mirror"), ==, -1);
    CHECK(spelling_among("", "repeat"), ==, -1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_distance_of_the_same_word),
        cmocka_unit_test(test_distance_counts_each_kind_of_slip),
        cmocka_unit_test(test_distance_adds_up),
        cmocka_unit_test(test_distance_ignores_case),
        cmocka_unit_test(test_distance_of_the_longest_words),
        cmocka_unit_test(test_nearest_word),
        cmocka_unit_test(test_nearest_of_two_is_the_first),
        cmocka_unit_test(test_nothing_is_near),
        cmocka_unit_test(test_among_words),
    };
    return cmocka_run_group_tests_name("spelling", tests, NULL, NULL);
}
