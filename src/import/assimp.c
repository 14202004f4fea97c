/* Reads models by assimp.
 *
 * All triangles are taken, with the matrices of their nodes; polygons are divided into triangles. Materials, textures,
 * bones, cameras and lights are ignored. The formats are right-handed, so z changes its sign and corners their order.
 * Texture coordinates have v upward (assimp turns glTF's, too): w = 1 - v.
 */
#include "import/import.h"

#include <assimp/cfileio.h>
#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* ---- files ---- */

typedef struct reading {
    const char *path;
    bool buffers;      /* glTF: other files may be opened, too */
    size_t size, done; /* bytes of the model */
    double shown;      /* the last share that was reported */
    const import_listener *to;
} reading;

/* An open file. assimp passes `base` to the functions below. */
typedef struct source {
    struct aiFile base;
    FILE *file;
    reading *of;
} source;

static void report_share(reading *k)
{
    const double share = k->done < k->size ? (double)k->done / (double)k->size : 1;
    if (share < k->shown + 0.01 && share < 1)
        return;
    k->shown = share;
    k->to->read(k->to->user, share);
}

static size_t read_some(struct aiFile *base, char *to, size_t size, size_t count)
{
    enum { PIECE = 1 << 20 };
    source *s = (source *)(void *)base->UserData;
    size_t all = size * count, got = 0, n = 1;
    while (got < all && n > 0) {
        n = fread(to + got, 1, all - got < PIECE ? all - got : PIECE, s->file);
        got += n;
        s->of->done += n;
        report_share(s->of);
    }
    return size ? got / size : 0;
}

static size_t write_none(struct aiFile *base, const char *from, size_t size, size_t count)
{
    (void)base, (void)from, (void)size, (void)count;
    return 0;
}

static size_t tell(struct aiFile *base)
{
    const long at = ftell(((source *)(void *)base->UserData)->file);
    return at < 0 ? 0 : (size_t)at;
}

static size_t size_of(struct aiFile *base)
{
    struct stat about;
    return fstat(fileno(((source *)(void *)base->UserData)->file), &about) == 0 ? (size_t)about.st_size : 0;
}

static enum aiReturn seek(struct aiFile *base, size_t offset, enum aiOrigin origin)
{
    const int from = origin == aiOrigin_SET ? SEEK_SET : origin == aiOrigin_CUR ? SEEK_CUR : SEEK_END;
    return fseek(((source *)(void *)base->UserData)->file, (long)offset, from) == 0 ? aiReturn_SUCCESS
                                                                                    : aiReturn_FAILURE;
}

static void flush(struct aiFile *base) { (void)base; }

/* Whether f is a regular file. If so, report it. */
static bool report_file(FILE *f, const import_listener *to)
{
    struct stat about;
    if (fstat(fileno(f), &about) != 0 || !S_ISREG(about.st_mode))
        return false;
    to->open(to->user, file_id_of(&about));
    return true;
}

static struct aiFile *open_one(struct aiFileIO *io, const char *path, const char *mode)
{
    reading *of = (reading *)(void *)io->UserData;
    FILE *f = mode[0] == 'r' && (of->buffers || strcmp(path, of->path) == 0) ? fopen(path, "rb") : NULL;
    source *s = f && report_file(f, of->to) ? malloc(sizeof *s) : NULL;
    if (!s) {
        if (f)
            fclose(f);
        return NULL;
    }
    *s = (source){{.FileSizeProc = size_of,
                   .FlushProc = flush,
                   .ReadProc = read_some,
                   .SeekProc = seek,
                   .TellProc = tell,
                   .WriteProc = write_none},
                  f,
                  of};
    s->base.UserData = (aiUserData)(void *)s;
    return &s->base;
}

static void close_one(struct aiFileIO *io, struct aiFile *base)
{
    source *s = (source *)(void *)base->UserData;
    (void)io;
    fclose(s->file);
    free(s);
}

/* ---- from the scene to triangles ---- */

typedef struct harvest {
    const struct aiScene *s;
    mesh_data *to; /* NULL: only count */
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
        if (f->mNumIndices != 3 || f->mIndices[0] >= from->mNumVertices || f->mIndices[1] >= from->mNumVertices ||
            f->mIndices[2] >= from->mNumVertices)
            continue; /* points and lines; assimp's validation has refused the rest */
        if (h->to)
            for (int i = 0; i < 3;
                 i++) { /* left-handed reverses the corners; a matrix that mirrors reverses them back */
                const int c = mirrors || i == 0 ? i : 3 - i;
                take_corner(from, f->mIndices[i], m, &normals, h->to->at[h->n][c], h->to->skin[h->n].normal[c],
                            h->to->skin[h->n].uv[c]);
            }
        h->n++;
    }
}

static void take_node(harvest *h, const struct aiNode *node, const struct aiMatrix4x4 *above)
{
    struct aiMatrix4x4 m = *above;
    aiMultiplyMatrix4(&m, &node->mTransformation);
    for (unsigned k = 0; k < node->mNumMeshes && h->n <= MESH_MOST; k++)
        if (node->mMeshes[k] < h->s->mNumMeshes)
            take_mesh(h, h->s->mMeshes[node->mMeshes[k]], &m);
    for (unsigned k = 0; k < node->mNumChildren && h->n <= MESH_MOST; k++)
        take_node(h, node->mChildren[k], &m);
}

static int64_t take_all(const struct aiScene *s, mesh_data *to)
{
    harvest h = {s, to, 0};
    struct aiMatrix4x4 m;
    aiIdentityMatrix4(&m);
    if (s->mRootNode)
        take_node(&h, s->mRootNode, &m);
    return h.n;
}

static bool harvest_scene(const struct aiScene *s, mesh_data *out, char why[MESH_WHY])
{
    const int64_t n = take_all(s, NULL);
    if (n == 0 || n > MESH_MOST) {
        if (n)
            snprintf(why, MESH_WHY, "more than %d triangles, expected no more", MESH_MOST);
        else
            snprintf(why, MESH_WHY, "no triangles, expected at least one");
        return false;
    }
    *out = (mesh_data){(int)n, malloc(sizeof *out->at * (size_t)n), malloc(sizeof *out->skin * (size_t)n), {0}};
    if (!out->at || !out->skin) {
        free(out->at);
        free(out->skin);
        snprintf(why, MESH_WHY, "out of memory");
        return false;
    }
    take_all(s, out);
    return true;
}

/* An STL has only the triangles' own normals, which would make smooth surfaces flat. */
static void forget_normals(mesh_data *d)
{
    for (int k = 0; k < d->n; k++)
        memset(d->skin[k].normal, 0, sizeof d->skin[k].normal);
}

static bool ends_with(const char *path, const char *end)
{
    const size_t n = strlen(path), m = strlen(end);
    for (size_t k = 0; n >= m && k < m; k++)
        if ((path[n - m + k] | 0x20) != (end[k] | 0x20))
            return false;
    return n >= m;
}

bool import_model(const char *path, const import_listener *to, mesh_data *out, char why[MESH_WHY])
{
    struct stat about;
    reading of = {path, ends_with(path, ".gltf"), stat(path, &about) == 0 ? (size_t)about.st_size : 0, 0, 0, to};
    struct aiFileIO io = {.OpenProc = open_one, .CloseProc = close_one, .UserData = (aiUserData)(void *)&of};
    struct aiPropertyStore *how = aiCreatePropertyStore();
    aiSetImportPropertyInteger(how, AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    aiSetImportPropertyInteger(how, AI_CONFIG_IMPORT_NO_SKELETON_MESHES, 1);
    const struct aiScene *s = aiImportFileExWithProperties(
        path, aiProcess_ValidateDataStructure | aiProcess_Triangulate | aiProcess_SortByPType, &io, how);
    bool good = false;
    if (!s) {
        const char *text = aiGetErrorString();
        snprintf(why, MESH_WHY, "%s", *text ? text : "it can't be read");
    } else
        good = harvest_scene(s, out, why);
    if (good && ends_with(path, ".stl"))
        forget_normals(out);
    if (s)
        aiReleaseImport(s);
    aiReleasePropertyStore(how);
    return good;
}
