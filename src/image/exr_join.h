/* Bands of a picture, OpenEXR files that image_writer_exr has written, are copied into one file: their chunks as they
 * are, without decompressing them.
 */
#ifndef KAGE_IMAGE_EXR_JOIN_H
#define KAGE_IMAGE_EXR_JOIN_H

#include "image/image.h"

/* An open file. One thread at a time. */
typedef struct exr_band exr_band;

/* Open a file and read its header. `path` must outlive the band. NULL, with a message in *e that names the file: it
 * can't be read, or is none that image_writer_exr writes. */
exr_band *exr_band_open(const char *path, errors *e);

/* Its size, channels in the order of the file, and texts. It lives as long as the band. */
const image_form *exr_band_form(const exr_band *b);

/* Add the band's rows to a writer by image_writer_exr whose width and channels are the same; what it has so far must be
 * a multiple of IMAGE_ROWS. Memory is that of one chunk. False: stopped by p; or failed, with a message in *e that
 * names the band, or for a reason that image_writer_close tells. */
bool exr_band_copy(exr_band *b, image_writer *to, const progress *p, errors *e);

void exr_band_close(exr_band *b); /* NULL: nothing */

#endif
