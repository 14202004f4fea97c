/* A model's file is read by a program of its own, kage-import: whatever a broken file does to the importer, crash, loop
 * for ever or take all memory, ends there, and is an error here. The triangles come back through a pipe.
 */
#define _GNU_SOURCE /* pipe2: no program that another thread starts meanwhile keeps the pipe open */

#include "mesh/find_reader.h"
#include "mesh/letter.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MOST_MIB = 1024 }; /* of a file: no model of MESH_MOST triangles is larger */

static bool receive(int from, void *to, size_t size)
{
    for (char *at = to; size > 0;) {
        const ssize_t n = read(from, at, size);
        if (n == 0 || (n < 0 && errno != EINTR))
            return false;
        at += n > 0 ? n : 0;
        size -= n > 0 ? (size_t)n : 0;
    }
    return true;
}

static bool receive_letter(int from, letter *l) { return receive(from, l, sizeof *l) && l->magic == LETTER_MAGIC; }

static bool fails(letter *l, const char *why)
{
    l->is = LETTER_WRONG;
    snprintf(l->why, sizeof l->why, "%s", why);
    return false;
}

/* The last letter; LETTER_READ where none came. */
static void receive_last(int from, const progress *w, files *opened, letter *l)
{
    bool come = receive_letter(from, l);
    for (; come && (l->is == LETTER_OPENED || l->is == LETTER_READ); come = receive_letter(from, l))
        if (l->is == LETTER_OPENED && !files_add(opened, l->opened)) {
            fails(l, "out of memory");
            return;
        } else if (l->is == LETTER_READ && !progress_show(w, l->share < 1 ? "reading" : "unpacking", l->share)) {
            fails(l, "cancelled");
            return;
        }
    if (!come)
        l->is = LETTER_READ;
}

static bool receive_all(int from, const progress *w, files *opened, letter *l, mesh_data *out)
{
    receive_last(from, w, opened, l);
    if (l->is != LETTER_DONE)
        return false;
    *out = l->data;
    out->at = malloc(sizeof *out->at * (size_t)out->n);
    out->skin = malloc(sizeof *out->skin * (size_t)out->n);
    const bool room = out->at && out->skin;
    if (room && receive(from, out->at, sizeof *out->at * (size_t)out->n) &&
        receive(from, out->skin, sizeof *out->skin * (size_t)out->n))
        return true;
    mesh_data_free(out);
    return fails(l, room ? "its reader ended too soon" : "out of memory");
}

/* Messages go to a terminal: without line ends or other controls. */
static void clean(char *text)
{
    for (char *c = text; *c; c++)
        *c = (unsigned char)*c < 0x20 || *c == 0x7f ? ' ' : *c;
    for (size_t n = strlen(text); n > 0 && (text[n - 1] == ' ' || text[n - 1] == '.'); n--)
        text[n - 1] = 0;
}

static bool can_open(const char *path, size_t *size, char why[MESH_WHY])
{
    static const char *const ends[] = {".obj", ".ply", ".stl", ".gltf", ".glb", ".off"};
    const char *dot = strrchr(path, '.');
    bool known = false;
    for (size_t k = 0; dot && k < sizeof ends / sizeof *ends; k++) {
        size_t i = 0;
        while (dot[i] && (i == 0 || (dot[i] | 0x20) == ends[k][i]))
            i++;
        known |= !dot[i] && !ends[k][i];
    }
    FILE *f = fopen(path, "rb");
    struct stat about;
    if (!f || fstat(fileno(f), &about) != 0)
        snprintf(why, MESH_WHY, "%s", strerror(errno));
    else if (!known)
        snprintf(why, MESH_WHY,
                 "no known kind of model, expected a name that ends in .obj, .ply, .stl, .gltf, .glb or .off");
    else if (!S_ISREG(about.st_mode))
        snprintf(why, MESH_WHY, "no regular file");
    else if (about.st_size == 0)
        snprintf(why, MESH_WHY, "the file is empty");
    else if ((size_t)about.st_size > MOST_MIB * MIB)
        snprintf(why, MESH_WHY, "the file is too large, expected at most %d MiB", MOST_MIB);
    else
        *size = (size_t)about.st_size;
    if (f)
        fclose(f);
    return *size > 0;
}

/* The program, with `to` as its descriptor LETTER_FD, nothing else to read from or write to, and the signals as any
 * program finds them, whatever the caller's process does with its own. 0, or an errno. */
static int start(const char *program, const char *path, int to, pid_t *pid)
{
    char *argv[] = {(char *)program, (char *)path, NULL};
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
        if (!error)
            error = posix_spawnattr_setsigmask(&how, &none);
        if (!error)
            error = posix_spawnattr_setsigdefault(&how, &usual);
        if (!error)
            error = posix_spawnattr_setflags(&how, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
        if (!error)
            error = posix_spawn(pid, program, &ends, &how, argv, environ);
        posix_spawnattr_destroy(&how);
    }
    posix_spawn_file_actions_destroy(&ends);
    return error;
}

/* Why the last letter is no LETTER_DONE. `status`: of the program, as waitpid gives it. */
static void explain(const letter *l, int status, size_t size, char why[MESH_WHY])
{
    if (l->is == LETTER_WRONG)
        snprintf(why, MESH_WHY, "%s", l->why);
    else if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
        snprintf(why, MESH_WHY, "reading it takes for ever, expected at most %d seconds",
                 LETTER_SECONDS + (int)(size / MIB / LETTER_MIB_A_SECOND));
    else
        snprintf(why, MESH_WHY, "its reader broke down over it, expected a sound file");
}

bool mesh_file_read(const char *path, const char *reader, const progress *w, files *opened, mesh_data *out,
                    char why[MESH_WHY])
{
    letter l = {.is = LETTER_READ};
    char program[READER_PATH];
    size_t size = 0;
    int ends[2], status = 0;
    pid_t pid;
    if (!can_open(path, &size, why) || !find_reader(reader, program, why, MESH_WHY))
        return false;
    if (!progress_show(w, "reading", 0)) {
        snprintf(why, MESH_WHY, "cancelled");
        return false;
    }
    if (pipe2(ends, O_CLOEXEC) != 0) {
        snprintf(why, MESH_WHY, "%s", strerror(errno));
        return false;
    }
    const int error = start(program, path, ends[1], &pid);
    close(ends[1]);
    const bool good = !error && receive_all(ends[0], w, opened, &l, out);
    close(ends[0]);
    if (!error && !good)
        kill(pid, SIGKILL); /* where it still runs: nobody waits for what it does */
    while (!error && waitpid(pid, &status, 0) < 0 && errno == EINTR)
        ;
    if (error)
        snprintf(why, MESH_WHY, "%.100s can't be started: %s", program, strerror(error));
    else if (!good)
        explain(&l, status, size, why);
    if (!good)
        clean(why);
    return good;
}
