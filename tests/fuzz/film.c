/* Pictures: written as PNG or EXR in steps of some rows, with any samples and texts, and read back the same; broken off
 * and resumed to the same bytes; cut into bands and joined to the same bytes; and files that are no bands refused.
 */
#include "fuzz/fuzz.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "image/exr_join.h"
#include "image/image.h"
#include "image/srgb.h"

enum { SIDE = 40, CHANNELS = 4, TEXT = 64, PIXELS = SIDE * SIDE };

typedef struct picture {
    image_form form;
    const char *name[CHANNELS];
    image_text text[2];
    char value[TEXT + 1];
    float *plane[CHANNELS];
} picture;

static bool never(void *user, const char *what, double share)
{
    (void)user;
    HOLDS(what && share >= 0 && share <= 1, "progress %g", share);
    return true;
}

static const progress show = {.show = never};

static void good(bool holds, errors *e, const char *what) { HOLDS(holds && !e->text, "%s: %s", what, e->text); }

/* Write rows y to `end` of the picture, `step` at a time. */
static void add(image_writer *w, const picture *p, int y, int end, int step)
{
    while (y < end) {
        const int rows = end - y < step ? end - y : step;
        const float *at[CHANNELS];
        for (int c = 0; c < p->form.channels; c++)
            at[c] = p->plane[c] + (size_t)y * (size_t)p->form.width;
        HOLDS(image_writer_add(w, rows, at, &show), "rows from %d are not added", y);
        y += rows;
    }
}

static void write_exr(const picture *p, image_form form, const char *path, int from, int end, int step)
{
    errors e = {0};
    form.height = form.resume ? p->form.height : end - from;
    image_writer *w = image_writer_exr(path, &form, &e);
    good(w, &e, "begin");
    add(w, p, from + image_writer_rows(w), end, step);
    good(image_writer_close(w, true, &e), &e, "close");
    errors_free(&e);
}

static void same_bytes(const char *a, const char *b)
{
    size_t n = 0, m = 0;
    uint8_t *x = fuzz_read(a, &n), *y = fuzz_read(b, &m);
    HOLDS(x && y && n == m && memcmp(x, y, n) == 0, "%s and %s differ", a, b);
    free(x);
    free(y);
}

/* ---- read back ---- */

typedef struct taken {
    float *v;
    uint8_t *times;
    int width, height;
} taken;

static const char *begin(void *user, int width, int height)
{
    const taken *t = user;
    HOLDS(width == t->width && height == t->height, "%d x %d were written, %d x %d read", t->width, t->height, width,
          height);
    return NULL;
}

static void take(void *user, int x, int y, int n, const float *v)
{
    taken *t = user;
    HOLDS(x >= 0 && y >= 0 && n > 0 && x + n <= t->width && y < t->height, "samples outside of the picture");
    for (int k = 0; k < n; k++) {
        t->v[y * t->width + x + k] = v[k];
        t->times[y * t->width + x + k]++;
    }
}

static void read_exr(const picture *p, const char *path)
{
    static float v[PIXELS];
    const int pixels = p->form.width * p->form.height;
    for (int c = 0; c < p->form.channels; c++) {
        uint8_t times[PIXELS] = {0};
        taken t = {v, times, p->form.width, p->form.height};
        const image_taker to = {&t, begin, take};
        float range[2];
        errors e = {0};
        bool finite = true;
        for (int k = 0; k < pixels; k++)
            finite = finite && isfinite(p->plane[c][k]);
        HOLDS(image_read(path, p->name[c], 1, &show, &to, range, &e) == finite, "channel %s: %s", p->name[c], e.text);
        errors_free(&e);
        for (int k = 0; finite && k < pixels; k++)
            HOLDS(times[k] == 1 && memcmp(&v[k], &p->plane[c][k], sizeof v[k]) == 0,
                  "sample %d: %g was written, %g read", k, (double)p->plane[c][k], (double)v[k]);
    }
}

static void read_texts(const picture *p, exr_band *b)
{
    const image_form *f = exr_band_form(b);
    HOLDS(f->width == p->form.width && f->channels == p->form.channels && f->texts == p->form.texts,
          "the band differs");
    for (int k = 0; k < f->texts; k++)
        for (int j = 0; j < f->texts; j++)
            HOLDS(strcmp(f->text[k].key, p->text[j].key) != 0 || strcmp(f->text[k].value, p->text[j].value) == 0,
                  "text '%s' was written, '%s' read", p->text[j].value, f->text[k].value);
}

/* A number from 0 to 1 as the nearest code. */
static void read_png(const picture *p, const char *path)
{
    image i = {0};
    bool exr = true;
    errors e = {0};
    srgb *codes = srgb_create(p->form.bits);
    good(codes && image_read_color(path, IMAGE_LINEAR, 1, &show, &i, &exr, &e), &e, "read");
    HOLDS(!exr && i.width == p->form.width && i.height == p->form.height, "%d x %d", i.width, i.height);
    HOLDS(image_png_bits(path) == p->form.bits && image_png_is_from(path, "kage"), "its head differs");
    const int pixels = i.width * i.height;
    uint16_t code[PIXELS];
    for (int c = 0; c < 3; c++) {
        srgb_encode(codes, pixels, p->plane[c], code);
        for (int k = 0; k < pixels; k++)
            HOLDS((int)lround((double)i.v[4 * k + c] * ((1 << p->form.bits) - 1)) == code[k], "sample %d of %d: %g", k,
                  c, (double)i.v[4 * k + c]);
    }
    free(codes);
    memory_free(i.v);
}

/* ---- what is done with a picture ---- */

static void as_png(picture *p, int step)
{
    const char *path = fuzz_path("out.png");
    errors e = {0};
    p->form.channels = 3;
    image_writer *w = image_writer_png(path, &p->form, &e);
    good(w, &e, "begin");
    add(w, p, 0, p->form.height, step);
    good(image_writer_close(w, true, &e), &e, "close");
    read_png(p, path);
}

/* Break off after `rows` rows, then go on. */
static void resume(const picture *p, int rows, const char *whole)
{
    const char *path = fuzz_path("resumed.exr");
    image_form form = p->form;
    errors e = {0};
    form.keep = true;
    image_writer *w = image_writer_exr(path, &form, &e);
    good(w, &e, "begin");
    add(w, p, 0, rows, IMAGE_ROWS);
    image_writer_close(w, false, &e);
    errors_free(&e);
    form.resume = true;
    write_exr(p, form, path, 0, p->form.height, IMAGE_ROWS);
    same_bytes(path, whole);
}

/* Cut it at a row, and join the bands. */
static void join(const picture *p, int cut, const char *whole)
{
    const char *path = fuzz_path("joined.exr"), *part[2] = {fuzz_path("a.exr"), fuzz_path("b.exr")};
    errors e = {0};
    write_exr(p, p->form, part[0], 0, cut, IMAGE_ROWS);
    write_exr(p, p->form, part[1], cut, p->form.height, IMAGE_ROWS);
    image_writer *w = image_writer_exr(path, &p->form, &e);
    good(w, &e, "begin");
    for (int k = 0; k < 2; k++) {
        exr_band *b = exr_band_open(part[k], &e);
        good(b, &e, "band");
        read_texts(p, b);
        good(exr_band_copy(b, w, &show, &e), &e, "copy");
        exr_band_close(b);
    }
    good(image_writer_close(w, true, &e), &e, "close");
    same_bytes(path, whole);
}

static void as_exr(bytes *b, const picture *p, int step)
{
    const char *path = fuzz_path("out.exr");
    write_exr(p, p->form, path, 0, p->form.height, step);
    read_exr(p, path);
    const int blocks = p->form.height / IMAGE_ROWS, cut = IMAGE_ROWS * bytes_between(b, 0, blocks);
    resume(p, cut, path);
    if (cut > 0 && cut < p->form.height)
        join(p, cut, path);
}

/* Samples: mostly from a short list, so that some repeat. */
static void take_samples(bytes *b, picture *p)
{
    float some[8];
    for (int k = 0; k < 8; k++)
        some[k] = (float)bytes_number(b);
    uint32_t mix = (uint32_t)bytes_int(b);
    for (int c = 0; c < CHANNELS; c++) {
        p->plane[c] = malloc(sizeof(float) * PIXELS);
        for (int k = 0; k < p->form.width * p->form.height; k++) {
            mix = mix * 1664525u + 1013904223u;
            p->plane[c][k] = b->left ? (float)bytes_number(b) : some[mix >> 29];
        }
    }
}

static void write_picture(bytes *b, int kind)
{
    static const char *const names[] = {"R", "G", "B", "N.X"};
    const int width = bytes_between(b, 1, SIDE), height = bytes_between(b, 1, SIDE);
    picture p = {.form = {.width = width,
                          .height = height,
                          .channels = bytes_between(b, 1, CHANNELS),
                          .texts = 2,
                          .bits = kind % 2 ? 8 : 16,
                          .threads = 1}};
    const int step = IMAGE_ROWS * bytes_between(b, 1, 3), length = bytes_between(b, 0, TEXT);
    bytes_take(b, p.value, (size_t)length);
    p.text[0] = (image_text){"Software", "kage 0"};
    p.text[1] = (image_text){"kage:scene", p.value};
    memcpy(p.name, names, sizeof names);
    p.form.name = p.name;
    p.form.text = p.text;
    take_samples(b, &p);
    if (kind < 2)
        as_png(&p, step);
    else
        as_exr(b, &p, step);
    for (int c = 0; c < CHANNELS; c++)
        free(p.plane[c]);
}

/* The bytes as one band, beside the same once more: nothing is known of them. */
static void join_bytes(const bytes *b)
{
    const char *const path[2] = {fuzz_path("a.exr"), fuzz_path("b.exr")}, *to = fuzz_path("joined.exr");
    kage_errors *e = NULL;
    patience patient = {1000};
    const kage_write_options o = {.threads = 1, .progress = fuzz_patience, .user = &patient};
    const size_t half = b->left / 2;
    remove(to);
    fuzz_write(path[0], b->at, b->left);
    kage_status status = kage_file_join(path, 1, to, &o, &e);
    fuzz_errors(status, e);
    fuzz_write(path[0], b->at, half);
    fuzz_write(path[1], b->at + half, b->left - half);
    e = NULL;
    status = kage_file_join(path, 2, to, &o, &e);
    fuzz_errors(status, e);
}

/* The first byte: PNG of 16 or 8 bits, EXR, or bands. */
void fuzz_film(const uint8_t *data, size_t size)
{
    bytes b = {data, size};
    const int kind = bytes_one(&b) % 6;
    if (kind < 4)
        write_picture(&b, kind);
    else
        join_bytes(&b);
}
