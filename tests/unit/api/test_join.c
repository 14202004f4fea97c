/* kage.h: bands of a picture, each in a file of its own, are joined to one file. */
#define _XOPEN_SOURCE 700

#include "unit/api/scenes.h"

#include <unistd.h>

#include "support/same_files.h"

enum { BANDS = 3, SIZE = 96 };

typedef struct fixture {
    char folder[32], whole[SIZE], joined[SIZE], band[BANDS][SIZE];
    const char *paths[BANDS];
} fixture;

static int begin(void **state)
{
    fixture *x = calloc(1, sizeof *x);
    *state = x;
    char folder[sizeof x->folder] = "/tmp/kage-join-XXXXXX";
    if (!x || !mkdtemp(folder))
        return -1;
    strcpy(x->folder, folder);
    snprintf(x->whole, SIZE, "%s/whole.exr", folder);
    snprintf(x->joined, SIZE, "%s/joined.exr", folder);
    for (int k = 0; k < BANDS; k++) {
        snprintf(x->band[k], SIZE, "%s/%d.exr", folder, k);
        x->paths[k] = x->band[k];
    }
    return 0;
}

static int end(void **state)
{
    fixture *x = *state;
    unlink(x->whole);
    unlink(x->joined);
    for (int k = 0; k < BANDS; k++)
        unlink(x->band[k]);
    const int gone = rmdir(x->folder);
    free(x);
    return gone;
}

/* Render a part of the picture to a file. */
static void render_part(kage_scene *s, kage_render_options o, const char *layers, int x0, int y0, int x1, int y1,
                        const char *path)
{
    const int crop[4] = {x0, y0, x1, y1};
    memcpy(o.crop, crop, sizeof crop);
    kage_film *f = render_with(s, &o);
    assert_int_equal(kage_film_write(f, path, &(kage_write_options){.layers = layers}, NULL), KAGE_OK);
    kage_film_free(f);
}

static void joined_bands_are_the_whole(void **state)
{
    fixture *x = *state;
    static const struct {
        kage_render_options o;
        const char *layers;
    } all[] = {{{0}, NULL},
               {{.width = 70, .height = 61, .layers = 1}, NULL},
               {{.width = 40, .height = 53, .layers = 1, .method = "2", .guard = KAGE_NO}, "N,color"},
               {{.aa = 3, .aa_threshold = 0.1, .height = 48, .width = 64}, "color"},
               {{.displaced = KAGE_YES, .layers = 1}, "tau"}};
    kage_scene *s = parse(GROUND);
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        const kage_render_options o = all[k].o;
        const int w = o.width ? o.width : 48, h = o.height ? o.height : 32;
        const int from[BANDS + 1] = {0, 16, h > 32 ? 32 : 16, h};
        const char *paths[BANDS];
        int count = 0;
        for (int i = BANDS - 1; i >= 0; i--) /* in another order than theirs */
            if (from[i] < from[i + 1]) {
                render_part(s, o, all[k].layers, 0, from[i], w, from[i + 1], x->band[i]);
                paths[count++] = x->band[i];
            }
        const kage_write_options write = {.layers = all[k].layers};
        assert_int_equal(kage_render_file(s, &o, x->whole, &write, NULL, NULL), KAGE_OK);
        kage_errors *e = NULL;
        if (kage_file_join(paths, count, x->joined, NULL, &e) != KAGE_OK)
            fail_by("kage_file_join", e);
        assert_same_files(x->whole, x->joined);
    }
    kage_scene_free(s);
}

/* Also a part of the picture, from a row between chunks of the whole on; and one band alone. */
static void joined_parts_are_the_part(void **state)
{
    fixture *x = *state;
    kage_scene *s = parse(GROUND);
    const kage_render_options o = {.crop = {3, 5, 40, 30}};
    render_part(s, o, NULL, 3, 5, 40, 21, x->band[0]);
    render_part(s, o, NULL, 3, 21, 40, 30, x->band[1]);
    assert_int_equal(kage_render_file(s, &o, x->whole, NULL, NULL, NULL), KAGE_OK);
    assert_int_equal(kage_file_join(x->paths, 2, x->joined, NULL, NULL), KAGE_OK);
    assert_same_files(x->whole, x->joined);
    assert_int_equal(kage_file_join(x->paths, 1, x->joined, NULL, NULL), KAGE_OK);
    assert_same_files(x->band[0], x->joined);
    kage_scene_free(s);
}

/* Joining fails with this in its message, and leaves the older file as it was. */
static void assert_refused(const fixture *x, int count, kage_status status, const char *words)
{
    size_t m, n;
    char *before = slurp(x->joined, &m);
    kage_errors *e = NULL;
    assert_int_equal(kage_file_join(x->paths, count, x->joined, NULL, &e), status);
    const kage_error *first = kage_errors_get(e, 0);
    assert_non_null(first);
    if (!strstr(first->text, words))
        fail_msg("'%s' is not in: %s", words, first->text);
    kage_errors_free(e);
    char *after = slurp(x->joined, &n);
    assert_int_equal(m, n);
    assert_memory_equal(before, after, n);
    free(before);
    free(after);
}

static void write_text(const char *path, const char *bytes, size_t size)
{
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(bytes, 1, size, f), size);
    assert_int_equal(fclose(f), 0);
}

static void what_does_not_belong_together_is_refused(void **state)
{
    fixture *x = *state;
    kage_scene *s = parse(GROUND), *other = parse(HEAD);
    const kage_render_options o = {.width = 48, .height = 64};
    render_part(s, o, NULL, 0, 0, 48, 16, x->band[0]);
    render_part(s, o, NULL, 0, 0, 48, 16, x->joined);
    render_part(s, o, NULL, 0, 32, 48, 64, x->band[1]);
    assert_refused(x, 2, KAGE_BAD_INPUT, "begins at row 32, and no band has the rows from 16 on");
    render_part(s, o, NULL, 0, 8, 48, 64, x->band[1]);
    assert_refused(x, 2, KAGE_BAD_INPUT, "begins at row 8, expected 16");
    render_part(s, o, NULL, 1, 16, 48, 64, x->band[1]);
    assert_refused(x, 2, KAGE_BAD_INPUT, "columns 1 to 48, expected 0 to 48");
    render_part(other, o, NULL, 0, 16, 48, 64, x->band[1]);
    assert_refused(x, 2, KAGE_BAD_INPUT, "'kage:scene'");
    render_part(s, (kage_render_options){.width = 48, .height = 80}, NULL, 0, 16, 48, 64, x->band[1]);
    assert_refused(x, 2, KAGE_BAD_INPUT, "'kage:set'");
    render_part(s, (kage_render_options){.width = 48, .height = 64, .layers = 1}, NULL, 0, 16, 48, 64, x->band[1]);
    assert_refused(x, 2, KAGE_BAD_INPUT, "other layers");
    render_part(s, o, NULL, 0, 16, 48, 40, x->band[1]);
    render_part(s, o, NULL, 0, 40, 48, 64, x->band[2]);
    assert_refused(x, 3, KAGE_BAD_INPUT, "it has 24 rows, expected a multiple of 16");
    assert_refused(x, 0, KAGE_BAD_OPTION, "0 bands, expected one or more");
    assert_int_equal(kage_file_join(x->paths, 1, "a.png", NULL, NULL), KAGE_BAD_OPTION);
    assert_int_equal(kage_file_join(x->paths, 1, "/nowhere/at/all.exr", NULL, NULL), KAGE_NOT_WRITTEN);
    kage_scene_free(s);
    kage_scene_free(other);
}

/* A band that is cut short, or whose bytes are others, is refused, or its bytes are copied: never a crash. */
static void damaged_bands_are_refused(void **state)
{
    fixture *x = *state;
    kage_scene *s = parse(GROUND);
    const kage_render_options o = {0};
    render_part(s, o, NULL, 0, 0, 48, 16, x->joined);
    render_part(s, o, NULL, 0, 0, 48, 16, x->band[0]);
    assert_int_equal(unlink(x->band[0]), 0);
    assert_refused(x, 1, KAGE_BAD_INPUT, "No such file");
    write_text(x->band[0], "no picture", 10);
    assert_refused(x, 1, KAGE_BAD_INPUT, "cannot be read: OpenEXR");
    size_t n;
    char *good = slurp(x->joined, &n), *bad = malloc(n);
    write_text(x->band[0], good, n - 100);
    assert_refused(x, 1, KAGE_BAD_INPUT, "cannot be read");
    for (size_t k = 0; k < n; k += 7) {
        memcpy(bad, good, n);
        bad[k] = (char)(bad[k] ^ 0x55);
        write_text(x->band[0], bad, n);
        const kage_status status = kage_file_join(x->paths, 1, x->whole, NULL, NULL);
        assert_true(status == KAGE_OK || status == KAGE_BAD_INPUT || status == KAGE_NOT_WRITTEN ||
                    status == KAGE_NO_MEMORY);
    }
    free(good);
    free(bad);
    kage_scene_free(s);
}

static int stop(void *user, const char *what, double share)
{
    assert_string_equal(what, "writing");
    *(double *)user = share;
    return share >= 0.5;
}

static void joining_can_be_cancelled(void **state)
{
    fixture *x = *state;
    kage_scene *s = parse(GROUND);
    double share = 0;
    render_part(s, (kage_render_options){0}, NULL, 0, 0, 48, 16, x->band[0]);
    render_part(s, (kage_render_options){0}, NULL, 0, 16, 48, 32, x->band[1]);
    const kage_write_options o = {.progress = stop, .user = &share};
    assert_int_equal(kage_file_join(x->paths, 2, x->joined, &o, NULL), KAGE_CANCELLED);
    CHECK(share, ==, 0.5);
    assert_int_not_equal(access(x->joined, F_OK), 0);
    kage_scene_free(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(joined_bands_are_the_whole, begin, end),
        cmocka_unit_test_setup_teardown(joined_parts_are_the_part, begin, end),
        cmocka_unit_test_setup_teardown(what_does_not_belong_together_is_refused, begin, end),
        cmocka_unit_test_setup_teardown(damaged_bands_are_refused, begin, end),
        cmocka_unit_test_setup_teardown(joining_can_be_cancelled, begin, end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
