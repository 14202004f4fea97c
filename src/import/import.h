/* Reading a model into memory, in the program kage-import. */
#ifndef KAGE_IMPORT_IMPORT_H
#define KAGE_IMPORT_IMPORT_H

#include "mesh/mesh_data.h"

/* Called for each file that is opened, and with the share of the model that has been read, 0..1. */
typedef struct import_listener {
    void (*open)(void *user, file_id id);
    void (*read)(void *user, double share);
    void *user;
} import_listener;

/* Read the model at `path`. The caller frees out->at and out->skin. False: `why` has one line. */
bool import_model(const char *path, const import_listener *to, mesh_data *out, char why[MESH_WHY]);

#endif
