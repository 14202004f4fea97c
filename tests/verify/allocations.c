/* Preloaded into the program: makes its N-th allocation fail. Only calls from the program's own code count, not those
 * of the libraries that it uses. At the end it says on KAGE_ALLOCATIONS_TO how many there were, and how many blocks of
 * the program's are left.
 *
 * KAGE_ALLOCATION=N: fail the N-th; KAGE_ALLOCATIONS_TO=FILE: "calls left".
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

extern void *__libc_malloc(size_t);
extern void *__libc_calloc(size_t, size_t);
extern void *__libc_realloc(void *, size_t);
extern void *__libc_memalign(size_t, size_t);
extern void __libc_free(void *);

enum { SLOTS = 1 << 20 };
static void *held[SLOTS]; /* the program's blocks; open addressing, (void *)1: was used */
static long calls, failing = -1;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static uintptr_t low, high; /* the program's code */

static void find_program(void)
{
    char line[512], own[256];
    const ssize_t n = readlink("/proc/self/exe", own, sizeof own - 1);
    FILE *f = fopen("/proc/self/maps", "r");
    own[n > 0 ? n : 0] = 0;
    while (f && fgets(line, sizeof line, f)) {
        unsigned long from, to;
        if (strstr(line, own) && strstr(line, "r-xp") && sscanf(line, "%lx-%lx", &from, &to) == 2) {
            low = from;
            high = to;
        }
    }
    if (f)
        fclose(f);
}

/* It is preloaded into kage-import, too, where it does nothing. */
__attribute__((constructor)) static void begin(void)
{
    char own[256];
    const char *n = getenv("KAGE_ALLOCATION");
    const ssize_t size = readlink("/proc/self/exe", own, sizeof own - 1);
    own[size > 0 ? size : 0] = 0;
    if (size > 6 && strcmp(own + size - 6, "import") == 0)
        return;
    find_program();
    calls = 0;
    failing = n ? atol(n) : -1;
}

static size_t slot_of(const void *p) { return ((uintptr_t)p >> 4) * 0x9e3779b1u % SLOTS; }

static void hold(void *p)
{
    pthread_mutex_lock(&lock);
    size_t k = slot_of(p);
    while ((uintptr_t)held[k] > 1)
        k = (k + 1) % SLOTS;
    held[k] = p;
    pthread_mutex_unlock(&lock);
}

static void drop(const void *p)
{
    if (!p || !low)
        return;
    pthread_mutex_lock(&lock);
    for (size_t k = slot_of(p); held[k]; k = (k + 1) % SLOTS)
        if (held[k] == p) {
            held[k] = (void *)1;
            break;
        }
    pthread_mutex_unlock(&lock);
}

static bool is_own(const void *caller) { return (uintptr_t)caller >= low && (uintptr_t)caller < high; }

/* Whether this call is the one that fails. */
static bool fails(const void *caller)
{
    if (!is_own(caller) || __atomic_add_fetch(&calls, 1, __ATOMIC_RELAXED) != failing)
        return false;
    errno = ENOMEM;
    return true;
}

static void *keep(void *p, const void *caller)
{
    if (p && is_own(caller))
        hold(p);
    return p;
}

#define CALLER __builtin_return_address(0)

void *malloc(size_t n) { return fails(CALLER) ? NULL : keep(__libc_malloc(n), CALLER); }

void *calloc(size_t n, size_t size) { return fails(CALLER) ? NULL : keep(__libc_calloc(n, size), CALLER); }

void *realloc(void *p, size_t n)
{
    if (fails(CALLER))
        return NULL;
    drop(p);
    void *q = __libc_realloc(p, n);
    return keep(q, CALLER);
}

int posix_memalign(void **p, size_t align, size_t n)
{
    if (fails(CALLER))
        return ENOMEM;
    void *q = __libc_memalign(align, n);
    if (!q)
        return ENOMEM;
    *p = keep(q, CALLER);
    return 0;
}

char *strndup(const char *s, size_t most)
{
    const size_t n = strnlen(s, most);
    char *p = fails(CALLER) ? NULL : keep(__libc_malloc(n + 1), CALLER);
    if (p) {
        memcpy(p, s, n);
        p[n] = 0;
    }
    return p;
}

char *strdup(const char *s) { return fails(CALLER) ? NULL : keep(strndup(s, strlen(s)), CALLER); }

char *realpath(const char *path, char *to)
{
    static char *(*real)(const char *, char *);
    if (!real)
        *(void **)&real = dlsym(RTLD_NEXT, "realpath");
    return !to && fails(CALLER) ? NULL : keep(real(path, to), to ? NULL : CALLER);
}

void free(void *p)
{
    drop(p);
    __libc_free(p);
}

__attribute__((destructor)) static void end(void)
{
    const char *to = getenv("KAGE_ALLOCATIONS_TO");
    long left = 0;
    char text[64];
    if (!low || !to)
        return;
    for (size_t k = 0; k < SLOTS; k++)
        left += (uintptr_t)held[k] > 1;
    const int file = open(to, O_WRONLY | O_CREAT | O_TRUNC, 0644);
    const int n = snprintf(text, sizeof text, "%ld %ld\n", calls, left);
    if (file >= 0 && write(file, text, (size_t)n) == n)
        close(file);
}
