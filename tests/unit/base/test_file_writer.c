/* Files written aside, in a folder of their own. */
#define _GNU_SOURCE /* symlink, mkdtemp, flock */

#include "support/check.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "base/aside.h"
#include "base/file_writer.h"
#include "support/in_folder.h"

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

/* A process that is killed now leaves nothing. */
static void test_an_unfinished_file_has_no_name(void **state)
{
    (void)state;
    errors e = {0};
    file_writer w;
    assert_true(file_writer_open(&w, "out", &e));
    if (!w.aside) /* else the file system can't do it */
        CHECK(entries(), ==, 0);
    assert_true(file_writer_write(&w, "new", 3, 0));
    assert_true(file_writer_close(&w, NULL, &e));
    CHECK(entries(), ==, 1);
}

/* An older file is replaced by one with no name, which gets one for a moment. */
static void test_a_new_file_has_the_usual_permissions(void **state)
{
    (void)state;
    errors e = {0};
    struct stat one, two;
    put("a", "x");
    put("out", "old");
    file_writer w;
    assert_true(file_writer_open(&w, "out", &e));
    assert_true(file_writer_close(&w, NULL, &e));
    assert_true(stat("a", &one) == 0 && stat("out", &two) == 0);
    CHECK(one.st_mode, ==, two.st_mode);
    CHECK(two.st_size, ==, 0);
    CHECK(entries(), ==, 2);
}

static void test_a_link_to_nothing_leads_to_the_file(void **state)
{
    (void)state;
    errors e = {0};
    file_writer w;
    assert_int_equal(symlink("a", "link"), 0);
    assert_true(file_writer_open(&w, "link", &e));
    assert_true(file_writer_write(&w, "new", 3, 0));
    assert_true(file_writer_close(&w, NULL, &e));
    assert_string_equal(text_of("a"), "new");
    char to[8] = "";
    CHECK(readlink("link", to, sizeof to), ==, 1);
}

static void test_a_link_to_itself_is_refused(void **state)
{
    (void)state;
    errors e = {0};
    file_writer w;
    assert_int_equal(symlink("link", "link"), 0);
    assert_false(file_writer_open(&w, "link", &e));
    assert_string_equal(e.text, "link: cannot be written: Too many levels of symbolic links\n");
    errors_free(&e);
}

static const char magic[4] = {'p', 'a', 'r', 't'};

static void test_a_part_lies_where_the_link_leads(void **state)
{
    (void)state;
    errors e = {0};
    file_writer w;
    assert_int_equal(symlink("out", "link"), 0);
    assert_true(file_writer_open_part(&w, "link", false, magic, &e));
    CHECK(access("out.part", F_OK), ==, 0);
    assert_true(file_writer_write(&w, magic, sizeof magic, 0));
    assert_false(file_writer_close(&w, "", &e));
    assert_string_equal(text_of("out.part"), "part");
}

/* The lock lasts until the file has its name. One who opened it before must not empty the finished file. */
static void test_a_part_is_written_by_one_at_a_time(void **state)
{
    (void)state;
    errors e = {0};
    file_writer first, second;
    assert_true(file_writer_open_part(&first, "out", false, magic, &e));
    assert_false(file_writer_open_part(&second, "out", false, magic, &e));
    assert_string_equal(e.text, "out.part: cannot be written: another process writes it\n");
    errors_free(&e);
    assert_true(file_writer_write(&first, magic, sizeof magic, 0));
    assert_true(file_writer_close(&first, NULL, &e));
    assert_true(file_writer_open_part(&second, "out", false, magic, &e));
    assert_string_equal(text_of("out"), "part");
    assert_false(file_writer_close(&second, "", &e));
}

/* What a process without O_TMPFILE leaves when it is killed is removed; what another one writes now is not. */
static void test_stale_files_are_removed(void **state)
{
    (void)state;
    errors e = {0};
    put(".kage-1-0", "left");
    put(".kage-2-0", "busy");
    put("a", "mine");
    assert_int_equal(symlink("a", ".kage-3-0"), 0);
    const int busy = open(".kage-2-0", O_RDWR);
    CHECK(flock(busy, LOCK_EX), ==, 0);
    aside_remove_stale("out", &e);
    assert_string_equal(e.text, ".kage-1-0: left by a process that was killed; removed\n");
    errors_free(&e);
    CHECK(entries(), ==, 3);
    close(busy);
    assert_true(unlink(".kage-2-0") == 0 && unlink(".kage-3-0") == 0);
}

/* What another process does just before a file is locked. The library's calls of flock come here; the parameters have
 * the names of sys/file.h. */
static void (*before_lock)(void);

int flock(int __fd, int __operation)
{
    void (*const other)(void) = before_lock;
    before_lock = NULL;
    if (other)
        other();
    return (int)syscall(SYS_flock, __fd, __operation);
}

static void use_the_name_again(void)
{
    assert_int_equal(rename(".kage-1-0", "out"), 0);
    put(".kage-1-0", "busy");
}

/* Another process gives its file the right name while this one looks at it, and begins with the next. */
static void test_a_name_that_is_used_again_is_not_removed(void **state)
{
    (void)state;
    errors e = {0};
    put(".kage-1-0", "whole");
    before_lock = use_the_name_again;
    aside_remove_stale("out", &e);
    CHECK(e.count, ==, 0);
    assert_string_equal(text_of("out"), "whole");
    assert_string_equal(text_of(".kage-1-0"), "busy");
    assert_int_equal(unlink(".kage-1-0"), 0);
}

/* A descriptor is written to where it stands, also where it is a file's. */
static void test_a_descriptor_is_written_to(void **state)
{
    (void)state;
    errors e = {0};
    file_writer w;
    char name[32];
    const int to = open("a", O_RDWR | O_CREAT | O_APPEND, 0666);
    CHECK(write(to, "one ", 4), ==, 4);
    snprintf(name, sizeof name, "/dev/fd/%d", to);
    assert_true(file_writer_open(&w, name, &e));
    assert_true(file_writer_write(&w, "two", 3, 0));
    assert_true(file_writer_close(&w, NULL, &e));
    assert_string_equal(text_of("a"), "one two");
    close(to);
    assert_false(file_writer_open(&w, name, &e));
    errors_free(&e);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        IN_FOLDER(test_nothing_is_seen_before_the_end),
        IN_FOLDER(test_writes_have_places),
        IN_FOLDER(test_a_dropped_file_leaves_nothing),
        IN_FOLDER(test_a_link_stays_one),
        IN_FOLDER(test_a_device_is_written_to),
        IN_FOLDER(test_a_full_device_is_an_error),
        IN_FOLDER(test_a_folder_is_refused),
        IN_FOLDER(test_an_unfinished_file_has_no_name),
        IN_FOLDER(test_a_new_file_has_the_usual_permissions),
        IN_FOLDER(test_a_link_to_nothing_leads_to_the_file),
        IN_FOLDER(test_a_link_to_itself_is_refused),
        IN_FOLDER(test_a_part_lies_where_the_link_leads),
        IN_FOLDER(test_a_part_is_written_by_one_at_a_time),
        IN_FOLDER(test_stale_files_are_removed),
        IN_FOLDER(test_a_name_that_is_used_again_is_not_removed),
        IN_FOLDER(test_a_descriptor_is_written_to),
    };
    return cmocka_run_group_tests_name("file_writer", tests, NULL, NULL);
}
