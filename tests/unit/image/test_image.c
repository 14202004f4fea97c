/* Image files: what is written reads back, what is damaged is refused, what fails leaves nothing behind. */
#define _XOPEN_SOURCE 700

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <dirent.h>
#include <fcntl.h>
#include <math.h>
#include <openexr.h>
#include <png.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "image/image.h"
#include "image/srgb.h"
#include "support/check.h"
#include "support/image_whole.h"

enum { WIDTH = 37, HEIGHT = 23, SAMPLES = WIDTH * HEIGHT }; /* as in tests/data */

static char folder[] = "/tmp/kage-test-image-XXXXXX";

/* ------------------------------------------------------------------------------------------------ helpers */

typedef image_writer *opener(const char *path, const image_form *form, errors *e);

/* Write a picture of up to 4 planes whole, `band` rows at a time. */
static bool write_by(opener *open, const char *path, const image_form *form, int band, const float *const *plane,
                     errors *e)
{
    image_writer *w = open(path, form, e);
    bool good = w != NULL;
    for (int y = 0, rows; good && y < form->height; y += rows) {
        const float *row[4];
        for (int c = 0; c < form->channels; c++)
            row[c] = plane[c] + (size_t)y * (size_t)form->width;
        rows = form->height - y < band ? form->height - y : band;
        assert_int_equal(image_writer_rows(w), y);
        good = image_writer_add(w, rows, row, NULL);
    }
    return w && image_writer_close(w, true, e);
}

static bool png_of(const char *path, int width, int height, int bits, const float *const *plane, int texts,
                   const image_text *text, errors *e)
{
    const image_form form = {
        .width = width, .height = height, .channels = 3, .bits = bits, .texts = texts, .text = text};
    return write_by(image_writer_png, path, &form, height, plane, e);
}

static const char *in_folder(const char *name)
{
    static char path[16][512]; /* a test holds fewer at a time */
    static int turn;
    char *p = path[turn++ % 16];
    snprintf(p, sizeof path[0], "%s/%s", folder, name);
    return p;
}

static const char *in_data(const char *name)
{
    static char path[512];
    snprintf(path, sizeof path, "%s/data/%s", KAGE_TESTS_DIR, name);
    return path;
}

static int files_in_folder(void)
{
    int n = 0;
    DIR *dir = opendir(folder);
    assert_non_null(dir);
    for (struct dirent *d; (d = readdir(dir)) != NULL;)
        n += strcmp(d->d_name, ".") != 0 && strcmp(d->d_name, "..") != 0;
    closedir(dir);
    return n;
}

static unsigned char *slurp(const char *path, size_t *size)
{
    FILE *f = fopen(path, "rb");
    assert_non_null(f);
    unsigned char *bytes = malloc(1 << 20);
    assert_non_null(bytes);
    *size = fread(bytes, 1, 1 << 20, f);
    CHECK(*size, <, 1 << 20);
    fclose(f);
    return bytes;
}

/* Anew: where a file with bytes is cut and written again, ext4 waits for the disk. */
static void spill(const char *path, const void *bytes, size_t size)
{
    unlink(path);
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(bytes, 1, size, f), size);
    fclose(f);
}

static void assert_same_files(const char *a, const char *b)
{
    size_t m, n;
    unsigned char *p = slurp(a, &m), *q = slurp(b, &n);
    assert_int_equal(m, n);
    assert_memory_equal(p, q, n);
    free(p);
    free(q);
}

/* Reading must fail with one message, which contains `words`. */
static void assert_refused(const char *path, const char *channel, const char *words)
{
    image m;
    float range[2];
    errors e = {0};
    assert_false(image_whole(path, channel, 2, &m, range, &e));
    assert_int_equal(e.count, 1);
    if (!strstr(e.text, words))
        fail_msg("%s: \"%s\" does not say \"%s\"", path, e.text, words);
    assert_null(m.v);
    errors_free(&e);
}

static image read_well(const char *path, const char *channel)
{
    image m;
    float range[2], lo = INFINITY, hi = -INFINITY;
    errors e = {0};
    if (!image_whole(path, channel, 2, &m, range, &e))
        fail_msg("%s: %s", path, e.text);
    for (int i = 0; i < m.width * m.height; i++) {
        lo = fminf(lo, m.v[i]);
        hi = fmaxf(hi, m.v[i]);
    }
    CHECK(range[0], ==, lo);
    CHECK(range[1], ==, hi);
    assert_int_equal(e.count, 0);
    return m;
}

/* A damaged file may be read or refused, as the damage may be where no sample is; it must not crash, and a
 * refusal has one message. By one thread: thousands of files would start a second one each. */
static bool survives(const char *path)
{
    image m;
    float range[2];
    errors e = {0};
    bool ok = image_whole(path, NULL, 1, &m, range, &e);
    assert_int_equal(e.count, ok ? 0 : 1);
    assert_true(ok || e.size > 2);
    CHECK((m.v != NULL), ==, ok);
    free(m.v);
    errors_free(&e);
    return ok;
}

/* Every shorter file is refused; no changed byte does harm. */
static void maltreat(const char *path)
{
    size_t size;
    unsigned char *bytes = slurp(path, &size);
    const char *victim = in_folder("victim");
    for (size_t n = 0; n < size; n += n < 700 ? 1 : 37) {
        spill(victim, bytes, n);
        if (survives(victim))
            fail_msg("%s: read though cut to %zu of %zu bytes", path, n, size);
    }
    static const unsigned char flips[] = {0xff, 0x01, 0x80};
    for (size_t f = 0; f < sizeof flips; f++)
        for (size_t i = 0; i < size; i += i < 700 ? 1 : 11) {
            bytes[i] ^= flips[f];
            spill(victim, bytes, size);
            survives(victim);
            bytes[i] ^= flips[f];
        }
    unlink(victim);
    free(bytes);
}

/* ---------------------------------------------------------------------------------------------------- sRGB */

static long double srgb_reference(long double x)
{
    return x <= 0.0031308L ? 12.92L * x : 1.055L * powl(x, 1 / 2.4L) - 0.055L;
}

static unsigned code_of(const srgb *s, float x)
{
    uint16_t code;
    srgb_encode(s, 1, &x, &code);
    return code;
}

/* The code rises with x, so it is right everywhere if it steps from k-1 to k between the same two floats as
 * the reference: for every k these two are looked for by bisection and compared with the reference. */
static void srgb_steps_where_the_standard_does(void **state)
{
    (void)state;
    for (int bits = 8; bits <= 16; bits += 8) {
        srgb *s = srgb_create(bits);
        assert_non_null(s);
        const unsigned max = (1U << bits) - 1;
        for (unsigned k = 1; k <= max; k++) {
            float low = 0, high = 1;
            while (nextafterf(low, 1) < high) {
                float middle = low + (high - low) / 2;
                *(code_of(s, middle) < k ? &low : &high) = middle;
            }
            assert_int_equal(code_of(s, low), k - 1);
            assert_int_equal(code_of(s, high), k);
            assert_true(srgb_reference((long double)low) * max < k - 0.5L);
            assert_true(srgb_reference((long double)high) * max >= k - 0.5L);
        }
        free(s);
    }
}

static void srgb_rises_and_clamps(void **state)
{
    (void)state;
    for (int bits = 8; bits <= 16; bits += 8) {
        srgb *s = srgb_create(bits);
        assert_non_null(s);
        const unsigned max = (1U << bits) - 1;
        const float zero[] = {NAN, -NAN, -INFINITY, -1, -0.0f, 0, 1e-45f, 1e-30f};
        for (size_t i = 0; i < sizeof zero / sizeof *zero; i++)
            assert_int_equal(code_of(s, zero[i]), 0);
        const float one[] = {1, 1.0000001f, 2, 1e30f, INFINITY};
        for (size_t i = 0; i < sizeof one / sizeof *one; i++)
            assert_int_equal(code_of(s, one[i]), max);
        unsigned last = 0;
        for (uint32_t b = 0x33000000; b <= 0x3f800000; b += 61) { /* 2^-25 to 1 */
            float x;
            memcpy(&x, &b, sizeof x);
            unsigned code = code_of(s, x);
            BETWEEN(last, code, last + 1);
            last = code;
        }
        free(s);
    }
}

/* ----------------------------------------------------------------------------------------------------- PNG */

static void on_png_error(png_structp png, png_const_charp message)
{
    (void)png;
    fail_msg("libpng: %s", message); /* jumps out of the test */
    abort();
}

/* A PNG by libpng itself: samples are bytes as libpng takes them, bit_depth and colour type any. */
static void make_png(const char *path, int bits, int colour, int interlace, const unsigned char *bytes, size_t stride,
                     bool with_gamma)
{
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, on_png_error, NULL);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, f);
    png_set_IHDR(png, info, WIDTH, HEIGHT, bits, colour, interlace, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    static const png_color palette[2] = {{0, 0, 0}, {255, 255, 255}};
    if (colour == PNG_COLOR_TYPE_PALETTE)
        png_set_PLTE(png, info, palette, 2);
    if (with_gamma)
        png_set_gAMA(png, info, 0.45455);
    png_write_info(png, info);
    png_bytep rows[HEIGHT];
    for (int y = 0; y < HEIGHT; y++)
        rows[y] = (png_bytep)bytes + (size_t)y * stride;
    png_write_image(png, rows);
    png_write_end(png, NULL);
    png_destroy_write_struct(&png, &info);
    fclose(f);
}

static unsigned grey_of(int x, int y, unsigned max) { return (unsigned)(x * 1009 + y * 499) % (max + 1); }

static void png_grey_of_every_kind_reads_exactly(void **state)
{
    (void)state;
    const char *path = in_folder("grey.png");
    for (int bits = 1; bits <= 16; bits *= 2)
        for (int alpha = 0; alpha <= (bits >= 8); alpha++)
            for (int variant = 0; variant < 4; variant++) {
                const unsigned max = (1U << bits) - 1;
                static unsigned char bytes[HEIGHT][WIDTH * 4];
                memset(bytes, 0, sizeof bytes);
                for (int y = 0; y < HEIGHT; y++)
                    for (int x = 0; x < WIDTH; x++) {
                        unsigned v = grey_of(x, y, max);
                        unsigned char *at = &bytes[y][x * bits * (1 + alpha) / 8];
                        if (bits == 16) {
                            at[0] = (unsigned char)(v >> 8);
                            at[1] = (unsigned char)(v & 255);
                        } else
                            at[0] |= (unsigned char)(v << (8 - bits - x * bits % 8));
                        if (alpha)
                            at[bits / 8] = (unsigned char)(x * 7);
                    }
                make_png(path, bits, alpha ? PNG_COLOR_TYPE_GRAY_ALPHA : PNG_COLOR_TYPE_GRAY,
                         variant & 1 ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, bytes[0], sizeof bytes[0],
                         variant & 2);
                image m = read_well(path, NULL);
                assert_int_equal(m.width, WIDTH);
                assert_int_equal(m.height, HEIGHT);
                for (int y = 0; y < HEIGHT; y++)
                    for (int x = 0; x < WIDTH; x++)
                        CHECK(m.v[y * WIDTH + x], ==, (float)((double)grey_of(x, y, max) / max));
                free(m.v);
            }
    unlink(path);
}

/* Red, green and blue that are one grey are as good as a grey; so is a palette of greys. */
static void png_in_colour_is_read_if_it_is_grey(void **state)
{
    (void)state;
    static unsigned char bytes[HEIGHT][WIDTH * 4];
    const char *path = in_folder("other.png");
    for (int alpha = 0; alpha <= 1; alpha++) {
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH * (3 + alpha); x++)
                bytes[y][x] = (unsigned char)grey_of(x / (3 + alpha), y, 255);
        make_png(path, 8, alpha ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB, 0, bytes[0], sizeof bytes[0], false);
        image m = read_well(path, NULL);
        for (int k = 0; k < WIDTH * HEIGHT; k++)
            CHECK(m.v[k], ==, (float)((double)grey_of(k % WIDTH, k / WIDTH, 255) / 255));
        free(m.v);
        bytes[HEIGHT - 1][(3 + alpha) * (WIDTH - 1) + 1] ^= 1;
        make_png(path, 8, alpha ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB, 0, bytes[0], sizeof bytes[0], false);
        assert_refused(path, NULL, "in colour; a grey one is expected");
    }
    make_png(path, 1, PNG_COLOR_TYPE_PALETTE, 0, bytes[0], sizeof bytes[0], false);
    free(read_well(path, NULL).v);
    assert_int_equal(image_png_bits(path), 1);
    unlink(path);
    assert_int_equal(image_png_bits(path), 0);
}

/* Unit vectors around (0, 0, 1), as colours. */
static void normal_map_is_refused_as_one(void **state)
{
    (void)state;
    static unsigned char bytes[HEIGHT][WIDTH * 3];
    const char *path = in_folder("normals.png");
    for (int k = 0; k < WIDTH * HEIGHT; k++) {
        const double x = 0.4 * sin(k), y = 0.4 * cos(3 * k), v[3] = {x, y, sqrt(1 - x * x - y * y)};
        for (int c = 0; c < 3; c++)
            bytes[k / WIDTH][3 * (k % WIDTH) + c] = (unsigned char)(127.5 * (v[c] + 1) + 0.5);
    }
    make_png(path, 8, PNG_COLOR_TYPE_RGB, 0, bytes[0], sizeof bytes[0], false);
    assert_refused(path, NULL, "a normal map, which has slopes but no heights");
    unlink(path);
}

static void png_has_no_channels(void **state)
{
    (void)state;
    static const unsigned char bytes[HEIGHT][WIDTH];
    const char *path = in_folder("other.png");
    make_png(path, 8, PNG_COLOR_TYPE_GRAY, 0, bytes[0], sizeof bytes[0], false);
    assert_refused(path, "height", "no channel 'height'");
    unlink(path);
}

/* One row of R, G, B with all that matters: ends, out of range, NaN. */
static const float red[WIDTH] = {0, 1, 0.5f, NAN, -1, 2, 0.0031308f, 0.18f, INFINITY, -INFINITY};
static const float green[WIDTH] = {0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f, 0.7f, 0.8f, 0.9f, 1};
static const float blue[WIDTH] = {1e-4f, 1e-3f, 1e-2f, 1e-5f, 1e-6f};

static void png_holds_the_srgb_codes_and_texts(void **state)
{
    (void)state;
    const char *path = in_folder("rgb.png");
    const image_text text[] = {{"Software", "kage"}, {"Scene", "two\nlines"}, {"Title", "\xe5\xbd\xb1"}};
    for (int bits = 8; bits <= 16; bits += 8) {
        const unsigned max = (1U << bits) - 1;
        errors e = {0};
        assert_true(png_of(path, WIDTH, 1, bits, (const float *const[]){red, green, blue}, 3, text, &e));
        FILE *f = fopen(path, "rb");
        png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, on_png_error, NULL);
        png_infop info = png_create_info_struct(png);
        png_init_io(png, f);
        png_read_png(png, info, 0, NULL);
        assert_int_equal(png_get_image_width(png, info), WIDTH);
        assert_int_equal(png_get_image_height(png, info), 1);
        assert_int_equal(png_get_bit_depth(png, info), bits);
        assert_int_equal(png_get_color_type(png, info), PNG_COLOR_TYPE_RGB);
        assert_true(png_get_valid(png, info, PNG_INFO_sRGB));
        assert_false(png_get_valid(png, info, PNG_INFO_tIME));
        png_textp got;
        int texts;
        png_get_text(png, info, &got, &texts);
        assert_int_equal(texts, 3);
        for (int i = 0; i < 3; i++) {
            assert_string_equal(got[i].key, text[i].key);
            assert_string_equal(got[i].text, text[i].value);
        }
        assert_int_equal(got[1].compression, PNG_TEXT_COMPRESSION_NONE);
        assert_int_equal(got[2].compression, PNG_ITXT_COMPRESSION_NONE);
        png_bytep row = png_get_rows(png, info)[0];
        for (int x = 0; x < WIDTH; x++)
            for (int c = 0; c < 3; c++) {
                float v = (c == 0 ? red : c == 1 ? green : blue)[x];
                long double clamped = v > 0 ? v < 1 ? (long double)v : 1 : 0;
                unsigned expected = (unsigned)(srgb_reference(clamped) * max + 0.5L);
                int i = 3 * x + c;
                assert_int_equal(bits == 8 ? row[i] : row[2 * i] << 8 | row[2 * i + 1], expected);
            }
        png_destroy_read_struct(&png, &info, NULL);
        fclose(f);
    }
    unlink(path);
}

static void damaged_png_is_refused(void **state)
{
    (void)state;
    static unsigned char bytes[HEIGHT][WIDTH];
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            bytes[y][x] = (unsigned char)grey_of(x, y, 255);
    const char *path = in_folder("good.png");
    make_png(path, 8, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_ADAM7, bytes[0], sizeof bytes[0], true);
    maltreat(path);
    unlink(path);
}

/* The header of a PNG: signature and IHDR with its check sum, for sizes libpng would not write. */
static void huge_png_is_refused(void **state)
{
    (void)state;
    const char *path = in_folder("huge.png");
    static const uint32_t size[][2] = {{65537, 1}, {1, 65537}, {65536, 4097}, {0x7fffffff, 0x7fffffff}, {0, 5}};
    for (size_t i = 0; i < sizeof size / sizeof *size; i++) {
        unsigned char b[33] = "\x89PNG\r\n\x1a\n\0\0\0\rIHDR";
        for (int k = 0; k < 8; k++)
            b[16 + k] = (unsigned char)(size[i][k / 4] >> (24 - 8 * (k % 4)));
        b[24] = 8;
        uint32_t crc = ~0U;
        for (int k = 12; k < 29; k++) {
            crc ^= b[k];
            for (int j = 0; j < 8; j++)
                crc = crc >> 1 ^ (crc & 1 ? 0xedb88320U : 0);
        }
        for (int k = 0; k < 4; k++)
            b[29 + k] = (unsigned char)(~crc >> (24 - 8 * k));
        /* followed by an empty IDAT, so that the header counts as read */
        static const unsigned char empty[12] = {0, 0, 0, 0, 'I', 'D', 'A', 'T', 0x35, 0xaf, 0x06, 0x1e};
        unsigned char whole[45];
        memcpy(whole, b, 33);
        memcpy(whole + 33, empty, 12);
        spill(path, whole, sizeof whole);
        assert_refused(path, NULL, size[i][0] ? "too large" : "libpng");
    }
    unlink(path);
}

/* ----------------------------------------------------------------------------------------------------- EXR */

static float number_of(int x, int y) { return (float)((7 * x + 13 * y) % 64); }

static void assert_numbers(const char *name, const char *channel, float scale, float offset, float tolerance)
{
    image m = read_well(in_data(name), channel);
    assert_int_equal(m.width, WIDTH);
    assert_int_equal(m.height, HEIGHT);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            float expected = number_of(x, y) * scale + offset;
            if (!(fabsf(m.v[y * WIDTH + x] - expected) <= tolerance))
                fail_msg("%s: %g at %d, %d is not %g", name, (double)m.v[y * WIDTH + x], x, y, (double)expected);
        }
    free(m.v);
}

static void exr_of_every_kind_is_read(void **state)
{
    (void)state;
    static const char *const exact[] = {"half-no.exr",    "half-rle.exr",  "half-zips.exr", "half-piz.exr",
                                        "half-pxr24.exr", "float-piz.exr", "window.exr",    "window-tiled.exr",
                                        "upwards.exr",    "tiled.exr",     "mixed.exr"};
    for (size_t i = 0; i < sizeof exact / sizeof *exact; i++)
        assert_numbers(exact[i], NULL, 1 / 64.0f, 0, 0);
    static const char *const lossy[] = {"half-b44.exr", "half-b44a.exr"};
    for (size_t i = 0; i < sizeof lossy / sizeof *lossy; i++)
        assert_numbers(lossy[i], "Y", 1 / 64.0f, 0, 0.125f); /* blunt on steps so sharp */
    assert_numbers("uint.exr", NULL, 1, 0, 0);
    assert_numbers("mixed.exr", "id", 1, 0, 0);
    assert_numbers("mixed.exr", "A", 0, 0, 0);
    assert_numbers("mixed.exr", "Z", 1 / 64.0f, 1, 0);
    assert_numbers("tiled.exr", "Z", 1 / 64.0f, 1, 0);
}

/* An uncompressed file ends with its lines, each after 8 bytes of its own: every half is put there once. */
static void every_half_is_read_exactly(void **state)
{
    (void)state;
    size_t size;
    unsigned char *bytes = slurp(in_data("half-no.exr"), &size);
    const char *path = in_folder("halves.exr");
    unsigned char *lines = bytes + size - HEIGHT * (8 + 2 * WIDTH);
    for (unsigned first = 0; first < 65536; first += SAMPLES) {
        for (unsigned i = 0; i < SAMPLES; i++) {
            unsigned h = (first + i) & 0xffff;
            h = (h & 0x7c00) == 0x7c00 ? 0 : h; /* NaN and infinities are tried below */
            unsigned char *at = lines + i / WIDTH * (8 + 2 * WIDTH) + 8 + 2 * (i % WIDTH);
            at[0] = (unsigned char)(h & 255);
            at[1] = (unsigned char)(h >> 8);
        }
        spill(path, bytes, size);
        image m = read_well(path, NULL);
        for (unsigned i = 0; i < SAMPLES; i++) {
            unsigned h = (first + i) & 0xffff, e = h >> 10 & 31;
            double expected = e == 31 ? 0 : e ? ldexp(1 + (h & 1023) / 1024.0, (int)e - 15) : (h & 1023) / 16777216.0;
            expected = h & 0x8000 && e != 31 ? -expected : expected;
            CHECK(m.v[i], ==, expected);
        }
        free(m.v);
    }
    static const unsigned char end[][2] = {{0x7c, 0x00}, {0xfc, 0x00}, {0x7c, 0x01}, {0xfe, 0x00}};
    static const char *const told[] = {"is infinite", "is -infinite", "is NaN", "is NaN"};
    for (int i = 0; i < 4; i++) {
        lines[8] = end[i][1];
        lines[9] = end[i][0];
        spill(path, bytes, size);
        assert_refused(path, NULL, told[i]);
    }
    unlink(path);
    free(bytes);
}

static void exr_of_other_kinds_is_refused(void **state)
{
    (void)state;
    assert_refused(in_data("deep.exr"), NULL, "deep");
    assert_refused(in_data("parts.exr"), NULL, "several parts");
    assert_refused(in_data("nan.exr"), NULL, "column 3 of row 5 (both from 0) is NaN");
    assert_refused(in_data("mixed.exr"), "height", "no channel 'height'; the file has A, Y, Z, id");
    assert_refused(in_data("nan.exr"), "height", "no channel 'height'");

    /* 37 x 23 samples divide by 37 and 23 only; the sampling follows name, type and flags of the channel */
    size_t size;
    unsigned char *bytes = slurp(in_data("half-no.exr"), &size);
    const char *path = in_folder("subsampled.exr");
    unsigned char *sampling = bytes + 8 + sizeof "channels" + sizeof "chlist" + 4 + sizeof "Y" + 8;
    assert_int_equal(sampling[0], 1);
    sampling[0] = WIDTH;
    spill(path, bytes, size);
    assert_refused(path, NULL, "subsampled");
    unlink(path);
    free(bytes);
}

/* The samples, the range and the first of several errors are the same for any number of threads. */
static void threads_make_no_difference(void **state)
{
    (void)state;
    static const char *const files[] = {"tiled.exr", "half-zips.exr", "half-no.exr", "window-tiled.exr"};
    for (size_t k = 0; k < sizeof files / sizeof *files; k++) {
        image one, many;
        float range[2], same[2];
        errors e = {0};
        assert_true(image_whole(in_data(files[k]), NULL, 1, &one, range, &e));
        for (int threads = 2; threads < 9; threads++) {
            assert_true(image_whole(in_data(files[k]), NULL, threads, &many, same, &e));
            assert_memory_equal(one.v, many.v, SAMPLES * sizeof *one.v);
            assert_memory_equal(range, same, sizeof range);
            free(many.v);
        }
        free(one.v);
    }
    size_t size;
    unsigned char *bytes = slurp(in_data("half-no.exr"), &size);
    const char *path = in_folder("bad-lines.exr");
    unsigned char *lines = bytes + size - HEIGHT * (8 + 2 * WIDTH);
    for (int y = 3; y < HEIGHT; y++)
        lines[y * (8 + 2 * WIDTH) + 8 + 1] = 0x7c; /* infinite or NaN */
    lines[5 * (8 + 2 * WIDTH)] ^= 1;               /* the number of a line */
    spill(path, bytes, size);
    for (int threads = 1; threads < 9; threads++)
        for (int again = 0; again < 20; again++) {
            image m;
            float range[2];
            errors e = {0};
            assert_false(image_whole(path, NULL, threads, &m, range, &e));
            assert_non_null(strstr(e.text, "column 0 of row 3"));
            errors_free(&e);
        }
    unlink(path);
    free(bytes);
}

static void damaged_exr_is_refused(void **state)
{
    (void)state;
    maltreat(in_data("mixed.exr"));
    maltreat(in_data("tiled.exr"));
    maltreat(in_data("half-piz.exr"));
    maltreat(in_data("half-pxr24.exr"));
    maltreat(in_data("half-rle.exr"));
    maltreat(in_data("half-zips.exr"));
    maltreat(in_data("half-no.exr"));
}

/* A file of ZIP ends with a stream of zlib, whose last four bytes are a checksum of what is compressed. */
static void zip_of_other_samples_is_refused(void **state)
{
    (void)state;
    static const char *const files[] = {"uint.exr", "mixed.exr", "tiled.exr"};
    const char *path = in_folder("checksum.exr");
    for (size_t k = 0; k < sizeof files / sizeof *files; k++) {
        size_t size;
        unsigned char *bytes = slurp(in_data(files[k]), &size);
        for (size_t i = 1; i <= 4; i++) {
            bytes[size - i] ^= 1;
            spill(path, bytes, size);
            assert_refused(path, NULL, "decompress");
            bytes[size - i] ^= 1;
        }
        free(bytes);
    }
    unlink(path);
}

/* Floats of all exponents and signs, the same on every run. */
static void fill(float *v, uint32_t seed)
{
    for (int i = 0; i < SAMPLES; i++) {
        do {
            seed = seed * 1664525U + 1013904223U;
            memcpy(&v[i], &seed, sizeof *v);
        } while (!isfinite(v[i]));
    }
}

static float plane[4][SAMPLES];

/* Out of order, and one name longer than the 31 bytes of old. */
static const char *const plane_name[] = {"R", "N.X", "visibility.of-a-light-with-a-rather-long-name", "B"};
static const image_text plane_text[] = {{"software", "kage"},
                                        {"scene", "objects:\n  - \xe5\xbd\xb1\n"},
                                        {"a name of an attribute that is longer than 31", "x"},
                                        {"empty", ""}};
static const image_form planes_form = {
    .width = WIDTH, .height = HEIGHT, .channels = 4, .name = plane_name, .texts = 4, .text = plane_text};

static const float *const *filled_planes(void)
{
    static const float *const all[] = {plane[0], plane[1], plane[2], plane[3]};
    for (int c = 0; c < 4; c++)
        fill(plane[c], (uint32_t)c + 1);
    return all;
}

static bool write_planes(const char *path, errors *e)
{
    return write_by(image_writer_exr, path, &planes_form, HEIGHT, filled_planes(), e);
}

static void exr_round_trip_keeps_every_bit(void **state)
{
    (void)state;
    const char *path = in_folder("planes.exr");
    errors e = {0};
    assert_true(write_planes(path, &e));
    for (int c = 0; c < 4; c++) {
        image m = read_well(path, plane_name[c]);
        assert_int_equal(m.width, WIDTH);
        assert_int_equal(m.height, HEIGHT);
        assert_memory_equal(m.v, plane[c], sizeof plane[c]);
        free(m.v);
    }
    assert_refused(path, NULL, "which channel is meant? The file has B, N.X, R, visibility");

    exr_context_t ctx;
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    assert_int_equal(exr_start_read(&ctx, path, &init), EXR_ERR_SUCCESS);
    for (int i = 0; i < 4; i++) {
        int32_t length;
        const char *value;
        assert_int_equal(exr_attr_get_string(ctx, 0, plane_text[i].key, &length, &value), EXR_ERR_SUCCESS);
        assert_int_equal(length, strlen(plane_text[i].value));
        assert_memory_equal(value, plane_text[i].value, (size_t)length);
    }
    exr_compression_t compression;
    assert_int_equal(exr_get_compression(ctx, 0, &compression), EXR_ERR_SUCCESS);
    assert_int_equal(compression, EXR_COMPRESSION_ZIP);
    exr_finish(&ctx);
    unlink(path);
}

/* -------------------------------------------------------------------------------------------- both formats */

static bool write_png(const char *path, errors *e)
{
    static float grey[SAMPLES];
    for (int i = 0; i < SAMPLES; i++)
        grey[i] = (float)((uint32_t)i * 2654435761U) / 4294967296.0f;
    return png_of(path, WIDTH, HEIGHT, 8, (const float *const[]){grey, grey, grey}, 0, NULL, e);
}

static bool (*const writers[])(const char *, errors *) = {write_png, write_planes};

static void same_image_same_bytes(void **state)
{
    (void)state;
    for (int w = 0; w < 2; w++) {
        errors e = {0};
        const char *a = in_folder("a"), *b = in_folder("another");
        assert_true(writers[w](a, &e));
        assert_true(writers[w](b, &e));
        assert_same_files(a, b);
        unlink(a);
        unlink(b);
    }
}

/* The permissions are those of any new file; what was there is replaced, also behind a link. */
static void file_is_replaced_whole(void **state)
{
    (void)state;
    for (int w = 0; w < 2; w++) {
        errors e = {0};
        struct stat st;
        const char *path = in_folder("there"), *link = in_folder("link"), *fresh = in_folder("fresh");
        mode_t mask = umask(027);
        spill(path, "old", 3);
        assert_int_equal(symlink("there", link), 0);
        assert_true(writers[w](link, &e));
        assert_true(writers[w](fresh, &e));
        umask(mask);
        assert_int_equal(files_in_folder(), 3);
        assert_int_equal(lstat(link, &st), 0);
        assert_true(S_ISLNK(st.st_mode));
        assert_same_files(path, fresh);
        assert_int_equal(stat(path, &st), 0);
        assert_int_equal(st.st_mode & 0777, 0640);
        unlink(path);
        unlink(link);
        unlink(fresh);
    }
}

static void assert_not_written(bool (*write)(const char *, errors *), const char *path, const char *reason)
{
    errors e = {0};
    int before = files_in_folder();
    assert_false(write(path, &e));
    assert_int_equal(e.count, 1);
    assert_non_null(strstr(e.text, path));
    if (!strstr(e.text, reason))
        fail_msg("\"%s\" does not say \"%s\"", e.text, reason);
    assert_int_equal(files_in_folder(), before);
    errors_free(&e);
}

static void failure_leaves_nothing_behind(void **state)
{
    (void)state;
    for (int w = 0; w < 2; w++) {
        assert_not_written(writers[w], in_folder("no/such"), "No such file or directory");
        assert_not_written(writers[w], folder, "Is a directory");
        assert_not_written(writers[w], "", "No such file or directory");
        assert_not_written(writers[w], "/dev/full", "No space left on device");
        const char *path = in_folder("precious");
        spill(path, "old", 3);
        assert_not_written(writers[w], in_folder("precious/below"), "Not a directory");
        /* a file that may not grow stands for a full disk, which comes early or at the last byte */
        errors none = {0};
        size_t whole;
        assert_true(writers[w](in_folder("whole"), &none));
        free(slurp(in_folder("whole"), &whole));
        unlink(in_folder("whole"));
        struct rlimit old, tight;
        assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
        void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
        tight = old;
        for (int i = 0; i <= 16; i++) {
            tight.rlim_cur = (whole - 1) * (size_t)i / 16;
            assert_int_equal(setrlimit(RLIMIT_FSIZE, &tight), 0);
            errors e = {0};
            bool ok = writers[w](path, &e);
            setrlimit(RLIMIT_FSIZE, &old);
            assert_false(ok);
            assert_non_null(strstr(e.text, "File too large"));
            errors_free(&e);
            assert_int_equal(files_in_folder(), 1);
        }
        signal(SIGXFSZ, handler);
        size_t n;
        unsigned char *bytes = slurp(path, &n);
        assert_int_equal(n, 3);
        assert_memory_equal(bytes, "old", 3);
        free(bytes);
        unlink(path);
    }
}

/* Rights do not bind root, so a child gives them up. */
static void protected_places_stay_as_they_are(void **state)
{
    (void)state;
    const char *path = in_folder("protected");
    spill(path, "old", 3);
    assert_int_equal(chmod(path, 0444), 0);
    assert_int_equal(chmod(folder, 0777), 0);
    pid_t child = fork();
    CHECK(child, >=, 0);
    if (child == 0) {
        int wrong = geteuid() == 0 && setuid(65534) != 0;
        for (int w = 0; w < 2; w++) {
            errors e = {0};
            wrong += writers[w](path, &e) || !strstr(e.text, "Permission denied");
            errors_free(&e);
            wrong += writers[w]("/kage-test.png", &e) || !strstr(e.text, "cannot be written");
            errors_free(&e);
        }
        _exit(wrong);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
    assert_int_equal(files_in_folder(), 1);
    unlink(path);
}

/* What is no regular file is written to, not replaced. */
static void pipe_gets_the_same_bytes(void **state)
{
    (void)state;
    const char *fifo = in_folder("fifo"), *copy = in_folder("copy"), *direct = in_folder("direct");
    assert_int_equal(mkfifo(fifo, 0600), 0);
    for (int w = 0; w < 2; w++) {
        errors e = {0};
        pid_t child = fork();
        CHECK(child, >=, 0);
        if (child == 0) {
            static unsigned char bytes[1 << 16];
            int in = open(fifo, O_RDONLY), out = open(copy, O_WRONLY | O_CREAT | O_TRUNC, 0600);
            ssize_t n;
            while ((n = read(in, bytes, sizeof bytes)) > 0)
                if (write(out, bytes, (size_t)n) != n)
                    _exit(1);
            _exit(n != 0);
        }
        int status;
        assert_true(writers[w](fifo, &e));
        assert_int_equal(waitpid(child, &status, 0), child);
        assert_int_equal(status, 0);
        assert_true(writers[w](direct, &e));
        assert_same_files(copy, direct);
        assert_true(writers[w]("/dev/null", &e));
    }
    struct stat st;
    assert_int_equal(stat(fifo, &st), 0);
    assert_true(S_ISFIFO(st.st_mode));
    assert_int_equal(stat("/dev/null", &st), 0);
    assert_true(S_ISCHR(st.st_mode));
    unlink(fifo);
    unlink(copy);
    unlink(direct);
}

/* ---------------------------------------------------------------------------------------- bands, and parts */

static void bands_have_the_same_bytes(void **state)
{
    (void)state;
    errors e = {0};
    const char *whole = in_folder("whole"), *bands = in_folder("bands");
    image_form form = planes_form;
    assert_true(write_planes(whole, &e));
    for (form.threads = 1; form.threads <= 3; form.threads++) {
        assert_true(write_by(image_writer_exr, bands, &form, IMAGE_ROWS, filled_planes(), &e));
        assert_same_files(whole, bands);
    }
    const image_form png = {.width = WIDTH, .height = HEIGHT, .channels = 3, .bits = 16};
    assert_true(write_by(image_writer_png, whole, &png, HEIGHT, filled_planes(), &e));
    assert_true(write_by(image_writer_png, bands, &png, IMAGE_ROWS, filled_planes(), &e));
    assert_same_files(whole, bands);
    unlink(whole);
    unlink(bands);
}

/* An unfinished file of every length is gone on with to the same bytes. */
static void every_part_is_resumed(void **state)
{
    (void)state;
    errors e = {0};
    const char *whole = in_folder("whole"), *path = in_folder("picture"), *part = in_folder("picture.part");
    image_form form = planes_form;
    size_t n;
    assert_true(write_planes(whole, &e));
    unsigned char *bytes = slurp(whole, &n);
    form.resume = true;
    form.threads = 1; /* so short a picture takes longer by two */
    bool kept = false, anew = false;
    for (size_t length = 0; length <= n; length += length + 7 < n ? 7 : 1) {
        spill(part, bytes, length);
        unlink(path);
        image_writer *w = image_writer_exr(path, &form, &e);
        assert_non_null(w);
        const int y = image_writer_rows(w);
        assert_true(y == 0 || y == IMAGE_ROWS); /* the last chunk is always written */
        kept = kept || y > 0;
        anew = anew || y == 0;
        const float *rest[4];
        for (int c = 0; c < 4; c++)
            rest[c] = plane[c] + y * WIDTH;
        assert_true(image_writer_add(w, HEIGHT - y, rest, NULL));
        assert_true(image_writer_close(w, true, &e));
        assert_same_files(whole, path);
        assert_int_equal(files_in_folder(), 2);
    }
    assert_true(kept && anew);
    free(bytes);
    unlink(whole);
    unlink(path);
}

static void parts_stay_or_are_refused(void **state)
{
    (void)state;
    errors e = {0};
    const char *path = in_folder("picture"), *part = in_folder("picture.part");
    image_form form = planes_form;
    form.keep = true;
    image_writer *w = image_writer_exr(path, &form, &e);
    assert_non_null(w);
    assert_true(image_writer_add(w, IMAGE_ROWS, filled_planes(), NULL));
    assert_false(image_writer_close(w, false, &e));
    assert_int_equal(e.count, 0); /* nothing has failed */
    assert_int_equal(access(part, F_OK), 0);
    assert_int_not_equal(access(path, F_OK), 0);
    form.resume = true;
    w = image_writer_exr(path, &form, &e);
    assert_int_equal(image_writer_rows(w), IMAGE_ROWS);
    image_writer_close(w, false, &e);
    form.height++;
    assert_null(image_writer_exr(path, &form, &e)); /* of another picture: it stays */
    assert_non_null(strstr(e.text, "part of another picture"));
    errors_free(&e);
    assert_int_equal(access(part, F_OK), 0);
    spill(part, "precious", 8);
    form.resume = false;
    assert_null(image_writer_exr(path, &form, &e));
    assert_non_null(strstr(e.text, "no unfinished picture"));
    errors_free(&e);
    assert_int_equal(files_in_folder(), 1);
    unlink(part);
}

static bool stop_at_once(void *user, const char *what, double share)
{
    int *calls = user;
    (void)share;
    assert_string_equal(what, "writing");
    return --*calls > 0;
}

static void a_callback_stops_the_writing(void **state)
{
    (void)state;
    static opener *const open[] = {image_writer_exr, image_writer_png};
    const image_form png = {.width = WIDTH, .height = HEIGHT, .channels = 3, .bits = 8};
    for (int k = 0; k < 2; k++)
        for (int calls = 1; calls <= 2; calls++) {
            errors e = {0};
            int left = calls;
            const progress p = {.show = stop_at_once, .user = &left};
            image_form form = k ? png : planes_form;
            form.threads = 1;
            image_writer *w = open[k](in_folder("stopped"), &form, &e);
            assert_false(image_writer_add(w, HEIGHT, filled_planes(), &p));
            assert_int_equal(left, 0);
            assert_false(image_writer_close(w, true, &e));
            assert_int_equal(e.count, 0);
            assert_int_equal(files_in_folder(), 0);
        }
}

static void nonsense_is_refused(void **state)
{
    (void)state;
    const char *path = in_folder("nonsense");
    assert_refused(in_folder("absent.png"), NULL, "No such file or directory");
    assert_refused(folder, NULL, "Is a directory");
    assert_refused("/dev/null", NULL, "no regular file");
    spill(path, "P5 1 1 255\n0", 12);
    assert_refused(path, NULL, "neither a PNG nor an OpenEXR file");
    spill(path, "\x76\x2f\x31\x01", 4);
    assert_refused(path, NULL, "OpenEXR");
    spill(path, "\x89PNG\r\n\x1a\n", 8);
    assert_refused(path, NULL, "too early");
    unlink(path);

    static const char *const twice[] = {"R", "R"};
    static const struct {
        opener *open;
        image_form form;
    } wrong[] = {{image_writer_exr, {.width = 0, .height = 1, .channels = 1, .name = twice}},
                 {image_writer_exr, {.width = 70000, .height = 1, .channels = 1, .name = twice}},
                 {image_writer_exr, {.width = WIDTH, .height = 1, .channels = 2, .name = twice}},
                 {image_writer_exr, {.width = WIDTH, .height = 1, .channels = 0}},
                 {image_writer_png, {.width = WIDTH, .height = -1, .channels = 3, .bits = 8}},
                 {image_writer_png, {.width = WIDTH, .height = 1, .channels = 3, .bits = 12}}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        errors e = {0};
        path = in_folder("unwritten");
        assert_null(wrong[i].open(path, &wrong[i].form, &e));
        assert_int_equal(e.count, 1);
        assert_non_null(strstr(e.text, path));
        assert_int_equal(files_in_folder(), 0);
        errors_free(&e);
    }
}

/* --------------------------------------------------------------------------------------------------------- */

static int make_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

/* Fails if a test has left a file. */
static int remove_folder(void **state)
{
    (void)state;
    return rmdir(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(srgb_steps_where_the_standard_does),
        cmocka_unit_test(srgb_rises_and_clamps),
        cmocka_unit_test(png_grey_of_every_kind_reads_exactly),
        cmocka_unit_test(png_in_colour_is_read_if_it_is_grey),
        cmocka_unit_test(normal_map_is_refused_as_one),
        cmocka_unit_test(png_has_no_channels),
        cmocka_unit_test(png_holds_the_srgb_codes_and_texts),
        cmocka_unit_test(damaged_png_is_refused),
        cmocka_unit_test(huge_png_is_refused),
        cmocka_unit_test(exr_of_every_kind_is_read),
        cmocka_unit_test(every_half_is_read_exactly),
        cmocka_unit_test(exr_of_other_kinds_is_refused),
        cmocka_unit_test(damaged_exr_is_refused),
        cmocka_unit_test(zip_of_other_samples_is_refused),
        cmocka_unit_test(threads_make_no_difference),
        cmocka_unit_test(exr_round_trip_keeps_every_bit),
        cmocka_unit_test(same_image_same_bytes),
        cmocka_unit_test(file_is_replaced_whole),
        cmocka_unit_test(failure_leaves_nothing_behind),
        cmocka_unit_test(protected_places_stay_as_they_are),
        cmocka_unit_test(pipe_gets_the_same_bytes),
        cmocka_unit_test(bands_have_the_same_bytes),
        cmocka_unit_test(every_part_is_resumed),
        cmocka_unit_test(parts_stay_or_are_refused),
        cmocka_unit_test(a_callback_stops_the_writing),
        cmocka_unit_test(nonsense_is_refused),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
