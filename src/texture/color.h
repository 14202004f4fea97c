/* Colour textures: linear colours as a function of (u,w), by a checker or an image. Independent of surfaces and light.
 * Constant after construction, so any number of threads may use one. */
#ifndef KAGE_TEXTURE_COLOR_H
#define KAGE_TEXTURE_COLOR_H

#include "image/image.h"
#include "texture/table.h"
#include "base/vec3.h"

typedef struct color_texture color_texture;

typedef struct color_texture_ops {
    const char *kind; /* as in the scene file */

    /* The linear colours at n <= LANES places. Reentrant, no allocation. */
    void (*eval)(const color_texture *p, int n, const real *u, const real *w, vec3s *color);

    void (*free)(color_texture *p); /* NULL: as free() */
} color_texture_ops;

struct color_texture {
    const color_texture_ops *ops;
};

/* The pixels of an image as a table; several colour textures can share them. */
typedef struct texels texels;

/* From an image of four values a pixel, which is copied, and the layout's wrap. NULL: out of memory, fewer than 2 x 2
 * pixels, or more than 2^29. */
texels *texels_new(const image *m, const map_layout *l, const progress *w);
texels *texels_share(texels *t); /* one owner more */
void texels_free(texels *t);

/* Two alternating colours in fields of size[0] x size[1] in (u,w), with a corner at `offset`. NULL: out of memory. */
color_texture *color_checker_new(const vec3 color[2], const double size[2], const double offset[2]);

/* The image on (u,w). The layout has the wrap that the texels were made with; they must outlive the texture. Colours
 * are of the nearest pixel, or bilinear between the centres of pixels. NULL: out of memory. */
color_texture *color_image_new(const texels *t, const map_layout *l, bool nearest);

void color_texture_free(color_texture *p);

#endif
