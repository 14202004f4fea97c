/* The parts of a model, by a walk over its nodes. */
#include "import/parts.h"

#include <assimp/cimport.h>
#include <assimp/material.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 1 << 16 }; /* parts */

static int64_t triangles_of(const struct aiMesh *m)
{
    int64_t n = 0;
    for (unsigned k = 0; k < m->mNumFaces; k++)
        n += m->mFaces[k].mNumIndices == 3;
    return n;
}

/* FNV-1a */
static uint32_t hash_of(const char *s)
{
    uint32_t h = 2166136261u;
    for (; *s; s++)
        h = (h ^ (unsigned char)*s) * 16777619u;
    return h;
}

/* Whether a part before the last one has its name. Notes the hash. */
static bool is_taken(const model_parts *p)
{
    model_part *of = &p->part[p->n];
    of->hash = hash_of(of->name);
    for (int k = 0; k < p->n; k++)
        if (p->part[k].hash == of->hash && strcmp(p->part[k].name, of->name) == 0)
            return true;
    return false;
}

/* Only what can be read and typed: no controls; cut between characters of UTF-8. */
static void clean(char *s)
{
    size_t n = strlen(s), cut = n;
    while (cut > 0 && ((unsigned char)s[cut - 1] & 0xc0) == 0x80)
        cut--;
    if (n == MESH_PART_NAME - 1 && cut > 0 && ((unsigned char)s[cut - 1] & 0x80))
        s[cut - 1] = 0;
    for (; *s; s++)
        *s = (unsigned char)*s < 0x20 || *s == 0x7f ? '?' : *s;
}

/* Name the part p->part[p->n]. several: its node has more than one. */
static void name_part(const struct aiScene *s, model_parts *p, const char *node, bool several)
{
    struct aiString material = {0};
    char *name = p->part[p->n].name, first[MESH_PART_NAME];
    const unsigned m = s->mMeshes[p->part[p->n].mesh]->mMaterialIndex;
    if (several && m < s->mNumMaterials)
        aiGetMaterialString(s->mMaterials[m], AI_MATKEY_NAME, &material);
    char whole[2 * MESH_PART_NAME + 2];
    snprintf(whole, sizeof whole, "%.127s%s%.127s", *node ? node : PARTS_NAMELESS, several ? "/" : "", material.data);
    whole[MESH_PART_NAME - 1] = 0;
    strcpy(name, whole);
    clean(name);
    strcpy(first, name);
    for (int k = 2; is_taken(p); k++)
        snprintf(name, MESH_PART_NAME, "%.*s %d", MESH_PART_NAME - 12, first, k);
}

static bool add(const struct aiScene *s, model_parts *p, const struct aiNode *node, unsigned mesh,
                const struct aiMatrix4x4 *m)
{
    const int64_t n = triangles_of(s->mMeshes[mesh]);
    if (n == 0)
        return true;
    if (p->n == p->room) {
        model_part *more = p->n < MOST ? realloc(p->part, sizeof *more * (size_t)(p->room = 2 * p->room + 16)) : NULL;
        if (!more)
            return false;
        p->part = more;
    }
    p->part[p->n] = (model_part){.mesh = mesh, .m = *m, .n = n};
    name_part(s, p, node->mName.data, node->mNumMeshes > 1);
    p->n++;
    p->triangles += n;
    return true;
}

/* False: out of memory. */
static bool walk(const struct aiScene *s, model_parts *p, const struct aiNode *node, const struct aiMatrix4x4 *above)
{
    struct aiMatrix4x4 m = *above;
    bool good = true;
    aiMultiplyMatrix4(&m, &node->mTransformation);
    for (unsigned k = 0; k < node->mNumMeshes && good && p->triangles <= MESH_MOST; k++)
        if (node->mMeshes[k] < s->mNumMeshes)
            good = add(s, p, node, node->mMeshes[k], &m);
    for (unsigned k = 0; k < node->mNumChildren && good && p->triangles <= MESH_MOST; k++)
        good = walk(s, p, node->mChildren[k], &m);
    return good;
}

bool parts_list(const struct aiScene *s, model_parts *to, char why[MESH_WHY])
{
    struct aiMatrix4x4 m;
    aiIdentityMatrix4(&m);
    *to = (model_parts){0};
    if (s->mRootNode && !walk(s, to, s->mRootNode, &m))
        snprintf(why, MESH_WHY, "out of memory");
    else if (to->triangles > MESH_MOST)
        snprintf(why, MESH_WHY, "more than %d triangles, expected no more", MESH_MOST);
    else if (to->triangles == 0)
        snprintf(why, MESH_WHY, "no triangles, expected at least one");
    else
        return true;
    return false;
}

/* False: neither the node nor one below has the name. */
static bool find(const struct aiNode *node, const char *name, const struct aiMatrix4x4 *above, struct aiMatrix4x4 *out)
{
    struct aiMatrix4x4 m = *above;
    aiMultiplyMatrix4(&m, &node->mTransformation);
    if (strcmp(node->mName.data, name) == 0) {
        *out = m;
        return true;
    }
    for (unsigned k = 0; k < node->mNumChildren; k++)
        if (find(node->mChildren[k], name, &m, out))
            return true;
    return false;
}

struct aiMatrix4x4 parts_matrix(const struct aiScene *s, const char *node)
{
    struct aiMatrix4x4 one, m;
    aiIdentityMatrix4(&one);
    return s->mRootNode && find(s->mRootNode, node, &one, &m) ? m : one;
}
