/* What kage-import (room import) writes for mesh/reader.c through a pipe: letters, with bytes behind some of them. Both
 * are built from the same source for the same machine, so structs go as they are.
 */
#ifndef KAGE_MESH_LETTER_H
#define KAGE_MESH_LETTER_H

#include "mesh/mesh_data.h"

/* The descriptor that kage-import writes to; its stdout and stderr are /dev/null. */
enum { LETTER_FD = 3 };

/* kage-import FILE: its triangles. kage-import FILE and LETTER_WISHES more arguments, then three for each bump: the
 * text of a scene; they are the members of import_wish (import/import.h) in their order, and those of import_bump. */
enum { LETTER_WISHES = 6 };

/* Each letter begins with it. It changes with the struct, so that a kage-import of another version is refused. */
#define LETTER_MAGIC 0x6b61676532ull

/* The limits of time of kage-import; errors state them. A scene's images may take more. */
#define MIB ((size_t)1 << 20)
enum { LETTER_SECONDS = 3, LETTER_MIB_A_SECOND = 1, LETTER_SCENE_SECONDS = 120 };

typedef struct letter {
    uint64_t magic;
    enum {
        LETTER_OPENED, /* a file is opened */
        LETTER_READ,   /* a share of the file is read */
        LETTER_WRONG,  /* the end: `why` */
        LETTER_NOTE,   /* `why` is something that the scene lacks */
        LETTER_FILE,   /* a file for the scene: its name is in `why`, `size` bytes follow */
        LETTER_DONE,   /* the end: the corners of data.n triangles follow, their skins, then data.parts parts; or
                          `size` bytes of a scene's text */
    } is;
    file_id opened;
    double share;
    size_t size;
    mesh_data data; /* without its arrays */
    char why[MESH_WHY];
} letter;

#endif
