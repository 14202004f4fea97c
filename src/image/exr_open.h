/* An OpenEXR file that is open for reading. Private to the image files. */
#ifndef KAGE_IMAGE_EXR_OPEN_H
#define KAGE_IMAGE_EXR_OPEN_H

#include <openexr.h>

#include "image/format.h"

/* What the library's callbacks need; it must stay where it is while the context is open. */
typedef struct exr_reader {
    int fd;
    char *why; /* IMAGE_WHY; the first reason counts */
} exr_reader;

/* Whether a call of the library succeeded; if not, there is a reason. */
bool exr_good(exr_reader *r, exr_result_t result);

/* Read the header. An incomplete file is an error. The context must be finished unless it is NULL. */
exr_result_t exr_open(exr_reader *r, exr_context_t *ctx);

#endif
