/* What the readers and writers of the file formats share. Private to the image files. */
#ifndef KAGE_IMAGE_FORMAT_H
#define KAGE_IMAGE_FORMAT_H

#include <stdint.h>
#include <stdio.h>

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

/* Allocate width x height pixels of `values` floats each in *out; the caller frees out->v. False, with a reason: too
 * large, or out of memory; then *out is as before. */
bool image_alloc(image *out, int64_t width, int64_t height, int values, char *why);

/* The readers behind image_read. *out begins empty; on error it may hold samples, and `why` the reason. color: four
 * values a pixel instead of one. */
bool image_read_png(FILE *file, bool color, image *out, char *why); /* file: after the 8 bytes of the signature */
bool image_read_exr(FILE *file, const char *channel, bool color, image *out, char *why); /* file: at any position */

#endif
