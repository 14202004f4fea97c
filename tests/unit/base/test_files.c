/* Sets of files. */
#define _XOPEN_SOURCE 700 /* symlink, mkdtemp */

#include "support/check.h"

#include "base/files.h"
#include "support/in_folder.h"

static void test_a_file_is_known_by_all_its_names(void **state)
{
    (void)state;
    files f = {0};
    put("a", "x");
    put("b", "x");
    assert_int_equal(symlink("a", "link"), 0);
    assert_int_equal(link("a", "hard"), 0);
    assert_true(files_add_path(&f, "a"));
    assert_true(files_have_path(&f, "./a"));
    assert_true(files_have_path(&f, "link"));
    assert_true(files_have_path(&f, "hard"));
    assert_false(files_have_path(&f, "b"));
    files_free(&f);
}

static void test_a_file_is_added_once(void **state)
{
    (void)state;
    files f = {0};
    put("a", "x");
    assert_true(files_add_path(&f, "a") && files_add_path(&f, "a"));
    CHECK(f.count, ==, 1);
    files_free(&f);
}

static void test_what_is_no_file_is_not_added(void **state)
{
    (void)state;
    files f = {0};
    assert_true(files_add_path(&f, "gone") && files_add_path(&f, "/dev/null") && files_add_path(&f, "."));
    CHECK(f.count, ==, 0);
    assert_false(files_have_path(&f, "gone"));
    files_free(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        IN_FOLDER(test_a_file_is_known_by_all_its_names),
        IN_FOLDER(test_a_file_is_added_once),
        IN_FOLDER(test_what_is_no_file_is_not_added),
    };
    return cmocka_run_group_tests_name("files", tests, NULL, NULL);
}
