/* Writes a file without a name, or under a temporary one, and names it when it is complete. */
#define _GNU_SOURCE /* flock */

#include "base/file_writer.h"

#include "base/aside.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static bool fail(const char *path, const char *why, errors *e)
{
    return errors_add(e, "%s: cannot be written: %s", path, why);
}

/* The descriptor that a path stands for; -1: it stands for a file. */
static int descriptor_of(const char *path)
{
    static const char *const folders[] = {"/dev/fd/", "/proc/self/fd/"};
    if (strcmp(path, "/dev/stdout") == 0)
        return STDOUT_FILENO;
    if (strcmp(path, "/dev/stderr") == 0)
        return STDERR_FILENO;
    for (size_t k = 0; k < sizeof folders / sizeof *folders; k++) {
        const char *number = path + strlen(folders[k]);
        if (strncmp(path, folders[k], strlen(folders[k])) == 0 && *number && strlen(number) < 8 &&
            strspn(number, "0123456789") == strlen(number))
            return atoi(number);
    }
    return -1;
}

/* Prepare what is copied at the end, without a name. */
static bool open_copy(file_writer *f, errors *e)
{
    static const char folder[] = "/tmp/";
    char *name;
    f->fd = aside_create(folder, &name);
    if (f->fd < 0)
        return errors_add(e, "%s: no room to prepare it in %s: %s", f->path, folder, strerror(errno));
    if (name)
        unlink(name); /* the open file suffices */
    free(name);
    return true;
}

/* Renaming needs no permission to write to the old file, but a read-only file must stay as it is. */
static bool set_target(file_writer *f, errors *e)
{
    if (access(f->path, W_OK) != 0 && errno != ENOENT)
        return fail(f->path, strerror(errno), e);
    f->target = aside_target(f->path);
    return f->target || fail(f->path, strerror(errno), e);
}

bool file_writer_open(file_writer *f, const char *path, errors *e)
{
    struct stat st;
    const int number = descriptor_of(path);
    *f = (file_writer){.path = path, .fd = -1};
    if (number >= 0 && fcntl(number, F_GETFL) < 0)
        return fail(path, strerror(errno), e);
    const bool exists = stat(path, &st) == 0;
    if (exists && S_ISDIR(st.st_mode))
        return fail(path, strerror(EISDIR), e);
    if (number >= 0 || (exists && !S_ISREG(st.st_mode)))
        return open_copy(f, e);
    if (!set_target(f, e))
        return false;
    f->fd = aside_create(f->target, &f->aside);
    if (f->fd >= 0)
        return true;
    fail(path, strerror(errno), e);
    free(f->target);
    return false;
}

/* A pipe that its reader set so may refuse bytes until it has room. */
static bool wait_for_room(int fd)
{
    struct pollfd room = {.fd = fd, .events = POLLOUT};
    return poll(&room, 1, -1) >= 0 || errno == EINTR;
}

static bool write_all(int fd, const char *data, size_t size)
{
    while (size > 0) {
        const ssize_t n = write(fd, data, size);
        if (n > 0) {
            data += n;
            size -= (size_t)n;
        } else if (n == 0)
            errno = EIO;
        if (n == 0 || (n < 0 && errno != EINTR && !(errno == EAGAIN && wait_for_room(fd))))
            return false;
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

/* Open PATH.part and lock it against other processes. One that has just finished it may have renamed it meanwhile, so
 * that what was opened is a good file. */
static bool lock_part(file_writer *f, errors *e)
{
    struct stat opened, named;
    f->fd = open(f->aside, O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK, 0666);
    if (f->fd < 0)
        return fail(f->aside, strerror(errno), e);
    if (flock(f->fd, LOCK_EX | LOCK_NB) != 0)
        return fail(f->aside, errno == EWOULDBLOCK ? "another process writes it" : strerror(errno), e);
    if (fstat(f->fd, &opened) != 0)
        return fail(f->aside, strerror(errno), e);
    if (stat(f->aside, &named) != 0 || opened.st_dev != named.st_dev || opened.st_ino != named.st_ino)
        return fail(f->aside, "another process has just finished it", e);
    return true;
}

/* See how much is in it. */
static bool take_part(file_writer *f, bool resume, const char magic[4], errors *e)
{
    struct stat st;
    if (!lock_part(f, e))
        return false;
    if (!begins_with(f->fd, magic))
        return fail(f->aside, "there is a file that is no unfinished picture, expected none", e);
    if (fstat(f->fd, &st) != 0 || (!resume && ftruncate(f->fd, 0) != 0))
        return fail(f->aside, strerror(errno), e);
    f->size = resume ? (uint64_t)st.st_size : 0;
    return true;
}

char *file_writer_part(const char *path)
{
    char *target = aside_target(path);
    const size_t room = target ? strlen(target) + sizeof ".part" : 0;
    char *name = target ? malloc(room) : NULL;
    if (name)
        snprintf(name, room, "%s.part", target);
    free(target);
    return name;
}

bool file_writer_open_part(file_writer *f, const char *path, bool resume, const char magic[4], errors *e)
{
    struct stat st;
    *f = (file_writer){.path = path, .fd = -1, .keep = true};
    if (descriptor_of(path) >= 0 || (stat(path, &st) == 0 && !S_ISREG(st.st_mode))) /* nothing stays of a pipe */
        return resume ? fail(path, "an unfinished picture needs a regular file", e) : file_writer_open(f, path, e);
    if (!set_target(f, e))
        return false;
    f->aside = file_writer_part(path);
    if (f->aside ? take_part(f, resume, magic, e) : fail(path, strerror(errno), e))
        return true;
    if (f->fd >= 0)
        close(f->fd);
    free(f->aside);
    free(f->target);
    return false;
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

/* Copy all of `from` to where `path` leads. 0, or errno. */
static int copy_to(const char *path, int from)
{
    char block[65536];
    ssize_t n = 0;
    const int number = descriptor_of(path), to = number >= 0 ? dup(number) : open(path, O_WRONLY | O_CLOEXEC);
    if (to < 0)
        return errno;
    int error = lseek(from, 0, SEEK_SET) < 0 ? errno : 0;
    while (!error && (n = read(from, block, sizeof block)) != 0)
        if (n < 0 ? errno != EINTR : !write_all(to, block, (size_t)n))
            error = errno;
    if (close(to) != 0 && !error)
        error = errno;
    return error;
}

/* Some file systems report only when a file is closed that the disk is full. So close a second descriptor: the file
 * itself stays open, and locked, until it has its name. 0, or errno. */
static int flush(int fd)
{
    const int second = fcntl(fd, F_DUPFD_CLOEXEC, 0);
    return second >= 0 && close(second) == 0 ? 0 : errno;
}

/* Bring a whole file to where it belongs. 0, or errno. */
static int deliver(file_writer *f)
{
    if (!f->target)
        return copy_to(f->path, f->fd);
    const int error = flush(f->fd);
    return error ? error : aside_rename(f->fd, f->aside, f->target);
}

bool file_writer_close(file_writer *f, const char *why, errors *e)
{
    if (!why && !f->error)
        f->error = deliver(f);
    if ((why || f->error) && f->aside && !f->keep)
        unlink(f->aside);
    close(f->fd);
    free(f->aside);
    free(f->target);
    if (f->error)
        return fail(f->path, strerror(f->error), e);
    return !why || (*why && fail(f->path, why, e));
}

bool file_writer_probe(const char *path, errors *e)
{
    file_writer f;
    const bool good = file_writer_open(&f, path, e);
    if (good)
        file_writer_close(&f, "", e);
    return good;
}
