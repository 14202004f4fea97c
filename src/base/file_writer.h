/* Output files that appear whole or not at all. */
#ifndef KAGE_BASE_FILE_WRITER_H
#define KAGE_BASE_FILE_WRITER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/errors.h"

/* A file being written. Nobody sees it at `path` before it is whole: it grows under another name in the same
 * directory and is renamed at the end. A path that leads to something other than a regular file (a terminal,
 * a pipe, /dev/null) keeps being that: the bytes are then copied there at the end. */
typedef struct file_writer {
    const char *path; /* as the caller wrote it, for messages */
    char *target;     /* where to rename to, all links followed; NULL: copy to path instead */
    char *aside;      /* the name meanwhile; NULL: none any more */
    int fd;
    int error; /* errno of the first write that failed; 0: none */
} file_writer;

/* False with a message in *e; then there is nothing to close. */
bool file_writer_open(file_writer *f, const char *path, errors *e);

/* Put `size` bytes at `offset`. A failure is kept in f->error. */
bool file_writer_write(file_writer *f, const void *data, size_t size, uint64_t offset);

/* End the file: with `why` NULL it takes its place, otherwise it is dropped. False with one message in *e, which
 * gives the system's reason if a write has failed, else `why`. */
bool file_writer_close(file_writer *f, const char *why, errors *e);

#endif
