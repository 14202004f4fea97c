/* What the files share that write a model as a scene. */
#ifndef KAGE_IMPORT_SCENE_H
#define KAGE_IMPORT_SCENE_H

#include <assimp/scene.h>

#include "import/import.h"
#include "import/parts.h"
#include "import/text.h"

/* An image that is used, and the colour that multiplies it. */
typedef struct scene_image {
    char *key;  /* what the model calls it, and the colour; owned */
    char *file; /* as the scene names it; owned. NULL: it can't be used, as was noted */
} scene_image;

/* A material in its two forms: for objects with texture coordinates and without. */
typedef struct scene_material {
    bool used[2];
    char name[2][TEXT_NAME];
} scene_material;

typedef struct importer {
    const struct aiScene *s;
    const char *path;
    const import_wish *wish;
    const import_listener *to;
    bool gltf;
    model_parts parts;
    char (*object)[TEXT_NAME]; /* the name of each part's object */
    int *bump;                 /* the bump of each part; -1: none */
    scene_material *material;  /* for each of assimp's, and one more for triangles without any */
    scene_image *image;
    int images;
    double lo[3], hi[3]; /* the box around the triangles, in the scene's coordinates */
    text out;
} importer;

/* ---- place.c ---- */

/* A point (one: 1) or a direction (0) of a node with the matrix m, in the scene's coordinates. */
void scene_place(const importer *k, const struct aiMatrix4x4 *m, const struct aiVector3D *v, double one, double to[3]);

/* The middle of the box, and the length of its diagonal. */
double scene_middle(const importer *k, double middle[3]);

/* Tell what the scene lacks, to the user and as a comment in the scene, indented by `indent`. */
void scene_tell(importer *k, int indent, const char *fmt, ...) TEXT_PRINTF(3, 4);

/* ---- camera.c ---- */

/* The keys camera and image. False, with a reason: there is no camera of the name. */
bool scene_camera(importer *k, char why[MESH_WHY]);

/* ---- lights.c ---- */

/* The key lights. */
void scene_lights(importer *k);

/* ---- material.c ---- */

/* The key materials: those that are used. */
void scene_materials(importer *k);

/* ---- image.c ---- */

/* The file for a material's image, times a colour; kage's own or converted. NULL: it can't be used; noted. owner: the
 * name of the material, for notes. */
const char *scene_image_file(importer *k, const char *uri, const double factor[3], const char *owner);

/* ---- bump.c ---- */

/* Find the bump of each part, in k->bump. False, with a reason. */
bool scene_find_bumps(importer *k, char why[MESH_WHY]);

/* The key bump of an object. */
void scene_write_bump(importer *k, const import_bump *b);

#endif
