/* kage.h from several threads of one process at once: scenes of their own, one scene that all share, and a scene that
 * the first of them has read again. Every film has the bytes that it has alone. Run under ThreadSanitizer, too: built
 * with OPENMP=no, as that does not see the barriers of OpenMP's library.
 */
#include "unit/api/scenes.h"

#include <pthread.h>

enum { THREADS = 6 };

typedef struct work {
    kage_scene *shared;
    int number, good;
    kage_film *film; /* of the shared scene */
} work;

static const kage_render_options kinds[] = {
    {.method = "2", .threads = 2},
    {.method = "exact", .threads = 1},
    {.displaced = KAGE_YES, .threads = 1},
};
enum { KINDS = sizeof kinds / sizeof *kinds };

/* No cmocka in here: it knows one thread. */
static void *use(void *user)
{
    work *k = user;
    kage_scene *own = NULL;
    kage_film *film = NULL;
    kage_probe *probe = NULL;
    kage_errors *wrong = NULL;
    k->good = kage_scene_parse(PARAMETRIC, strlen(PARAMETRIC), "own", NULL, NULL, &own, NULL) == KAGE_OK &&
              kage_render(own, &kinds[0], &film, NULL) == KAGE_OK &&
              kage_render(k->shared, &kinds[k->number % KINDS], &k->film, NULL) == KAGE_OK &&
              kage_scene_probe(k->shared, 24, 30, &probe, NULL) == KAGE_OK;
    kage_scene *none = NULL;
    k->good = k->good && kage_scene_parse("objects: [", 10, NULL, NULL, NULL, &none, &wrong) == KAGE_BAD_INPUT &&
              kage_errors_count(wrong) == 1;
    kage_errors_free(wrong);
    kage_probe_free(probe);
    kage_film_free(film);
    kage_scene_free(own);
    return NULL;
}

static void threads_share_a_scene(void **state)
{
    (void)state;
    pthread_t thread[THREADS];
    work all[THREADS];
    kage_scene *s = parse(GROUND);
    for (int k = 0; k < THREADS; k++) {
        all[k] = (work){.shared = s, .number = k};
        assert_int_equal(pthread_create(&thread[k], NULL, use, &all[k]), 0);
    }
    for (int k = 0; k < THREADS; k++)
        assert_int_equal(pthread_join(thread[k], NULL), 0);
    for (int k = 0; k < THREADS; k++) {
        assert_true(all[k].good);
        kage_scene *alone = parse(GROUND);
        kage_film *want = render_with(alone, &kinds[k % KINDS]);
        assert_true(same_films(all[k].film, want));
        kage_film_free(all[k].film);
        kage_film_free(want);
        kage_scene_free(alone);
    }
    kage_scene_free(s);
}

/* Change after change of a scene that all share, rendered by a method for which each is read again. */
static void *use_changes(void *user)
{
    enum { STEPS = 4 };
    static const char *const sets[STEPS] = {"camera.fov=30", "objects.ground.bump.scale=0.2", "render.aa=2",
                                            "objects.ground.bump.scale=0.1"};
    work *k = user;
    kage_scene *s = k->shared;
    for (int i = 0; k->good && i < STEPS; i++) {
        kage_scene *t = NULL;
        const kage_load_options o = {.sets = &sets[(i + k->number) % STEPS], .set_count = 1};
        k->good = kage_scene_change(s, &o, &t, NULL) == KAGE_OK;
        if (s != k->shared)
            kage_scene_free(s);
        s = t;
        const kage_render_options r = {
            .method = k->number % 2 ? "exact" : "0", .threads = 1, .reuse = k->film, .width = 24, .height = 16};
        k->good = k->good && kage_scene_get_info(s)->text && kage_render(s, &r, &k->film, NULL) == KAGE_OK &&
                  kage_scene_get_info(k->shared)->text;
    }
    kage_scene_free(s == k->shared ? NULL : s);
    return NULL;
}

static void threads_change_a_scene(void **state)
{
    (void)state;
    pthread_t thread[THREADS];
    work all[THREADS];
    const char *const set = "objects.ground.bump.scale=0.5";
    kage_scene *s = parse_with(GROUND, NULL, &(kage_load_options){.sets = &set, .set_count = 1, .threads = 1});
    for (int k = 0; k < THREADS; k++) {
        all[k] = (work){.shared = s, .number = k, .good = 1};
        assert_int_equal(pthread_create(&thread[k], NULL, use_changes, &all[k]), 0);
    }
    for (int k = 0; k < THREADS; k++) {
        assert_int_equal(pthread_join(thread[k], NULL), 0);
        assert_true(all[k].good);
        kage_film_free(all[k].film);
    }
    kage_scene_free(s);
}

static void *read_model(void *user)
{
    kage_scene *s = NULL;
    *(int *)user = (int)kage_scene_parse(MODEL, strlen(MODEL), "m", KAGE_TESTS_DIR "/../scenes/data", NULL, &s, NULL);
    kage_scene_free(s);
    return NULL;
}

static void threads_read_models(void **state)
{
    (void)state;
    pthread_t thread[THREADS];
    int status[THREADS];
    for (int k = 0; k < THREADS; k++)
        assert_int_equal(pthread_create(&thread[k], NULL, read_model, &status[k]), 0);
    for (int k = 0; k < THREADS; k++)
        assert_int_equal(pthread_join(thread[k], NULL), 0);
    for (int k = 0; k < THREADS; k++)
        assert_int_equal(status[k], KAGE_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(threads_share_a_scene),
        cmocka_unit_test(threads_change_a_scene),
        cmocka_unit_test(threads_read_models),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
