/* kage.h: films written to files, and pictures written in bands, interrupted and resumed. */
#define _XOPEN_SOURCE 700

#include "unit/api/scenes.h"

#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "support/check.h"
#include "support/image_whole.h"
#include "support/same_files.h"

static void pictures_are_written(void **state)
{
    (void)state;
    char folder[] = "/tmp/kage-api-XXXXXX", png[64], exr[64];
    assert_non_null(mkdtemp(folder));
    snprintf(png, sizeof png, "%s/a.png", folder);
    snprintf(exr, sizeof exr, "%s/a.exr", folder);
    kage_scene *s = parse(GROUND);
    const kage_render_options o = {.layers = 1};
    kage_film *f = render_with(s, &o);
    kage_errors *e;
    assert_false(kage_file_is_picture(png));
    assert_int_equal(kage_film_write(f, png, NULL, &e), KAGE_OK);
    assert_true(kage_file_is_picture(png));
    assert_int_equal(kage_film_write(f, exr, &(kage_write_options){.layers = "Z,N"}, &e), KAGE_OK);
    image read;
    float range[2];
    errors wrong = {0};
    assert_true(image_whole(exr, "N.Y", 1, &read, range, &wrong));
    assert_memory_equal(read.v, kage_film_plane(f, "N.Y"), pixels_of(f) * sizeof *read.v);
    free(read.v);
    assert_false(image_whole(exr, "R", 1, &read, range, &wrong));
    errors_free(&wrong);
    assert_int_equal(kage_film_write(f, exr, &(kage_write_options){.layers = "Z,Q"}, &e), KAGE_BAD_OPTION);
    kage_errors_free(e);
    assert_int_equal(kage_film_write(f, "/nowhere/at/all.png", NULL, &e), KAGE_NOT_WRITTEN);
    assert_non_null(strstr(kage_errors_get(e, 0)->text, "/nowhere/at/all.png"));
    kage_errors_free(e);
    assert_int_equal(kage_film_write(f, png, &(kage_write_options){.bits = 12}, NULL), KAGE_BAD_OPTION);
    assert_int_equal(kage_film_write(f, "a.jpg", NULL, NULL), KAGE_BAD_OPTION);
    assert_int_equal(kage_file_probe(png, NULL), KAGE_OK);
    assert_int_equal(kage_file_probe("/nowhere/at/all.png", NULL), KAGE_NOT_WRITTEN);
    unlink(png);
    unlink(exr);
    assert_int_equal(rmdir(folder), 0);
    kage_film_free(f);
    kage_scene_free(s);
}

/* A picture written in bands has the bytes of the film that is written whole. */
static void bands_have_the_same_bytes(void **state)
{
    (void)state;
    static const kage_render_options all[] = {
        {.threads = 2},
        {.threads = 1, .layers = 1, .width = 75, .height = 53},
        {.layers = 1, .width = 75, .height = 53, .aa = 3, .aa_threshold = 0.05},
        {.layers = 1, .aa = 2, .aa_threshold = 0.05, .width = 96, .height = 64, .crop = {7, 5, 67, 59}},
    };
    char folder[] = "/tmp/kage-api-XXXXXX", whole[64], bands[64];
    assert_non_null(mkdtemp(folder));
    kage_scene *s = parse(GROUND);
    for (size_t k = 0; k < 2 * sizeof all / sizeof *all; k++) {
        const kage_render_options *o = &all[k / 2];
        const kage_write_options w = {.band = 16, .layers = k == 6 ? "N,color" : NULL};
        snprintf(whole, sizeof whole, "%s/whole.%s", folder, k % 2 ? "png" : "exr");
        snprintf(bands, sizeof bands, "%s/bands.%s", folder, k % 2 ? "png" : "exr");
        kage_film *f = render_with(s, o), *last;
        const kage_write_options one = {.layers = w.layers};
        assert_int_equal(kage_film_write(f, whole, &one, NULL), KAGE_OK);
        assert_int_equal(kage_render_file(s, o, bands, &w, &last, NULL), KAGE_OK);
        assert_same_files(whole, bands);
        const kage_stats *a = kage_film_get_stats(f), *b = kage_film_get_stats(last);
        int crop[4];
        kage_film_crop(last, crop);
        assert_true(crop[3] - crop[1] <= 16);
        CHECK(b->camera_rays, >=, a->camera_rays); /* bands have a margin where samples are adaptive */
        if (!o->aa)
            assert_int_equal(b->shadow_rays, a->shadow_rays);
        kage_film_free(f);
        kage_film_free(last);
        unlink(whole);
        unlink(bands);
    }
    assert_int_equal(rmdir(folder), 0);
    kage_scene_free(s);
}

/* Killed again and again, at any moment, a picture is at last the same. */
static void a_killed_picture_is_resumed(void **state)
{
    (void)state;
    char folder[] = "/tmp/kage-api-XXXXXX", whole[64], path[64], part[64];
    assert_non_null(mkdtemp(folder));
    snprintf(whole, sizeof whole, "%s/whole.exr", folder);
    snprintf(path, sizeof path, "%s/a.exr", folder);
    snprintf(part, sizeof part, "%s/a.exr.part", folder);
    kage_scene *s = parse(GROUND);
    const kage_render_options o = {.threads = 1, .layers = 1, .width = 160, .height = 800, .aa = 3};
    const kage_write_options w = {.threads = 1, .band = 16, .resume = 1};
    kage_film *f = render_with(s, &o);
    const long step = (long)(kage_film_get_stats(f)->seconds * 1e9 / 7);
    assert_int_equal(kage_film_write(f, whole, NULL, NULL), KAGE_OK);
    kage_film_free(f);
    int killed = 0, status = -1;
    for (int k = 0; status != 0 && k < 100; k++) {
        const pid_t child = fork();
        if (child == 0)
            _exit(kage_render_file(s, &o, path, &w, NULL, NULL) != KAGE_OK);
        nanosleep(&(struct timespec){0, step + 1117000L * k}, NULL);
        if (killed < 5)
            kill(child, SIGKILL);
        assert_int_equal(waitpid(child, &status, 0), child);
        killed += WIFSIGNALED(status);
    }
    CHECK(killed, >=, 2);
    assert_int_equal(status, 0);
    assert_same_files(whole, path);
    assert_int_not_equal(access(part, F_OK), 0);
    unlink(whole);
    unlink(path);
    assert_int_equal(rmdir(folder), 0);
    kage_scene_free(s);
}

typedef struct seen {
    int calls, cancel_at;
    double last;
} seen;

static int cancel_later(void *user, const char *what, double share)
{
    seen *k = user;
    assert_string_equal(what, "rendering");
    k->last = share;
    return ++k->calls == k->cancel_at;
}

/* A cancelled picture leaves a part only where it is asked for; the next call begins where it ended. */
static void a_cancelled_picture_is_resumed(void **state)
{
    (void)state;
    char folder[] = "/tmp/kage-api-XXXXXX", path[64], part[64];
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/a.exr", folder);
    snprintf(part, sizeof part, "%s/a.exr.part", folder);
    kage_scene *s = parse(GROUND);
    seen k = {0, 60, 0};
    const kage_render_options o = {.threads = 1, .width = 64, .height = 160, .progress = cancel_later, .user = &k};
    kage_write_options w = {.threads = 1, .band = 16};
    kage_errors *e;
    assert_int_equal(kage_render_file(s, &o, path, &w, NULL, NULL), KAGE_CANCELLED);
    assert_int_equal(rmdir(folder), 0); /* nothing is in it */
    assert_int_equal(mkdir(folder, 0700), 0);
    w.keep = 1;
    k = (seen){0, 60, 0};
    assert_int_equal(kage_render_file(s, &o, path, &w, NULL, NULL), KAGE_CANCELLED);
    const double reached = k.last;
    CHECK(reached, >, 0.1);
    assert_int_equal(access(part, F_OK), 0);
    kage_render_options other = o;
    other.method = "1";
    w.resume = 1;
    assert_int_equal(kage_render_file(s, &other, path, &w, NULL, &e), KAGE_NOT_WRITTEN);
    assert_non_null(strstr(kage_errors_get(e, 0)->text, "part of another picture"));
    kage_errors_free(e);
    k = (seen){0, 1, 0};
    assert_int_equal(kage_render_file(s, &o, path, &w, NULL, NULL), KAGE_CANCELLED);
    BETWEEN(reached - 0.11, k.last, reached);
    unlink(part);
    assert_int_equal(kage_render_file(s, &o, path, &(kage_write_options){.band = 8}, NULL, NULL), KAGE_BAD_OPTION);
    assert_int_equal(kage_render_file(s, &o, "a.png", &w, NULL, NULL), KAGE_BAD_OPTION);
    assert_int_equal(rmdir(folder), 0);
    kage_scene_free(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_are_written),
        cmocka_unit_test(bands_have_the_same_bytes),
        cmocka_unit_test(a_killed_picture_is_resumed),
        cmocka_unit_test(a_cancelled_picture_is_resumed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
