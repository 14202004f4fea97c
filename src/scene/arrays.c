/* Sets of arrays by name. */
#include "scene/arrays.h"

#include <stdlib.h>
#include <string.h>

#include "base/shared.h"

static void drop(scene_array *x)
{
    if (!x || !shared_drop(&x->others))
        return;
    free(x->name);
    memory_free(x->memory);
    free(x);
}

static scene_array **place_of(const arrays *a, bool is_mesh, const char *name)
{
    for (int k = 0; k < a->count; k++)
        if (a->item[k]->is_mesh == is_mesh && strcmp(a->item[k]->name, name) == 0)
            return &a->item[k];
    return NULL;
}

/* Owns x, also on failure. */
static bool add(arrays *a, scene_array *x)
{
    scene_array **old = place_of(a, x->is_mesh, x->name);
    if (old) {
        drop(*old);
        *old = x;
        return true;
    }
    scene_array **more = realloc(a->item, sizeof(scene_array *) * ((size_t)a->count + 1));
    if (!more) {
        drop(x);
        return false;
    }
    a->item = more;
    a->item[a->count++] = x;
    return true;
}

static scene_array *new_array(const char *name, bool is_mesh, size_t bytes, memory *m)
{
    scene_array *x = calloc(1, sizeof *x);
    if (!x)
        return NULL;
    x->is_mesh = is_mesh;
    x->name = strdup(name);
    x->memory = memory_new(m, bytes);
    if (x->name && x->memory)
        return x;
    drop(x);
    return NULL;
}

bool arrays_add_image(arrays *a, const char *name, const image_array *from, memory *m)
{
    const size_t size = image_array_size(from);
    scene_array *x = new_array(name, false, size, m);
    if (!x)
        return false;
    memcpy(x->memory, from->samples, size);
    x->image = *from;
    x->image.samples = x->memory;
    return add(a, x);
}

/* Copy n numbers to *at, and go on behind them. NULL of NULL. */
static const double *put(double **at, const double *from, size_t n)
{
    double *to = *at;
    if (!from)
        return NULL;
    memcpy(to, from, n * sizeof *to);
    *at += n;
    return to;
}

bool arrays_add_mesh(arrays *a, const char *name, const mesh_array *mesh, memory *m)
{
    const size_t n = (size_t)mesh->vertices, numbers = n * (size_t)(3 + (mesh->normals ? 3 : 0) + (mesh->uvs ? 2 : 0));
    const size_t corners = 3 * (size_t)mesh->triangles * sizeof *mesh->corners;
    scene_array *x = new_array(name, true, numbers * sizeof(double) + corners, m);
    if (!x)
        return false;
    double *at = x->memory;
    x->mesh = *mesh;
    x->mesh.positions = put(&at, mesh->positions, 3 * n);
    x->mesh.normals = put(&at, mesh->normals, 3 * n);
    x->mesh.uvs = put(&at, mesh->uvs, 2 * n);
    memcpy(at, mesh->corners, corners);
    x->mesh.corners = (const uint32_t *)(const void *)at;
    return add(a, x);
}

bool arrays_add_all(arrays *a, const arrays *from)
{
    for (int k = 0; k < from->count; k++) {
        shared_add(&from->item[k]->others);
        if (!add(a, from->item[k]))
            return false;
    }
    return true;
}

const scene_array *arrays_find(const arrays *a, bool is_mesh, const char *name)
{
    scene_array **at = a ? place_of(a, is_mesh, name) : NULL;
    return at ? *at : NULL;
}

void arrays_free(arrays *a)
{
    for (int k = 0; k < a->count; k++)
        drop(a->item[k]);
    free(a->item);
    *a = (arrays){0};
}
