/* Opening a model by assimp. */
#ifndef KAGE_IMPORT_OPEN_H
#define KAGE_IMPORT_OPEN_H

#include <assimp/scene.h>

#include "import/import.h"

/* assimp's scene: triangles, one mesh for each material of a node. NULL: `why` has one line. The caller frees it by
 * aiReleaseImport. */
const struct aiScene *import_open(const char *path, const import_listener *to, char why[MESH_WHY]);

/* Whether a name ends so, in small or large letters. */
bool import_ends_with(const char *path, const char *end);

#endif
