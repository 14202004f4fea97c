/* Reads JPEG by libjpeg (libjpeg-turbo), reads and writes PNG by libpng's simplified interface. */
#include "import/picture.h"

#include <math.h>
#include <png.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jpeglib.h> /* after stdio.h, as it asks for */

picture_kind picture_kind_of(const unsigned char *bytes, size_t size)
{
    static const struct {
        picture_kind kind;
        size_t size;
        unsigned char first[8];
    } kinds[] = {{PICTURE_PNG, 8, {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'}},
                 {PICTURE_JPEG, 3, {0xff, 0xd8, 0xff}},
                 {PICTURE_EXR, 4, {0x76, 0x2f, 0x31, 0x01}}};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
        if (size >= kinds[k].size && memcmp(bytes, kinds[k].first, kinds[k].size) == 0)
            return kinds[k].kind;
    return PICTURE_OTHER;
}

/* Keep red, green and blue of n pixels of 4 bytes, in place or not; r: where red is, 0 or 2. Whether any is clear. */
static bool drop_alpha(const unsigned char *from, size_t n, int r, unsigned char *to)
{
    bool clear = false;
    for (size_t k = 0; k < n; k++) {
        const unsigned char x[3] = {from[4 * k + (size_t)r], from[4 * k + 1], from[4 * k + 2 - (size_t)r]};
        clear |= from[4 * k + 3] != 255;
        memcpy(to + 3 * k, x, 3);
    }
    return clear;
}

/* Alpha is read, as libpng would lay the image on a ground without it. */
static bool decode_png(const unsigned char *bytes, size_t size, picture *out, char why[PICTURE_WHY])
{
    png_image m = {.version = PNG_IMAGE_VERSION};
    if (png_image_begin_read_from_memory(&m, bytes, size)) {
        m.format = PNG_FORMAT_RGBA;
        m.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;
        const size_t n = (size_t)m.width * m.height;
        out->v = m.width < 1 << 16 && m.height < 1 << 16 ? malloc(4 * n) : NULL;
        if (out->v && png_image_finish_read(&m, NULL, out->v, 0, NULL)) {
            out->width = (int)m.width;
            out->height = (int)m.height;
            out->clear = drop_alpha(out->v, n, 0, out->v);
            return true;
        }
    }
    snprintf(why, PICTURE_WHY, "%s", *m.message ? m.message : "out of memory");
    png_image_free(&m);
    return false;
}

/* libjpeg's error handler must not return. */
typedef struct jpeg_job {
    struct jpeg_error_mgr how; /* first, as libjpeg knows it alone */
    jmp_buf jump;
    char *why;
} jpeg_job;

static void on_error(j_common_ptr j)
{
    jpeg_job *job = (jpeg_job *)(void *)j->err;
    char text[JMSG_LENGTH_MAX];
    job->how.format_message(j, text);
    snprintf(job->why, PICTURE_WHY, "%s", text);
    longjmp(job->jump, 1);
}

static void on_message(j_common_ptr j) { (void)j; }

static bool decode_jpeg(const unsigned char *bytes, size_t size, picture *out, char why[PICTURE_WHY])
{
    struct jpeg_decompress_struct j;
    jpeg_job job = {.why = why};
    j.err = jpeg_std_error(&job.how);
    job.how.error_exit = on_error;
    job.how.output_message = on_message;
    if (setjmp(job.jump)) {
        jpeg_destroy_decompress(&j);
        return false;
    }
    jpeg_create_decompress(&j);
    jpeg_mem_src(&j, bytes, (unsigned long)size);
    jpeg_read_header(&j, TRUE);
    j.out_color_space = JCS_RGB;
    jpeg_start_decompress(&j);
    out->width = (int)j.output_width;
    out->height = (int)j.output_height;
    out->v = malloc(3 * (size_t)j.output_width * j.output_height);
    for (JSAMPROW row; out->v && j.output_scanline < j.output_height;) {
        row = out->v + 3 * (size_t)j.output_width * j.output_scanline;
        jpeg_read_scanlines(&j, &row, 1);
    }
    if (out->v)
        jpeg_finish_decompress(&j);
    else
        snprintf(why, PICTURE_WHY, "out of memory");
    jpeg_destroy_decompress(&j);
    return out->v;
}

bool picture_decode(const unsigned char *bytes, size_t size, picture *out, char why[PICTURE_WHY])
{
    *out = (picture){0};
    const picture_kind kind = picture_kind_of(bytes, size);
    if (kind == PICTURE_PNG ? decode_png(bytes, size, out, why)
                            : kind == PICTURE_JPEG && decode_jpeg(bytes, size, out, why))
        return true;
    if (kind != PICTURE_PNG && kind != PICTURE_JPEG)
        snprintf(why, PICTURE_WHY, "no PNG, JPEG or OpenEXR");
    free(out->v);
    *out = (picture){0};
    return false;
}

bool picture_of_texels(const unsigned char *bgra, int width, int height, picture *out)
{
    *out = (picture){.width = width, .height = height, .v = malloc(3 * (size_t)width * (size_t)height)};
    if (out->v)
        out->clear = drop_alpha(bgra, (size_t)width * (size_t)height, 2, out->v);
    return out->v;
}

void picture_tint(picture *p, const double factor[3])
{
    unsigned char to[3][256];
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 256; k++) {
            const double s = k / 255.0, linear = s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4),
                         x = fmin(fmax(linear * factor[c], 0), 1);
            to[c][k] = (unsigned char)(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055) + 0.5);
        }
    const size_t n = (size_t)p->width * (size_t)p->height;
    for (size_t k = 0; k < n; k++)
        for (int c = 0; c < 3; c++)
            p->v[3 * k + (size_t)c] = to[c][p->v[3 * k + (size_t)c]];
}

unsigned char *picture_encode(const picture *p, size_t *size)
{
    png_image m = {.version = PNG_IMAGE_VERSION,
                   .width = (png_uint_32)p->width,
                   .height = (png_uint_32)p->height,
                   .format = PNG_FORMAT_RGB};
    png_alloc_size_t n = 0;
    if (!png_image_write_to_memory(&m, NULL, &n, 0, p->v, 0, NULL))
        return NULL;
    unsigned char *to = malloc(n);
    if (to && !png_image_write_to_memory(&m, to, &n, 0, p->v, 0, NULL)) {
        free(to);
        return NULL;
    }
    *size = n;
    return to;
}
