/* Where a height map or an image lies on a surface's (u,w). Builds on values.h alone. */
#ifndef KAGE_READ_LAYOUT_H
#define KAGE_READ_LAYOUT_H

#include "read/values.h"

/* size or repeat, offset, wrap and samples, on a surface whose extent is u and w; into *l, which has its defaults.
 * False with an error. */
bool reader_layout(reader *r, node *at, const double u[2], const double w[2], map_layout *l);

/* What a map without a size covers: the surface's extent; on a mesh the square that its texture coordinates are meant
 * for, 0..1. */
void reader_extent(const surface *f, const shape_spec *spec, double u[2], double w[2]);

/* Whether the object has (u,w) everywhere, for what lies on it; `at`: that. False with an error. */
bool reader_textured(reader *r, node *at, const object *o);

/* A bump, or a color, for a mesh some of whose texture is mirrored (texture/mirrored_uv.h). Owns p or c; returns what
 * replaces it, NULL with an error or of NULL. */
bump *reader_mirror_bump(reader *r, const object *o, bump *p);
color_texture *reader_mirror_color(reader *r, const object *o, color_texture *c);

#endif
