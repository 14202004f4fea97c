/* A file of Bezier patches: a text of control points, three numbers each. 16 points are a patch, the first four of them
 * along u. Blanks, commas and ends of lines separate numbers; # begins a comment.
 */
#ifndef KAGE_PATCH_PATCH_FILE_H
#define KAGE_PATCH_PATCH_FILE_H

#include "base/errors.h"
#include "base/limits.h"
#include "base/vec3.h"

enum { PATCHES_MAX = 4096 }; /* of an object */

/* Read the control points, 16 * *patches of them; owned by the caller. Coordinates are within +-most, and there
 * are at most `allowed` patches, PATCHES_MAX or fewer. NULL with an error in *e, as `name:line:col: ...`; name: the
 * file as the scene has it. */
vec3 *patch_file_read(const char *path, const char *name, double most, cap allowed, int *patches, errors *e);

#endif
