/* The model importer, as it runs in the program kage-import. */
#ifndef KAGE_IMPORT_IMPORT_H
#define KAGE_IMPORT_IMPORT_H

#include "mesh/mesh_data.h"

/* Who hears of each file that is opened, and of the share of the model that has been read. */
typedef struct import_listener {
    void (*open)(void *user, file_id id);
    void (*read)(void *user, double share);
    void *user;
} import_listener;

/* Read the model in the file at `path`. False, and why not in one line. */
bool import_model(const char *path, const import_listener *to, mesh_data *out, char why[MESH_WHY]);

#endif
