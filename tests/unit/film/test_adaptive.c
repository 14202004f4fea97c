/* Where more samples are taken: at pixels that look different from a neighbour. */
#include "support/check.h"
#include "film/adaptive.h"
#include "scene/scene.h"

#include <stdlib.h>

/* Marks of a film of 5 x 4 pixels, black, with one grey pixel in column 2 of row 1. */
static unsigned char *marks(float grey, double threshold, window part, int threads)
{
    static const scene none = {.lights = 0};
    errors e = {0};
    film *f = film_new(&none, (window){0, 0, 5, 4}, false, 1, NULL, NULL, &e);
    assert_non_null(f);
    for (int k = FILM_R; k <= FILM_B; k++)
        f->plane[k][5 + 2] = grey;
    unsigned char *found = adaptive_find(f, part, threshold, threads, NULL, &e);
    film_free(f);
    assert_non_null(found);
    return found;
}

static void the_pixel_and_its_neighbours(void **state)
{
    static const unsigned char want[20] = {0, 0, 1, 0, 0, 0, 1, 1, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0};
    (void)state;
    unsigned char *found = marks(1, 0.1, (window){0, 0, 5, 4}, 1);
    assert_memory_equal(found, want, sizeof want);
    memory_free(found);
}

/* In a crop neighbours beyond its edge count, as they are on the film. */
static void across_a_crop(void **state)
{
    (void)state;
    unsigned char *found = marks(1, 0.1, (window){0, 2, 5, 4}, 1);
    CHECK(found[2], ==, 1); /* below the grey pixel, which is not in the crop */
    CHECK(found[1], ==, 0);
    memory_free(found);
}

/* Linear 0.2158 is 0.5 as displayed: the sum over three colours is 1.5. */
static void threshold_is_of_displayed_sums(void **state)
{
    (void)state;
    unsigned char *below = marks(0.2158f, 1.49, (window){0, 0, 5, 4}, 1);
    unsigned char *above = marks(0.2158f, 1.51, (window){0, 0, 5, 4}, 1);
    CHECK(below[7], ==, 1);
    CHECK(above[7], ==, 0);
    memory_free(below);
    memory_free(above);
}

static void same_by_any_threads(void **state)
{
    (void)state;
    unsigned char *one = marks(0.5f, 0.1, (window){0, 0, 5, 4}, 1), *three = marks(0.5f, 0.1, (window){0, 0, 5, 4}, 3);
    assert_memory_equal(one, three, 20);
    memory_free(one);
    memory_free(three);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_pixel_and_its_neighbours),
        cmocka_unit_test(across_a_crop),
        cmocka_unit_test(threshold_is_of_displayed_sums),
        cmocka_unit_test(same_by_any_threads),
    };
    return cmocka_run_group_tests_name("adaptive", tests, NULL, NULL);
}
