/* Where a map lies: by its size, or by how often it goes into the surface. */
#include "read/parts.h"
#include "support/reading.h"

static const double U[2] = {-1, 3}, W[2] = {2, 5}, ENDLESS[2] = {-HUGE_VAL, HUGE_VAL};

/* The layout of a text on a surface of 4 by 3; the error it must have. */
static map_layout layout_of(const char *text, const double u[2], const double w[2], const char *error)
{
    reading *t = reading_of(text);
    map_layout l = {.size = {1, 1}};
    assert_int_equal(reader_layout(&t->r, yaml_root(t->r.y), u, w, &l), !error);
    reading_told(t, error);
    reading_end(t);
    return l;
}

static void without_a_size_it_covers_the_surface(void **state)
{
    const map_layout l = layout_of("{}\n", U, W, NULL);
    (void)state;
    NEAR(l.offset[0], -1, 0);
    NEAR(l.offset[1], 2, 0);
    NEAR(l.size[0], 4, 0);
    NEAR(l.size[1], 3, 0);
}

static void repeat_divides_the_surface(void **state)
{
    const map_layout l = layout_of("repeat: [8, 2]\n", U, W, NULL);
    (void)state;
    NEAR(l.size[0], 0.5, 0);
    NEAR(l.size[1], 1.5, 0);
}

static void size_is_in_u_and_w(void **state)
{
    const map_layout l = layout_of("size: [0.25, 7]\n", U, W, NULL);
    (void)state;
    NEAR(l.size[0], 0.25, 0);
    NEAR(l.size[1], 7, 0);
}

static void offset_counts_from_the_surfaces_beginning(void **state)
{
    const map_layout l = layout_of("offset: [0.5, -0.25]\n", U, W, NULL);
    (void)state;
    NEAR(l.offset[0], -0.5, 0);
    NEAR(l.offset[1], 1.75, 0);
}

static void on_an_endless_surface_offset_counts_from_0(void **state)
{
    const map_layout l = layout_of("size: [2, 2]\noffset: [0.5, -0.25]\n", ENDLESS, ENDLESS, NULL);
    (void)state;
    NEAR(l.offset[0], 0.5, 0);
    NEAR(l.offset[1], -0.25, 0);
}

static void an_endless_surface_needs_a_size(void **state)
{
    (void)state;
    layout_of("{}\n", ENDLESS, ENDLESS, "a map on an unbounded surface, expected 'size: [in u, in w]'");
}

static void size_and_repeat_exclude_each_other(void **state)
{
    (void)state;
    layout_of("size: [1, 1]\nrepeat: [2, 2]\n", U, W, ":2:9: both 'size' and 'repeat'");
}

static void wrap_and_samples_are_words(void **state)
{
    const map_layout l = layout_of("wrap: mirror\nsamples: corners\n", U, W, NULL);
    (void)state;
    assert_int_equal(l.wrap, MAP_MIRROR);
    assert_true(l.corners);
}

static void another_word_is_refused(void **state)
{
    (void)state;
    layout_of("wrap: tile\n", U, W, ":1:7: ");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_a_size_it_covers_the_surface),
        cmocka_unit_test(repeat_divides_the_surface),
        cmocka_unit_test(size_is_in_u_and_w),
        cmocka_unit_test(offset_counts_from_the_surfaces_beginning),
        cmocka_unit_test(on_an_endless_surface_offset_counts_from_0),
        cmocka_unit_test(an_endless_surface_needs_a_size),
        cmocka_unit_test(size_and_repeat_exclude_each_other),
        cmocka_unit_test(wrap_and_samples_are_words),
        cmocka_unit_test(another_word_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
