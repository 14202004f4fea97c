/* kage.h: rendering with options, films and their planes, pictures written and read, a pixel, a survey. */
#include "unit/api/scenes.h"

#include "image/image.h"
#include "support/check.h"

/* What a result points to before a call; afterwards it does not. */
static char nowhere[1];

#include <unistd.h>

static void a_film_has_planes(void **state)
{
    (void)state;
    kage_scene *s = parse(GROUND);
    kage_film *f = render_with(s, NULL);
    kage_scene_free(s); /* the film does not need it */
    assert_int_equal(kage_film_width(f), 48);
    assert_int_equal(kage_film_height(f), 32);
    assert_int_equal(kage_film_plane_count(f), 3);
    assert_string_equal(kage_film_plane_name(f, 1), "G");
    assert_null(kage_film_plane_name(f, 3));
    assert_null(kage_film_plane(f, "Z"));
    CHECK(kage_film_plane(f, "R")[31 * 48 + 24], >, 0.01);
    kage_film_free(f);
}

static void layers_are_planes(void **state)
{
    (void)state;
    kage_scene *s = parse(GROUND);
    const kage_render_options o = {.layers = 1};
    kage_film *f = render_with(s, &o);
    const float *order = kage_film_plane(f, "order"), *lamp = kage_film_plane(f, "visibility.lamp");
    assert_non_null(kage_film_plane(f, "N.X"));
    for (size_t k = 0; k < pixels_of(f); k++) {
        BETWEEN(-1, order[k], 0);
        BETWEEN(0, lamp[k], 1);
    }
    kage_film_free(f);
    kage_scene_free(s);
}

/* An option is the same as the change that the program makes for it: also where the scene is read again. */
static void options_are_as_changes(void **state)
{
    (void)state;
    static const struct {
        kage_render_options o;
        const char *set;
    } all[] = {
        {{.method = "2+"}, "render.shadow=2+"},
        {{.method = "exact"}, "render.shadow=exact"},
        {{.displaced = KAGE_YES}, "render.surface=displaced"},
        {{.shifted = KAGE_YES}, "render.shade=shifted"},
        {{.bump_shadow = "exact"}, "render.bump_shadow=exact"},
        {{.guard = KAGE_NO, .method = "0"}, "render.guard=false"},
        {{.self_shadow = KAGE_NO}, "render.self_shadow=false"},
        {{.width = 30, .height = 40}, "image.size=[30, 40]"},
        {{.aa = 2}, "render.aa=2"},
    };
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        const kage_load_options change = {.sets = &all[k].set, .set_count = 1};
        kage_scene *plain = parse(GROUND), *changed = parse_with(GROUND, NULL, &change);
        kage_film *a = render_with(plain, &all[k].o), *b = render_with(changed, NULL);
        if (!same_films(a, b))
            fail_msg("not as %s", all[k].set);
        kage_film_free(a);
        kage_film_free(b);
        kage_scene_free(plain);
        kage_scene_free(changed);
    }
}

/* And back: a scene of displaced surfaces as bump mapping, when it has been both. */
static void a_scene_can_be_both_surfaces(void **state)
{
    (void)state;
    const char *const set = "render.surface=displaced";
    const kage_load_options change = {.sets = &set, .set_count = 1};
    const kage_render_options smooth = {.displaced = KAGE_NO};
    kage_scene *plain = parse(GROUND), *rough = parse_with(GROUND, NULL, &change);
    kage_film *a = render_with(plain, NULL), *b = render_with(rough, NULL), *c = render_with(rough, &smooth),
              *d = render_with(rough, NULL);
    assert_true(same_films(a, c));
    assert_true(same_films(b, d));
    assert_false(same_films(a, b));
    kage_film_free(a);
    kage_film_free(b);
    kage_film_free(c);
    kage_film_free(d);
    kage_scene_free(plain);
    kage_scene_free(rough);
}

/* Displaced surfaces need no horizon maps; the same scene as bump mapping does. */
static void horizons_are_built_when_they_are_needed(void **state)
{
    (void)state;
    static const char text[] = HEAD "  ground:\n    rectangle: {origin: [-2, 0, -2], u: [0, 0, 4], w: [4, 0, 0]}\n"
                                    "    material: clay\n    bump: {function: 0.2*sin(40*u)}\n";
    const char *const sets[] = {"render.bump_shadow=horizon", "render.surface=displaced", "lights.lamp.at=[-4, 1, -2]"};
    const kage_load_options low = {.sets = sets + 2, .set_count = 1}, all = {.sets = sets, .set_count = 3};
    const kage_render_options smooth = {.displaced = KAGE_NO}, horizon = {.bump_shadow = "horizon"};
    kage_scene *plain = parse_with(text, NULL, &low), *rough = parse_with(text, NULL, &all);
    kage_film *a = render_with(plain, &horizon), *b = render_with(rough, &smooth), *c = render_with(plain, NULL);
    assert_true(same_films(a, b));
    assert_false(same_films(a, c));
    kage_film_free(a);
    kage_film_free(b);
    kage_film_free(c);
    kage_scene_free(plain);
    kage_scene_free(rough);
}

static void what_can_not_be_displaced_is_an_error_then(void **state)
{
    (void)state;
    static const char text[] = HEAD "  ground:\n    plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}\n"
                                    "    material: clay\n    bump: {function: 0.1*u}\n";
    kage_scene *s = parse(text);
    const kage_render_options o = {.displaced = KAGE_YES};
    kage_film *f;
    kage_errors *e;
    assert_int_equal(kage_render(s, &o, &f, &e), KAGE_BAD_INPUT);
    assert_null(f);
    assert_int_equal(kage_errors_get(e, 0)->line, 12);
    kage_errors_free(e);
    kage_film *again = render_with(s, NULL);
    kage_film_free(again);
    kage_scene_free(s);
}

static void threads_and_crops_change_no_pixel(void **state)
{
    (void)state;
    kage_scene *s = parse(GROUND);
    const kage_render_options one = {.aa = 3, .aa_threshold = 0.1, .threads = 1},
                              four = {.aa = 3, .aa_threshold = 0.1, .threads = 4},
                              part = {.aa = 3, .aa_threshold = 0.1, .crop = {10, 5, 31, 22}};
    kage_film *a = render_with(s, &one), *b = render_with(s, &four), *c = render_with(s, &part);
    int crop[4];
    assert_true(same_films(a, b));
    kage_film_crop(c, crop);
    assert_int_equal(crop[0], 10);
    assert_int_equal(crop[3], 22);
    const float *whole = kage_film_plane(a, "R"), *cut = kage_film_plane(c, "R");
    for (int y = 5; y < 22; y++)
        assert_memory_equal(whole + y * 48 + 10, cut + (y - 5) * 21, 21 * sizeof *cut);
    kage_film_free(a);
    kage_film_free(b);
    kage_film_free(c);
    kage_scene_free(s);
}

static void wrong_options_are_named(void **state)
{
    (void)state;
    static const struct {
        kage_render_options o;
        const char *says;
    } all[] = {
        {{.method = "3"}, "'3' is no method"},         {{.width = 10}, "10 x 0 pixels"},
        {{.width = -1, .height = 4}, "-1 x 4 pixels"}, {{.aa = 17}, "17 samples"},
        {{.aa_threshold = -1}, "threshold"},           {{.threads = 2000}, "2000 threads"},
        {{.crop = {0, 0, 49, 32}}, "48 x 32 pixels"},  {{.crop = {5, 5, 5, 6}}, "crop 5,5,5,6"},
        {{.guard = (kage_choice)7}, "KAGE_AS_SCENE"},  {{.width = 32768, .height = 32768}, "pixels"},
    };
    kage_scene *s = parse(GROUND);
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        kage_film *f = (kage_film *)(void *)nowhere;
        kage_errors *e = NULL;
        assert_int_equal(kage_render(s, &all[k].o, &f, &e), KAGE_BAD_OPTION);
        assert_null(f);
        if (!strstr(kage_errors_get(e, 0)->text, all[k].says))
            fail_msg("'%s', expected '%s'", kage_errors_get(e, 0)->text, all[k].says);
        kage_errors_free(e);
    }
    kage_scene_free(s);
}

typedef struct seen {
    int calls, cancel_at;
    double last;
} seen;

static int count(void *user, const char *what, double share)
{
    seen *k = user;
    assert_string_equal(what, "rendering");
    CHECK(share, >=, k->last);
    k->last = share;
    return ++k->calls == k->cancel_at;
}

static void progress_grows(void **state)
{
    (void)state;
    kage_scene *s = parse(GROUND);
    seen k = {0, 0, 0};
    const kage_render_options o = {.threads = 1, .progress = count, .user = &k};
    kage_film *f = render_with(s, &o);
    CHECK(k.calls, >, 1);
    NEAR(k.last, 1, 0);
    kage_film_free(f);
    kage_scene_free(s);
}

static void rendering_can_be_cancelled(void **state)
{
    (void)state;
    kage_scene *s = parse(GROUND);
    for (int threads = 1; threads <= 2; threads++) {
        seen k = {0, 1, 0};
        const kage_render_options o = {.threads = threads, .aa = 2, .aa_threshold = 0.1, .progress = count, .user = &k};
        kage_film *f = (kage_film *)(void *)nowhere;
        kage_errors *e = (kage_errors *)(void *)nowhere;
        assert_int_equal(kage_render(s, &o, &f, &e), KAGE_CANCELLED);
        assert_null(f);
        assert_null(e);
        assert_int_equal(k.calls, 1);
    }
    kage_scene_free(s);
}

/* 2^20 samples of an area light in each pixel that sees the ground: a tile there takes minutes. Tiles above see the
 * background. Two bands of four tiles, so that two threads take one each. */
#define LONG_TILES                                                                                                     \
    "camera: {from: [0.5, 3, -5], at: [0, 0, 0], fov: 40}\n"                                                           \
    "image: {size: [16, 64]}\n"                                                                                        \
    "render: {aa: 16}\n"                                                                                               \
    "lights:\n"                                                                                                        \
    "  lamp: {at: [-4, 5, -2], area: {u: [1, 0, 0], w: [0, 0, 1], samples: [64, 64]}}\n"                               \
    "materials:\n"                                                                                                     \
    "  clay: {color: [0.8, 0.7, 0.6], ambient: 0.1, diffuse: 0.8}\n"                                                   \
    "objects:\n"                                                                                                       \
    "  low: {plane: {origin: [0, -9, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: clay}\n"

/* While one tile is rendered, by the caller's thread or by the other one, the callback is called again and again, and
 * ends it. Without that there would be four calls at most: at the start, and after each four tiles. */
static void a_long_tile_can_be_cancelled(void **state)
{
    (void)state;
    kage_scene *s = parse(LONG_TILES);
    for (int threads = 1; threads <= 2; threads++) {
        seen k = {0, 8, 0};
        const kage_render_options o = {.threads = threads, .progress = count, .user = &k};
        kage_film *f = NULL;
        assert_int_equal(kage_render(s, &o, &f, NULL), KAGE_CANCELLED);
        assert_int_equal(k.calls, 8);
        CHECK(k.last, <, 1);
    }
    kage_scene_free(s);
}

/* Height look-ups of a displaced open cone that is transformed. */
static int64_t lookups_of_cone(const char *transform)
{
    char text[1024];
    snprintf(text, sizeof text,
             HEAD "  hat: {cone: {from: [1, 0, 0], from_radius: 0.6, to: [1, 1, 0], to_radius: 0, open: true}, "
                  "material: clay, bump: {function: sin(9*u)*sin(7*w), scale: 0.03}, transform: [{%s}]}\n",
             transform);
    kage_scene *s = parse(text);
    const kage_render_options o = {.displaced = KAGE_YES};
    kage_film *f = render_with(s, &o);
    const int64_t count = kage_film_get_stats(f)->height_lookups;
    kage_film_free(f);
    kage_scene_free(s);
    return count;
}

/* Stretched, a cone is searched by pieces, up to its apex where these have no normal. That takes about twice the
 * look-ups of its closed form. */
static void a_stretched_cone_takes_few_lookups(void **state)
{
    (void)state;
    const int64_t turned = lookups_of_cone("rotate: [0, 30, 0]"), stretched = lookups_of_cone("scale: [1, 1.2, 0.8]");
    CHECK(turned, >, 1000);
    CHECK(stretched, <, 4 * turned);
}

static int render_inside(void *user, const char *what, double share)
{
    (void)what, (void)share;
    kage_film *f = render_with(user, NULL);
    kage_film_free(f);
    return 0;
}

static void a_callback_may_render(void **state)
{
    (void)state;
    kage_scene *s = parse(GROUND);
    const kage_render_options o = {.progress = render_inside, .user = s};
    kage_film *f = render_with(s, &o);
    kage_film_free(f);
    kage_scene_free(s);
}

static void the_stats_count(void **state)
{
    (void)state;
    kage_scene *s = parse(GROUND);
    const kage_render_options o = {.method = "1", .timing = 1};
    kage_film *f = render_with(s, &o);
    const kage_stats *t = kage_film_get_stats(f);
    int64_t sum = 0;
    double seconds = 0;
    for (int k = 0; k < t->order_count; k++)
        sum += t->orders[k].samples;
    for (int k = 0; k < t->stage_count; k++)
        seconds += t->stages[k].seconds;
    assert_int_equal(t->camera_rays, 48 * 32);
    assert_int_equal(sum, t->bumped);
    assert_string_equal(t->method, "1");
    CHECK(t->bumped, >, 100);
    CHECK(seconds, >, 0);
    CHECK(t->seconds, >, 0);
    kage_film_free(f);
    kage_scene_free(s);
}

/* The probe's row for the scene's method has what the layers have. */
static void a_probe_is_as_the_picture(void **state)
{
    (void)state;
    kage_scene *s = parse(GROUND);
    const kage_render_options o = {.method = "2", .layers = 1};
    kage_film *f = render_with(s, &o);
    kage_probe *p = NULL;
    kage_errors *e;
    const int x = 24, y = 30, at = y * 48 + x;
    assert_int_equal(kage_scene_probe(s, x, y, &p, &e), KAGE_OK);
    assert_int_equal(p->object, 1);
    assert_int_equal(p->bumped, 1);
    NEAR(p->u, kage_film_plane(f, "uw.u")[at], 1e-5);
    NEAR(p->P, kage_film_plane(f, "height")[at], 1e-5);
    int rows = 0;
    for (int k = 0; k < p->row_count; k++)
        if (strcmp(p->rows[k].method, "2") == 0 && p->rows[k].guard) {
            NEAR(p->rows[k].tau, kage_film_plane(f, "tau")[at], 1e-5);
            NEAR(p->rows[k].color[0], kage_film_plane(f, "R")[at], 1e-5);
            NEAR(p->rows[k].visible[0], kage_film_plane(f, "visibility.lamp")[at], 1e-5);
            rows++;
        }
    assert_int_equal(rows, 1);
    kage_probe_free(p);
    assert_int_equal(kage_scene_probe(s, 48, 0, &p, &e), KAGE_BAD_OPTION);
    assert_null(p);
    kage_errors_free(e);
    kage_film_free(f);
    kage_scene_free(s);
}

static void a_survey_warns_of_steep_bumps(void **state)
{
    (void)state;
    const char *const set = "objects.ground.bump.scale=8";
    const kage_load_options steep = {.sets = &set, .set_count = 1};
    for (int k = 0; k < 2; k++) {
        kage_scene *s = parse_with(GROUND, NULL, k ? &steep : NULL);
        kage_survey *v;
        assert_int_equal(kage_scene_survey(s, &v, NULL), KAGE_OK);
        int warnings = 0;
        for (int i = 0; i < v->warning_count; i++)
            warnings += v->warnings[i].code == KAGE_WARN_STEEP && v->warnings[i].object == 1;
        assert_int_equal(warnings, k);
        assert_int_equal(v->objects[0].samples, 0);
        CHECK(v->objects[1].slope_95, >, v->objects[1].slope_median);
        kage_survey_free(v);
        kage_scene_free(s);
    }
}

static void the_export_is_written(void **state)
{
    (void)state;
    char path[] = "/tmp/kage-pov-XXXXXX", line[200] = "";
    const int fd = mkstemp(path);
    CHECK(fd, >=, 0);
    kage_scene *s = parse(GROUND);
    const kage_povray_options o = {.command = "a test", .displaced = KAGE_YES};
    kage_povray_report r;
    assert_int_equal(kage_scene_write_povray(s, path, &o, &r, NULL), KAGE_OK);
    assert_null(r.coarse);
    FILE *f = fopen(path, "r");
    assert_non_null(f);
    assert_non_null(fgets(line, sizeof line, f));
    assert_non_null(strstr(line, "truly displaced"));
    assert_non_null(fgets(line, sizeof line, f));
    assert_string_equal(line, "// made by: a test\n");
    fclose(f);
    close(fd);
    unlink(path);
    kage_scene_free(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_film_has_planes),
        cmocka_unit_test(layers_are_planes),
        cmocka_unit_test(options_are_as_changes),
        cmocka_unit_test(a_scene_can_be_both_surfaces),
        cmocka_unit_test(horizons_are_built_when_they_are_needed),
        cmocka_unit_test(what_can_not_be_displaced_is_an_error_then),
        cmocka_unit_test(threads_and_crops_change_no_pixel),
        cmocka_unit_test(wrong_options_are_named),
        cmocka_unit_test(progress_grows),
        cmocka_unit_test(rendering_can_be_cancelled),
        cmocka_unit_test(a_stretched_cone_takes_few_lookups),
        cmocka_unit_test(a_long_tile_can_be_cancelled),
        cmocka_unit_test(a_callback_may_render),
        cmocka_unit_test(the_stats_count),
        cmocka_unit_test(a_probe_is_as_the_picture),
        cmocka_unit_test(a_survey_warns_of_steep_bumps),
        cmocka_unit_test(the_export_is_written),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
