/* The caller's arrays: checked, and copied for the scene. */
#include "api/api.h"

#include <stdlib.h>
#include <string.h>

static bool is_name(const char *name)
{
    enum { MOST = 59 };
    return name && *name && strlen(name) <= MOST &&
           !name[strspn(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-")];
}

static bool good_name(const char *what, const char *name, errors *e)
{
    return is_name(name) ||
           errors_add(e, "%s '%.60s': no name, expected up to 59 letters, digits, _ and -", what, name ? name : "");
}

static bool good_image(const kage_image_array *a, errors *e)
{
    if (!good_name("an image", a->name, e))
        return false;
    if (a->width < 1 || a->height < 1 || a->width > IMAGE_MAX_SIDE || a->height > IMAGE_MAX_SIDE ||
        (long)a->width * a->height > IMAGE_MAX_PIXELS)
        return errors_add(e, "the image '%s' has %d x %d pixels, expected 1 to %d each, and at most %ld", a->name,
                          a->width, a->height, IMAGE_MAX_SIDE, IMAGE_MAX_PIXELS);
    if (a->channels < 1 || a->channels > 4)
        return errors_add(e, "the image '%s' has %d channels, expected 1 to 4", a->name, a->channels);
    if ((int)a->type < KAGE_U8 || a->type > KAGE_F64)
        return errors_add(e, "the image '%s' has no such type of samples, expected KAGE_U8, U16, F32 or F64", a->name);
    return a->samples || errors_add(e, "the image '%s' has no samples", a->name);
}

static bool good_mesh(const kage_mesh_array *a, errors *e)
{
    if (!good_name("a mesh", a->name, e))
        return false;
    if (a->vertex_count < 1 || a->triangle_count < 1 || a->triangle_count > MESH_MOST)
        return errors_add(e, "the mesh '%s' has %d vertices and %d triangles, expected 1 or more, and at most %d",
                          a->name, a->vertex_count, a->triangle_count, MESH_MOST);
    return (a->positions && a->triangles) || errors_add(e, "the mesh '%s' has no positions or no triangles", a->name);
}

/* A name that is given twice. */
static bool good_names(const kage_load_options *o, errors *e)
{
    for (int k = 0; k < o->image_count; k++)
        for (int j = 0; j < k; j++)
            if (strcmp(o->images[k].name, o->images[j].name) == 0)
                return errors_add(e, "two images '%s', expected each name once", o->images[k].name);
    for (int k = 0; k < o->mesh_count; k++)
        for (int j = 0; j < k; j++)
            if (strcmp(o->meshes[k].name, o->meshes[j].name) == 0)
                return errors_add(e, "two meshes '%s', expected each name once", o->meshes[k].name);
    return true;
}

bool arrays_are_good(const kage_load_options *o, errors *e)
{
    bool good = true;
    if (o->image_count < 0 || o->mesh_count < 0)
        return errors_add(e, "%d images and %d meshes, expected 0 or more", o->image_count, o->mesh_count);
    if ((o->image_count && !o->images) || (o->mesh_count && !o->meshes))
        return errors_add(e, "%d images and %d meshes, but no list of them", o->image_count, o->mesh_count);
    for (int k = 0; k < o->image_count; k++)
        good = good_image(&o->images[k], e) && good;
    for (int k = 0; k < o->mesh_count; k++)
        good = good_mesh(&o->meshes[k], e) && good;
    return good && good_names(o, e);
}

bool arrays_take(arrays *to, const kage_load_options *o, memory *m)
{
    static const image_type types[] = {IMAGE_U8, IMAGE_U16, IMAGE_F32, IMAGE_F64};
    bool good = true;
    for (int k = 0; good && k < o->image_count; k++) {
        const kage_image_array *a = &o->images[k];
        const image_array copy = {a->width, a->height, a->channels, types[a->type], a->samples};
        good = arrays_add_image(to, a->name, &copy, m);
    }
    for (int k = 0; good && k < o->mesh_count; k++) {
        const kage_mesh_array *a = &o->meshes[k];
        const mesh_array copy = {a->vertex_count, a->triangle_count, a->positions, a->normals, a->uvs, a->triangles};
        good = arrays_add_mesh(to, a->name, &copy, m);
    }
    return good;
}
