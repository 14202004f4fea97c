/* Memory that runs out, at every place in turn: loading, rendering and writing a scene of each kind. The n-th request
 * of the library fails; then there is an error, KAGE_NO_MEMORY, nothing crashes, and all that was given out is back.
 *
 * The linker puts the functions below in the place of malloc and its like for our own objects (--wrap, see the
 * Makefile); other libraries keep theirs. A request that only makes a piece smaller may fail without any harm.
 */
#include "unit/api/scenes.h"

#include <errno.h>
#include <unistd.h>

/* The linker makes these names. */
/* NOLINTBEGIN(bugprone-reserved-identifier) */
void *__real_malloc(size_t size);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *p, size_t size);
int __real_posix_memalign(void **p, size_t align, size_t size);
char *__real_strdup(const char *text);
void __real_free(void *p);
struct fy_node;
struct fy_document;
struct fy_node *__real_fy_node_build_from_malloc_string(struct fy_document *to, char *text, size_t size);
struct fy_node *__wrap_fy_node_build_from_malloc_string(struct fy_document *to, char *text, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_realloc(void *p, size_t size);
int __wrap_posix_memalign(void **p, size_t align, size_t size);
char *__wrap_strdup(const char *text);
void __wrap_free(void *p);

enum { MOST = 1 << 14 };
static long request, fails_at; /* 0: none fails */
static void *live[MOST];
static int lives;

static int fails(void)
{
    const int now = fails_at && ++request == fails_at;
    if (now)
        errno = ENOMEM;
    return now;
}

static void *give(void *p)
{
    if (p && fails_at && lives < MOST)
        live[lives++] = p;
    return p;
}

/* What is not ours, as realpath's, is not in the list. */
static void take(const void *p)
{
    for (int k = lives - 1; p && k >= 0; k--)
        if (live[k] == p) {
            live[k] = live[--lives];
            return;
        }
}

void *__wrap_malloc(size_t size) { return fails() ? NULL : give(__real_malloc(size)); }

void *__wrap_calloc(size_t n, size_t size) { return fails() ? NULL : give(__real_calloc(n, size)); }

void *__wrap_realloc(void *p, size_t size)
{
    if (fails())
        return NULL;
    void *q = __real_realloc(p, size);
    if (q) {
        take(p);
        give(q);
    }
    return q;
}

int __wrap_posix_memalign(void **p, size_t align, size_t size)
{
    const int error = fails() ? ENOMEM : __real_posix_memalign(p, align, size);
    if (!error)
        give(*p);
    return error;
}

char *__wrap_strdup(const char *text) { return fails() ? NULL : give(__real_strdup(text)); }

void __wrap_free(void *p)
{
    take(p);
    __real_free(p);
}

/* The text becomes the document's. */
struct fy_node *__wrap_fy_node_build_from_malloc_string(struct fy_document *to, char *text, size_t size)
{
    take(text);
    return __real_fy_node_build_from_malloc_string(to, text, size);
}

/* NOLINTEND(bugprone-reserved-identifier) */

/* What a scene is read with, and a change that is made of it; NULL: none. */
static const kage_load_options *arrays;
static const char *change;

/* Change a scene, render both by what must be read again, and write its text. Returns the step. */
static const char *change_it(kage_scene *s, const char *path, kage_status *status, kage_errors **e)
{
    kage_scene *t = NULL;
    kage_film *f = NULL;
    const kage_load_options o = {.sets = (const char *[]){"camera.fov=30", change}, .set_count = 2};
    const kage_render_options exact = {.threads = 1, .method = "exact", .width = 8, .height = 8};
    const char *step = "change";
    *status = kage_scene_change(s, &o, &t, e);
    if (*status == KAGE_OK) {
        step = "render what is changed";
        *status = kage_render(t, &exact, &f, e);
    }
    if (*status == KAGE_OK) {
        step = "write the text";
        *status = kage_scene_write(t, path, e);
    }
    kage_film_free(f);
    kage_scene_free(t);
    return step;
}

static const char *work_on(const char *text, const kage_render_options *o, const char *path, kage_status *status)
{
    kage_scene *s = NULL;
    kage_film *f = NULL;
    kage_errors *e = NULL;
    const char *step = "load";
    char png[64], exr[64];
    snprintf(png, sizeof png, "%s.png", path);
    snprintf(exr, sizeof exr, "%s.exr", path);
    kage_load_options one = arrays ? *arrays : (kage_load_options){0};
    one.threads = 1;
    const kage_write_options write = {.threads = 1, .band = 16};
    *status = kage_scene_parse(text, strlen(text), "m", KAGE_TESTS_DIR "/../scenes/data", &one, &s, &e);
    if (*status == KAGE_OK) {
        step = "render";
        *status = kage_render(s, o, &f, &e);
    }
    for (int k = 0; *status == KAGE_OK && k < 2; k++) {
        step = k ? "write an EXR" : "write a PNG";
        *status = kage_film_write(f, k ? exr : png, &write, &e);
    }
    if (*status == KAGE_OK) {
        step = "write in bands";
        *status = kage_render_file(s, o, exr, &write, NULL, &e);
    }
    if (*status == KAGE_OK) {
        step = "join bands";
        *status = kage_file_join((const char *const[]){exr}, 1, exr, NULL, &e);
        /* OpenEXR 3.1 reads a text as empty where there is no memory for it: the band then seems to be none, or
         * another's. */
        if (*status == KAGE_BAD_INPUT && strstr(kage_errors_get(e, 0)->text, ": it "))
            *status = KAGE_NO_MEMORY;
    }
    if (*status == KAGE_OK) {
        step = "export";
        *status = kage_scene_write_povray(s, path, NULL, NULL, &e);
    }
    if (*status == KAGE_OK && change)
        step = change_it(s, path, status, &e);
    if (*status != KAGE_OK && *status != KAGE_NO_MEMORY)
        print_error("%s\n", kage_errors_get(e, 0)->message);
    if (*status != KAGE_OK && kage_errors_count(e) == 0)
        step = "say why";
    unlink(png);
    unlink(exr);
    kage_errors_free(e);
    kage_film_free(f);
    kage_scene_free(s);
    return step;
}

/* `stride`: every how many requests one is tried; the first 100 all are. */
static void each_fails(const char *text, const kage_render_options *o, long stride)
{
    char path[] = "/tmp/kage-memory-XXXXXX";
    const int fd = mkstemp(path);
    assert_true(fd >= 0);
    long n = 1;
    kage_status status = KAGE_NO_MEMORY;
    int reached = 1;
    for (; reached; n += n < 100 ? 1 : stride) {
        request = 0;
        lives = 0;
        fails_at = n;
        const char *step = work_on(text, o, path, &status);
        const int left = lives;
        reached = request >= n;
        fails_at = 0;
        if (left)
            fail_msg("request %ld: %d pieces of memory are not freed, in: %s", n, left, step);
        if (status != KAGE_OK && status != KAGE_NO_MEMORY)
            fail_msg("request %ld failed, and status %d came of it, in: %s", n, status, step);
    }
    assert_true(n > 20);
    close(fd);
    unlink(path);
}

static const kage_render_options plain = {
    .threads = 1, .layers = 1, .aa = 2, .aa_threshold = 0.1, .width = 16, .height = 12};
static const kage_render_options truth = {.threads = 1, .displaced = KAGE_YES, .width = 16, .height = 12};

static void of_functions(void **state)
{
    (void)state;
    each_fails(GROUND, &plain, 1);
}

static void of_maps(void **state)
{
    (void)state;
    each_fails(WITH_MAP, &plain, 1);
}

static void of_changes(void **state)
{
    (void)state;
    change = "objects.ball.bump.scale=0.2";
    each_fails(WITH_MAP, &plain, 3);
    change = NULL;
}

static void of_arrays(void **state)
{
    (void)state;
    static const uint8_t sample[4] = {0, 200, 100, 255};
    static const double at[9] = {0, 0, 0, 1, 0, 0, 0, 0, 1};
    static const uint32_t corner[3] = {0, 2, 1};
    static const kage_image_array h = {"h", 2, 2, 1, KAGE_U8, sample};
    static const kage_mesh_array m = {"m", 3, 1, at, at, at, corner};
    static const char *const set[] = {"objects.ball.bump.map.file=\"array:h\"",
                                      "objects.flat={mesh: {file: \"array:m\"}, material: clay}"};
    const kage_load_options o = {
        .sets = set, .set_count = 2, .images = &h, .image_count = 1, .meshes = &m, .mesh_count = 1};
    arrays = &o;
    each_fails(WITH_MAP, &plain, 3);
    arrays = NULL;
}

static void of_displaced_surfaces(void **state)
{
    (void)state;
    each_fails(GROUND, &truth, 1);
}

static void of_parametric_surfaces(void **state)
{
    (void)state;
    each_fails(PARAMETRIC, &truth, 7);
}

static void of_models(void **state)
{
    (void)state;
    each_fails(MODEL, &plain, 7);
}

/* Opaque copies in two materials and transparent ones in two: three crowds, and four objects of one list. */
static void of_lists(void **state)
{
    static const char scene[] = "camera: {from: [0.5, 3, -5], at: [0, 0, 0], fov: 40}\n"
                                "lights:\n"
                                "  lamp: {at: [-4, 5, -2], color: [1, 1, 1]}\n"
                                "materials:\n"
                                "  clay: {color: [0.8, 0.7, 0.6]}\n"
                                "  tiles: {color: {checker: {even: [0, 0, 1], odd: [1, 0, 0], size: [0.5, 0.5]}}}\n"
                                "  glass: {filter: 0.9, ior: 1.3}\n"
                                "  water: {filter: 0.8, ior: 1.1}\n"
                                "objects:\n"
                                "  ball: {sphere: {center: [0, 1, 0], radius: 0.4}, material: clay, hidden: true}\n"
                                "  balls: {copies: {of: ball, file: %s}}\n"
                                "  egg: {copy: ball, transform: [{scale: [1, 2, 1]}, {rotate: [20, 0, 0]}]}\n";
    char path[] = "/tmp/kage-list-XXXXXX", text[sizeof scene + sizeof path];
    const int fd = mkstemp(path);
    FILE *f = fd >= 0 ? fdopen(fd, "w") : NULL;
    (void)state;
    assert_non_null(f);
    fputs("x,y,z,material\n0,0,0,clay\n1,0,0,tiles\n-1,0,0,glass\n0,0,1,water\n1,0,1,\n", f);
    fclose(f);
    snprintf(text, sizeof text, scene, path);
    each_fails(text, &plain, 1);
    unlink(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(of_changes),
        cmocka_unit_test(of_arrays),
        cmocka_unit_test(of_functions),
        cmocka_unit_test(of_maps),
        cmocka_unit_test(of_displaced_surfaces),
        cmocka_unit_test(of_parametric_surfaces),
        cmocka_unit_test(of_models),
        cmocka_unit_test(of_lists),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
