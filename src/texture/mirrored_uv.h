/* Textures that are partly mirrored, as mesh.h lays them out: u above `hi` or below `lo` is reflected there. The
 * partials by u change their sign where u is reflected.
 */
#ifndef KAGE_TEXTURE_MIRRORED_UV_H
#define KAGE_TEXTURE_MIRRORED_UV_H

#include "texture/bump.h"
#include "texture/color.h"

/* The same P or colour texture with u reflected. Own p, also on failure. NULL: out of memory, or p is NULL. */
bump *bump_mirrored_uv(bump *p, double lo, double hi);
color_texture *color_mirrored_uv(color_texture *p, double lo, double hi);

#endif
