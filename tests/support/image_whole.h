/* A whole image of one value a pixel, by image_read. */
#ifndef KAGE_TESTS_IMAGE_WHOLE_H
#define KAGE_TESTS_IMAGE_WHOLE_H

#include <stdlib.h>
#include <string.h>

#include "image/image.h"

static const char *whole_begin(void *user, int width, int height)
{
    image *out = user;
    *out = (image){width, height, malloc((size_t)width * (size_t)height * sizeof *out->v)};
    return out->v ? NULL : "out of memory";
}

static void whole_take(void *user, int x, int y, int n, const float *v)
{
    const image *out = user;
    memcpy(out->v + (size_t)y * (size_t)out->width + (size_t)x, v, (size_t)n * sizeof *v);
}

/* out->v: free(); NULL where the file is refused. */
static inline bool image_whole(const char *path, const char *channel, int threads, image *out, float range[2],
                               errors *e)
{
    const image_taker to = {out, whole_begin, whole_take};
    *out = (image){0};
    if (image_read(path, channel, threads, NULL, &to, range, e))
        return true;
    free(out->v);
    *out = (image){0};
    return false;
}

#endif
