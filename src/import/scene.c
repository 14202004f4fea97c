/* A model as the text of a scene. Its triangles stay in the model's file, which the scene names, part by part. */
#include "import/scene.h"

#include "import/open.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void find_box(importer *k)
{
    for (int a = 0; a < 3; a++) {
        k->lo[a] = HUGE_VAL;
        k->hi[a] = -HUGE_VAL;
    }
    for (int i = 0; i < k->parts.n; i++) {
        const struct aiMesh *m = k->s->mMeshes[k->parts.part[i].mesh];
        for (unsigned v = 0; v < m->mNumVertices; v++) {
            double x[3];
            scene_place(k, &k->parts.part[i].m, &m->mVertices[v], 1, x);
            for (int a = 0; a < 3; a++) {
                k->lo[a] = x[a] < k->lo[a] ? x[a] : k->lo[a];
                k->hi[a] = x[a] > k->hi[a] ? x[a] : k->hi[a];
            }
        }
    }
}

/* A model of one part may have no name for it but its file's. */
static void name_objects(importer *k)
{
    for (int i = 0; i < k->parts.n; i++) {
        const bool alone = k->parts.n == 1 && strcmp(k->parts.part[i].name, PARTS_NAMELESS) == 0;
        text_scene_name(k->object[i], alone ? k->wish->stem : k->parts.part[i].name);
        text_unique(k->object[i], k->object, i);
    }
}

static bool has_uv(const importer *k, int part)
{
    return k->s->mMeshes[k->parts.part[part].mesh]->mTextureCoords[0] != NULL;
}

static scene_material *material_of(const importer *k, int part)
{
    const unsigned m = k->s->mMeshes[k->parts.part[part].mesh]->mMaterialIndex;
    return &k->material[m < k->s->mNumMaterials ? m : k->s->mNumMaterials];
}

/* ---- copies ---- */

/* The linear part of a matrix in the scene's coordinates, and where it moves the origin. */
typedef struct motion {
    double m[3][3], t[3];
} motion;

static motion motion_of(const importer *k, const struct aiMatrix4x4 *m)
{
    static const struct aiVector3D axis[2][3] = {{{1, 0, 0}, {0, 1, 0}, {0, 0, -1}}, {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}}};
    const struct aiVector3D origin = {0, 0, 0};
    motion x;
    scene_place(k, m, &origin, 1, x.t);
    for (int a = 0; a < 3; a++) {
        double column[3];
        scene_place(k, m, &axis[k->wish->z_up][a], 0, column);
        for (int i = 0; i < 3; i++)
            x.m[i][a] = column[i];
    }
    return x;
}

static double minor(const motion *x, int i, int j)
{
    const int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
    return x->m[a][c] * x->m[b][d] - x->m[a][d] * x->m[b][c];
}

/* b a^-1: what moves a to b. False: a has no inverse. */
static bool motion_between(const motion *a, const motion *b, motion *out)
{
    const double det = a->m[0][0] * minor(a, 0, 0) + a->m[0][1] * minor(a, 0, 1) + a->m[0][2] * minor(a, 0, 2);
    if (!(fabs(det) > 1e-30))
        return false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            out->m[i][j] = 0;
            for (int c = 0; c < 3; c++)
                out->m[i][j] += b->m[i][c] * minor(a, j, c) / det;
        }
    for (int i = 0; i < 3; i++)
        out->t[i] = b->t[i] - (out->m[i][0] * a->t[0] + out->m[i][1] * a->t[1] + out->m[i][2] * a->t[2]);
    return true;
}

/* Whether it only turns, scales all directions alike, and moves; *scale is by how much. */
static bool keeps_shape(const motion *x, double *scale)
{
    double dot[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            dot[i][j] = x->m[0][i] * x->m[0][j] + x->m[1][i] * x->m[1][j] + x->m[2][i] * x->m[2][j];
    const double s = (dot[0][0] + dot[1][1] + dot[2][2]) / 3,
                 det = x->m[0][0] * minor(x, 0, 0) + x->m[0][1] * minor(x, 0, 1) + x->m[0][2] * minor(x, 0, 2);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (!(fabs(dot[i][j] - (i == j ? s : 0)) <= 1e-5 * s))
                return false;
    *scale = sqrt(s);
    return det > 0 && *scale > 1e-4 && *scale < 1e4;
}

/* Find an earlier part of the same mesh, with the same bump, of which this one is a copy. -1: none. */
static int original_of(const importer *k, int part, motion *by, double *scale)
{
    const motion here = motion_of(k, &k->parts.part[part].m);
    for (int i = 0; i < part; i++)
        if (k->parts.part[i].mesh == k->parts.part[part].mesh) { /* the first: it is no copy itself */
            const motion first = motion_of(k, &k->parts.part[i].m);
            return k->bump[i] == k->bump[part] && motion_between(&first, &here, by) && keeps_shape(by, scale) ? i : -1;
        }
    return -1;
}

/* As kage's rotate: about x, then y, then z. */
static void add_turn(importer *k, const motion *x, double scale)
{
    const double degrees = 57.29577951308232, s = fmin(fmax(-x->m[2][0] / scale, -1), 1);
    const bool locked = fabs(s) > 1 - 1e-12;
    const double turn[3] = {degrees * (locked ? atan2(-x->m[1][2], x->m[1][1]) : atan2(x->m[2][1], x->m[2][2])),
                            degrees * asin(s), degrees * (locked ? 0 : atan2(x->m[1][0], x->m[0][0]))};
    if (fabs(turn[0]) + fabs(turn[1]) + fabs(turn[2]) > 1e-5) {
        text_add(&k->out, "{rotate: ");
        text_vector(&k->out, turn);
        text_add(&k->out, "}, ");
    }
}

static void write_copy(importer *k, int original, const motion *by, double scale)
{
    text_add(&k->out, "    copy: %s\n    transform: [", k->object[original]);
    if (fabs(scale - 1) > 1e-5)
        text_add(&k->out, "{scale: %.7g}, ", scale);
    add_turn(k, by, scale);
    text_add(&k->out, "{translate: ");
    text_vector(&k->out, by->t);
    text_add(&k->out, "}]\n");
}

/* ---- objects ---- */

static void write_object(importer *k, int i)
{
    motion by;
    double scale;
    const int original = original_of(k, i, &by, &scale);
    text_add(&k->out, "  %s:\n", k->object[i]);
    if (original >= 0) {
        write_copy(k, original, &by, scale);
        return;
    }
    text_add(&k->out, "    mesh: {file: ");
    text_string(&k->out, k->wish->model);
    if (k->parts.n > 1) {
        text_add(&k->out, ", part: ");
        text_string(&k->out, k->parts.part[i].name);
    }
    text_add(&k->out, "}\n    material: %s\n", material_of(k, i)->name[has_uv(k, i)]);
    if (k->wish->z_up)
        text_add(&k->out, "    transform: [{rotate: [90, 0, 0]}]\n");
    if (k->bump[i] >= 0)
        scene_write_bump(k, &k->wish->bump[k->bump[i]]);
}

static bool write_scene(importer *k, char why[MESH_WHY])
{
    name_objects(k);
    find_box(k);
    if (!scene_find_bumps(k, why))
        return false;
    for (int i = 0; i < k->parts.n; i++)
        material_of(k, i)->used[has_uv(k, i)] = true;
    text_add(&k->out, "# Made by kage import from ");
    text_string(&k->out, k->wish->model);
    text_add(&k->out, ", which has the triangles. docs/models.md tells what\n# the keys mean that a model lacks.\n\n");
    if (!scene_camera(k, why))
        return false;
    text_add(&k->out, "render: {shadow: auto, aa: 3, aa_threshold: 0.1}\n");
    scene_lights(k);
    scene_materials(k);
    text_add(&k->out, "\nobjects:\n");
    for (int i = 0; i < k->parts.n; i++)
        write_object(k, i);
    if (k->out.failed)
        snprintf(why, MESH_WHY, "out of memory");
    return !k->out.failed;
}

char *import_scene(const char *path, const import_wish *wish, const import_listener *to, char why[MESH_WHY])
{
    importer k = {.s = import_open(path, to, why), .path = path, .wish = wish, .to = to};
    k.gltf = import_ends_with(path, ".gltf") || import_ends_with(path, ".glb");
    if (!k.s || !parts_list(k.s, &k.parts, why))
        return NULL;
    k.object = calloc((size_t)k.parts.n, sizeof *k.object);
    k.bump = calloc((size_t)k.parts.n, sizeof *k.bump);
    k.material = calloc((size_t)k.s->mNumMaterials + 1, sizeof *k.material);
    const bool room = k.object && k.bump && k.material;
    if (!room)
        snprintf(why, MESH_WHY, "out of memory");
    return room && write_scene(&k, why) ? k.out.s : NULL; /* nothing is freed, as the program ends */
}
