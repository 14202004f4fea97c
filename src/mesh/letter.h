/* What kage-import (room import) writes for mesh/load.c through a pipe: letters, and behind the last one the triangles.
 * Both are built from the same source for the same machine, so structs go as they are.
 */
#ifndef KAGE_MESH_LETTER_H
#define KAGE_MESH_LETTER_H

#include "mesh/mesh_data.h"

/* kage-import FILE: the descriptor that it writes to; its stdout and stderr are /dev/null. */
enum { LETTER_FD = 3 };

/* Each letter begins with it. It changes with the struct, so that a kage-import of another version is refused. */
#define LETTER_MAGIC 0x6b61676531ull

/* The limits of time of kage-import; errors state them. */
#define MIB ((size_t)1 << 20)
enum { LETTER_SECONDS = 3, LETTER_MIB_A_SECOND = 1 };

typedef struct letter {
    uint64_t magic;
    enum {
        LETTER_OPENED, /* a file is opened */
        LETTER_READ,   /* a share of the file is read */
        LETTER_WRONG,  /* the end: `why` */
        LETTER_DONE,   /* the end: the corners of data.n triangles follow, then their skins */
    } is;
    file_id opened;
    double share;
    mesh_data data; /* without its arrays */
    char why[MESH_WHY];
} letter;

#endif
