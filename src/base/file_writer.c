/* Writes a file under a temporary name and renames it when it is complete. */
#define _XOPEN_SOURCE 700 /* realpath */

#include "base/file_writer.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool fail(const char *path, const char *why, errors *e)
{
    return errors_add(e, "%s: cannot be written: %s", path, why);
}

/* Create a hidden file with a new name in `dir`, which ends with a slash ("": the current directory). Unlike mkstemp it
 * has a new file's usual permissions. The caller frees the name. NULL, with errno set, on failure. */
static char *create_aside(const char *dir, size_t dir_length, int *fd)
{
    const size_t room = dir_length + 64;
    char *name = malloc(room);
    *fd = -1;
    for (int n = 0; name && *fd < 0 && n < 1000; n++) {
        snprintf(name, room, "%.*s.kage-%ld-%d", (int)dir_length, dir, (long)getpid(), n);
        *fd = open(name, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (*fd < 0 && errno != EEXIST)
            break; /* EEXIST: another thread's, or left by a process that was killed */
    }
    if (*fd < 0) {
        int error = errno;
        free(name);
        errno = error;
        return NULL;
    }
    return name;
}

bool file_writer_open(file_writer *f, const char *path, errors *e)
{
    struct stat st;
    const bool exists = stat(path, &st) == 0;
    *f = (file_writer){.path = path, .fd = -1};
    if (exists && S_ISDIR(st.st_mode))
        return fail(path, strerror(EISDIR), e);
    if (exists && !S_ISREG(st.st_mode)) {
        static const char dir[] = "/tmp/";
        f->aside = create_aside(dir, sizeof dir - 1, &f->fd);
        if (!f->aside)
            return errors_add(e, "%s: no room to prepare it in %s: %s", path, dir, strerror(errno));
        unlink(f->aside); /* the open file suffices for the copy */
        free(f->aside);
        f->aside = NULL;
        return true;
    }
    /* Renaming needs no permission to write to the old file, but a read-only file must stay as it is. */
    if (exists && access(path, W_OK) != 0)
        return fail(path, strerror(errno), e);
    f->target = exists ? realpath(path, NULL) : strdup(path);
    if (!f->target)
        return fail(path, strerror(errno), e);
    const char *slash = strrchr(f->target, '/');
    f->aside = create_aside(f->target, slash ? (size_t)(slash + 1 - f->target) : 0, &f->fd);
    if (!f->aside) {
        fail(path, strerror(errno), e);
        free(f->target);
        return false;
    }
    return true;
}

static bool write_all(int fd, const char *data, size_t size)
{
    while (size > 0) {
        ssize_t n = write(fd, data, size);
        if (n < 0 && errno != EINTR)
            return false;
        if (n > 0) {
            data += n;
            size -= (size_t)n;
        }
    }
    return true;
}

bool file_writer_write(file_writer *f, const void *data, size_t size, uint64_t offset)
{
    if (!f->error && (lseek(f->fd, (off_t)offset, SEEK_SET) < 0 || !write_all(f->fd, data, size)))
        f->error = errno;
    return !f->error;
}

/* Is the open file empty, or does it begin with these bytes? */
static bool begins_with(int fd, const char magic[4])
{
    char found[4];
    const ssize_t n = pread(fd, found, sizeof found, 0);
    return n == 0 || (n == sizeof found && memcmp(found, magic, sizeof found) == 0);
}

/* Lock the open file f->aside against other processes, and see how much is in it. False: f->error, or a message. */
static bool take_part(file_writer *f, bool resume, const char magic[4], errors *e)
{
    struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    struct stat st;
    if (fcntl(f->fd, F_SETLK, &lock) != 0)
        return errno == EACCES || errno == EAGAIN ? fail(f->aside, "another process writes it", e)
                                                  : fail(f->aside, strerror(errno), e);
    if (!begins_with(f->fd, magic))
        return fail(f->aside, "there is a file that is no unfinished picture, expected none", e);
    if (fstat(f->fd, &st) != 0 || (!resume && ftruncate(f->fd, 0) != 0))
        return fail(f->aside, strerror(errno), e);
    f->size = resume ? (uint64_t)st.st_size : 0;
    return true;
}

bool file_writer_open_part(file_writer *f, const char *path, bool resume, const char magic[4], errors *e)
{
    struct stat st;
    const bool exists = stat(path, &st) == 0;
    *f = (file_writer){.path = path, .fd = -1, .keep = true};
    if (exists && !S_ISREG(st.st_mode)) /* nothing stays of a pipe */
        return resume && !S_ISDIR(st.st_mode) ? fail(path, "an unfinished picture needs a regular file", e)
                                              : file_writer_open(f, path, e);
    if (exists && access(path, W_OK) != 0)
        return fail(path, strerror(errno), e);
    f->target = exists ? realpath(path, NULL) : strdup(path);
    const size_t room = f->target ? strlen(f->target) + sizeof ".part" : 0;
    f->aside = f->target ? malloc(room) : NULL;
    bool good = f->aside != NULL;
    if (good) {
        snprintf(f->aside, room, "%s.part", f->target);
        f->fd = open(f->aside, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    }
    if (f->fd < 0)
        good = fail(path, strerror(errno), e);
    else if (!take_part(f, resume, magic, e)) {
        close(f->fd);
        good = false;
    }
    if (!good) {
        free(f->aside);
        free(f->target);
    }
    return good;
}

bool file_writer_read(const file_writer *f, void *data, size_t size, uint64_t offset)
{
    char *to = data;
    while (size > 0) {
        const ssize_t n = pread(f->fd, to, size, (off_t)offset);
        if (n == 0 || (n < 0 && errno != EINTR))
            return false;
        if (n > 0) {
            to += n;
            offset += (uint64_t)n;
            size -= (size_t)n;
        }
    }
    return true;
}

bool file_writer_cut(file_writer *f, uint64_t size)
{
    if (!f->error && ftruncate(f->fd, (off_t)size) != 0)
        f->error = errno;
    return !f->error;
}

/* Copy all of `from` into `path`. 0, or errno. */
static int copy_to(const char *path, int from)
{
    char block[65536];
    ssize_t n = 0;
    int to = open(path, O_WRONLY | O_CLOEXEC);
    if (to < 0)
        return errno;
    int error = lseek(from, 0, SEEK_SET) < 0 ? errno : 0;
    while (!error && (n = read(from, block, sizeof block)) != 0)
        if (n < 0 || !write_all(to, block, (size_t)n))
            error = errno;
    if (close(to) != 0 && !error)
        error = errno;
    return error;
}

bool file_writer_close(file_writer *f, const char *why, errors *e)
{
    if (!why && !f->error && !f->target)
        f->error = copy_to(f->path, f->fd);
    if (close(f->fd) != 0 && !f->error) /* some file systems only report here that the disk is full */
        f->error = errno;
    if (!why && !f->error && f->target && rename(f->aside, f->target) != 0)
        f->error = errno;
    if ((why || f->error) && f->aside && !f->keep)
        unlink(f->aside);
    free(f->aside);
    free(f->target);
    if (f->error)
        return fail(f->path, strerror(f->error), e);
    return !why || (*why && fail(f->path, why, e));
}
