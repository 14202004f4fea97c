/* Image files: height maps and colours in, pictures out. Rows run from top to bottom. Only png.c includes libpng, only
 * exr_read.c and exr_write.c include OpenEXR.
 */
#ifndef KAGE_IMAGE_IMAGE_H
#define KAGE_IMAGE_IMAGE_H

#include <stdbool.h>

#include "base/errors.h"

/* Samples of an image: one value a pixel, or four where it was read in colour. */
typedef struct image {
    int width, height;
    float *v; /* height x width x values; the owner calls free() */
} image;

/* The most samples a side and in all of an image that is read or written. */
enum { IMAGE_MAX_SIDE = 65536 };
#define IMAGE_MAX_PIXELS ((long)1 << 28)

/* Read one channel of a file into *out.
 *
 * PNG: grey, 8 or 16 bit (also 1, 2, 4 bit; grey with alpha, the alpha ignored), as sample / (2^bits - 1),
 * so 0..1, without any gamma; `channel` must be NULL. Colour and palette images are refused.
 * OpenEXR: half or float (or uint) scanline or tiled single-part files; the channel named `channel`, or,
 * where that is NULL, the only channel, or Y; otherwise the error lists the names there are. Values as
 * they are; NaN and infinities are refused.
 * The kind of file is recognised by its first bytes, not by its name.
 * False with one message in *e, which begins with the reason and does not name the file. */
bool image_read(const char *path, const char *channel, image *out, errors *e);

/* How values of a colour relate to light; IMAGE_BY_KIND: PNG as sRGB, OpenEXR linear. */
typedef enum image_encoding { IMAGE_BY_KIND, IMAGE_SRGB, IMAGE_LINEAR } image_encoding;

/* Read a file in colour: four values a pixel, that is 4 x width values a row; linear red, green and blue, and alpha,
 * which is 1.
 *
 * PNG: any kind; sRGB unless IMAGE_LINEAR is asked for. Its other statements about gamma are ignored.
 * OpenEXR: as above; R, G and B, or Y as a grey. Always linear; IMAGE_SRGB is an error.
 * An image that is transparent anywhere is refused. exr: whether the file is one. */
bool image_read_color(const char *path, image_encoding encoding, image *out, bool *exr, errors *e);

/* A named text to write into the file. */
typedef struct image_text {
    const char *key, *value;
} image_text;

/* A channel to write: height x width samples. */
typedef struct image_channel {
    const char *name;
    const float *v;
} image_channel;

/* Write an OpenEXR file of float32 channels (scanlines, ZIP), in any order given, with the texts as string
 * attributes and nothing that depends on the clock. The file appears whole (written aside, then renamed)
 * or not at all. `threads` share the work, 0: one for each processor; the bytes are the same. False with a message in
 * *e that names the file. */
bool image_write_exr(const char *path, int threads, int width, int height, int channels, const image_channel *channel,
                     int texts, const image_text *text, errors *e);

/* Write a PNG of 8 or 16 bits from linear R, G, B in 0..1 (clamped; NaN becomes 0) through the sRGB transfer
 * function, marked as sRGB, rounded to nearest, without dither. The same promises as above. */
bool image_write_png(const char *path, int width, int height, int bits, const float *r, const float *g, const float *b,
                     int texts, const image_text *text, errors *e);

/* Is the file a PNG whose text Software names this program, of any version? */
bool image_png_is_from(const char *path, const char *program);

#endif
