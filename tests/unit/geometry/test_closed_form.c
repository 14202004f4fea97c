/* What closed forms are said to be: their table, and moving them to the origin. */
#include <string.h>

#include "geometry/closed_form.h"
#include "support/check.h"

static void no_two_forms_have_one_name(void **state)
{
    (void)state;
    for (int i = 0; i < CLOSED_FORM_COUNT; i++)
        for (int k = 0; k < i; k++)
            assert_string_not_equal(closed_forms[i]->name, closed_forms[k]->name);
}

static void names_are_in_the_order_of_the_table(void **state)
{
    char names[256] = "";
    (void)state;
    for (int k = 0; k < CLOSED_FORM_COUNT; k++) {
        strcat(names, closed_forms[k]->name);
        strcat(names, " ");
    }
    assert_string_equal(CLOSED_FORM_NAMES, names);
}

/* What shape_centred and the exports rely on. */
static void each_form_has_one_place_or_two_ends(void **state)
{
    (void)state;
    for (int k = 0; k < CLOSED_FORM_COUNT; k++) {
        int places = 0;
        for (const form_parameter *p = closed_forms[k]->parameters; p->key; p++)
            places += p->type == FORM_PLACE;
        BETWEEN(1, places, 2);
    }
}

static void a_shape_with_one_place_is_centred_there(void **state)
{
    const shape_values v = {.v = {{1, 2, 3}}, .r = {0.5}};
    vec3 middle;
    const shape_values c = shape_centred(&form_sphere, &v, &middle);
    (void)state;
    NEAR(middle.y, 2, 0);
    NEAR(c.v[0].y, 0, 0);
    NEAR(c.r[0], 0.5, 0);
}

static void a_shape_with_two_ends_is_centred_between_them(void **state)
{
    const shape_values v = {.v = {{1, 2, 3}, {1, 6, 3}}, .r = {0.5}};
    vec3 middle;
    const shape_values c = shape_centred(&form_cylinder, &v, &middle);
    (void)state;
    NEAR(middle.y, 4, 0);
    NEAR(c.v[0].y, -2, 0);
    NEAR(c.v[1].y, 2, 0);
}

static void capped_shapes_have_no_formula(void **state)
{
    shape_values v = {.v = {{0, 0, 0}, {0, 1, 0}}, .r = {0.5, 0.25}};
    form_formula f;
    (void)state;
    assert_false(form_cone.formula(&v, &f));
    v.open = true;
    assert_true(form_cone.formula(&v, &f));
}

static void what_cannot_be_made_names_its_parameter(void **state)
{
    const shape_values thick = {.v = {{0, 0, 0}, {0, 1, 0}}, .r = {1, 2}};
    form_fault fault = {NULL, NULL};
    (void)state;
    assert_null(form_torus.make(&thick, &fault));
    assert_string_equal(fault.key, "minor");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_two_forms_have_one_name),
        cmocka_unit_test(names_are_in_the_order_of_the_table),
        cmocka_unit_test(each_form_has_one_place_or_two_ends),
        cmocka_unit_test(a_shape_with_one_place_is_centred_there),
        cmocka_unit_test(a_shape_with_two_ends_is_centred_between_them),
        cmocka_unit_test(capped_shapes_have_no_formula),
        cmocka_unit_test(what_cannot_be_made_names_its_parameter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
