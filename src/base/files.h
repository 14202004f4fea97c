/* A set of files, compared by device and inode because a file can have several names. A scene keeps the set of its
 * inputs, so that no output replaces one. */
#ifndef KAGE_BASE_FILES_H
#define KAGE_BASE_FILES_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <sys/stat.h>
#include <sys/types.h>

/* The same for all names of a file. */
typedef struct file_id {
    dev_t device;
    ino_t number;
} file_id;

typedef struct files {
    file_id *id; /* owned */
    int count;
} files;

/* Bytes of a file that a scene names. */
#define FILES_MOST ((int64_t)1 << 34)

/* Open an input to read it. A pipe would be waited for, a device may have no end: what is no regular file is not
 * opened. NULL, with a reason in *why. */
FILE *files_open_input(const char *path, const char **why);

static inline file_id file_id_of(const struct stat *about) { return (file_id){about->st_dev, about->st_ino}; }

/* Add a file, once. False: out of memory. */
bool files_add(files *f, file_id id);

/* The same by a path; links are followed. Only regular files are added: others cannot be lost. */
bool files_add_path(files *f, const char *path);

bool files_have_path(const files *f, const char *path);

void files_free(files *f);

#endif
