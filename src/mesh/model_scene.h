/* A whole model as a scene: its text, the files that it needs, and what it lacks. */
#ifndef KAGE_MESH_MODEL_SCENE_H
#define KAGE_MESH_MODEL_SCENE_H

#include "mesh/mesh_data.h"

typedef struct model_file {
    char *name; /* in the scene's folder, without a slash */
    unsigned char *bytes;
    size_t size;
} model_file;

/* Zero-initialise; model_scene_free. */
typedef struct model_scene {
    char *text;
    int files, notes;
    model_file *file;
    char **note; /* lines */
} model_scene;

/* Run the program `reader` (NULL: the one that reader.c finds) on the model, with the `count` arguments behind its path
 * that letter.h tells of. The files that it opens are added to *opened. False, with the reason in one line; *out may be
 * filled in part. */
bool model_scene_read(const char *path, const char *reader, int count, const char *const *argument, const progress *w,
                      files *opened, model_scene *out, char why[MESH_WHY]);

void model_scene_free(model_scene *s);

#endif
