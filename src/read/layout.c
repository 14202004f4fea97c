/* Where height maps and images lie in (u,w), and textures that are mirrored on part of a mesh. */
#include "read/parts.h"

#include <stdlib.h>

#include "texture/mirrored_uv.h"

/* The map's size in (u,w): given, or the surface's extent divided by `repeat`. */
static bool read_size(reader *r, node *at, const double extent[2], double size_of[2])
{
    node *size = yaml_get(at, "size"), *repeat = yaml_get(at, "repeat");
    double n[2] = {1, 1};
    if (size && repeat)
        return yaml_error(r->y, repeat, "both 'size' and 'repeat', expected one of them");
    if (size)
        return yaml_numbers(r->y, size, 2, SMALL, BIG, "the size of the map [in u, in w], 1e-6 or more", size_of);
    if (!(extent[0] < HUGE_VAL))
        return yaml_error(r->y, repeat ? repeat : at, "a map on an unbounded surface, expected 'size: [in u, in w]'");
    const bool good =
        reader_pair(r, at, "repeat", SMALL, "how often the map goes into the surface [in u, in w], 1e-6 or more", n);
    for (int a = 0; a < 2; a++)
        size_of[a] = extent[a] / n[a];
    return good;
}

bool reader_layout(reader *r, node *at, const double u[2], const double w[2], map_layout *l)
{
    const double extent[2] = {u[1] - u[0], w[1] - w[0]};
    const bool bounded = extent[0] < HUGE_VAL;
    double shift[2] = {0, 0};
    bool good = read_size(r, at, extent, l->size);
    good = reader_pair(r, at, "offset", -BIG, "where the map begins [in u, in w]", shift) && good;
    l->offset[0] = (bounded ? u[0] : 0) + shift[0];
    l->offset[1] = (bounded ? w[0] : 0) + shift[1];
    const int wrap = reader_word(r, at, "wrap", "repeat clamp mirror", "repeat, clamp or mirror");
    const int samples = reader_word(r, at, "samples", "cells corners", "cells or corners");
    l->wrap = wrap < 0 ? MAP_REPEAT : (map_wrap)wrap;
    l->corners = samples == 1;
    return good && wrap >= 0 && samples >= 0;
}

void reader_extent(const surface *f, const shape_spec *spec, double u[2], double w[2])
{
    f->ops->extent(f, 0, u, w);
    if (spec->kind == SHAPE_MESH) {
        u[0] = w[0] = 0;
        u[1] = w[1] = 1;
    }
}

bool reader_textured(reader *r, node *at, const object *o)
{
    const shape_spec *f = &o->shape_spec;
    if (f->kind != SHAPE_MESH || f->found.bare == 0)
        return true;
    return yaml_error(
        r->y, at, "%d of the %d triangles of '%s' have no texture coordinates, expected them for a bump or a pattern",
        f->found.bare, f->triangles, f->file);
}

/* Whether a mesh has mirrored triangles. These have u above *hi, or below *lo after a transform that mirrors. */
static bool has_mirrored(const object *o, double *lo, double *hi)
{
    double u[2], w[2];
    if (o->shape_spec.kind != SHAPE_MESH || o->shape_spec.found.folded == 0)
        return false;
    o->own->ops->extent(o->own, 0, u, w);
    *lo = u[0] - (u[1] - u[0]);
    *hi = u[1] + (u[1] - u[0]);
    return true;
}

bump *reader_mirror_bump(reader *r, const object *o, bump *p)
{
    double lo, hi;
    if (!p || !has_mirrored(o, &lo, &hi))
        return p;
    char *key = reader_key(r, "mirrored %p %.17g %.17g", (const void *)p, lo, hi);
    bump *made = reader_found_bump(r, key);
    if (made)
        bump_free(p);
    else
        made = reader_keep_bump(r, key, reader_made(r, bump_mirrored_uv(p, lo, hi)));
    free(key);
    return made;
}

color_texture *reader_mirror_color(reader *r, const object *o, color_texture *c)
{
    double lo, hi;
    return c && has_mirrored(o, &lo, &hi) ? reader_made(r, color_mirrored_uv(c, lo, hi)) : c;
}
