/* Output files that appear complete or not at all. */
#ifndef KAGE_BASE_FILE_WRITER_H
#define KAGE_BASE_FILE_WRITER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/errors.h"

/* A file being written. It has no name yet, or another one in the same directory (base/aside.h), and gets its own at
 * the end. If `path` is not a regular file (a terminal, a pipe, /dev/null), the bytes are copied there instead; so they
 * are for a descriptor of the process (/dev/stdout, /dev/fd/3), whatever it is. One thread at a time. */
typedef struct file_writer {
    const char *path; /* the caller's, for messages */
    char *target;     /* path with all links followed; NULL: not a regular file */
    char *aside;      /* the temporary name; NULL: the file has none */
    int fd;
    bool keep;     /* an unfinished file stays under its temporary name */
    uint64_t size; /* of the unfinished file that was there */
    int error;     /* errno of the first write that failed; 0: none */
} file_writer;

/* Start. `path` must outlive f. False, with a message in *e: f need not be closed. */
bool file_writer_open(file_writer *f, const char *path, errors *e);

/* The name of an unfinished file: where `path` leads, with .part behind it. The caller frees it. NULL, with errno set,
 * on failure. */
char *file_writer_part(const char *path);

/* Start, or go on: the temporary name is file_writer_part(path), and the file stays there until it is finished. resume:
 * keep what is in it, f->size bytes; else begin it anew, but only if there is nothing or a file that begins with these
 * 4 bytes. No two processes write it at a time. What is not a regular file is opened as by file_writer_open, and can't
 * be resumed.
 */
bool file_writer_open_part(file_writer *f, const char *path, bool resume, const char magic[4], errors *e);

/* Read what was there. False: it could not be read. */
bool file_writer_read(const file_writer *f, void *data, size_t size, uint64_t offset);

/* Cut off what is after the first `size` bytes. A failure is kept in f->error. */
bool file_writer_cut(file_writer *f, uint64_t size);

/* Put `size` bytes at `offset`. A failure is kept in f->error. */
bool file_writer_write(file_writer *f, const void *data, size_t size, uint64_t offset);

/* Finish the file if `why` is NULL, else delete it, unless it is kept. False, with one message in *e: the system's
 * reason if a write failed, else `why`, unless that is empty. */
bool file_writer_close(file_writer *f, const char *why, errors *e);

/* Whether a file could be written at `path` now. Nothing is changed. */
bool file_writer_probe(const char *path, errors *e);

#endif
