/* What events make of the state: the eye, the lights, the bumps, the methods, the split line. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "look/keys.h"
#include "look/orbit.h"
#include "look/state.h"

/* A scene as kage.h tells of it: the eye 5 before the origin, two lights, a bump, a copy with it, a smooth object. */
static const kage_light_info lights[] = {{.name = "lamp", .at = {0, 4, -3}}, {.name = "sun", .at = {9, 9, 0}}};
static const kage_object_info objects[] = {{.name = "ground", .bump_of = "ground", .bump_scale = 0.2},
                                           {.name = "leaf", .bump_of = "stone"},
                                           {.name = "stone", .bump_of = "stone", .bump_scale = 1},
                                           {.name = "cube"}};
static const kage_scene_info scene = {.width = 400,
                                      .height = 300,
                                      .method = "0",
                                      .bump_shadow = "none",
                                      .light_count = 2,
                                      .object_count = 4,
                                      .lights = lights,
                                      .objects = objects,
                                      .camera = {.eye = {0, 0, -5}, .up = {0, 1, 0}, .fov = 90}};

static view_state started(void)
{
    view_state v;
    view_start(&v, 400, 300);
    return v;
}

static unsigned give(view_state *v, view_event e) { return view_take(v, &scene, "", &e); }

static unsigned key(view_state *v, int k) { return give(v, (view_event){.kind = EVENT_KEY, .key = k}); }

/* Press at 100,100, move by dx, dy, release. */
static unsigned drag(view_state *v, int button, bool shift, int dx, int dy)
{
    give(v, (view_event){.kind = EVENT_PRESS, .x = 100, .y = 100, .button = button, .shift = shift});
    const unsigned asked = give(v, (view_event){.kind = EVENT_MOVE, .x = 100 + dx, .y = 100 + dy, .shift = shift});
    give(v, (view_event){.kind = EVENT_RELEASE, .x = 100 + dx, .y = 100 + dy, .button = button});
    return asked;
}

#define NEAR(x, to) assert_true(fabs((x) - (to)) < 1e-9)

static void a_drag_turns_the_eye(void **state)
{
    (void)state;
    view_state v = started();
    assert_true(drag(&v, 1, false, 200, 0) & ASK_PICTURE); /* a quarter of a turn: the eye goes to the left */
    NEAR(v.look.from[0], -5);
    NEAR(v.look.from[1], 0);
    NEAR(v.look.from[2], 0);
    assert_true(v.look.moved);
    drag(&v, 1, false, 0, 100); /* downwards: the eye goes up */
    NEAR(v.look.from[1], 5 * sin(0.25 * 3.14159265358979323846));
    NEAR(orbit_distance(v.look.from, v.look.at), 5);
    drag(&v, 1, false, 0, 100000); /* and keeps away from the axis */
    NEAR(v.look.from[1], 5 * sin(89 * 3.14159265358979323846 / 180));
}

static void a_motion_without_a_button_turns_nothing(void **state)
{
    (void)state;
    view_state v = started();
    assert_false(give(&v, (view_event){.kind = EVENT_MOVE, .x = 10, .y = 20}) & ASK_PICTURE);
    assert_false(v.look.moved);
    assert_true(v.over);
    give(&v, (view_event){.kind = EVENT_MOVE, .x = 10, .y = 300}); /* on the bar */
    assert_false(v.over);
}

static void the_eye_moves_sideways_with_the_picture(void **state)
{
    (void)state;
    view_state v = started();
    drag(&v, 3, false, 40, 20); /* of 400 pixels, which are 10 units wide there */
    NEAR(v.look.at[0], -1);
    NEAR(v.look.at[1], 0.5);
    NEAR(v.look.from[0], -1);
    NEAR(v.look.from[2], -5);
}

static void shift_drag_moves_the_chosen_light(void **state)
{
    (void)state;
    view_state v = started();
    drag(&v, 1, true, 200, 0);
    assert_int_equal(v.look.lights, 1);
    assert_string_equal(v.look.light[0].name, "lamp");
    NEAR(v.look.light[0].at[0], 3); /* from the front to the right */
    NEAR(v.look.light[0].at[1], 4);
    assert_false(v.look.moved);
    key(&v, KEY_TAB);
    drag(&v, 1, true, 10, 0);
    assert_string_equal(v.look.light[1].name, "sun");
    drag(&v, 1, true, 10, 0);
    assert_int_equal(v.look.lights, 2);
}

static void the_wheel_scales_the_bump_under_the_mouse_or_all(void **state)
{
    (void)state;
    view_state v = started();
    const view_event up = {.kind = EVENT_WHEEL, .notches = 2};
    view_take(&v, &scene, "stone", &up);
    assert_int_equal(v.look.bumps, 1);
    assert_string_equal(v.look.bump[0].name, "stone");
    assert_int_equal(v.look.bump[0].notches, 2);
    view_take(&v, &scene, "", &up);
    assert_int_equal(v.look.bumps, 2); /* the copy's is its original's */
    assert_int_equal(v.look.bump[0].notches, 4);
    assert_string_equal(v.look.bump[1].name, "ground");
}

static void the_wheel_with_ctrl_comes_nearer(void **state)
{
    (void)state;
    view_state v = started();
    give(&v, (view_event){.kind = EVENT_WHEEL, .notches = 1, .ctrl = true});
    NEAR(v.look.from[2], -5 / VIEW_NOTCH);
    give(&v, (view_event){.kind = EVENT_WHEEL, .notches = -1, .ctrl = true});
    NEAR(v.look.from[2], -5);
    give(&v, (view_event){.kind = EVENT_WHEEL, .notches = 1, .shift = true});
    NEAR(v.look.light[0].at[1], 4 / VIEW_NOTCH);
}

static void keys_choose_methods(void **state)
{
    (void)state;
    static const struct {
        int key;
        const char *name;
    } methods[] = {{'n', "none"}, {'0', "0"}, {'1', "1"}, {'2', "2"}, {'m', "march:8"}, {'a', "auto"}, {'e', "exact"}};
    view_state v = started();
    for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
        assert_true(key(&v, methods[k].key) & ASK_PICTURE);
        assert_string_equal(v.look.shadow, methods[k].name);
        assert_true(kage_method_is_known(v.look.shadow));
    }
}

static void a_held_key_shows_none(void **state)
{
    (void)state;
    view_state v = started();
    key(&v, '2');
    key(&v, 'c');
    assert_string_equal(v.look.shadow, "none");
    give(&v, (view_event){.kind = EVENT_KEY_UP, .key = 'c'});
    assert_string_equal(v.look.shadow, "2");
    key(&v, 'c');
    key(&v, '1'); /* chosen meanwhile: it is for afterwards */
    assert_string_equal(v.look.shadow, "none");
    give(&v, (view_event){.kind = EVENT_KEY_UP, .key = 'c'});
    assert_string_equal(v.look.shadow, "1");
}

static void settings_toggle_from_what_the_scene_has(void **state)
{
    (void)state;
    view_state v = started();
    key(&v, 's');
    assert_string_equal(v.look.shade, "shifted");
    key(&v, 's');
    assert_string_equal(v.look.shade, "smooth");
    key(&v, 'b');
    assert_string_equal(v.look.own, KAGE_RELIEF_BUMP_SHADOW);
    key(&v, 'b');
    assert_string_equal(v.look.own, "none");
    kage_scene_info other = scene;
    other.bump_shadow = "horizon";
    other.shifted = other.displaced = 1;
    const view_event s = {.kind = EVENT_KEY, .key = 's'}, b = {.kind = EVENT_KEY, .key = 'b'},
                     d = {.kind = EVENT_KEY, .key = 'd'};
    v = started();
    view_take(&v, &other, "", &s);
    view_take(&v, &other, "", &b);
    view_take(&v, &other, "", &d);
    assert_string_equal(v.look.shade, "smooth");
    assert_string_equal(v.look.own, "none");
    assert_string_equal(v.look.surface, "smooth");
    view_take(&v, &other, "", &b);
    assert_string_equal(v.look.own, "horizon");
}

static void space_splits_the_picture(void **state)
{
    (void)state;
    view_state v = started();
    key(&v, ' ');
    assert_string_equal(v.look.beside, "none");
    give(&v, (view_event){.kind = EVENT_KEY, .key = '1', .shift = true});
    assert_string_equal(v.look.beside, "1");
    assert_string_equal(v.look.shadow, "");
    key(&v, ' ');
    assert_string_equal(v.look.beside, "");
}

static void r_takes_all_back(void **state)
{
    (void)state;
    view_state v = started(), first = started();
    drag(&v, 1, false, 10, 10);
    drag(&v, 1, true, 10, 10);
    give(&v, (view_event){.kind = EVENT_WHEEL, .notches = 1});
    key(&v, '2');
    key(&v, ' ');
    key(&v, 'l');
    assert_true(memcmp(&v.look, &first.look, sizeof v.look) != 0);
    key(&v, 'r');
    assert_memory_equal(&v.look, &first.look, sizeof v.look);
}

static void escape_closes_the_help_first(void **state)
{
    (void)state;
    view_state v = started();
    key(&v, 'h');
    assert_true(v.help);
    assert_false(key(&v, KEY_ESCAPE) & ASK_QUIT);
    assert_false(v.help);
    assert_true(key(&v, KEY_ESCAPE) & ASK_QUIT);
    assert_true(key(&v, 'q') & ASK_QUIT);
    assert_int_equal(key(&v, 'p'), ASK_SAVE);
    assert_int_equal(key(&v, KEY_RELOAD), ASK_RELOAD);
    assert_int_equal(key(&v, 'z'), 0);
}

static void no_light_and_no_bump_are_no_harm(void **state)
{
    (void)state;
    view_state v = started();
    kage_scene_info empty = scene;
    empty.light_count = empty.object_count = 0;
    for (int k = 0; k < view_key_count; k++)
        for (int shift = 0; shift < 2; shift++) {
            const view_event e = {.kind = EVENT_KEY, .key = view_keys[k].key, .shift = shift};
            view_take(&v, &empty, "", &e);
        }
    const view_event wheel = {.kind = EVENT_WHEEL, .notches = 1, .shift = true};
    view_take(&v, &empty, "", &wheel);
    assert_int_equal(v.look.lights + v.look.bumps, 0);
}

static void every_key_is_in_the_help(void **state)
{
    (void)state;
    for (int k = 0; k < view_key_count; k++) {
        const int c = view_keys[k].key;
        bool told = c <= ' ' || c >= 256 || c == '+' || c == '/' || c == '='; /* by a word, or the same as another */
        for (int j = 0; j < view_key_count && !told; j++)
            told = view_keys[j].name && strchr(view_keys[j].name, c);
        if (!told)
            fail_msg("no help tells of %c", c);
        if (view_keys[k].help && strlen(view_keys[k].help) > 60) /* the panel of 74 columns cuts it */
            fail_msg("the help of %s is too long", view_keys[k].name);
        for (int j = 0; j < k; j++)
            if (c && view_keys[j].key == c)
                fail_msg("%c is there twice", c);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_drag_turns_the_eye),
        cmocka_unit_test(a_motion_without_a_button_turns_nothing),
        cmocka_unit_test(the_eye_moves_sideways_with_the_picture),
        cmocka_unit_test(shift_drag_moves_the_chosen_light),
        cmocka_unit_test(the_wheel_scales_the_bump_under_the_mouse_or_all),
        cmocka_unit_test(the_wheel_with_ctrl_comes_nearer),
        cmocka_unit_test(keys_choose_methods),
        cmocka_unit_test(a_held_key_shows_none),
        cmocka_unit_test(settings_toggle_from_what_the_scene_has),
        cmocka_unit_test(space_splits_the_picture),
        cmocka_unit_test(r_takes_all_back),
        cmocka_unit_test(escape_closes_the_help_first),
        cmocka_unit_test(no_light_and_no_bump_are_no_harm),
        cmocka_unit_test(every_key_is_in_the_help),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
