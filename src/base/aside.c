/* Temporary files that leave nothing behind: without a name by O_TMPFILE, else locked, so that a later process sees
 * that nobody writes them. */
#define _GNU_SOURCE /* O_TMPFILE, realpath, flock */

#include "base/aside.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define PREFIX ".kage-"

enum { LINKS = 40, TRIES = 1000 };

/* How many letters of a path are its folder, with the slash. */
static size_t folder_length(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash + 1 - path) : 0;
}

/* The folder of `path`, with `rest` behind it. NULL: out of memory. */
static char *beside(const char *path, const char *rest)
{
    const size_t n = folder_length(path), room = n + strlen(rest) + 1;
    char *name = malloc(room);
    if (name)
        snprintf(name, room, "%.*s%s", (int)n, path, rest);
    return name;
}

/* The n-th of this process's temporary names for `target`. */
static char *name_of(const char *target, int n)
{
    char rest[64];
    snprintf(rest, sizeof rest, PREFIX "%ld-%d", (long)getpid(), n);
    return beside(target, rest);
}

/* Whether descriptors can be given a name. */
static bool has_link(int fd)
{
    char own[32];
    snprintf(own, sizeof own, "/proc/self/fd/%d", fd);
    return access(own, F_OK) == 0;
}

static int create_unnamed(const char *target)
{
#if defined(O_TMPFILE)
    char *folder = beside(target, ".");
    const int fd = folder ? open(folder, O_RDWR | O_TMPFILE | O_CLOEXEC, 0666) : -1;
    free(folder);
    if (fd < 0 || has_link(fd))
        return fd;
    close(fd);
#else
    (void)target;
#endif
    return -1;
}

/* Lock a file that has just been made. False: another process took it for one that was left, and removed it. */
static bool lock_new(int fd)
{
    struct stat st;
    return flock(fd, LOCK_EX | LOCK_NB) != 0 ? errno != EWOULDBLOCK : fstat(fd, &st) != 0 || st.st_nlink > 0;
}

int aside_create(const char *target, char **name)
{
    int fd = create_unnamed(target);
    *name = NULL;
    if (fd >= 0) {
        flock(fd, LOCK_EX | LOCK_NB); /* for the moment in which aside_rename gives it another name */
        return fd;
    }
    for (int n = 0; fd < 0 && n < TRIES; n++) {
        free(*name);
        *name = name_of(target, n);
        fd = *name ? open(*name, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666) : -1;
        if (fd < 0 && (!*name || errno != EEXIST))
            break; /* EEXIST: another thread's, or left by a process that was killed */
        if (fd >= 0 && !lock_new(fd)) {
            close(fd);
            fd = -1;
        }
    }
    if (fd < 0) {
        const int error = errno;
        free(*name);
        *name = NULL;
        errno = error;
    }
    return fd;
}

/* Give a file without a name a new one. 0, or errno; EEXIST: there is a file. */
static int link_as(int fd, const char *name)
{
    char own[32];
    snprintf(own, sizeof own, "/proc/self/fd/%d", fd);
    return linkat(AT_FDCWD, own, AT_FDCWD, name, AT_SYMLINK_FOLLOW) == 0 ? 0 : errno;
}

/* No call gives a file the name of another one, so it gets a name of its own for a moment. */
static int replace(int fd, const char *target)
{
    int error = EEXIST;
    for (int n = 0; error == EEXIST && n < TRIES; n++) {
        char *name = name_of(target, n);
        error = name ? link_as(fd, name) : ENOMEM;
        if (!error && rename(name, target) != 0) {
            error = errno;
            unlink(name);
        }
        free(name);
    }
    return error;
}

int aside_rename(int fd, const char *name, const char *target)
{
    if (name)
        return rename(name, target) == 0 ? 0 : errno;
    const int error = link_as(fd, target);
    return error == EEXIST ? replace(fd, target) : error;
}

/* ---- what others have left ---- */

/* Whether a file's name is one of name_of's. */
static bool is_ours(const char *name)
{
    static const char digits[] = "0123456789";
    if (strncmp(name, PREFIX, sizeof PREFIX - 1) != 0)
        return false;
    const char *pid = name + sizeof PREFIX - 1;
    const size_t n = strspn(pid, digits), m = pid[n] == '-' ? strspn(pid + n + 1, digits) : 0;
    return n > 0 && m > 0 && !pid[n + 1 + m];
}

/* Whether the name is still that of the open file: its process may have renamed it, and used the name again. */
static bool is_still(const char *name, const struct stat *opened)
{
    struct stat st;
    return lstat(name, &st) == 0 && st.st_dev == opened->st_dev && st.st_ino == opened->st_ino;
}

/* Remove the file, if it is one, and nobody holds its lock. */
static bool remove_left(const char *name)
{
    struct stat st;
    const int fd = open(name, O_RDONLY | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC);
    const bool removed = fd >= 0 && fstat(fd, &st) == 0 && S_ISREG(st.st_mode) && flock(fd, LOCK_EX | LOCK_NB) == 0 &&
                         is_still(name, &st) && unlink(name) == 0;
    if (fd >= 0)
        close(fd);
    return removed;
}

void aside_remove_stale(const char *path, errors *found)
{
    char *target = aside_target(path), *folder = target ? beside(target, ".") : NULL;
    DIR *all = folder ? opendir(folder) : NULL;
    for (struct dirent *d; all && (d = readdir(all)) != NULL;) {
        char *name = is_ours(d->d_name) ? beside(target, d->d_name) : NULL;
        if (name && remove_left(name))
            errors_add(found, "%s: left by a process that was killed; removed", name);
        free(name);
    }
    if (all)
        closedir(all);
    free(folder);
    free(target);
}

/* ---- links ---- */

/* What the link leads to, beside it where that is relative. NULL, with errno set: it is no link. */
static char *follow(const char *path)
{
    char to[PATH_MAX];
    const ssize_t n = readlink(path, to, sizeof to - 1);
    if (n < 0)
        return NULL;
    to[n] = 0;
    return to[0] == '/' ? strdup(to) : beside(path, to);
}

char *aside_target(const char *path)
{
    char *at = realpath(path, NULL);
    if (at || errno != ENOENT)
        return at;
    at = strdup(path); /* nothing is there, or a link to nothing */
    for (int k = 0; at; k++) {
        char *next = follow(at);
        if (!next)
            return at;
        free(at);
        at = next;
        if (k == LINKS) {
            free(at);
            errno = ELOOP;
            return NULL;
        }
    }
    return NULL;
}
