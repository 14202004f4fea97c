/* Sets of files, and files written aside: in a folder of their own. */
#define _XOPEN_SOURCE 700 /* symlink, mkdtemp */

#include "support/check.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file_writer.h"
#include "base/files.h"

static char home[4096];

static int enter_folder(void **state)
{
    char *folder = strdup("/tmp/kage-XXXXXX");
    *state = folder;
    return folder && getcwd(home, sizeof home) && mkdtemp(folder) && chdir(folder) == 0 ? 0 : -1;
}

static int leave_folder(void **state)
{
    static const char *const made[] = {"a", "b", "link", "hard", "out", "gone"};
    for (size_t i = 0; i < sizeof made / sizeof *made; i++)
        unlink(made[i]);
    const int status = chdir(home) == 0 ? rmdir(*state) : -1; /* fails where something is left behind */
    free(*state);
    return status;
}

static void put(const char *path, const char *text)
{
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    fputs(text, f);
    fclose(f);
}

static const char *text_of(const char *path)
{
    static char text[256];
    FILE *f = fopen(path, "r");
    assert_non_null(f);
    text[fread(text, 1, sizeof text - 1, f)] = 0;
    fclose(f);
    return text;
}

static int entries(void)
{
    int n = 0;
    DIR *d = opendir(".");
    assert_non_null(d);
    while (readdir(d))
        n++;
    closedir(d);
    return n - 2;
}

/* ---- files ---- */

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

/* ---- file_writer ---- */

static void test_nothing_is_seen_before_the_end(void **state)
{
    (void)state;
    errors e = {0};
    file_writer w;
    put("out", "old");
    assert_true(file_writer_open(&w, "out", &e));
    assert_true(file_writer_write(&w, "new!", 4, 0));
    assert_string_equal(text_of("out"), "old");
    assert_true(file_writer_close(&w, NULL, &e));
    assert_string_equal(text_of("out"), "new!");
    CHECK(e.count, ==, 0);
}

static void test_writes_have_places(void **state)
{
    (void)state;
    errors e = {0};
    file_writer w;
    assert_true(file_writer_open(&w, "out", &e));
    assert_true(file_writer_write(&w, "world", 5, 6));
    assert_true(file_writer_write(&w, "hello ", 6, 0));
    assert_true(file_writer_close(&w, NULL, &e));
    assert_string_equal(text_of("out"), "hello world");
}

static void test_a_dropped_file_leaves_nothing(void **state)
{
    (void)state;
    errors e = {0};
    file_writer w;
    put("out", "old");
    assert_true(file_writer_open(&w, "out", &e));
    assert_true(file_writer_write(&w, "new", 3, 0));
    assert_false(file_writer_close(&w, "no more light", &e));
    assert_string_equal(text_of("out"), "old");
    assert_string_equal(e.text, "out: cannot be written: no more light\n");
    CHECK(entries(), ==, 1);
    errors_free(&e);
}

static void test_a_link_stays_one(void **state)
{
    (void)state;
    errors e = {0};
    file_writer w;
    put("a", "old");
    assert_int_equal(symlink("a", "link"), 0);
    assert_true(file_writer_open(&w, "link", &e));
    assert_true(file_writer_write(&w, "new", 3, 0));
    assert_true(file_writer_close(&w, NULL, &e));
    assert_string_equal(text_of("a"), "new");
    char to[8] = "";
    CHECK(readlink("link", to, sizeof to), ==, 1);
}

static void test_a_device_is_written_to(void **state)
{
    (void)state;
    errors e = {0};
    file_writer w;
    assert_true(file_writer_open(&w, "/dev/null", &e));
    assert_true(file_writer_write(&w, "x", 1, 0));
    assert_true(file_writer_close(&w, NULL, &e));
    CHECK(entries(), ==, 0);
}

static void test_a_full_device_is_an_error(void **state)
{
    (void)state;
    errors e = {0};
    file_writer w;
    if (access("/dev/full", W_OK) != 0)
        skip();
    assert_true(file_writer_open(&w, "/dev/full", &e));
    assert_true(file_writer_write(&w, "x", 1, 0));
    assert_false(file_writer_close(&w, NULL, &e));
    assert_string_equal(e.text, "/dev/full: cannot be written: No space left on device\n");
    errors_free(&e);
}

static void test_a_folder_is_refused(void **state)
{
    (void)state;
    errors e = {0};
    file_writer w;
    assert_false(file_writer_open(&w, ".", &e));
    assert_false(file_writer_open(&w, "none/out", &e));
    assert_string_equal(e.text, ".: cannot be written: Is a directory\n"
                                "none/out: cannot be written: No such file or directory\n");
    errors_free(&e);
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, enter_folder, leave_folder)

int main(void)
{
    const struct CMUnitTest tests[] = {
        IN_FOLDER(test_a_file_is_known_by_all_its_names),
        IN_FOLDER(test_a_file_is_added_once),
        IN_FOLDER(test_what_is_no_file_is_not_added),
        IN_FOLDER(test_nothing_is_seen_before_the_end),
        IN_FOLDER(test_writes_have_places),
        IN_FOLDER(test_a_dropped_file_leaves_nothing),
        IN_FOLDER(test_a_link_stays_one),
        IN_FOLDER(test_a_device_is_written_to),
        IN_FOLDER(test_a_full_device_is_an_error),
        IN_FOLDER(test_a_folder_is_refused),
    };
    return cmocka_run_group_tests_name("files", tests, NULL, NULL);
}
