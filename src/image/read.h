/* The readers behind image_read, one for each file format. Each begins with *out empty, and leaves it empty on error;
 * why[IMAGE_WHY] then holds the reason. color: four values a pixel instead of one.
 */
#ifndef KAGE_IMAGE_READ_H
#define KAGE_IMAGE_READ_H

#include <stdio.h>

#include "image/image.h"

/* Room for a reason in one sentence. */
enum { IMAGE_WHY = 512 };

bool image_read_png(FILE *file, bool color, image *out, char *why); /* file: after the 8 bytes of the signature */
bool image_read_exr(FILE *file, const char *channel, bool color, image *out, char *why); /* file: at any position */

#endif
