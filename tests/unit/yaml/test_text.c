/* Places in a text, and what an error shows of them. */
#include "support/check.h"

#include <stdio.h>
#include <string.h>

#include "yaml/text.h"

static void expect_place(const char *text, size_t at, int line, int column)
{
    int l, c;
    text_place(text, at, &l, &c);
    if (l != line || c != column)
        fail_msg("byte %zu of '%s' is at %d:%d, expected %d:%d", at, text, l, c, line, column);
}

static void test_places_count_from_1(void **state)
{
    (void)state;
    expect_place("ab\ncd", 0, 1, 1);
    expect_place("ab\ncd", 1, 1, 2);
    expect_place("ab\ncd", 3, 2, 1);
    expect_place("ab\ncd", 5, 2, 3);
}

static void test_every_kind_of_line_end(void **state)
{
    (void)state;
    expect_place("a\nb", 2, 2, 1);
    expect_place("a\rb", 2, 2, 1);
    expect_place("a\r\nb", 3, 2, 1);
    expect_place("a\n\nb", 3, 3, 1);
}

static void test_columns_are_characters(void **state)
{
    (void)state;
    expect_place("\xc3\xa4"
                 "b",
                 2, 1, 2); /* two bytes */
    expect_place("\xe2\x82\xac"
                 "b",
                 3, 1, 2); /* three */
    expect_place("\xf0\x9f\x98\x80"
                 "b",
                 4, 1, 2); /* four */
}

/* ---- UTF-8 ---- */

static void expect_bad(const char *text, size_t size, size_t at)
{
    const size_t found = text_not_utf8(text, size);
    if (found != at)
        fail_msg("the first bad byte of '%s' is %zu, expected %zu", text, found, at);
}

static void test_utf8_is_accepted(void **state)
{
    (void)state;
    static const char good[] = "a\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80z\xed\x9f\xbf\xf4\x8f\xbf\xbf";
    expect_bad(good, sizeof good - 1, sizeof good - 1);
}

static void test_what_is_no_utf8(void **state)
{
    (void)state;
    expect_bad("ab\x80", 3, 2);    /* a tail alone */
    expect_bad("ab\xc3", 3, 2);    /* cut short */
    expect_bad("a\xc0\xaf", 3, 1); /* longer than needed, of 2, 3 and 4 bytes */
    expect_bad("a\xe0\x80\xaf", 4, 1);
    expect_bad("a\xf0\x80\x80\xaf", 5, 1);
    expect_bad("a\xed\xa0\x80", 4, 1);     /* half of a pair of UTF-16 */
    expect_bad("a\xf4\x90\x80\x80", 5, 1); /* above U+10FFFF */
    expect_bad("a\xff", 2, 1);
}

/* ---- errors ---- */

static void expect_error(const char *text, int line, int column, const char *message, const char *want)
{
    errors e = {0};
    assert_false(text_error(&e, "s.yaml", text, line, column, message));
    assert_string_equal(e.text, want);
    errors_free(&e);
}

static void test_error_shows_the_line_and_a_caret(void **state)
{
    (void)state;
    expect_error("a: 1\nscale: -1\n", 2, 8, "too small",
                 "s.yaml:2:8: too small\n    2 | scale: -1\n      |        ^\n");
}

static void test_caret_below_wide_characters_and_tabs(void **state)
{
    (void)state;
    expect_error("\t\xc3\xa4: x", 1, 5, "no", "s.yaml:1:5: no\n    1 | \t\xc3\xa4: x\n      | \t   ^\n");
}

static void test_error_behind_the_last_line_is_at_its_end(void **state)
{
    (void)state;
    expect_error("ab\n", 2, 1, "more expected", "s.yaml:1:3: more expected\n    1 | ab\n      |   ^\n");
}

static void test_control_characters_are_shown_as_question_marks(void **state)
{
    (void)state;
    expect_error("a\x1b[31m\x7f\xc2\x9b", 1, 1, "x\x1by", "s.yaml:1:1: x?y\n    1 | a?[31m??\n      | ^\n");
}

static void test_of_a_long_line_the_part_around_the_caret(void **state)
{
    (void)state;
    char text[5001], want[400], shown[151];
    for (int i = 0; i < 5000; i++)
        text[i] = (char)('a' + i % 26);
    text[5000] = 0;
    snprintf(shown, sizeof shown, "%.150s", text + 2999 - 120);
    snprintf(want, sizeof want, "s.yaml:1:3000: no\n    1 | %s\n      | %120s^\n", shown, "");
    expect_error(text, 1, 3000, "no", want);
}

/* ---- scalars ---- */

/* The byte of a scalar's value is found in the text by what is written there. */
static void expect_offset(const char *text, size_t start, scalar_style style, size_t offset, const char *there)
{
    const size_t at = text_offset(text, start, style, offset);
    if (strncmp(text + at, there, strlen(there)) != 0)
        fail_msg("byte %zu of the value in '%s' is found at '%s', expected '%s'", offset, text, text + at, there);
}

static void test_offset_in_plain_and_folded_lines(void **state)
{
    (void)state;
    expect_offset("k: one two", 3, SCALAR_PLAIN, 4, "two");
    expect_offset("k: one\n   two", 3, SCALAR_PLAIN, 4, "two");
    expect_offset("k: one\n\n   two", 3, SCALAR_PLAIN, 4, "two"); /* an empty line is one line end */
}

static void test_offset_in_quotes(void **state)
{
    (void)state;
    expect_offset("'it''s x'", 1, SCALAR_SINGLE, 5, "x");
    expect_offset("\"a\\tb x\"", 1, SCALAR_DOUBLE, 4, "x");
    expect_offset("\"\\x41\\u00e4 x\"", 1, SCALAR_DOUBLE, 4, "x"); /* A, and two bytes */
    expect_offset("\"one \\\n   two\"", 1, SCALAR_DOUBLE, 4, "two");
}

static void test_offset_in_blocks(void **state)
{
    (void)state;
    expect_offset("k: |\n  one\n  two\n", 5, SCALAR_LITERAL, 4, "two");
    expect_offset("k: |\n  one\n    two\n", 5, SCALAR_LITERAL, 6, "two"); /* two blanks more belong to the value */
    expect_offset("k: >\n  one\n  two\n", 5, SCALAR_FOLDED, 4, "two");
    expect_offset("k: >\n  one\n\n  two\n", 5, SCALAR_FOLDED, 4, "two");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_places_count_from_1),
        cmocka_unit_test(test_every_kind_of_line_end),
        cmocka_unit_test(test_columns_are_characters),
        cmocka_unit_test(test_utf8_is_accepted),
        cmocka_unit_test(test_what_is_no_utf8),
        cmocka_unit_test(test_error_shows_the_line_and_a_caret),
        cmocka_unit_test(test_caret_below_wide_characters_and_tabs),
        cmocka_unit_test(test_error_behind_the_last_line_is_at_its_end),
        cmocka_unit_test(test_control_characters_are_shown_as_question_marks),
        cmocka_unit_test(test_of_a_long_line_the_part_around_the_caret),
        cmocka_unit_test(test_offset_in_plain_and_folded_lines),
        cmocka_unit_test(test_offset_in_quotes),
        cmocka_unit_test(test_offset_in_blocks),
    };
    return cmocka_run_group_tests_name("text", tests, NULL, NULL);
}
