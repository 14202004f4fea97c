/* Memory for the samples of an image, and the limits of its size. */
#ifndef KAGE_IMAGE_BUFFER_H
#define KAGE_IMAGE_BUFFER_H

#include <stdint.h>

#include "image/image.h"

/* NULL, or why an image of this size is neither read nor written. */
const char *image_refuse_size(int64_t width, int64_t height);

/* Allocate width x height pixels of `values` floats each in *out; the caller frees out->v. NULL, or the reason of the
 * failure; then *out is as before. */
const char *image_alloc(image *out, int64_t width, int64_t height, int values);

#endif
