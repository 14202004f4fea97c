/* Meshes: a model file, how its normals are made, and whether it can be used. */
#include "read/parts.h"

#include "mesh/mesh.h"

#include <stdlib.h>
#include <string.h>

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

/* Read all of a model, or one part. Where a part is asked for, the whole is kept for the next object's. */
static bool read_triangles(reader *r, const char *path, const char *part, mesh_data *d, char why[MESH_WHY])
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
    return mesh_data_part(&r->model, part, d, why);
}

/* False: with an error. */
static bool read_model(reader *r, node *at, mesh_normals normals, double crease, mesh_data *d)
{
    char why[MESH_WHY];
    node *file = yaml_get(at, "file"), *part = yaml_get(at, "part");
    const char *name = yaml_text(r->y, file, "the file of a model");
    const char *part_name = part ? yaml_text(r->y, part, "the name of a part of the model") : NULL;
    char *path = name && (!part || part_name) ? reader_beside(r, name) : NULL;
    bool good = path && read_triangles(r, path, part_name, d, why);
    if (good)
        progress_show(r->from->progress, "checking", 1);
    good = good && mesh_clean(d, normals, crease, BIG, r->from->threads, why);
    if (path && !good)
        yaml_error(r->y, part ? part : file, "'%s' can't be used: %s", name, why);
    else if (path && !is_large(d))
        good = yaml_error(r->y, file, "'%s' can't be used: it is smaller than %g, expected some size", name, SMALL);
    free(path);
    free(d->part); /* of the file's triangles, some of which may have been left out */
    d->part = NULL;
    if (!good)
        mesh_data_free(d);
    return good;
}

surface *reader_mesh(reader *r, node *at, shape_spec *spec)
{
    mesh_data d = {0};
    double crease = 40;
    if (!yaml_map(r->y, at, "mesh", "file part normals crease"))
        return NULL;
    node *file = yaml_need(r->y, at, "file", "mesh");
    const int normals = reader_word(r, at, "normals", "file smooth flat", "file, smooth or flat");
    if (!reader_number(r, at, "crease", 0, false, 180, "an angle of 0 to 180 degrees", &crease) || normals < 0 ||
        !file || !read_model(r, at, (mesh_normals)normals, crease, &d))
        return NULL;
    surface *f = reader_made(r, mesh_new(&d, r->from->threads, r->from->progress));
    if (!f)
        return NULL;
    *spec = (shape_spec){.kind = SHAPE_MESH,
                         .file = reader_copy(r, yaml_text(r->y, file, "the file of a model")),
                         .triangles = ((mesh *)f)->d.n,
                         .found = ((mesh *)f)->d.notes};
    return f;
}
