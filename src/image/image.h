/* Image files: reads height maps and colours, writes pictures. Rows run from top to bottom. Only png.c includes libpng,
 * only exr_read.c and exr_write.c include OpenEXR.
 */
#ifndef KAGE_IMAGE_IMAGE_H
#define KAGE_IMAGE_IMAGE_H

#include <stdbool.h>

#include "base/errors.h"
#include "base/progress.h"

/* An image in colour: four values a pixel. */
typedef struct image {
    int width, height;
    float *v; /* height x width x 4 values; memory_free */
} image;

/* The most samples a side and in all of an image that is read; a picture that is written has only the
 * limit of its sides. */
enum { IMAGE_MAX_SIDE = 65536 };
#define IMAGE_MAX_PIXELS ((long)1 << 28)

/* Who takes the samples of an image while it is decoded, so that it need not be in memory twice. */
typedef struct image_taker {
    void *user;

    /* Called once, before the samples. Returns NULL, or why the image can't be taken; "": not enough memory. */
    const char *(*begin)(void *user, int width, int height);

    /* Called with n samples of row y, from column x on, for each sample once, in any order, by several threads at once.
     */
    void (*take)(void *user, int x, int y, int n, const float *v);
} image_taker;

/* Read one channel of a file, on the given number of threads (0: one for each processor; PNG takes two at
 * most). w: where its memory comes from; NULL: without a limit. range: the least sample and the most.
 *
 * PNG: grey, 8 or 16 bit (also 1, 2, 4 bit; grey with alpha, the alpha ignored), as sample / (2^bits - 1),
 * so 0..1, without any gamma; `channel` must be NULL. Colour and palette images must be grey: red, green and blue the
 * same in every pixel.
 * OpenEXR: half, float or uint, scanlines or tiles, one part. The channel named `channel`; if that is NULL, the only
 * channel, or Y. Values are not changed; NaN and infinities are refused.
 * The format is recognised by the file's first bytes, not by its name.
 * False, with one message in *e that does not name the file. */
bool image_read(const char *path, const char *channel, int threads, const progress *w, const image_taker *to,
                float range[2], errors *e);

/* The bits of a PNG's samples, or the indices of its palette: 1 to 16. 0: the file is no PNG. */
int image_png_bits(const char *path);

/* The encoding of colours; IMAGE_BY_KIND: sRGB in PNG, linear in OpenEXR. */
typedef enum image_encoding { IMAGE_BY_KIND, IMAGE_SRGB, IMAGE_LINEAR } image_encoding;

/* Read a file in colour: four values a pixel, that is 4 x width values a row; linear red, green and blue, and alpha,
 * which is 1.
 *
 * PNG: any kind; sRGB unless IMAGE_LINEAR is asked for. Its other statements about gamma are ignored.
 * OpenEXR: as above; R, G and B, or Y as a grey. Always linear; IMAGE_SRGB is an error.
 * An image that is transparent anywhere is refused. exr: whether the file is one. */
bool image_read_color(const char *path, image_encoding encoding, int threads, const progress *w, image *out, bool *exr,
                      errors *e);

/* A named text to write into the file. */
typedef struct image_text {
    const char *key, *value;
} image_text;

/* What a picture's file holds, and how it is written. */
typedef struct image_form {
    int width, height;
    int channels;            /* a PNG has 3: red, green and blue */
    const char *const *name; /* of each channel of an EXR, in any order */
    int texts;
    const image_text *text;
    int bits;    /* of a PNG: 8 or 16 */
    int threads; /* that compress an EXR; 0: one for each processor */
    bool keep;   /* an EXR that is not finished stays, as PATH.part */
    bool resume; /* an EXR: go on with PATH.part, if there is one from the same header */
} image_form;

/* A file to which rows are added from the top on. It appears complete or not at all (file_writer.h). The bytes depend
 * neither on the clock, nor on the threads, nor on how many rows are added at a time. */
typedef struct image_writer image_writer;

/* OpenEXR: float32 channels (scanlines, ZIP), with the texts as string attributes. `path` must outlive the writer.
 * NULL, with a message in *e that names the file. */
image_writer *image_writer_exr(const char *path, const image_form *form, errors *e);

/* PNG, from linear light in 0..1 (clamped; NaN becomes 0) through the sRGB transfer function, marked as sRGB, rounded
 * to nearest, without dither. Otherwise as image_writer_exr. */
image_writer *image_writer_png(const char *path, const image_form *form, errors *e);

/* How many rows are in the file. */
int image_writer_rows(const image_writer *w);

/* Rows are added in multiples of this, but for the last ones. */
enum { IMAGE_ROWS = 16 };

/* Add rows; plane[c]: rows x width samples of channel c. p, or NULL, is called as "writing" in the caller's thread with
 * the share of these rows that is done. False: stopped by p, or failed, for a reason that image_writer_close tells. */
bool image_writer_add(image_writer *w, int rows, const float *const *plane, const progress *p);

/* Free w. whole: finish the file, with all rows in it; else delete it, or keep the rows in PATH.part. False: not
 * written, with a message in *e that names the file if something failed. */
bool image_writer_close(image_writer *w, bool whole, errors *e);

/* Is the file a PNG whose text Software names this program, of any version? */
bool image_png_is_from(const char *path, const char *program);

#endif
