/* kage.h: scenes from texts and files, their errors with places, and what is in them. */
#include "unit/api/scenes.h"

#include "support/check.h"

#include <locale.h>

/* What a result points to before a call; afterwards it does not. */
static char nowhere[1];

/* The errors of a text that is no good scene. */
static kage_errors *errors_of(const char *text, const kage_load_options *o)
{
    kage_scene *s = (kage_scene *)(void *)nowhere;
    kage_errors *e = NULL;
    assert_int_equal(kage_scene_parse(text, strlen(text), "test.yaml", NULL, o, &s, &e), KAGE_BAD_INPUT);
    assert_null(s);
    assert_non_null(e);
    return e;
}

static void an_error_has_its_place(void **state)
{
    (void)state;
    kage_errors *e = errors_of("camera: {from: [0, 3, -5], at: [0, 0, 0]}\nlights: {}\nmaterials: {}\n"
                               "objects:\n  ball: {sphere: {center: [0, 0, 0], radius: -1}, material: clay}\n",
                               NULL);
    const kage_error *first = kage_errors_get(e, 0);
    assert_string_equal(first->file, "test.yaml");
    assert_int_equal(first->line, 5);
    assert_int_equal(first->column, 46);
    assert_non_null(strstr(first->text, "expected"));
    assert_null(strchr(first->text, '\n'));
    assert_int_equal(strncmp(first->message, "test.yaml:5:46: ", 16), 0);
    assert_int_equal(strncmp(first->message + 16, first->text, strlen(first->text)), 0);
    assert_int_equal(first->message[strlen(first->message) - 1], '^');
    kage_errors_free(e);
}

static void all_errors_are_found_at_once(void **state)
{
    (void)state;
    kage_errors *e = errors_of("camera: {from: [0, 3], at: [0, 0, 0]}\nlights: 1\nmaterials: {}\nobjects: {}\n", NULL);
    assert_int_equal(kage_errors_found(e), 2);
    assert_int_equal(kage_errors_count(e), 2);
    assert_int_equal(kage_errors_get(e, 0)->line, 1);
    assert_int_equal(kage_errors_get(e, 1)->line, 2);
    assert_null(kage_errors_get(e, 2));
    assert_null(kage_errors_get(e, -1));
    kage_errors_free(e);
}

static void an_error_of_a_change_is_in_that_change(void **state)
{
    (void)state;
    const char *const sets[] = {"objects.ground.bump.scale=-x"};
    const kage_load_options o = {.sets = sets, .set_count = 1};
    kage_errors *e = errors_of(GROUND, &o);
    assert_string_equal(kage_errors_get(e, 0)->file, "--set");
    assert_int_equal(kage_errors_get(e, 0)->line, 1);
    assert_int_equal(kage_errors_get(e, 0)->column, 27);
    kage_errors_free(e);
}

static void a_file_that_is_not_there_is_an_error_without_a_place(void **state)
{
    (void)state;
    kage_scene *s;
    kage_errors *e;
    assert_int_equal(kage_scene_load("/nowhere/at/all.yaml", NULL, &s, &e), KAGE_BAD_INPUT);
    assert_null(kage_errors_get(e, 0)->file);
    assert_int_equal(kage_errors_get(e, 0)->line, 0);
    assert_string_equal(kage_errors_get(e, 0)->text, kage_errors_get(e, 0)->message);
    kage_errors_free(e);
}

static void errors_need_not_be_asked_for(void **state)
{
    (void)state;
    kage_scene *s;
    assert_int_equal(kage_scene_parse("x", 1, NULL, NULL, NULL, &s, NULL), KAGE_BAD_INPUT);
    assert_null(s);
    kage_errors_free(NULL);
    kage_scene_free(NULL);
    kage_film_free(NULL);
    assert_int_equal(kage_errors_count(NULL), 0);
}

static void a_text_is_read_to_its_size_and_not_farther(void **state)
{
    (void)state;
    static const char text[] = GROUND "nonsense";
    kage_scene *s = NULL;
    kage_errors *e = NULL;
    assert_int_equal(kage_scene_parse(text, sizeof text - sizeof "nonsense", NULL, NULL, NULL, &s, &e), KAGE_OK);
    assert_string_equal(kage_scene_get_info(s)->path, "scene");
    kage_scene_free(s);
}

static void changes_are_made(void **state)
{
    (void)state;
    const char *const sets[] = {"image.size=[20, 10]", "render.shadow=march:4"};
    const kage_load_options o = {.sets = sets, .set_count = 2};
    kage_scene *s = parse_with(GROUND, NULL, &o);
    assert_int_equal(kage_scene_get_info(s)->width, 20);
    assert_string_equal(kage_scene_get_info(s)->method, "march:4");
    kage_scene_free(s);
}

static void files_are_found_in_the_folder(void **state)
{
    (void)state;
    kage_scene *s = parse_with(WITH_MAP, KAGE_TESTS_DIR "/../scenes/data", NULL);
    assert_string_equal(kage_scene_get_info(s)->objects[1].map, "bumps.png");
    assert_true(kage_scene_uses_file(s, KAGE_TESTS_DIR "/../scenes/data/bumps.png"));
    assert_false(kage_scene_uses_file(s, KAGE_TESTS_DIR "/../scenes/cube.yaml"));
    kage_scene_free(s);
    kage_scene *file;
    assert_int_equal(kage_scene_load(KAGE_TESTS_DIR "/../scenes/cube.yaml", NULL, &file, NULL), KAGE_OK);
    assert_true(kage_scene_uses_file(file, KAGE_TESTS_DIR "/../scenes/cube.yaml"));
    kage_scene_free(file);
}

static void the_scene_says_what_is_in_it(void **state)
{
    (void)state;
    kage_scene *s = parse(GROUND);
    const kage_scene_info *i = kage_scene_get_info(s);
    assert_string_equal(i->path, "test.yaml");
    assert_int_equal(i->light_count, 1);
    assert_string_equal(i->lights[0].name, "lamp");
    assert_string_equal(i->lights[0].kind, "point");
    assert_int_equal(i->object_count, 2);
    assert_string_equal(i->objects[0].shape, "box");
    assert_null(i->objects[0].bump);
    assert_string_equal(i->objects[1].name, "ground");
    assert_non_null(i->objects[1].bump);
    NEAR(i->objects[1].height[1], 0.1, 1e-3);
    assert_int_equal(i->objects[1].bounded, 1);
    assert_int_equal(i->depth, 0);
    kage_scene_free(s);
}

static void the_scene_says_where_the_camera_and_the_bumps_are(void **state)
{
    (void)state;
    static const char text[] = GROUND "  leaf: {copy: ball, transform: [{translate: [3, 0, 0]}]}\n"
                                      "  twig: {copy: leaf}\n"
                                      "  ball: {sphere: {center: [0, 2, 0], radius: 1}, material: clay, bump: {map: "
                                      "{file: bumps.png}, scale: 0.2, zero: 0.5, sign: down}}\n";
    kage_scene *s = parse_with(text, KAGE_TESTS_DIR "/../scenes/data", NULL);
    const kage_scene_info *i = kage_scene_get_info(s);
    NEAR(i->camera.eye[2], -5, 1e-6);
    NEAR(i->camera.at[2], 0, 1e-6);
    NEAR(i->camera.up[1], 1, 1e-6);
    NEAR(i->camera.fov, 40, 1e-6);
    NEAR(i->camera.width, 0, 1e-9);
    assert_null(i->objects[0].bump_of);
    assert_string_equal(i->objects[1].bump_of, "ground");
    NEAR(i->objects[1].bump_scale, 1, 1e-9);
    for (int k = 2; k < 5; k++) {
        assert_string_equal(i->objects[k].bump_of, "ball");
        NEAR(i->objects[k].bump_scale, 0.2, 1e-6);
    }
    kage_scene_free(s);
    static const char *const sets[] = {"camera={from: [0, 3, -5], at: [0, 0, 1], width: 6}"};
    const kage_load_options o = {.sets = sets, .set_count = 1};
    s = parse_with(GROUND, NULL, &o);
    NEAR(kage_scene_get_info(s)->camera.width, 6, 1e-6);
    NEAR(kage_scene_get_info(s)->camera.fov, 0, 1e-9);
    kage_scene_free(s);
}

static void layers_have_names(void **state)
{
    (void)state;
    static const char *const good[] = {"color", "R", "Z", "N", "N.X", "uw", "tau", "visibility", "visibility.lamp"};
    static const char *const bad[] = {"", "r", "N.", "N.Q", "colour", "visibility.sun"};
    kage_scene *s = parse(GROUND);
    for (size_t k = 0; k < sizeof good / sizeof *good; k++)
        if (!kage_scene_has_layer(s, good[k]))
            fail_msg("no layer %s", good[k]);
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
        if (kage_scene_has_layer(s, bad[k]))
            fail_msg("a layer %s", bad[k]);
    kage_scene_free(s);
}

static void a_model_needs_its_reader(void **state)
{
    (void)state;
    kage_scene *s;
    kage_errors *e;
    const kage_load_options o = {.model_reader = "/nowhere/kage-import"};
    assert_int_equal(kage_scene_parse(MODEL, strlen(MODEL), "m", KAGE_TESTS_DIR "/../scenes/data", &o, &s, &e),
                     KAGE_BAD_INPUT);
    assert_non_null(strstr(kage_errors_get(e, 0)->text, "/nowhere/kage-import"));
    assert_int_equal(kage_errors_get(e, 0)->line, 10);
    kage_errors_free(e);
}

/* Any other program in its place: /bin/true ends at once, and says nothing. */
static void a_reader_that_breaks_down_is_an_error_of_the_scene(void **state)
{
    (void)state;
    kage_scene *s;
    kage_errors *e;
    const kage_load_options o = {.model_reader = "/bin/true"};
    assert_int_equal(kage_scene_parse(MODEL, strlen(MODEL), "m", KAGE_TESTS_DIR "/../scenes/data", &o, &s, &e),
                     KAGE_BAD_INPUT);
    assert_non_null(strstr(kage_errors_get(e, 0)->text, "its reader failed"));
    kage_errors_free(e);
}

static void a_model_is_read(void **state)
{
    (void)state;
    kage_scene *s = parse_with(MODEL, KAGE_TESTS_DIR "/../scenes/data", NULL);
    assert_string_equal(kage_scene_get_info(s)->objects[1].model->file, "lantern.obj");
    CHECK(kage_scene_get_info(s)->objects[1].model->triangles, >, 100);
    kage_scene_free(s);
}

#define WILD                                                                                                           \
    HEAD "  dome:\n"                                                                                                   \
         "    parametric: {x: u, y: 0.1*sin(90*u)*cos(80*w), z: w, u: [-1, 1], w: [-1, 1]}\n"                          \
         "    material: clay\n"

static int cancel_at(void *user, const char *what, double share)
{
    (void)share;
    return strcmp(what, user) == 0;
}

static void reading_can_be_cancelled(void **state)
{
    (void)state;
    static const char *const at[] = {"objects", "reading", "building"};
    for (size_t k = 0; k < sizeof at / sizeof *at; k++) {
        kage_scene *s = (kage_scene *)(void *)nowhere;
        kage_errors *e = (kage_errors *)(void *)nowhere;
        const kage_load_options o = {.progress = cancel_at, .user = (void *)at[k]};
        assert_int_equal(kage_scene_parse(MODEL, strlen(MODEL), "m", KAGE_TESTS_DIR "/../scenes/data", &o, &s, &e),
                         KAGE_CANCELLED);
        assert_null(s);
        assert_null(e);
    }
}

static int count_building(void *user, const char *what, double share)
{
    int *left = user;
    BETWEEN(0, share, 1);
    return strcmp(what, "building") == 0 && --*left == 0;
}

/* A parametric surface tells of its pieces as they are halved, and no more are after it is cancelled. */
static void preparing_a_patch_can_be_cancelled(void **state)
{
    (void)state;
    const int MANY = 1 << 20;
    int left = MANY;
    const kage_load_options all = {.threads = 1, .progress = count_building, .user = &left};
    kage_scene_free(parse_with(WILD, NULL, &all));
    const int calls = MANY - left;
    CHECK(calls, >=, 64);
    for (int at = 1; at <= calls; at += calls / 3) {
        kage_scene *s = NULL;
        const kage_load_options o = {.threads = 1, .progress = count_building, .user = &left};
        left = at;
        assert_int_equal(kage_scene_parse(WILD, strlen(WILD), "w", NULL, &o, &s, NULL), KAGE_CANCELLED);
        assert_int_equal(left, 0);
    }
}

static void wrong_options_are_named(void **state)
{
    (void)state;
    kage_scene *s;
    kage_errors *e;
    const kage_load_options o = {.threads = -1};
    assert_int_equal(kage_scene_parse(GROUND, strlen(GROUND), NULL, NULL, &o, &s, &e), KAGE_BAD_OPTION);
    assert_non_null(strstr(kage_errors_get(e, 0)->text, "threads"));
    kage_errors_free(e);
}

static void the_methods_are_listed(void **state)
{
    (void)state;
    CHECK(kage_method_count(), >=, 8);
    assert_string_equal(kage_method_get(0).name, "none");
    assert_null(kage_method_get(kage_method_count()).name);
    assert_true(kage_method_is_known("iter:4"));
    assert_true(kage_method_is_known("bump"));
    assert_false(kage_method_is_known("bump:1"));
    assert_false(kage_method_is_known("iter:0"));
    assert_string_equal(kage_version(), KAGE_VERSION);
}

/* Where this system has such a locale; its name is not the same everywhere. */
static void a_decimal_comma_changes_nothing(void **state)
{
    (void)state;
    static const char *const names[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "nl_NL.UTF-8"};
    const char *set = NULL;
    for (size_t k = 0; !set && k < sizeof names / sizeof *names; k++)
        set = setlocale(LC_NUMERIC, names[k]);
    if (!set)
        skip();
    kage_scene *s = parse(GROUND);
    NEAR(kage_scene_get_info(s)->objects[1].height[1], 0.1, 1e-3);
    assert_string_equal(setlocale(LC_NUMERIC, NULL), set);
    setlocale(LC_NUMERIC, "C");
    kage_scene_free(s);
}

/* Each limit has a field of its own, whose built-in value is taken, and one more is not. */
static void limits_are_listed_and_checked(void **state)
{
    (void)state;
    assert_null(kage_limit_get(-1).name);
    assert_null(kage_limit_get(kage_limit_count()).name);
    for (int k = 0; k < kage_limit_count(); k++) {
        const kage_limit of = kage_limit_get(k);
        for (int64_t more = 0; more <= 1; more++) {
            kage_limits l = {0};
            *(int64_t *)((char *)&l + of.offset) = of.most + more;
            const kage_load_options o = {.limits = &l};
            kage_scene *s = NULL;
            kage_errors *e = NULL;
            const kage_status status = kage_scene_parse(GROUND, strlen(GROUND), NULL, NULL, &o, &s, &e);
            assert_int_equal(status, more ? KAGE_BAD_OPTION : KAGE_OK);
            if (more)
                assert_non_null(strstr(kage_errors_get(e, 0)->text, of.name));
            kage_scene_free(s);
            kage_errors_free(e);
        }
        for (int j = 0; j < k; j++)
            assert_true(kage_limit_get(j).offset != of.offset);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_error_has_its_place),
        cmocka_unit_test(all_errors_are_found_at_once),
        cmocka_unit_test(an_error_of_a_change_is_in_that_change),
        cmocka_unit_test(a_file_that_is_not_there_is_an_error_without_a_place),
        cmocka_unit_test(errors_need_not_be_asked_for),
        cmocka_unit_test(a_text_is_read_to_its_size_and_not_farther),
        cmocka_unit_test(changes_are_made),
        cmocka_unit_test(files_are_found_in_the_folder),
        cmocka_unit_test(the_scene_says_what_is_in_it),
        cmocka_unit_test(the_scene_says_where_the_camera_and_the_bumps_are),
        cmocka_unit_test(layers_have_names),
        cmocka_unit_test(a_model_needs_its_reader),
        cmocka_unit_test(a_reader_that_breaks_down_is_an_error_of_the_scene),
        cmocka_unit_test(a_model_is_read),
        cmocka_unit_test(reading_can_be_cancelled),
        cmocka_unit_test(preparing_a_patch_can_be_cancelled),
        cmocka_unit_test(wrong_options_are_named),
        cmocka_unit_test(limits_are_listed_and_checked),
        cmocka_unit_test(the_methods_are_listed),
        cmocka_unit_test(a_decimal_comma_changes_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
