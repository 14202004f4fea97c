/* Textures of meshes, which are mirrored on some triangles: there mesh.h puts u above `hi` or below `lo`, and here u is
 * reflected at `hi` or `lo`. Partials by such u change their sign.
 */
#ifndef KAGE_TEXTURE_MIRRORED_UV_H
#define KAGE_TEXTURE_MIRRORED_UV_H

#include "texture/bump.h"
#include "texture/color.h"

/* The same P or colour texture with u reflected. The result owns p, which is freed on failure. NULL: out of memory,
 * or p is NULL. */
bump *bump_mirrored_uv(bump *p, double lo, double hi);
color_texture *color_mirrored_uv(color_texture *p, double lo, double hi);

#endif
