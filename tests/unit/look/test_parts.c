/* The parts of the view that need no window: changes of the scene, stages, false colours, the watch, saved names. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "look/changes.h"
#include "look/colours.h"
#include "look/readout.h"
#include "look/save.h"
#include "look/stage.h"
#include "look/watch.h"

static kage_scene *cube(void)
{
    kage_scene *s = NULL;
    assert_int_equal(kage_scene_load(KAGE_TESTS_DIR "/../scenes/cube.yaml", NULL, &s, NULL), KAGE_OK);
    return s;
}

static void a_look_becomes_changes(void **state)
{
    (void)state;
    static const char *const expected[] = {"image.size=[200, 100]",
                                           "camera.from=[1, 2, -3.25]",
                                           "camera.at=[0, 0, 0.333333]",
                                           "lights.lamp.at=[-4, 5, 6]",
                                           "objects.ground.bump.scale=0.2662",
                                           "render.shadow=march:8",
                                           "render.bump_shadow=march:8",
                                           "render.aa=3",
                                           "render.aa_threshold=0.1"};
    kage_scene *s = cube();
    look l = {.width = 200,
              .height = 100,
              .moved = 1,
              .from = {1, 2, -3.25},
              .at = {0, 0, 1.0 / 3},
              .lights = 2,
              .light = {{"lamp", {-4, 5, 6}}, {"gone", {0, 0, 0}}},
              .bumps = 2,
              .bump = {{"ground", 2}, {"gone", 1}},
              .shadow = "march:8",
              .own = "march:8"};
    changes c;
    changes_make(&c, &l, kage_scene_get_info(s), true);
    assert_int_equal(c.count, 9);
    for (int k = 0; k < c.count; k++)
        assert_string_equal(c.list[k], expected[k]);
    changes_make(&c, &l, kage_scene_get_info(s), false);
    assert_int_equal(c.count, 7);
    look none = {.width = 640, .height = 480};
    changes_make(&c, &none, kage_scene_get_info(s), false);
    assert_int_equal(c.count, 0);
    kage_scene_free(s);
}

static void stages_fit_a_frame(void **state)
{
    (void)state;
    stage_cost c = {0};
    const double pixels = 518400;
    assert_int_equal(stage_first(&c, pixels), 4); /* nothing is known */
    stage_learn(&c, 0.001, 0.007, pixels);
    assert_int_equal(stage_first(&c, pixels), STAGE_FULL);
    assert_int_equal(stage_next(&c, STAGE_FULL, pixels, 1), STAGE_FINE);
    assert_int_equal(stage_next(&c, STAGE_FULL, pixels, 0), -1);
    assert_int_equal(stage_next(&c, STAGE_FINE, pixels, 1), -1);
    stage_cost slow = {0};
    stage_learn(&slow, 0.001, 0.040, pixels);
    assert_int_equal(stage_first(&slow, pixels), 2);
    assert_int_equal(stage_next(&slow, 2, pixels, 1), STAGE_FULL);
    stage_cost slower = {0};
    stage_learn(&slower, 0.001, 9, pixels);
    assert_int_equal(stage_first(&slower, pixels), STAGE_COARSEST);
    assert_int_equal(stage_next(&slower, STAGE_COARSEST, pixels, 1), 4); /* something finer in between */
    assert_int_equal(stage_next(&slower, 2, pixels, 1), STAGE_FULL);
    for (int k = 0; k < 20; k++)
        stage_learn(&slower, 0.001, 0.007, pixels); /* it is forgotten */
    assert_int_equal(stage_first(&slower, pixels), STAGE_FULL);
}

static kage_film *film_of(kage_scene *s, const char *method)
{
    kage_film *f = NULL;
    const kage_render_options o = {.method = method, .width = 32, .height = 24, .layers = 1};
    assert_int_equal(kage_render(s, &o, &f, NULL), KAGE_OK);
    return f;
}

static void colours_tell_values(void **state)
{
    (void)state;
    const legend tau = {LAYER_TAU, -0.5, 0.5}, height = {LAYER_HEIGHT, 0, 2}, order = {LAYER_ORDER, -1, 6};
    uint8_t low[3], high[3], mid[3], none[3];
    colours_of(&tau, -0.5, low);
    colours_of(&tau, 0.5, high);
    colours_of(&tau, 0, mid);
    assert_true(low[2] > low[0] && high[0] > high[2]); /* blue, red */
    assert_true(mid[0] == 247 && mid[1] == 247 && mid[2] == 247);
    colours_of(&tau, 9, mid);
    assert_memory_equal(mid, high, 3);
    colours_of(&height, 2, high);
    colours_of(&height, 0, low);
    assert_true(high[1] > low[1]);
    colours_of(&height, (double)NAN, none);
    assert_true(none[0] == none[1] && none[1] == none[2]);
    for (int k = -1; k < 7; k++)
        for (int j = -1; j < k; j++) {
            assert_non_null(colours_order(k));
            colours_of(&order, k, low);
            colours_of(&order, j, high);
            assert_true(memcmp(low, high, 3) != 0);
        }
    assert_null(colours_order(7));
    assert_null(colours_order(-2));
}

static void films_are_painted(void **state)
{
    (void)state;
    kage_scene *s = cube();
    kage_film *f = film_of(s, "2");
    uint8_t *rgba = calloc(24, 4 * 40); /* rows longer than the film's */
    const legend l = colours_range(f, LAYER_HEIGHT), t = colours_range(f, LAYER_TAU);
    assert_true(l.low < 0 && l.high > 0 && l.high < 0.22);
    assert_true(t.low == -t.high && t.high > 0);
    colours_paint(f, &l, rgba, 4 * 40);
    const float *height = kage_film_plane(f, "height"), *order = kage_film_plane(f, "order");
    for (int y = 0; y < 24; y++)
        for (int x = 0; x < 32; x++) {
            uint8_t want[3];
            const float h = height[32 * y + x];
            colours_of(&l, order[32 * y + x] < 0 && h == 0 ? (double)NAN : (double)h, want);
            assert_memory_equal(&rgba[4 * (40 * y + x)], want, 3);
            assert_int_equal(rgba[4 * (40 * y + x) + 3], 255);
        }
    assert_int_equal(rgba[4 * 32], 0);
    free(rgba);
    kage_film_free(f);
    kage_scene_free(s);
}

static void a_pixel_is_read_out(void **state)
{
    (void)state;
    kage_scene *s = cube();
    readout r;
    readout_make(&r, s, 600, 420); /* on the ground */
    assert_string_equal(r.owner, "ground");
    assert_non_null(strstr(r.line, "ground  (u,w) "));
    assert_non_null(strstr(r.line, "  P "));
    assert_non_null(strstr(r.line, "  tau "));
    assert_non_null(strstr(r.line, "lamp lit"));
    assert_non_null(strstr(r.table[0], "lamp"));
    int methods = 0;
    for (int k = 1; k < r.lines; k++)
        methods += strncmp(r.table[k], "march:8 ", 8) == 0 || strncmp(r.table[k], "2 ", 2) == 0;
    assert_int_equal(methods, 2);
    readout_make(&r, s, 250, 200); /* on the cube */
    assert_non_null(strstr(r.line, "cube"));
    assert_string_equal(r.owner, "");
    readout_make(&r, s, 9999, 0);
    assert_string_equal(r.line, "");
    kage_scene_free(s);
}

static void write_file(const char *path, const char *text)
{
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    fputs(text, f);
    fclose(f);
}

static void a_changed_file_is_seen_once_and_only_when_whole(void **state)
{
    (void)state;
    char path[] = "/tmp/kage-watch-XXXXXX";
    const int fd = mkstemp(path);
    assert_true(fd >= 0);
    close(fd);
    watch w;
    write_file(path, "one");
    watch_start(&w, path);
    assert_false(watch_look(&w));
    write_file(path, "three");
    assert_false(watch_look(&w)); /* it may still be written */
    assert_true(watch_look(&w));
    assert_false(watch_look(&w));
    write_file(path, ""); /* an editor that has begun */
    assert_false(watch_look(&w));
    assert_false(watch_look(&w));
    write_file(path, "seven");
    assert_false(watch_look(&w));
    write_file(path, "eleven");
    assert_false(watch_look(&w));
    assert_true(watch_look(&w));
    unlink(path); /* between the removal and the new one */
    assert_false(watch_look(&w));
    assert_false(watch_look(&w));
    write_file(path, "thirteen");
    assert_false(watch_look(&w));
    assert_true(watch_look(&w));
    unlink(path);
}

static void names_end_before_the_dot(void **state)
{
    (void)state;
    assert_int_equal(save_stem("a/b.c/cube.yaml"), 10);
    assert_int_equal(save_stem("a/b.c/cube"), 10);
    assert_int_equal(save_stem(".cube"), 5);
    assert_int_equal(save_stem("cube.x.yaml"), 6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_look_becomes_changes),   cmocka_unit_test(stages_fit_a_frame),
        cmocka_unit_test(colours_tell_values),      cmocka_unit_test(films_are_painted),
        cmocka_unit_test(a_pixel_is_read_out),      cmocka_unit_test(a_changed_file_is_seen_once_and_only_when_whole),
        cmocka_unit_test(names_end_before_the_dot),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
