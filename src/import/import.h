/* Reading a model into memory, in the program kage-import: its triangles, or all of it as the text of a scene. */
#ifndef KAGE_IMPORT_IMPORT_H
#define KAGE_IMPORT_IMPORT_H

#include "mesh/mesh_data.h"

/* Called for each file that is opened, and with the share of the model that has been read, 0..1. note: something in the
 * model that the scene lacks, in one line. file: a file that the scene needs beside it. */
typedef struct import_listener {
    void (*open)(void *user, file_id id);
    void (*read)(void *user, double share);
    void (*note)(void *user, const char *text);
    void (*file)(void *user, const char *name, const void *bytes, size_t size);
    void *user;
} import_listener;

/* Read the model at `path`. The caller frees out->at, out->skin and out->part. False: `why` has one line. */
bool import_model(const char *path, const import_listener *to, mesh_data *out, char why[MESH_WHY]);

/* A bump for the objects whose name, in the scene or in the model, fits a pattern with * and ?. */
typedef struct import_bump {
    const char *object, *map; /* the map's file as the scene names it */
    const char *rest;         /* key=value, with commas between them */
    bool used;
} import_bump;

typedef struct import_wish {
    const char *model;  /* the model's file as the scene names it */
    const char *folder; /* the model's folder as the scene names it: "" or with a slash at its end */
    const char *stem;   /* begins the names of the images that are written */
    const char *camera; /* its name; NULL: the first */
    bool z_up;
    double brightness; /* a factor for all lights */
    int bumps;
    import_bump *bump;
} import_wish;

/* Read the model at `path` as a scene. Returns its YAML, to be freed. NULL: `why` has one line. */
char *import_scene(const char *path, const import_wish *wish, const import_listener *to, char why[MESH_WHY]);

#endif
