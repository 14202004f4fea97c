/* Meshes: a model file, how its normals are made, and whether it can be used. */
#include "read/parts.h"

#include "mesh/mesh.h"

#include <stdlib.h>

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

surface *reader_mesh(reader *r, node *at, shape_spec *spec)
{
    mesh_data d = {0};
    double crease = 40;
    char why[MESH_WHY];
    if (!yaml_map(r->y, at, "mesh", "file normals crease"))
        return NULL;
    node *file = yaml_need(r->y, at, "file", "mesh");
    const char *name = file ? yaml_text(r->y, file, "the file of a model") : NULL;
    const int normals = reader_word(r, at, "normals", "file smooth flat", "file, smooth or flat");
    if (!reader_number(r, at, "crease", 0, false, 180, "an angle of 0 to 180 degrees", &crease) || normals < 0 || !name)
        return NULL;
    char *path = reader_beside(r, name);
    bool good = path && mesh_file_read(path, r->from->model_reader, r->from->progress, &r->s->made_from, &d, why);
    if (good)
        progress_show(r->from->progress, "checking", 1);
    good = good && mesh_clean(&d, (mesh_normals)normals, crease, BIG, r->from->threads, why);
    if (path && !good)
        yaml_error(r->y, file, "'%s' can't be used: %s", name, why);
    else if (path && !is_large(&d))
        good = yaml_error(r->y, file, "'%s' can't be used: it is smaller than %g, expected some size", name, SMALL);
    free(path);
    if (!good) {
        mesh_data_free(&d);
        return NULL;
    }
    surface *f = reader_made(r, mesh_new(&d, r->from->threads, r->from->progress));
    if (!f)
        return NULL;
    *spec = (shape_spec){
        .kind = SHAPE_MESH, .file = reader_copy(r, name), .triangles = ((mesh *)f)->d.n, .found = ((mesh *)f)->d.notes};
    return f;
}
