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

static const char *refuse_size(int64_t width, int64_t height)
{
    if (width < 1 || height < 1)
        return "the image has no samples";
    if (width > IMAGE_MAX_SIDE || height > IMAGE_MAX_SIDE || width * height > IMAGE_MAX_PIXELS)
        return "the image is too large: the limits are 65536 samples a side and 2^28 in all";
    return NULL;
}

bool image_alloc(image *out, int64_t width, int64_t height, int values, char *why)
{
    const char *refused = refuse_size(width, height);
    float *v = refused ? NULL : malloc((size_t)(width * height) * (size_t)values * sizeof *v);
    if (!v)
        return image_refuse(why, "%s", refused ? refused : "there is not enough memory for the image");
    *out = (image){(int)width, (int)height, v};
    return true;
}

/* ---- writing ---- */

const char *image_refuse_form(const image_form *form)
{
    if (form->width < 1 || form->height < 1)
        return "the image has no samples";
    if (form->width > IMAGE_MAX_SIDE || form->height > IMAGE_MAX_SIDE)
        return "the image is too large: the limit is 65536 samples a side";
    return form->channels < 1 ? "the image has no channels" : NULL;
}

int image_writer_rows(const image_writer *w) { return w->rows; }

bool image_writer_add(image_writer *w, int rows, const float *const *plane, const progress *p)
{
    w->failed = w->failed || !w->add(w, rows, plane, p);
    if (!w->failed)
        w->rows += rows;
    return !w->failed;
}

bool image_writer_close(image_writer *w, bool whole, errors *e)
{
    return w->close(w, whole && !w->failed && w->rows == w->height, e);
}
