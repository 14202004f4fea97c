/* Image files: reads height maps and colours, writes pictures. Rows run from top to bottom. Only png.c includes libpng,
 * only exr_read.c and exr_write.c include OpenEXR.
 */
#ifndef KAGE_IMAGE_IMAGE_H
#define KAGE_IMAGE_IMAGE_H

#include <stdbool.h>

#include "base/errors.h"

/* An image in colour: four values a pixel. */
typedef struct image {
    int width, height;
    float *v; /* height x width x 4 values; free() */
} image;

/* The most samples a side and in all of an image that is read or written. */
enum { IMAGE_MAX_SIDE = 65536 };
#define IMAGE_MAX_PIXELS ((long)1 << 28)

/* Who takes the samples of an image while it is decoded, so that it need not be in memory twice. */
typedef struct image_taker {
    void *user;

    /* Called once, before the samples. Returns NULL, or why the image can't be taken. */
    const char *(*begin)(void *user, int width, int height);

    /* Called with n samples of row y, from column x on, for each sample once, in any order, by several threads at once.
     */
    void (*take)(void *user, int x, int y, int n, const float *v);
} image_taker;

/* Read one channel of a file, on the given number of threads (0: one for each processor; only OpenEXR uses more than
 * one). range: the least sample and the most.
 *
 * PNG: grey, 8 or 16 bit (also 1, 2, 4 bit; grey with alpha, the alpha ignored), as sample / (2^bits - 1),
 * so 0..1, without any gamma; `channel` must be NULL. Colour and palette images are refused.
 * OpenEXR: half, float or uint, scanlines or tiles, one part. The channel named `channel`; if that is NULL, the only
 * channel, or Y. Values are not changed; NaN and infinities are refused.
 * The format is recognised by the file's first bytes, not by its name.
 * False, with one message in *e that does not name the file. */
bool image_read(const char *path, const char *channel, int threads, const image_taker *to, float range[2], errors *e);

/* The encoding of colours; IMAGE_BY_KIND: sRGB in PNG, linear in OpenEXR. */
typedef enum image_encoding { IMAGE_BY_KIND, IMAGE_SRGB, IMAGE_LINEAR } image_encoding;

/* Read a file in colour: four values a pixel, that is 4 x width values a row; linear red, green and blue, and alpha,
 * which is 1.
 *
 * PNG: any kind; sRGB unless IMAGE_LINEAR is asked for. Its other statements about gamma are ignored.
 * OpenEXR: as above; R, G and B, or Y as a grey. Always linear; IMAGE_SRGB is an error.
 * An image that is transparent anywhere is refused. exr: whether the file is one. */
bool image_read_color(const char *path, image_encoding encoding, int threads, image *out, bool *exr, errors *e);

/* A named text to write into the file. */
typedef struct image_text {
    const char *key, *value;
} image_text;

/* A channel to write: height x width samples. */
typedef struct image_channel {
    const char *name;
    const float *v;
} image_channel;

/* Write an OpenEXR file of float32 channels (scanlines, ZIP), given in any order, with the texts as string attributes.
 * The file appears complete or not at all (file_writer.h). The bytes do not depend on the clock or on `threads` (0: one
 * for each processor). False, with a message in *e that names the file. */
bool image_write_exr(const char *path, int threads, int width, int height, int channels, const image_channel *channel,
                     int texts, const image_text *text, errors *e);

/* Write a PNG of 8 or 16 bits from linear R, G, B in 0..1 (clamped; NaN becomes 0) through the sRGB transfer
 * function, marked as sRGB, rounded to nearest, without dither. Otherwise as image_write_exr. */
bool image_write_png(const char *path, int width, int height, int bits, const float *r, const float *g, const float *b,
                     int texts, const image_text *text, errors *e);

/* Is the file a PNG whose text Software names this program, of any version? */
bool image_png_is_from(const char *path, const char *program);

#endif
