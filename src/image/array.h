/* Images in memory, read as if they were in files: whole numbers as a PNG's, floats as an OpenEXR's. */
#ifndef KAGE_IMAGE_ARRAY_H
#define KAGE_IMAGE_ARRAY_H

#include "image/image.h"

typedef enum image_type { IMAGE_U8, IMAGE_U16, IMAGE_F32, IMAGE_F64 } image_type;

typedef struct image_array {
    int width, height, channels; /* 1 to 4 */
    image_type type;
    const void *samples; /* from the top, row by row */
} image_array;

/* Bytes of all samples. */
size_t image_array_size(const image_array *a);

/* As image_read and image_read_color. */
bool image_array_read(const image_array *a, const char *channel, const progress *w, const image_taker *to,
                      float range[2], errors *e);
bool image_array_read_color(const image_array *a, image_encoding encoding, const progress *w, image *out,
                            bool *is_float, errors *e);

#endif
