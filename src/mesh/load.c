/* A model's file is read in a process of its own: whatever a broken file does to the importer, crash, go round for ever
 * or take all memory, ends there, and is an error here. The triangles come back through a pipe.
 */
#include "mesh/mesh_data.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define MIB ((size_t)1 << 20)
enum { MOST_MIB = 1024, SECONDS = 3, MIB_A_SECOND = 1, ROOM_MIB = 512, TIMES = 96 };

/* What comes through the pipe: a file that is opened, a share of it that is read, the end with an error, or the end
 * with triangles, their corners and skins. */
typedef struct letter {
    enum { OPENED, READ, WRONG, DONE } is;
    file_id opened;
    double share;
    mesh_data data; /* without its arrays */
    char why[MESH_WHY];
} letter;

/* ---- the child ---- */

static void send(int to, const void *from, size_t size)
{
    for (const char *at = from; size > 0;) {
        const ssize_t n = write(to, at, size);
        if (n < 0 && errno != EINTR)
            _exit(1);
        at += n > 0 ? n : 0;
        size -= n > 0 ? (size_t)n : 0;
    }
}

static void send_opened(void *user, file_id id)
{
    const letter l = {.is = OPENED, .opened = id};
    send(*(const int *)user, &l, sizeof l);
}

static void send_share(void *user, double share)
{
    const letter l = {.is = READ, .share = share};
    send(*(const int *)user, &l, sizeof l);
}

static void limit(int what, rlim_t most)
{
    struct rlimit l;
    if (getrlimit(what, &l) == 0 && (l.rlim_cur == RLIM_INFINITY || l.rlim_cur > most)) {
        l.rlim_cur = most;
        setrlimit(what, &l);
    }
}

/* No more time, memory or words than a whole file needs. */
static void confine(size_t size)
{
    const int nowhere = open("/dev/null", O_RDWR);
    for (int k = 0; k < 3 && nowhere >= 0; k++)
        dup2(nowhere, k);
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_CPU, SECONDS + size / MIB / MIB_A_SECOND);
#ifndef __SANITIZE_ADDRESS__ /* which has all addresses for itself */
    limit(RLIMIT_AS, ROOM_MIB * MIB + TIMES * size);
#endif
}

static void child(const char *path, size_t size, int to)
{
    letter l = {.is = WRONG};
    confine(size);
    if (mesh_import(path, &(mesh_listener){send_opened, send_share, &to}, &l.data, l.why))
        l.is = DONE;
    const mesh_data d = l.data;
    l.data.at = NULL;
    l.data.skin = NULL;
    send(to, &l, sizeof l);
    if (l.is == DONE) {
        send(to, d.at, sizeof *d.at * (size_t)d.n);
        send(to, d.skin, sizeof *d.skin * (size_t)d.n);
    }
    _exit(0);
}

/* ---- the parent ---- */

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

/* The letter that is the last; READ where none came. */
static void receive_last(int from, const progress *w, files *opened, letter *l)
{
    bool come = receive(from, l, sizeof *l), room = true;
    for (; come && room && (l->is == OPENED || l->is == READ); come = receive(from, l, sizeof *l))
        if (l->is == OPENED)
            room = files_add(opened, l->opened);
        else
            progress_show(w, l->share < 1 ? "reading" : "unpacking", l->share);
    if (!room) {
        l->is = WRONG;
        snprintf(l->why, sizeof l->why, "out of memory");
    } else if (!come)
        l->is = READ;
}

static bool receive_all(int from, const progress *w, files *opened, letter *l, mesh_data *out)
{
    receive_last(from, w, opened, l);
    if (l->is != DONE)
        return false;
    *out = l->data;
    out->at = malloc(sizeof *out->at * (size_t)out->n);
    out->skin = malloc(sizeof *out->skin * (size_t)out->n);
    if (out->at && out->skin && receive(from, out->at, sizeof *out->at * (size_t)out->n) &&
        receive(from, out->skin, sizeof *out->skin * (size_t)out->n))
        return true;
    snprintf(l->why, sizeof l->why, "%s", out->at && out->skin ? "its reader ended too soon" : "out of memory");
    mesh_data_free(out);
    l->is = WRONG;
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

bool mesh_file_read(const char *path, const progress *w, files *opened, mesh_data *out, char why[MESH_WHY])
{
    letter l = {.is = READ};
    size_t size = 0;
    int ends[2], status = 0;
    if (!can_open(path, &size, why))
        return false;
    progress_show(w, "reading", 0);
    if (pipe(ends) != 0) {
        snprintf(why, MESH_WHY, "%s", strerror(errno));
        return false;
    }
    fflush(NULL);
    const pid_t pid = fork();
    if (pid == 0) {
        close(ends[0]);
        child(path, size, ends[1]);
    }
    close(ends[1]);
    const bool good = pid > 0 && receive_all(ends[0], w, opened, &l, out);
    close(ends[0]);
    while (pid > 0 && waitpid(pid, &status, 0) < 0 && errno == EINTR)
        ;
    if (good)
        return true;
    if (pid < 0)
        snprintf(why, MESH_WHY, "%s", strerror(errno));
    else if (l.is == WRONG)
        snprintf(why, MESH_WHY, "%s", l.why);
    else if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
        snprintf(why, MESH_WHY, "reading it takes for ever, expected at most %d seconds",
                 SECONDS + (int)(size / MIB / MIB_A_SECOND));
    else
        snprintf(why, MESH_WHY, "its reader broke down over it, expected a sound file");
    clean(why);
    return false;
}
