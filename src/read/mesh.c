/* Meshes: a model file, how its normals are made, and whether it can be used. */
#include "read/parts.h"

#include "mesh/mesh.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

static bool is_large(const mesh_data *d)
{
    double lo[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, hi[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, size = 0;
    for (int k = 0; k < d->n; k++)
        for (int i = 0; i < 9; i++) {
            const double x = (double)d->at[k][i / 3][i % 3];
            lo[i % 3] = lesser(lo[i % 3], x);
            hi[i % 3] = greater(hi[i % 3], x);
        }
    for (int a = 0; a < 3; a++)
        size = fmax(size, hi[a] - lo[a]);
    return size >= SMALL;
}

/* All of a file, or one part. Where a part is asked for, the whole is kept for the next object's. */
static bool read_file(reader *r, const char *path, const char *part, mesh_data *d, char why[MESH_WHY])
{
    const scene_source *from = r->from;
    if (!part)
        return mesh_file_read(path, from->model_reader, from->progress, &r->s->made_from, d, why);
    if (!r->model_path || strcmp(r->model_path, path) != 0) {
        free(r->model_path);
        mesh_data_free(&r->model);
        r->model_path = NULL;
        if (!mesh_file_read(path, from->model_reader, from->progress, &r->s->made_from, &r->model, why))
            return false;
        r->model_path = reader_copy(r, path);
    }
    return mesh_data_part(&r->model, part, from->progress, d, why);
}

/* What a mesh is made from. */
typedef struct model {
    node *file, *part;
    source from;
    const char *part_name; /* NULL: all of it */
    mesh_normals normals;
    double crease;
} model;

/* The triangles, checked. False with an error. */
static bool read_triangles(reader *r, const model *m, mesh_data *d)
{
    char why[MESH_WHY];
    if (m->from.array && m->part)
        return yaml_error(r->y, m->part, "an array has no parts, expected none to be named");
    bool good = m->from.array ? mesh_array_read(&m->from.array->mesh, r->from->progress, d, why)
                              : read_file(r, m->from.path, m->part_name, d, why);
    if (good)
        progress_show(r->from->progress, "checking", 1);
    good = good && mesh_clean(d, m->normals, m->crease, BIG, r->from->threads, r->from->progress, why);
    memory_free(d->part); /* of the file's triangles, some of which may have been left out */
    d->part = NULL;
    if (!good)
        return yaml_error(r->y, m->part ? m->part : m->file, "'%s' can't be used: %s", m->from.name, why);
    return is_large(d) ||
           yaml_error(r->y, m->file, "'%s' can't be used: the model is smaller than %g, expected some size",
                      m->from.name, SMALL);
}

/* A glTF may have its numbers in other files, which may have changed. */
static bool is_alone(const char *path)
{
    const char *dot = path ? strrchr(path, '.') : NULL;
    return !dot || strcasecmp(dot, ".gltf") != 0;
}

static surface *new_mesh(reader *r, const model *m)
{
    mesh_data d = {0};
    char *key = NULL;
    if (*m->from.id && is_alone(m->from.path))
        key = reader_key(r, "mesh %s %d %.17g %s\n%s", m->from.id, (int)m->normals, m->crease, m->from.name,
                         m->part_name ? m->part_name : "");
    surface *f = reader_found_surface(r, key);
    if (!f && read_triangles(r, m, &d))
        f = reader_keep_surface(r, key, reader_made(r, mesh_new(&d, r->from->threads, r->from->progress)));
    mesh_data_free(&d);
    free(key);
    return f;
}

surface *reader_mesh(reader *r, node *at, shape_spec *spec)
{
    model m = {.crease = 40};
    if (!yaml_map(r->y, at, "mesh", "file part normals crease"))
        return NULL;
    m.file = yaml_need(r->y, at, "file", "mesh");
    m.part = yaml_get(at, "part");
    const int normals = reader_word(r, at, "normals", "file smooth flat", "file, smooth or flat");
    bool good = m.file && reader_source(r, m.file, true, "the file of a model", &m.from);
    good = reader_number(r, at, "crease", 0, false, 180, "an angle of 0 to 180 degrees", &m.crease) && good;
    m.part_name = m.part ? yaml_text(r->y, m.part, "the name of a part of the model") : NULL;
    m.normals = (mesh_normals)normals;
    good = normals >= 0 && (!m.part || m.part_name) && good;
    surface *f = good ? new_mesh(r, &m) : NULL;
    if (f)
        *spec = (shape_spec){.kind = SHAPE_MESH,
                             .file = reader_copy(r, m.from.name),
                             .triangles = ((mesh *)f)->d.n,
                             .found = ((mesh *)f)->d.notes};
    source_free(&m.from);
    return f;
}
