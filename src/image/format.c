/* Reasons, size limits and allocation for all formats. */
#include "image/format.h"

#include <stdarg.h>
#include <stdlib.h>

bool image_refuse(char *why, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    if (!why[0])
        vsnprintf(why, IMAGE_WHY, fmt, args);
    va_end(args);
    return false;
}

const char *image_refuse_size(int64_t width, int64_t height)
{
    if (width < 1 || height < 1)
        return "the image has no samples";
    if (width > IMAGE_MAX_SIDE || height > IMAGE_MAX_SIDE || width * height > IMAGE_MAX_PIXELS)
        return "the image is too large: the limits are 65536 samples a side and 2^28 in all";
    return NULL;
}

bool image_alloc(image *out, int64_t width, int64_t height, int values, char *why)
{
    const char *refused = image_refuse_size(width, height);
    float *v = refused ? NULL : malloc((size_t)(width * height) * (size_t)values * sizeof *v);
    if (!v)
        return image_refuse(why, "%s", refused ? refused : "there is not enough memory for the image");
    *out = (image){(int)width, (int)height, v};
    return true;
}
