/* Samples of an image: size limits and allocation. */
#include "image/buffer.h"

#include <stdlib.h>

const char *image_refuse_size(int64_t width, int64_t height)
{
    if (width < 1 || height < 1)
        return "the image has no samples";
    if (width > IMAGE_MAX_SIDE || height > IMAGE_MAX_SIDE || width * height > IMAGE_MAX_PIXELS)
        return "the image is too large: the limits are 65536 samples a side and 2^28 in all";
    return NULL;
}

const char *image_alloc(image *out, int64_t width, int64_t height, int values)
{
    const char *why = image_refuse_size(width, height);
    if (why)
        return why;
    float *v = malloc((size_t)(width * height) * (size_t)values * sizeof *v);
    if (!v)
        return "there is not enough memory for the image";
    *out = (image){(int)width, (int)height, v};
    return NULL;
}
