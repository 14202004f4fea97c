/* What the readers and writers of the file formats share. Private to the image files. */
#ifndef KAGE_IMAGE_FORMAT_H
#define KAGE_IMAGE_FORMAT_H

#include <stdint.h>
#include <stdio.h>

#include "image/array.h"
#include "image/image.h"

/* Room for a reason in one sentence. */
enum { IMAGE_WHY = 512 };

/* Format a reason into why[IMAGE_WHY], unless there is one already. Always false. */
bool image_refuse(char *why, const char *fmt, ...) KAGE_PRINTF(2, 3);

/* What all writers share, at the beginning of each's own struct. */
struct image_writer {
    int width, height, rows; /* rows that are in the file */
    bool failed;
    bool (*add)(image_writer *w, int rows, const float *const *plane, const progress *p);
    bool (*close)(image_writer *w, bool whole, errors *e); /* frees w, too */
};

/* NULL, or why a picture cannot be written. */
const char *image_refuse_form(const image_form *form);

/* The samples on their way to the taker. values: of a pixel, 1 or 4. */
typedef struct image_stream {
    const image_taker *to;
    const progress *progress; /* NULL: none */
    int values, width, height;
    float range[2]; /* of all values so far */
} image_stream;

/* "there is not enough memory for the image", and what it needs, in `why`. Always false. */
bool image_refuse_memory(const image_stream *s, char *why);

/* Before the samples. False, with a reason: too large, or not taken. */
bool image_begin(image_stream *s, int64_t width, int64_t height, char *why);

/* Pass on n pixels of row y from column x on, and widen the range, which may be another thread's own. False, with a
 * reason: a value is NaN or infinite. */
bool image_pass(const image_stream *s, int x, int y, int n, const float *v, float range[2], char *why);

/* Show how many rows are decoded. False, with a reason: the caller has ended the reading. */
bool image_goes_on(const image_stream *s, int rows, char *why);

/* Whole numbers as samples, 0..1. */
static inline float image_of_u8(int x) { return (float)x / 255.0f; }
static inline float image_of_u16(int x) { return (float)x / 65535.0f; }

/* The readers behind image_read. */
bool image_read_png(FILE *file, int threads, image_stream *to,
                    char *why); /* file: after the 8 bytes of the signature */
bool image_read_exr(FILE *file, const char *channel, int threads, image_stream *to, char *why); /* at any position */

bool image_read_array(const image_array *a, const char *channel, image_stream *to, char *why);

#endif
