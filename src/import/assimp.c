/* Reads a model's triangles.
 *
 * All triangles are taken, part by part, with the matrices of their nodes; polygons are divided into triangles.
 * Materials, textures, bones, cameras and lights are ignored (scene.c reads most of them). The formats are
 * right-handed, so z changes its sign and corners their order. Texture coordinates have v upward (assimp turns glTF's,
 * too): w = 1 - v.
 */
#include "import/open.h"
#include "import/parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct harvest {
    mesh_data *to;
    int64_t n;
} harvest;

static double place(const struct aiMatrix4x4 *m, int row, const struct aiVector3D *v, double one)
{
    const float *r = &m->a1 + 4 * row;
    return (double)r[0] * (double)v->x + (double)r[1] * (double)v->y + (double)r[2] * (double)v->z + (double)r[3] * one;
}

/* The matrix for normals: cofactors, which are the inverse's transpose times the determinant, with their sign changed
 * where the determinant is below 0. Returns the determinant. */
static double cofactors(const struct aiMatrix4x4 *m, struct aiMatrix4x4 *to)
{
    const float *r = &m->a1;
    float *o = &to->a1;
    memset(to, 0, sizeof *to);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int a = 4 * ((i + 1) % 3), b = 4 * ((i + 2) % 3), c = (j + 1) % 3, d = (j + 2) % 3;
            o[4 * i + j] = r[a + c] * r[b + d] - r[a + d] * r[b + c];
        }
    const double det = (double)r[0] * (double)o[0] + (double)r[1] * (double)o[1] + (double)r[2] * (double)o[2];
    for (int k = 0; k < 12 && det < 0; k++)
        o[k] = -o[k];
    return det;
}

static void take_corner(const struct aiMesh *from, unsigned index, const struct aiMatrix4x4 *m,
                        const struct aiMatrix4x4 *normals, float at[3], float normal[3], float uv[2])
{
    for (int k = 0; k < 3; k++) {
        const float sign = k == 2 ? -1 : 1; /* right-handed to left-handed */
        at[k] = sign * (float)place(m, k, &from->mVertices[index], 1);
        normal[k] = from->mNormals ? sign * (float)place(normals, k, &from->mNormals[index], 0) : 0;
    }
    const bool has = from->mTextureCoords[0] != NULL;
    uv[0] = has ? from->mTextureCoords[0][index].x : NAN;
    uv[1] = has ? 1 - from->mTextureCoords[0][index].y : NAN;
}

static void take_mesh(harvest *h, const struct aiMesh *from, const struct aiMatrix4x4 *m)
{
    struct aiMatrix4x4 normals;
    const bool mirrors = cofactors(m, &normals) < 0;
    for (unsigned k = 0; k < from->mNumFaces; k++) {
        const struct aiFace *f = &from->mFaces[k];
        if (f->mNumIndices != 3)
            continue;                 /* points and lines; assimp's validation has refused indices out of range */
        for (int i = 0; i < 3; i++) { /* left-handed reverses the corners; a matrix that mirrors reverses them back */
            const int c = mirrors || i == 0 ? i : 3 - i;
            take_corner(from, f->mIndices[i], m, &normals, h->to->at[h->n][c], h->to->skin[h->n].normal[c],
                        h->to->skin[h->n].uv[c]);
        }
        h->n++;
    }
}

/* The triangles of all parts, one part behind the other. */
static void take_parts(const struct aiScene *s, const model_parts *p, mesh_data *to)
{
    harvest h = {to, 0};
    for (int k = 0; k < p->n; k++) {
        to->part[k].first = (int)h.n;
        to->part[k].n = (int)p->part[k].n;
        memcpy(to->part[k].name, p->part[k].name, sizeof p->part[k].name);
        take_mesh(&h, s->mMeshes[p->part[k].mesh], &p->part[k].m);
    }
}

static bool harvest_scene(const struct aiScene *s, mesh_data *out, char why[MESH_WHY])
{
    model_parts p;
    const bool good = parts_list(s, &p, why);
    if (good) {
        const size_t n = (size_t)p.triangles;
        *out = (mesh_data){.n = (int)n,
                           .at = malloc(sizeof *out->at * n),
                           .skin = malloc(sizeof *out->skin * n),
                           .part = calloc((size_t)p.n, sizeof *out->part),
                           .parts = p.n};
    }
    const bool room = good && out->at && out->skin && out->part;
    if (room)
        take_parts(s, &p, out);
    else if (good)
        snprintf(why, MESH_WHY, "out of memory");
    free(p.part);
    return room;
}

/* An STL has only the triangles' own normals, which would make smooth surfaces flat. */
static void forget_normals(mesh_data *d)
{
    for (int k = 0; k < d->n; k++)
        memset(d->skin[k].normal, 0, sizeof d->skin[k].normal);
}

bool import_model(const char *path, const import_listener *to, mesh_data *out, char why[MESH_WHY])
{
    const struct aiScene *s = import_open(path, to, why);
    const bool good = s && harvest_scene(s, out, why);
    if (good && import_ends_with(path, ".stl"))
        forget_normals(out);
    return good; /* nothing is freed, as the program ends */
}
