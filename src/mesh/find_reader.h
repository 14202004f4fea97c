/* Where the program is that reads models. Private to mesh/load.c. */
#ifndef KAGE_MESH_FIND_READER_H
#define KAGE_MESH_FIND_READER_H

#include <stdbool.h>
#include <stddef.h>

enum { READER_PATH = 4096 };

/* The path of kage-import; `asked`: the caller's own, or NULL. False: why not, in one line of at most `size` bytes. */
bool find_reader(const char *asked, char path[READER_PATH], char *why, size_t size);

#endif
