/* kage.h: height maps, images and models in memory make the pictures that files of the same numbers make. */
#include "unit/api/scenes.h"

#include "image/image.h"

#include <unistd.h>

#define DATA KAGE_TESTS_DIR "/../scenes/data"

#define BALL(file)                                                                                                     \
    HEAD "  ball:\n"                                                                                                   \
         "    sphere: {center: [0, 0, 0], radius: 1.4}\n"                                                              \
         "    material: clay\n"                                                                                        \
         "    bump: {map: {" file "}, repeat: [2, 1], scale: 0.1, zero: 0.5, sign: up}\n"

#define IMAGE(file)                                                                                                    \
    "camera: {from: [0.5, 3, -5], at: [0, 0, 0], fov: 40}\n"                                                           \
    "image: {size: [48, 32]}\n"                                                                                        \
    "lights: {lamp: {at: [-4, 5, -2], color: [1, 1, 1]}}\n"                                                            \
    "materials: {skin: {color: {image: {file: '" file "', size: [3, 2]}}, diffuse: 0.9}}\n"                            \
    "objects: {ground: {plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: skin}}\n"

#define SHAPE(file)                                                                                                    \
    HEAD "  model: {mesh: {file: '" file "'}, material: clay, bump: {function: 0.02*sin(40*u)*sin(30*w)}}\n"

/* The samples of one channel, or four values a pixel: the caller frees them. */
typedef struct samples {
    int width, height;
    float *v;
} samples;

static const char *begin(void *user, int width, int height)
{
    *(samples *)user = (samples){width, height, malloc((size_t)width * (size_t)height * sizeof(float))};
    return NULL;
}

static void take(void *user, int x, int y, int n, const float *v)
{
    const samples *s = user;
    memcpy(s->v + y * s->width + x, v, (size_t)n * sizeof *v);
}

static samples samples_of(const char *path, const char *channel)
{
    samples s;
    float range[2];
    errors e = {0};
    assert_true(image_read(path, channel, 1, NULL, &(image_taker){&s, begin, take}, range, &e));
    return s;
}

static kage_scene *scene_with(const char *text, const kage_image_array *a)
{
    return parse_with(text, DATA, &(kage_load_options){.images = a, .image_count = a ? 1 : 0});
}

/* By the scene's method and by one for which it is read again. */
static void same_pictures(kage_scene *a, kage_scene *b)
{
    static const kage_render_options all[] = {{.layers = 1, .width = 24, .height = 16},
                                              {.layers = 1, .width = 24, .height = 16, .method = "exact"}};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        kage_film *f = render_with(a, &all[k]), *g = render_with(b, &all[k]);
        assert_true(same_films(f, g));
        kage_film_free(f);
        kage_film_free(g);
    }
    kage_scene_free(a);
    kage_scene_free(b);
}

static void whole_numbers_are_as_a_png(void **state)
{
    (void)state;
    const samples s = samples_of(DATA "/bumps.png", NULL);
    const size_t n = (size_t)s.width * (size_t)s.height;
    uint16_t *one = malloc(n * sizeof *one), *two = malloc(2 * n * sizeof *two);
    for (size_t k = 0; k < n; k++) {
        one[k] = two[2 * k] = (uint16_t)(s.v[k] * 65535 + 0.5f);
        two[2 * k + 1] = 77; /* alpha */
    }
    for (int channels = 1; channels <= 2; channels++) {
        const kage_image_array a = {"h", s.width, s.height, channels, KAGE_U16, channels == 1 ? one : two};
        same_pictures(scene_with(BALL("file: 'array:h'"), &a), scene_with(BALL("file: bumps.png"), NULL));
    }
    free(s.v);
    free(one);
    free(two);
}

static void floats_are_as_an_exr(void **state)
{
    (void)state;
    const samples s = samples_of(DATA "/jacksboro.exr", "elevation");
    const size_t n = (size_t)s.width * (size_t)s.height;
    double *wide = malloc(n * sizeof *wide);
    for (size_t k = 0; k < n; k++)
        wide[k] = (double)s.v[k];
    const char *const sets[] = {"objects.ball.bump.scale=0.0003", "objects.ball.bump.zero=531"};
    for (int k = 0; k < 2; k++) {
        const kage_image_array a = {"h", s.width, s.height, 1, k ? KAGE_F64 : KAGE_F32, k ? (void *)wide : s.v};
        const kage_load_options in_memory = {.sets = sets, .set_count = 2, .images = &a, .image_count = 1},
                                file = {.sets = sets, .set_count = 2};
        same_pictures(parse_with(BALL("file: 'array:h'"), DATA, &in_memory),
                      parse_with(BALL("file: jacksboro.exr, channel: elevation"), DATA, &file));
    }
    free(s.v);
    free(wide);
}

static void colours_are_as_a_png_or_an_exr(void **state)
{
    (void)state;
    kage_scene *s = parse(GROUND);
    kage_film *f = render_with(s, &(kage_render_options){.layers = 1});
    const size_t n = pixels_of(f);
    uint8_t *rgba = malloc(4 * n), *rgb = malloc(3 * n);
    float *linear = malloc(3 * n * sizeof *linear);
    assert_int_equal(kage_film_srgb(f, rgba, 0, 1), KAGE_OK);
    for (size_t k = 0; k < n; k++)
        for (size_t c = 0; c < 3; c++) {
            rgb[3 * k + c] = rgba[4 * k + c];
            linear[3 * k + c] = kage_film_plane(f, (const char *[]){"R", "G", "B"}[c])[k];
        }
    assert_int_equal(kage_film_write(f, DATA "/kage_test_colours.png", NULL, NULL), KAGE_OK);
    assert_int_equal(kage_film_write(f, DATA "/kage_test_colours.exr", NULL, NULL), KAGE_OK);
    const kage_image_array all[] = {
        {"c", 48, 32, 3, KAGE_U8, rgb}, {"c", 48, 32, 4, KAGE_U8, rgba}, {"c", 48, 32, 3, KAGE_F32, linear}};
    for (int k = 0; k < 3; k++)
        same_pictures(scene_with(IMAGE("array:c"), &all[k]), k < 2 ? scene_with(IMAGE("kage_test_colours.png"), NULL)
                                                                   : scene_with(IMAGE("kage_test_colours.exr"), NULL));
    unlink(DATA "/kage_test_colours.png");
    unlink(DATA "/kage_test_colours.exr");
    kage_film_free(f);
    kage_scene_free(s);
    free(rgba);
    free(rgb);
    free(linear);
}

/* ---- models ---- */

enum { ACROSS = 9, VERTICES = ACROSS * ACROSS, TRIANGLES = 2 * (ACROSS - 1) * (ACROSS - 1) };

/* A bent sheet with texture coordinates, and normals if asked for. */
typedef struct sheet {
    double at[3 * VERTICES], normal[3 * VERTICES], uv[2 * VERTICES];
    uint32_t corner[3 * TRIANGLES];
    kage_mesh_array a;
} sheet;

static void make_sheet(sheet *s, int normals)
{
    int n = 0;
    for (int y = 0; y < ACROSS; y++)
        for (int x = 0; x < ACROSS; x++, n++) {
            const double u = x / (ACROSS - 1.0), v = y / (ACROSS - 1.0);
            const double at[3] = {3 * u - 1.5, 0.25 * (u * u + v), 1.5 - 3 * v}, normal[3] = {-0.125 * u, 1, 0.0625};
            memcpy(s->at + 3 * n, at, sizeof at);
            memcpy(s->normal + 3 * n, normal, sizeof normal);
            s->uv[2 * n] = u;
            s->uv[2 * n + 1] = v;
        }
    n = 0;
    for (uint32_t y = 0; y + 1 < ACROSS; y++)
        for (uint32_t x = 0; x + 1 < ACROSS; x++, n += 6) {
            const uint32_t k = y * ACROSS + x, two[6] = {k, k + 1, k + ACROSS + 1, k, k + ACROSS + 1, k + ACROSS};
            memcpy(s->corner + n, two, sizeof two);
        }
    s->a = (kage_mesh_array){"m", VERTICES, TRIANGLES, s->at, normals ? s->normal : NULL, s->uv, s->corner};
}

static void write_ply(const sheet *s, const char *path)
{
    FILE *f = fopen(path, "w");
    fprintf(f, "ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n%s",
            VERTICES, s->a.normals ? "property float nx\nproperty float ny\nproperty float nz\n" : "");
    fprintf(f, "property float u\nproperty float v\nelement face %d\nproperty list uchar int vertex_indices\n",
            TRIANGLES);
    fprintf(f, "end_header\n");
    for (int k = 0; k < VERTICES; k++) {
        const double *p = s->at + 3 * k, *n = s->normal + 3 * k;
        fprintf(f, "%.9g %.9g %.9g ", p[0], p[1], p[2]);
        if (s->a.normals)
            fprintf(f, "%.9g %.9g %.9g ", n[0], n[1], n[2]);
        fprintf(f, "%.9g %.9g\n", s->uv[2 * k], s->uv[2 * k + 1]);
    }
    for (int k = 0; k < TRIANGLES; k++)
        fprintf(f, "3 %u %u %u\n", s->corner[3 * k], s->corner[3 * k + 1], s->corner[3 * k + 2]);
    fclose(f);
}

static void write_obj(const sheet *s, const char *path)
{
    FILE *f = fopen(path, "w");
    for (int k = 0; k < VERTICES; k++) {
        fprintf(f, "v %.9g %.9g %.9g\n", s->at[3 * k], s->at[3 * k + 1], s->at[3 * k + 2]);
        fprintf(f, "vt %.9g %.9g\n", s->uv[2 * k], s->uv[2 * k + 1]);
        if (s->a.normals)
            fprintf(f, "vn %.9g %.9g %.9g\n", s->normal[3 * k], s->normal[3 * k + 1], s->normal[3 * k + 2]);
    }
    for (int k = 0; k < TRIANGLES; k++) {
        fprintf(f, "f");
        for (int c = 0; c < 3; c++) {
            const uint32_t i = s->corner[3 * k + c] + 1;
            fprintf(f, s->a.normals ? " %u/%u/%u" : " %u/%u", i, i, i);
        }
        fprintf(f, "\n");
    }
    fclose(f);
}

static void meshes_are_as_models(void **state)
{
    (void)state;
    sheet s;
    for (int normals = 0; normals < 2; normals++) {
        make_sheet(&s, normals);
        write_ply(&s, DATA "/kage_test_model.ply");
        write_obj(&s, DATA "/kage_test_model.obj");
        for (int obj = 0; obj < 2; obj++)
            same_pictures(parse_with(SHAPE("array:m"), DATA, &(kage_load_options){.meshes = &s.a, .mesh_count = 1}),
                          obj ? scene_with(SHAPE("kage_test_model.obj"), NULL)
                              : scene_with(SHAPE("kage_test_model.ply"), NULL));
        unlink(DATA "/kage_test_model.ply");
        unlink(DATA "/kage_test_model.obj");
    }
}

/* ---- what is wrong ---- */

static void fails_by(const char *text, const kage_load_options *o, kage_status status, int line, const char *words)
{
    kage_scene *s = NULL;
    kage_errors *e = NULL;
    assert_int_equal(kage_scene_parse(text, strlen(text), "test.yaml", NULL, o, &s, &e), status);
    assert_null(s);
    const kage_error *first = kage_errors_get(e, 0);
    if (!strstr(first->text, words))
        fail_msg("'%s' does not say '%s'", first->text, words);
    assert_int_equal(first->line, line);
    kage_errors_free(e);
}

static void wrong_arrays_are_errors(void **state)
{
    (void)state;
    static const float nan_at_3[4] = {0, 1, 2, NAN};
    static const double place[9] = {0, 0, 0, 1, 0, 0, 0, 0, 1};
    static const uint32_t corner[3] = {0, 1, 3};
    const kage_image_array good = {"h", 2, 2, 1, KAGE_F32, place}, nan = {"h", 2, 2, 1, KAGE_F32, nan_at_3};
    const kage_image_array thin = {"h", 1, 4, 1, KAGE_F32, place}, three = {"h", 2, 2, 3, KAGE_U8, place};
    const kage_image_array bad[] = {{"", 2, 2, 1, KAGE_F32, place},   {"a b", 2, 2, 1, KAGE_F32, place},
                                    {NULL, 2, 2, 1, KAGE_F32, place}, {"h", 0, 2, 1, KAGE_F32, place},
                                    {"h", 2, 2, 5, KAGE_F32, place},  {"h", 2, 2, 1, (kage_type)7, place},
                                    {"h", 2, 2, 1, KAGE_F32, NULL},   {"h", 70000, 2, 1, KAGE_F32, place}};
    const kage_mesh_array beyond = {"m", 3, 1, place, NULL, NULL, corner},
                          empty = {"m", 3, 0, place, NULL, NULL, corner};
    const kage_image_array twice[2] = {good, good};
    const char *const map = BALL("file: 'array:h'");
#define IMAGES(a, n) (&(kage_load_options){.images = (a), .image_count = (n)})
#define MESHES(a, n) (&(kage_load_options){.meshes = (a), .mesh_count = (n)})
    fails_by(map, NULL, KAGE_BAD_INPUT, 12, "no array 'h' of samples");
    fails_by(BALL("file: 'array:k'"), IMAGES(&good, 1), KAGE_BAD_INPUT, 12, "expected one of: h");
    fails_by(SHAPE("array:h"), IMAGES(&good, 1), KAGE_BAD_INPUT, 9, "no array 'h' of a model");
    fails_by(map, IMAGES(&nan, 1), KAGE_BAD_INPUT, 12, "the sample in column 1 of row 1 (both from 0) is NaN");
    fails_by(map, IMAGES(&thin, 1), KAGE_BAD_INPUT, 12, "expected at least 2 x 2");
    fails_by(map, IMAGES(&three, 1), KAGE_BAD_INPUT, 12, "3 channels");
    fails_by(BALL("file: 'array:h', channel: Y"), IMAGES(&good, 1), KAGE_BAD_INPUT, 12, "no named channels");
    fails_by(SHAPE("array:m"), MESHES(&beyond, 1), KAGE_BAD_INPUT, 9, "has the vertex 3, expected 0 to 2");
    fails_by(SHAPE("array:m"), MESHES(&empty, 1), KAGE_BAD_OPTION, 0, "0 triangles");
    fails_by(map, IMAGES(twice, 2), KAGE_BAD_OPTION, 0, "two images 'h'");
    fails_by(map, IMAGES(NULL, 1), KAGE_BAD_OPTION, 0, "no list");
    fails_by(map, IMAGES(&good, -1), KAGE_BAD_OPTION, 0, "-1 images");
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
        fails_by(map, IMAGES(&bad[k], 1), KAGE_BAD_OPTION, 0, "image");
}

static void an_array_is_no_file(void **state)
{
    (void)state;
    static const uint8_t sample[8] = {0, 200, 100, 255, 7, 8, 9, 10};
    const kage_image_array h = {"h", 2, 2, 1, KAGE_U8, sample}, c = {"c", 2, 2, 2, KAGE_U8, sample};
    kage_scene *s = scene_with(BALL("file: 'array:h'"), &h);
    kage_errors *e = NULL;
    assert_false(kage_scene_uses_file(s, "array:h"));
    assert_string_equal(kage_scene_get_info(s)->objects[1].map, "array:h");
    assert_int_equal(kage_scene_write_povray(s, "kage_test.pov", NULL, NULL, NULL), KAGE_OK); /* as triangles */
    unlink("kage_test.pov");
    kage_scene_free(s);
    static const uint8_t grey[8] = {0, 255, 200, 255, 100, 255, 255, 255};
    const kage_image_array opaque = {"c", 2, 2, 2, KAGE_U8, grey};
    s = scene_with(IMAGE("array:c"), &opaque);
    assert_int_equal(kage_scene_write_povray(s, "kage_test.pov", NULL, NULL, &e), KAGE_BAD_INPUT);
    assert_non_null(strstr(kage_errors_get(e, 0)->text, "array:c"));
    kage_errors_free(e);
    kage_scene_free(s);
    fails_by(IMAGE("array:c"), IMAGES(&c, 1), KAGE_BAD_INPUT, 4, "is transparent");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(whole_numbers_are_as_a_png),     cmocka_unit_test(floats_are_as_an_exr),
        cmocka_unit_test(colours_are_as_a_png_or_an_exr), cmocka_unit_test(meshes_are_as_models),
        cmocka_unit_test(wrong_arrays_are_errors),        cmocka_unit_test(an_array_is_no_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
