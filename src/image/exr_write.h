/* What exr_join.c does with a writer of OpenEXR files. Private to the image files. */
#ifndef KAGE_IMAGE_EXR_WRITE_H
#define KAGE_IMAGE_EXR_WRITE_H

#include <stdint.h>

#include "image/image.h"

/* Add the next chunk of a writer by image_writer_exr, `size` bytes that are compressed already: IMAGE_ROWS rows, or
 * the last ones. False: failed, for a reason that image_writer_close tells. */
bool exr_writer_add_chunk(image_writer *w, const void *bytes, uint64_t size);

#endif
