/* A file of Bezier patches: a text with the control points, three numbers each, sixteen in turn a patch, the first four
 * along u. Blanks, commas and lines part them; # begins a remark.
 */
#ifndef KAGE_READ_PATCH_FILE_H
#define KAGE_READ_PATCH_FILE_H

#include "base/errors.h"
#include "base/vec3.h"

enum { PATCHES_MAX = 4096 };

/* The control points, 16 * *patches of them; owned by the caller. NULL, and what is wrong in *e, as `name:line:col:
 * ...`; name: as the scene has it. */
vec3 *patch_file_read(const char *path, const char *name, double most, int *patches, errors *e);

#endif
