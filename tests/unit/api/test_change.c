/* kage_scene_change: the pictures of a fresh reading, and what is shared instead of read or made again. */
#include "unit/api/scenes.h"

#include "api/api.h"
#include "support/check.h"

#include <time.h>
#include <unistd.h>

#define DATA KAGE_TESTS_DIR "/../scenes/data"

#define PATCHES                                                                                                        \
    HEAD "  pot:\n"                                                                                                    \
         "    patches: {file: teapot.txt}\n"                                                                           \
         "    material: clay\n"                                                                                        \
         "    transform: [{scale: 0.5}]\n"

#define MODEL_AND_BUMP                                                                                                 \
    HEAD "  model:\n"                                                                                                  \
         "    mesh: {file: kage_test_change.obj}\n"                                                                    \
         "    material: clay\n"                                                                                        \
         "    bump: {function: 0.02*sin(40*u)}\n"                                                                      \
         "    transform: [{rotate: [0, 20, 0]}]\n"

enum { MOST = 3 };
typedef struct step {
    const char *set[MOST];
} step;

static int count(const step *s)
{
    int n = 0;
    while (n < MOST && s->set[n])
        n++;
    return n;
}

static kage_scene *change(kage_scene *s, const kage_load_options *o)
{
    kage_scene *changed = NULL;
    kage_errors *e = NULL;
    if (kage_scene_change(s, o, &changed, &e) != KAGE_OK)
        fail_by("kage_scene_change", e);
    assert_null(e);
    return changed;
}

static kage_scene *change_by(kage_scene *s, const char *set)
{
    return change(s, &(kage_load_options){.sets = &set, .set_count = 1});
}

static void same_pictures(kage_scene *a, kage_scene *b, const char *by)
{
    const kage_render_options o = {.layers = 1, .method = by, .width = 24, .height = 16};
    kage_film *f = render_with(a, &o), *g = render_with(b, &o);
    assert_true(same_films(f, g));
    kage_film_free(f);
    kage_film_free(g);
}

/* Change after change: each picture is that of a fresh reading with all the changes. The scene before is freed first or
 * last. */
static void follow(const char *text, const step *steps, int n, const char *by)
{
    const char *sets[64];
    int all = 0;
    kage_scene *s = parse_with(text, DATA, NULL);
    for (int k = 0; k < n; k++) {
        const kage_load_options o = {.sets = steps[k].set, .set_count = count(&steps[k])};
        kage_scene *next = change(s, &o);
        for (int j = 0; j < o.set_count; j++)
            sets[all++] = o.sets[j];
        kage_scene *fresh = parse_with(text, DATA, &(kage_load_options){.sets = sets, .set_count = all});
        kage_scene *written = parse_with(kage_scene_get_info(next)->text, DATA, NULL);
        same_pictures(written, fresh, NULL);
        kage_scene_free(written);
        if (k % 2)
            kage_scene_free(s);
        same_pictures(next, fresh, NULL);
        if (by)
            same_pictures(next, fresh, by);
        kage_scene_free(fresh);
        if (k % 2 == 0)
            kage_scene_free(s);
        s = next;
    }
    kage_scene_free(s);
}

static void changed_scenes_are_as_fresh_ones(void **state)
{
    (void)state;
    const step map[] = {
        {{"camera.from=[1, 3, -5]"}},
        {{"objects.ball.bump.scale=0.2"}},
        {{"camera.from=[0, 3, -5]", "render.aa=2"}},
        {{"objects.ball.bump.scale=0.05", "objects.ball.bump.zero=0.4"}},
        {{"objects.ball.bump.repeat=[3, 2]"}},
        {{"objects.ball.bump={function: 0.1*sin(9*u)}"}},
        {{"objects.ball.bump={map: {file: bumps.png}, scale: 0.1, zero: 0, sign: down, wrap: mirror}"}},
        {{"objects.ball.bump.map={file: jacksboro.exr, channel: elevation}", "objects.ball.bump.scale=0.0003"}},
        {{"objects.ball.bump.zero=500", "objects.ball.bump.wrap=clamp"}},
        {{"materials.clay.color={image: {file: bumps.png, repeat: [2, 2]}}"}},
        {{"materials.clay.color.image.wrap=mirror"}},
        {{"materials.clay.color.image.encoding=linear"}},
        {{"objects.new={sphere: {center: [1, 1, 0], radius: 0.5}, material: clay}"}}};
    follow(WITH_MAP, map, sizeof map / sizeof *map, "exact");
    const step curved[] = {
        {{"camera.fov=30"}}, {{"objects.dome.bump.scale=2"}}, {{"objects.dome.parametric.y=sin(w)"}}};
    follow(PARAMETRIC, curved, sizeof curved / sizeof *curved, "exact");
    const step pot[] = {
        {{"camera.fov=60"}}, {{"objects.pot.transform=[{scale: 0.4}]"}}, {{"lights.lamp.at=[1, 5, -2]"}}};
    follow(PATCHES, pot, sizeof pot / sizeof *pot, NULL);
}

static void write_model(double high)
{
    FILE *f = fopen(DATA "/kage_test_change.obj", "w");
    fprintf(f, "v -1 0 0\nv 1 0 0\nv 0 %g 1\nv 0 0 -1\nvt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\n", high);
    fprintf(f, "f 1/1 2/2 3/3\nf 2/2 1/1 4/4\nf 3/3 4/4 1/1\nf 4/4 3/3 2/2\n");
    fclose(f);
}

static const object *last(const kage_scene *s) { return &s->first->object[s->first->objects - 1]; }

static void what_is_not_changed_is_shared(void **state)
{
    (void)state;
    kage_scene *s = parse_with(WITH_MAP, DATA, NULL), *t = change_by(s, "camera.from=[1, 3, -5]");
    assert_ptr_equal(last(s)->bump, last(t)->bump);
    kage_scene *u = change_by(t, "objects.ball.bump.scale=0.2");
    assert_ptr_not_equal(last(t)->bump, last(u)->bump);
    kage_scene_free(s);
    kage_scene_free(t);
    s = change_by(u, "camera.from=[2, 3, -5]");
    t = change_by(s, "objects.ball.bump.scale=0.3"); /* from the samples, which the change between has passed on */
    assert_int_equal(t->first->shelf.count, 2);
    kage_scene_free(s);
    kage_scene_free(t);
    kage_scene_free(u);
    s = parse_with(PATCHES, DATA, NULL);
    t = change_by(s, "camera.from=[1, 3, -5]");
    assert_ptr_equal(last(s)->own, last(t)->own);
    kage_scene_free(s);
    kage_scene_free(t);
}

/* Further readings take from the first one, and those of a changed scene from those of the scene before. */
static void readings_share(void **state)
{
    (void)state;
    write_model(1);
    kage_scene *s = parse_with(MODEL_AND_BUMP, DATA, NULL);
    const reading exact = {.shadow = {.kind = METHOD_EXACT}};
    errors e = {0};
    const scene *a = scene_reading(s, exact, NULL, &e);
    assert_ptr_equal(last(s)->own, a->object[1].own);
    assert_ptr_equal(last(s)->bump, a->object[1].bump);
    assert_non_null(a->object[1].displaced);
    kage_scene *t = change_by(s, "camera.from=[1, 3, -5]");
    kage_scene_free(s);
    const scene *b = scene_reading(t, exact, NULL, &e);
    s = t;
    const surface *displaced = b->object[1].displaced, *moved = b->object[1].shape;
    t = change_by(s, "lights.lamp.at=[1, 5, -2]");
    b = scene_reading(t, exact, NULL, &e);
    assert_ptr_equal(b->object[1].displaced, displaced);
    assert_ptr_equal(b->object[1].shape, moved);
    kage_scene_free(t);
    t = change_by(s, "objects.model.transform=[{rotate: [0, 30, 0]}]");
    b = scene_reading(t, exact, NULL, &e);
    assert_ptr_not_equal(b->object[1].displaced, displaced);
    same_pictures(s, s, "exact");
    kage_scene_free(s);
    kage_scene_free(t);
    unlink(DATA "/kage_test_change.obj");
}

static void a_changed_file_is_read_again(void **state)
{
    (void)state;
    write_model(1);
    kage_scene *s = parse_with(MODEL_AND_BUMP, DATA, NULL);
    kage_scene *same = change(s, &(kage_load_options){.model_reader = "/nowhere"}); /* it is not needed */
    assert_ptr_equal(last(s)->own, last(same)->own);
    kage_scene_free(same);
    write_model(1.25);
    kage_scene *t = change(s, NULL), *fresh = parse_with(MODEL_AND_BUMP, DATA, NULL);
    assert_ptr_not_equal(last(s)->own, last(t)->own);
    same_pictures(t, fresh, NULL);
    kage_scene_free(s);
    kage_scene_free(t);
    kage_scene_free(fresh);
    unlink(DATA "/kage_test_change.obj");
}

static void arrays_stay_and_can_be_given_again(void **state)
{
    (void)state;
    static const uint8_t one[4] = {0, 255, 255, 0}, two[6] = {255, 0, 0, 255, 9, 100};
    const char *const set = "objects.ball.bump.map.file=\"array:h\"";
    const kage_image_array a = {"h", 2, 2, 1, KAGE_U8, one}, b = {"h", 3, 2, 1, KAGE_U8, two};
    const kage_load_options first = {.sets = &set, .set_count = 1, .images = &a, .image_count = 1};
    const kage_load_options second = {.sets = &set, .set_count = 1, .images = &b, .image_count = 1};
    kage_scene *s = parse_with(WITH_MAP, DATA, &first), *t = change_by(s, "camera.from=[1, 3, -5]");
    assert_ptr_equal(last(s)->bump, last(t)->bump);
    kage_scene *u = change(t, &(kage_load_options){.images = &b, .image_count = 1});
    kage_scene_free(t);
    assert_int_equal(kage_scene_get_info(u)->objects[1].map_size[0], 3);
    t = change(s, &second);
    kage_scene *fresh = parse_with(WITH_MAP, DATA, &second);
    same_pictures(t, fresh, "exact");
    kage_scene_free(s);
    kage_scene_free(t);
    kage_scene_free(u);
    kage_scene_free(fresh);
}

static void wrong_changes_are_errors(void **state)
{
    (void)state;
    kage_scene *s = parse_with(WITH_MAP, DATA, NULL), *t = s;
    kage_errors *e = NULL;
    const char *const set = "objects.ball.bump.scale=high";
    assert_int_equal(kage_scene_change(s, &(kage_load_options){.sets = &set, .set_count = 1}, &t, &e), KAGE_BAD_INPUT);
    assert_null(t);
    assert_string_equal(kage_errors_get(e, 0)->file, "--set");
    assert_int_equal(kage_errors_get(e, 0)->column, 25);
    kage_errors_free(e);
    assert_int_equal(kage_scene_change(s, &(kage_load_options){.threads = -1}, &t, NULL), KAGE_BAD_OPTION);
    kage_scene_free(s);
}

/* What was read with other limits is looked at again, and only then. */
static void tighter_limits_hold_for_what_was_read(void **state)
{
    (void)state;
    const kage_limits enough = {.side = 512}, few = {.side = 511}, more = {.side = 600};
    kage_scene *s = parse_with(WITH_MAP, DATA, &(kage_load_options){.limits = &enough}), *t = s;
    kage_errors *e = NULL;
    assert_int_equal(kage_scene_change(s, &(kage_load_options){.limits = &few}, &t, &e), KAGE_BAD_INPUT);
    assert_null(t);
    assert_non_null(strstr(kage_errors_get(e, 0)->text, "expected at most 511 a side"));
    kage_errors_free(e);
    t = change(s, &(kage_load_options){.limits = &more});
    assert_ptr_equal(last(s)->bump, last(t)->bump);
    kage_scene_free(t);
    t = change(s, &(kage_load_options){.limits = &(kage_limits){.samples = 512 * 512}});
    assert_ptr_not_equal(last(s)->bump, last(t)->bump);
    same_pictures(s, t, "exact");
    kage_scene_free(t);
    kage_scene_free(s);
}

/* One change of each place, and pictures name them. */
static void changes_do_not_pile_up(void **state)
{
    (void)state;
    static const char *const all[] = {"camera.from=[1, 3, -5]",
                                      "objects.ground.bump.scale=2",
                                      "objects.ground.bump={function: sin(u)}",
                                      "objects.ground.bump.scale=3",
                                      "camera.from=[2, 3, -5]",
                                      "objects.ground.bump.scale=4",
                                      "objects.ground.bump={function: cos(u)}"};
    kage_scene *s = parse(GROUND);
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        kage_scene *t = change_by(s, all[k]);
        kage_scene_free(s);
        s = t;
    }
    kage_film *f = render_with(s, NULL);
    assert_string_equal(kage_film_metadata(f, 3).value, "camera.from=[2, 3, -5]\nobjects.ground.bump.scale=2\n"
                                                        "objects.ground.bump={function: cos(u)}");
    kage_film_free(f);
    kage_scene_free(s);
}

static void the_changed_text_is_written(void **state)
{
    (void)state;
    const char *const sets[] = {"camera.from=[1, 3, -5]", "objects.ball.bump.scale=0.2", "render.aa=2"};
    kage_scene *s = parse_with(WITH_MAP, DATA, NULL);
    assert_string_equal(kage_scene_get_info(s)->text, WITH_MAP);
    kage_scene *t = change(s, &(kage_load_options){.sets = sets, .set_count = 3}), *read = NULL;
    assert_string_equal(kage_scene_get_info(s)->text, WITH_MAP);
    assert_int_equal(kage_scene_write(t, DATA "/kage_test_written.yaml", NULL), KAGE_OK);
    assert_int_equal(kage_scene_load(DATA "/kage_test_written.yaml", NULL, &read, NULL), KAGE_OK);
    unlink(DATA "/kage_test_written.yaml");
    assert_string_equal(kage_scene_get_info(read)->text, kage_scene_get_info(t)->text);
    assert_non_null(strstr(kage_scene_get_info(read)->text, "\nrender: {aa: 2}\n"));
    same_pictures(t, read, "exact");
    kage_errors *e = NULL;
    assert_int_equal(kage_scene_write(t, "/nowhere/x.yaml", &e), KAGE_NOT_WRITTEN);
    assert_non_null(strstr(kage_errors_get(e, 0)->text, "/nowhere/x.yaml"));
    kage_errors_free(e);
    kage_scene_free(s);
    kage_scene_free(t);
    kage_scene_free(read);
}

/* A change of the camera costs a part of a reading: the least time of some of each, in turns, as other work on the
 * machine only adds. That of a bump's scale is told alone: it makes a map's table anew, whose pages cost what the
 * system asks. */
static double seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void a_change_is_quick(void **state)
{
    (void)state;
    enum { TIMES = 9 };
    double fresh = HUGE_VAL, eye = HUGE_VAL, scale = HUGE_VAL;
    const kage_load_options one = {.threads = 1};
    kage_scene *s = parse_with(WITH_MAP, DATA, &one);
    for (int k = 0; k < TIMES; k++) {
        char set[64];
        snprintf(set, sizeof set, "objects.ball.bump.scale=%g", 0.1 + 0.01 * k);
        double start = seconds();
        kage_scene *a = parse_with(WITH_MAP, DATA, &one);
        fresh = fmin(fresh, seconds() - start);
        kage_scene_free(a);
        start = seconds();
        a = change_by(s, "camera.from=[1, 3, -5]");
        eye = fmin(eye, seconds() - start);
        kage_scene_free(s);
        start = seconds();
        s = change_by(a, set);
        scale = fmin(scale, seconds() - start);
        kage_scene_free(a);
    }
    kage_scene_free(s);
    print_message("a reading %.3f ms, the eye %.3f ms, the scale %.3f ms\n", 1e3 * fresh, 1e3 * eye, 1e3 * scale);
    CHECK(eye, <, 0.5 * fresh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(changed_scenes_are_as_fresh_ones),
        cmocka_unit_test(what_is_not_changed_is_shared),
        cmocka_unit_test(readings_share),
        cmocka_unit_test(a_changed_file_is_read_again),
        cmocka_unit_test(arrays_stay_and_can_be_given_again),
        cmocka_unit_test(wrong_changes_are_errors),
        cmocka_unit_test(tighter_limits_hold_for_what_was_read),
        cmocka_unit_test(changes_do_not_pile_up),
        cmocka_unit_test(a_change_is_quick),
        cmocka_unit_test(the_changed_text_is_written),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
