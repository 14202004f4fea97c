/* For LD_PRELOAD: makes the n-th call of one of the system's functions fail. FAIL_CALL: its name; FAIL_AT: n, from 1;
 * FAIL_ERRNO: what errno is set to; 0: the call does only one byte. FAIL_ON: all later calls fail, too. FAIL_IN: only
 * in the program of this name. FAIL_LOG: a file that is made when it fails.
 */
#define _GNU_SOURCE

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int (*real_open)(const char *, int, ...);

/* Whether this call is the one that fails; errno is set then. */
static bool fails(const char *name, bool *is_short)
{
    static int calls;
    const char *call = getenv("FAIL_CALL"), *at = getenv("FAIL_AT"), *code = getenv("FAIL_ERRNO");
    *is_short = false;
    const char *in = getenv("FAIL_IN");
    if (!call || !at || !code || strcmp(call, name) != 0 || (in && strcmp(in, program_invocation_short_name) != 0))
        return false;
    const int n = __atomic_add_fetch(&calls, 1, __ATOMIC_SEQ_CST);
    if (n < atoi(at) || (n > atoi(at) && !getenv("FAIL_ON")))
        return false;
    if (!real_open)
        *(void **)&real_open = dlsym(RTLD_NEXT, "open");
    const int log = getenv("FAIL_LOG") ? real_open(getenv("FAIL_LOG"), O_WRONLY | O_CREAT, 0666) : -1;
    if (log >= 0)
        ((int (*)(int))dlsym(RTLD_NEXT, "close"))(log);
    *is_short = atoi(code) == 0;
    errno = atoi(code);
    return true;
}

#define REAL(type, name)                                                                                               \
    static type real;                                                                                                  \
    bool is_short;                                                                                                     \
    if (!real)                                                                                                         \
        *(void **)&real = dlsym(RTLD_NEXT, name);                                                                      \
    const bool failed = fails(name, &is_short)

typedef ssize_t (*writer)(int, const void *, size_t);
typedef ssize_t (*reader)(int, void *, size_t);
typedef ssize_t (*preader)(int, void *, size_t, off_t);
typedef int (*opener)(const char *, int, ...);
typedef int (*closer)(int);
typedef int (*renamer)(const char *, const char *);
typedef int (*linker)(int, const char *, int, const char *, int);
typedef int (*cutter)(int, off_t);
typedef off_t (*seeker)(int, off_t, int);

ssize_t write(int fd, const void *data, size_t size)
{
    REAL(writer, "write");
    return failed && !is_short ? -1 : real(fd, data, failed && size > 1 ? 1 : size);
}

ssize_t read(int fd, void *data, size_t size)
{
    REAL(reader, "read");
    return failed && !is_short ? -1 : real(fd, data, failed && size > 1 ? 1 : size);
}

ssize_t pread(int fd, void *data, size_t size, off_t at)
{
    REAL(preader, "pread");
    return failed && !is_short ? -1 : real(fd, data, failed && size > 1 ? 1 : size, at);
}

int open(const char *path, int how, ...)
{
    va_list more;
    va_start(more, how);
    const int mode = how & (O_CREAT | O_TMPFILE) ? va_arg(more, int) : 0;
    va_end(more);
    REAL(opener, "open");
    return failed && !is_short ? -1 : real(path, how, mode);
}

int close(int fd)
{
    REAL(closer, "close");
    const int done = real(fd);
    if (failed && !is_short)
        errno = atoi(getenv("FAIL_ERRNO"));
    return failed && !is_short ? -1 : done;
}

int rename(const char *from, const char *to)
{
    REAL(renamer, "rename");
    return failed && !is_short ? -1 : real(from, to);
}

int linkat(int a, const char *from, int b, const char *to, int how)
{
    REAL(linker, "linkat");
    return failed && !is_short ? -1 : real(a, from, b, to, how);
}

int ftruncate(int fd, off_t size)
{
    REAL(cutter, "ftruncate");
    return failed && !is_short ? -1 : real(fd, size);
}

off_t lseek(int fd, off_t at, int from)
{
    REAL(seeker, "lseek");
    return failed && !is_short ? -1 : real(fd, at, from);
}
