/* kage.h: films as bytes for a screen, what their files say of them, and their memory used again. */
#include "unit/api/scenes.h"

#include "image/image.h"
#include "image/srgb.h"

#include <unistd.h>

static kage_film *film_of(const char *text, const kage_render_options *o)
{
    kage_scene *s = parse(text);
    kage_film *f = render_with(s, o);
    kage_scene_free(s);
    return f;
}

/* The bytes of the film's own PNG, 4 a pixel. The caller frees them. */
static uint8_t *png_bytes(const kage_film *f)
{
    image m;
    bool exr;
    errors e = {0};
    assert_int_equal(kage_film_write(f, "kage_test_film.png", NULL, NULL), KAGE_OK);
    assert_true(image_read_color("kage_test_film.png", IMAGE_LINEAR, 1, NULL, &m, &exr, &e));
    unlink("kage_test_film.png");
    uint8_t *bytes = malloc(4 * pixels_of(f));
    for (size_t k = 0; k < 4 * pixels_of(f); k++)
        bytes[k] = (uint8_t)(m.v[k] * 255 + 0.5f);
    memory_free(m.v);
    return bytes;
}

static void the_screen_has_the_bytes_of_a_png(void **state)
{
    (void)state;
    for (int threads = 0; threads < 4; threads++) {
        const kage_render_options o = {.width = 301, .height = 203, .threads = 2};
        kage_film *f = film_of(GROUND, &o);
        uint8_t *png = png_bytes(f), *rgba = malloc(4 * pixels_of(f)), *wide = malloc(203 * 1300);
        assert_int_equal(kage_film_srgb(f, rgba, 0, threads), KAGE_OK);
        assert_memory_equal(rgba, png, 4 * pixels_of(f));
        memset(wide, 7, 203 * 1300);
        assert_int_equal(kage_film_srgb(f, wide, 1300, threads), KAGE_OK);
        for (int y = 0; y < 203; y++) {
            assert_memory_equal(wide + 1300 * y, png + 4 * 301 * y, 4 * 301);
            for (int k = 4 * 301; k < 1300; k++)
                assert_int_equal(wide[1300 * y + k], 7);
        }
        assert_int_equal(kage_film_srgb(f, rgba, 4 * 301 - 1, threads), KAGE_BAD_OPTION);
        assert_int_equal(kage_film_srgb(f, rgba, 0, -1), KAGE_BAD_OPTION);
        free(png);
        free(rgba);
        free(wide);
        kage_film_free(f);
    }
}

/* Every float that matters: around each threshold, and what is no colour. */
static void both_encoders_agree(void **state)
{
    (void)state;
    enum { N = 1 << 16 };
    srgb *s = srgb_create(8);
    float *x = malloc(N * sizeof *x);
    uint16_t *code = malloc(N * sizeof *code);
    uint8_t *rgba = malloc(4 * N);
    for (int k = 0; k < N; k++) {
        const uint32_t bits = (uint32_t)k << 16 | ((uint32_t)k * 40503u & 0xffffu);
        memcpy(&x[k], &bits, sizeof bits); /* negative, infinite, NaN too */
    }
    for (int pass = 0; pass < 2; pass++) {
        srgb_encode(s, N, x, code);
        srgb_encode_rgba(s, N, x, x, x, rgba);
        for (int k = 0; k < N; k++) {
            assert_int_equal(rgba[4 * k], code[k]);
            assert_int_equal(rgba[4 * k + 2], code[k]);
            assert_int_equal(rgba[4 * k + 3], 255);
        }
        for (int k = 0; k < N; k++)
            x[k] = (float)k / N * 1.01f;
    }
    free(s);
    free(x);
    free(code);
    free(rgba);
}

static const char *value_of(const kage_film *f, const char *name)
{
    for (int k = 0; k < kage_film_metadata_count(f); k++)
        if (strcmp(kage_film_metadata(f, k).name, name) == 0)
            return kage_film_metadata(f, k).value;
    return NULL;
}

static void a_film_says_what_its_files_say(void **state)
{
    (void)state;
    const char *const sets[] = {"render.aa=2", "objects.ground.bump.scale=2"};
    kage_scene *s = parse_with(GROUND, NULL, &(kage_load_options){.sets = sets, .set_count = 2});
    kage_film *f = render_with(s, &(kage_render_options){.method = "2+", .crop = {3, 4, 20, 30}});
    kage_scene_free(s);
    assert_string_equal(value_of(f, "kage:file"), "test.yaml");
    assert_string_equal(value_of(f, "kage:scene"), GROUND);
    assert_string_equal(value_of(f, "kage:set"), "render.aa=2\nobjects.ground.bump.scale=2\nrender.shadow=2+");
    assert_string_equal(value_of(f, "kage:crop"), "3,4,20,30");
    assert_string_equal(value_of(f, "kage:shadow"), "2+");
    assert_string_equal(value_of(f, "kage:guard"), "yes");
    assert_null(kage_film_metadata(f, kage_film_metadata_count(f)).name);
    assert_null(kage_film_metadata(f, -1).value);
    char read[2000];
    assert_int_equal(kage_film_write(f, "kage_test_film.png", NULL, NULL), KAGE_OK);
    FILE *png = fopen("kage_test_film.png", "rb");
    const size_t n = fread(read, 1, sizeof read, png);
    fclose(png);
    unlink("kage_test_film.png");
    for (int k = 0; k < kage_film_metadata_count(f); k++) { /* tEXt: the key, a 0, the text */
        const kage_metadata m = kage_film_metadata(f, k);
        const size_t key = strlen(m.name) + 1, value = strlen(m.value);
        size_t at = 0;
        while (at + key + value <= n &&
               (memcmp(read + at, m.name, key) != 0 || memcmp(read + at + key, m.value, value) != 0))
            at++;
        assert_true(at + key + value <= n);
    }
    kage_film_free(f);
}

/* Films of other sizes and layers, one after another, with the bytes that new ones have. */
static void memory_is_used_again(void **state)
{
    (void)state;
    static const kage_render_options all[] = {
        {.layers = 1, .width = 64, .height = 64},
        {.width = 60, .height = 64},
        {.layers = 1, .width = 50, .height = 50},
        {.width = 200, .height = 100, .aa = 2},
        {.width = 20, .height = 10},
        {.width = 20, .height = 12, .layers = 1},
        {.width = 20, .height = 12, .aa = 3, .aa_threshold = 0.1},
    };
    kage_scene *s = parse(GROUND);
    kage_film *f = NULL;
    int shared = 0;
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        kage_render_options o = all[k];
        kage_film *fresh = render_with(s, &o);
        const float *before = f ? kage_film_plane(f, "R") : NULL;
        o.reuse = f;
        f = render_with(s, &o);
        shared += kage_film_plane(f, "R") == before;
        assert_true(same_films(f, fresh));
        kage_film_free(fresh);
    }
    assert_int_equal(shared, 4); /* all but where there is no room, or far too much */
    assert_int_equal(kage_render(s, &(kage_render_options){.aa = -1, .reuse = f}, &f, NULL), KAGE_BAD_OPTION);
    assert_null(f); /* valgrind and the sanitizers tell that it is freed */
    kage_scene_free(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_screen_has_the_bytes_of_a_png),
        cmocka_unit_test(both_encoders_agree),
        cmocka_unit_test(a_film_says_what_its_files_say),
        cmocka_unit_test(memory_is_used_again),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
