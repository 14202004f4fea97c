/* P and colours on (u,w) of which one part lies mirrored beyond the ends of u, as mesh.h lays what is mirrored: beyond
 * `hi` and below `lo` u goes back again. Their partials by u turn their sign there.
 */
#ifndef KAGE_TEXTURE_MIRRORED_UV_H
#define KAGE_TEXTURE_MIRRORED_UV_H

#include "texture/bump.h"
#include "texture/color.h"

/* Own p, also on failure. NULL: out of memory. */
bump *bump_mirrored_uv(bump *p, double lo, double hi);
color_texture *color_mirrored_uv(color_texture *p, double lo, double hi);

#endif
