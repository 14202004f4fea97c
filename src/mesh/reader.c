/* Runs kage-import (room import) on a model and takes its letters from a pipe. A broken file can
 * make the importer crash, loop for ever or use up its memory. In a process of its own that is only an error here.
 */
#define _GNU_SOURCE /* dladdr, secure_getenv, pipe2 */

#include "mesh/reader.h"

#include "base/clock.h"
#include "base/files.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#ifndef KAGE_LIBEXEC
#define KAGE_LIBEXEC "/usr/local/libexec/kage"
#endif

enum {
    MOST_BYTES = 1 << 30, /* of a file: no model of MESH_MOST triangles is larger */
    PATH_SIZE = 4096,
    PATIENCE = 10, /* the limit of its time by the clock, in those of its processor time */
};

/* ---- where kage-import is ---- */

/* Whether `folder`, n bytes long, with `below` behind it has the program. */
static bool has(const char *folder, size_t n, const char *below, char path[PATH_SIZE])
{
    const int size = snprintf(path, PATH_SIZE, "%.*s%s/kage-import", (int)n, folder, below);
    return size > 0 && size < PATH_SIZE && access(path, X_OK) == 0;
}

static bool is_near(const char *file, char path[PATH_SIZE])
{
    const char *slash = strrchr(file, '/');
    const size_t n = slash ? (size_t)(slash - file) : 0;
    return slash && (has(file, n, "", path) || has(file, n, "/../libexec/kage", path));
}

/* Beside the file that holds this code. For a program dladdr only knows the name that it was called by, which may be
 * without a folder; so /proc is asked as well. */
static bool is_beside(char path[PATH_SIZE])
{
    static const char here = 0;
    char program[PATH_SIZE];
    Dl_info about;
    const ssize_t n = readlink("/proc/self/exe", program, sizeof program - 1);
    program[n > 0 ? n : 0] = 0;
    return (dladdr(&here, &about) != 0 && about.dli_fname && is_near(about.dli_fname, path)) ||
           (n > 0 && is_near(program, path));
}

/* The path of kage-import: `asked`, which may be NULL, else the environment's KAGE_IMPORT, else beside this code or in
 * ../libexec/kage from there, else where the library was installed. False, with the reason: there is none. */
static bool find_reader(const char *asked, char path[PATH_SIZE], char why[MESH_WHY])
{
    const char *said = asked ? asked : secure_getenv("KAGE_IMPORT"),
               *by = asked ? "as asked for" : "as KAGE_IMPORT says";
    if (said) {
        const int n = snprintf(path, PATH_SIZE, "%s", said);
        if (n < PATH_SIZE && access(path, X_OK) == 0)
            return true;
        snprintf(why, MESH_WHY, "no program %.150s to read models, %s", said, by);
        return false;
    }
    if (is_beside(path) || has(KAGE_LIBEXEC, strlen(KAGE_LIBEXEC), "", path))
        return true;
    snprintf(why, MESH_WHY,
             "no program kage-import to read models, expected it beside kage, in " KAGE_LIBEXEC
             ", or where KAGE_IMPORT says");
    return false;
}

/* ---- its letters ---- */

static bool stop_waiting(reader_pipe *p, const char *why)
{
    p->stopped = true;
    return reader_fails(p, why);
}

/* Wait until there is something to read. Its processor time is limited, but a program may also sleep, or wait for a
 * file. False: the time is over, or the caller has ended the call. */
static bool wait_for_bytes(reader_pipe *p)
{
    const double between = 0.02; /* seconds */
    struct pollfd ready = {.fd = p->from, .events = POLLIN};
    for (int n = 0; n <= 0;) {
        n = poll(&ready, 1, (int)(1e3 * between));
        if (n < 0 && errno != EINTR)
            return stop_waiting(p, strerror(errno));
        const double now = clock_seconds();
        if (n <= 0 && now > p->end)
            return stop_waiting(p, "its reader waits for too long, expected a file that can be read at once");
        if (now - p->asked < between)
            continue;
        p->asked = now;
        if (!progress_show(p->show, p->share < 1 ? "reading" : "unpacking", p->share))
            return stop_waiting(p, "cancelled");
    }
    return true;
}

static bool receive(reader_pipe *p, void *to, size_t size)
{
    for (char *at = to; size > 0;) {
        if (!wait_for_bytes(p))
            return false;
        const ssize_t n = read(p->from, at, size);
        if (n == 0 || (n < 0 && errno != EINTR))
            return false;
        at += n > 0 ? n : 0;
        size -= n > 0 ? (size_t)n : 0;
    }
    return true;
}

bool reader_receive(reader_pipe *p, void *to, size_t size)
{
    return receive(p, to, size) || (!p->stopped && reader_fails(p, "its reader ended too soon"));
}

bool reader_fails(reader_pipe *p, const char *why)
{
    p->letter.is = LETTER_WRONG;
    snprintf(p->letter.why, sizeof p->letter.why, "%s", why);
    return false;
}

/* The next letter. The program has read a file that may have broken it, so what it sends need not make sense. False:
 * there is none that does. */
static bool receive_letter(reader_pipe *p, letter *l)
{
    return receive(p, l, sizeof *l) && l->magic == LETTER_MAGIC && l->is >= LETTER_OPENED && l->is <= LETTER_DONE &&
           memchr(l->why, 0, sizeof l->why) && l->share >= 0 && l->share <= 1;
}

/* Take letters until the last one. True: it has come, and all was taken. */
static bool receive_all(const reader_call *c, reader_pipe *p)
{
    letter *l = &p->letter;
    bool good;
    while ((good = receive_letter(p, l)) && l->is != LETTER_WRONG) {
        if (l->is == LETTER_OPENED) {
            if (!files_add(c->opened, l->opened))
                return reader_fails(p, "out of memory");
        } else if (l->is == LETTER_READ) {
            p->share = l->share;
            if (!progress_show(c->show, l->share < 1 ? "reading" : "unpacking", l->share))
                return reader_fails(p, "cancelled");
        } else if (!c->take(c->user, p))
            return false;
        else if (l->is == LETTER_DONE)
            return true;
    }
    l->is = good || p->stopped ? LETTER_WRONG : LETTER_READ;
    return false;
}

/* Messages go to a terminal: without line ends or other controls. */
static void clean(char *text)
{
    for (char *c = text; *c; c++)
        *c = (unsigned char)*c < 0x20 || *c == 0x7f ? ' ' : *c;
    for (size_t n = strlen(text); n > 0 && (text[n - 1] == ' ' || text[n - 1] == '.'); n--)
        text[n - 1] = 0;
}

static bool can_open(const char *path, const progress *w, size_t *size, char why[MESH_WHY])
{
    cap most = progress_limit(w, LIMIT_FILE, MOST_BYTES);
    if (most.most > MOST_BYTES)
        most = (cap){MOST_BYTES, ""};
    static const char *const ends[] = {".obj", ".ply", ".stl", ".gltf", ".glb", ".off", ".dae", ".fbx", ".3ds"};
    const char *dot = strrchr(path, '.');
    bool known = false;
    for (size_t k = 0; dot && k < sizeof ends / sizeof *ends; k++)
        known |= strcasecmp(dot, ends[k]) == 0;
    const char *reason;
    FILE *f = files_open_input(path, &reason);
    struct stat about;
    if (!f || fstat(fileno(f), &about) != 0)
        snprintf(why, MESH_WHY, "%s", f ? strerror(errno) : reason);
    else if (!known)
        snprintf(why, MESH_WHY,
                 "no known kind of model, expected a name that ends in .obj, .ply, .stl, .gltf, .glb, .off, .dae, "
                 ".fbx or .3ds");
    else if (about.st_size == 0)
        snprintf(why, MESH_WHY, "the file is empty");
    else if (about.st_size > most.most)
        snprintf(why, MESH_WHY, "it has %lld bytes, expected at most %lld%s", (long long)about.st_size,
                 (long long)most.most, most.by);
    else
        *size = (size_t)about.st_size;
    if (f)
        fclose(f);
    return *size > 0;
}

/* The program, with `to` as its descriptor LETTER_FD, nothing else to read from or write to, and the signals as any
 * program finds them, whatever the caller's process does with its own. 0, or an errno. */
static int start(const char *program, char **argv, int to, pid_t *pid)
{
    posix_spawn_file_actions_t ends;
    posix_spawnattr_t how;
    sigset_t none, usual;
    sigemptyset(&none);
    sigemptyset(&usual);
    sigaddset(&usual, SIGPIPE);
    sigaddset(&usual, SIGXCPU);
    int error = posix_spawn_file_actions_init(&ends);
    if (error)
        return error;
    error = posix_spawnattr_init(&how);
    if (!error) {
        error = posix_spawn_file_actions_adddup2(&ends, to, LETTER_FD);
        for (int k = 0; k < 3 && !error; k++)
            error = posix_spawn_file_actions_addopen(&ends, k, "/dev/null", O_RDWR, 0);
        error = error ? error : posix_spawnattr_setsigmask(&how, &none);
        error = error ? error : posix_spawnattr_setsigdefault(&how, &usual);
        error = error ? error : posix_spawnattr_setflags(&how, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
        error = error ? error : posix_spawn(pid, program, &ends, &how, argv, environ);
        posix_spawnattr_destroy(&how);
    }
    posix_spawn_file_actions_destroy(&ends);
    return error;
}

/* Why the last letter is no LETTER_DONE. `status`: of the program, as waitpid gives it. */
static void explain(const letter *l, int status, int seconds, char why[MESH_WHY])
{
    if (l->is == LETTER_WRONG)
        snprintf(why, MESH_WHY, "%s", l->why);
    else if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
        snprintf(why, MESH_WHY, "reading it takes too long, expected at most %d seconds", seconds);
    else
        snprintf(why, MESH_WHY, "its reader failed, expected a valid file");
}

/* Start the program and take its letters. argv[0] is left to be set. */
static bool run(const reader_call *c, char **argv, int seconds, char why[MESH_WHY])
{
    char program[PATH_SIZE];
    int ends[2], status = 0;
    pid_t pid;
    if (!find_reader(c->reader, program, why))
        return false;
    if (!progress_show(c->show, "reading", 0)) {
        snprintf(why, MESH_WHY, "cancelled");
        return false;
    }
    if (pipe2(ends, O_CLOEXEC) != 0) { /* so that programs that other threads start do not inherit the pipe */
        snprintf(why, MESH_WHY, "%s", strerror(errno));
        return false;
    }
    fcntl(ends[0], F_SETPIPE_SZ, (int)MIB); /* a wish: 16 times fewer turns between the two programs */
    argv[0] = program;
    const double now = clock_seconds();
    reader_pipe p = {.from = ends[0],
                     .letter = {.is = LETTER_READ},
                     .show = c->show,
                     .end = now + (double)PATIENCE * seconds,
                     .asked = now};
    const int error = start(program, argv, ends[1], &pid);
    close(ends[1]);
    const bool good = !error && receive_all(c, &p);
    close(ends[0]);
    if (!error && !good)
        kill(pid, SIGKILL); /* where it still runs: nobody waits for what it does */
    while (!error && waitpid(pid, &status, 0) < 0 && errno == EINTR)
        ;
    if (error)
        snprintf(why, MESH_WHY, "%.100s can't be started: %s", program, strerror(error));
    else if (!good)
        explain(&p.letter, status, seconds, why);
    return good;
}

bool reader_run(const reader_call *c, char why[MESH_WHY])
{
    size_t size = 0;
    char **argv = can_open(c->path, c->show, &size, why) ? calloc((size_t)c->count + 3, sizeof *argv) : NULL;
    if (!argv) {
        if (size)
            snprintf(why, MESH_WHY, "out of memory");
        return false;
    }
    argv[1] = (char *)c->path;
    for (int k = 0; k < c->count; k++)
        argv[2 + k] = (char *)c->argument[k];
    const int seconds =
        LETTER_SECONDS + (int)(size / MIB / LETTER_MIB_A_SECOND) + (c->count ? LETTER_SCENE_SECONDS : 0);
    const bool good = run(c, argv, seconds, why);
    free(argv);
    if (!good)
        clean(why);
    return good;
}
