/* The list of messages. */
#include "support/check.h"

#include <string.h>

#include "base/errors.h"

static void test_messages_are_lines(void **state)
{
    (void)state;
    errors e = {0};
    assert_false(errors_add(&e, "%s:%d: wrong", "a.yaml", 7));
    assert_false(errors_add(&e, "and again"));
    assert_string_equal(e.text, "a.yaml:7: wrong\nand again\n");
    CHECK(e.size, ==, strlen(e.text));
    CHECK(e.count, ==, 2);
    errors_free(&e);
}

static void test_long_messages_are_whole(void **state)
{
    (void)state;
    static char text[10000];
    memset(text, 'x', sizeof text - 1);
    errors e = {0};
    errors_add(&e, "%s", text);
    CHECK(e.size, ==, sizeof text);
    errors_free(&e);
}

static void test_control_characters_are_not_passed_on(void **state)
{
    (void)state;
    errors e = {0};
    errors_add(&e, "%s", "a\033[2J\x7f\xc2\x9b\xc2\xa0\t\xc3\xa4");
    assert_string_equal(e.text, "a?[2J???\xc2\xa0\t\xc3\xa4\n");
    errors_free(&e);
}

static void test_more_than_fifty_are_only_counted(void **state)
{
    (void)state;
    errors e = {0};
    for (int i = 0; i < ERRORS_SHOWN + 20; i++)
        errors_add(&e, "x");
    CHECK(e.count, ==, ERRORS_SHOWN + 20);
    CHECK(e.size, ==, 2 * ERRORS_SHOWN);
    errors_free(&e);
}

static void test_free_leaves_an_empty_list(void **state)
{
    (void)state;
    errors e = {0};
    errors_add(&e, "x");
    errors_free(&e);
    assert_null(e.text);
    CHECK(e.count, ==, 0);
    errors_free(&e);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_messages_are_lines),
        cmocka_unit_test(test_long_messages_are_whole),
        cmocka_unit_test(test_control_characters_are_not_passed_on),
        cmocka_unit_test(test_more_than_fifty_are_only_counted),
        cmocka_unit_test(test_free_leaves_an_empty_list),
    };
    return cmocka_run_group_tests_name("errors", tests, NULL, NULL);
}
