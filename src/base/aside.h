/* Files without a name, or with one for a time, in the folder of a file that is being written. */
#ifndef KAGE_BASE_ASIDE_H
#define KAGE_BASE_ASIDE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/errors.h"

/* Create a file in the folder of `target`. It has no name where the system can do so, so that nothing is left of a
 * process that is killed; else *name is one that aside_remove_stale knows. It is locked as long as it is open. The
 * caller frees *name. Returns the descriptor; -1, with errno set, on failure. */
int aside_create(const char *target, char **name);

/* Give the open file the name `target`, in place of an older file. name: what it has, else NULL. `target` is the old
 * file or the new one at any time. 0, or errno; then no file is left under another name. */
int aside_rename(int fd, const char *name, const char *target);

/* Remove what processes that were killed have left in the folder of `path`: files with a name of aside_create that
 * nobody has open. Adds a line to *found for each. */
void aside_remove_stale(const char *path, errors *found);

/* The file that `path` leads to: all links are followed, the last one also where it leads to nothing. NULL, with errno
 * set: there is no such folder, or too many links. The caller frees it. */
char *aside_target(const char *path);

#endif
