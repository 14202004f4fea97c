/* Where maps and images lie on a surface, and meshes whose texture is partly mirrored. */
#include "read/layout.h"

#include "texture/mirrored_uv.h"

/* By the map's size in (u,w), or by how often it goes into the surface's extent. */
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
    const bool good = !repeat || yaml_numbers(r->y, repeat, 2, SMALL, BIG,
                                              "how often the map goes into the surface [in u, in w], 1e-6 or more", n);
    for (int a = 0; a < 2; a++)
        size_of[a] = extent[a] / n[a];
    return good;
}

bool reader_layout(reader *r, node *at, const double u[2], const double w[2], map_layout *l)
{
    const double extent[2] = {u[1] - u[0], w[1] - w[0]};
    const bool bounded = extent[0] < HUGE_VAL;
    double shift[2] = {0, 0};
    node *k;
    bool good = read_size(r, at, extent, l->size);
    if ((k = yaml_get(at, "offset")))
        good = yaml_numbers(r->y, k, 2, -BIG, BIG, "where the map begins [in u, in w]", shift) && good;
    l->offset[0] = (bounded ? u[0] : 0) + shift[0];
    l->offset[1] = (bounded ? w[0] : 0) + shift[1];
    if ((k = yaml_get(at, "wrap"))) {
        const int word = yaml_word(r->y, k, "repeat clamp mirror", "repeat, clamp or mirror");
        good = word >= 0 && good;
        l->wrap = word < 0 ? MAP_REPEAT : (map_wrap)word;
    }
    if ((k = yaml_get(at, "samples"))) {
        const int word = yaml_word(r->y, k, "cells corners", "cells or corners");
        good = word >= 0 && good;
        l->corners = word == 1;
    }
    return good;
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
        r->y, at, "%d of the %d triangles of '%s' have no texture coordinates, expected them for what lies on (u,w)",
        f->found.bare, f->triangles, f->file);
}

/* What is mirrored has its (u,w) in a range of the same width beyond the surface's own, on both sides of it: a
 * transform that mirrors exchanges them. */
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
    if (p && has_mirrored(o, &lo, &hi) && !(p = bump_mirrored_uv(p, lo, hi)))
        errors_add(r->e, "out of memory");
    return p;
}

color_texture *reader_mirror_color(reader *r, const object *o, color_texture *c)
{
    double lo, hi;
    if (c && has_mirrored(o, &lo, &hi) && !(c = color_mirrored_uv(c, lo, hi)))
        errors_add(r->e, "out of memory");
    return c;
}
