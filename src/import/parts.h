/* The parts of a model: the triangles of one node that have one material. Scenes name them, so their names depend on
 * nothing but the model.
 */
#ifndef KAGE_IMPORT_PARTS_H
#define KAGE_IMPORT_PARTS_H

#include <assimp/scene.h>

#include "mesh/mesh_data.h"

#define PARTS_NAMELESS "part" /* the name of a part whose node has none */

typedef struct model_part {
    char name[MESH_PART_NAME];
    uint32_t hash; /* of the name */
    unsigned mesh; /* index into aiScene.mMeshes */
    struct aiMatrix4x4 m;
    int64_t n; /* triangles */
} model_part;

typedef struct model_parts {
    model_part *part; /* owned */
    int n, room;
    int64_t triangles;
} model_parts;

/* List the parts in the order of the file, with their nodes' matrices. A part has its node's name; `/` and the
 * material's follow where the node has several materials; ` 2`, ` 3` ... where an earlier part has the name. False,
 * with a reason: none, too many triangles, or out of memory. The caller frees to->part in either case. */
bool parts_list(const struct aiScene *s, model_parts *to, char why[MESH_WHY]);

/* The matrix of the node with this name; the identity if there is none. */
struct aiMatrix4x4 parts_matrix(const struct aiScene *s, const char *node);

#endif
