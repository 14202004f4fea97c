/* kage-import FILE [WISHES]: reads a model for libkage in a process of its own, so that a broken file that crashes
 * assimp or takes too much time or memory does no harm. Writes messages (mesh/letter.h) to file descriptor 3. Exit
 * status 0 after the last message, 2 without a file or a reader.
 */
#include "import/import.h"
#include "mesh/letter.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

/* The limit of memory: ROOM_MIB, for the images of a scene SCENE_ROOM_MIB, plus TIMES the file's size. A triangle takes
 * some 30 bytes in a text file, and some 1500 in assimp. */
enum { ROOM_MIB = 512, TIMES = 96, SCENE_ROOM_MIB = 2048 };

static void send(const void *from, size_t size)
{
    for (const char *at = from; size > 0;) {
        const ssize_t n = write(LETTER_FD, at, size);
        if (n < 0 && errno != EINTR)
            _exit(1);
        at += n > 0 ? n : 0;
        size -= n > 0 ? (size_t)n : 0;
    }
}

static void send_opened(void *user, file_id id)
{
    const letter l = {.magic = LETTER_MAGIC, .is = LETTER_OPENED, .opened = id};
    (void)user;
    send(&l, sizeof l);
}

static void send_share(void *user, double share)
{
    const letter l = {.magic = LETTER_MAGIC, .is = LETTER_READ, .share = share};
    (void)user;
    send(&l, sizeof l);
}

static void send_note(void *user, const char *text)
{
    letter l = {.magic = LETTER_MAGIC, .is = LETTER_NOTE};
    (void)user;
    snprintf(l.why, sizeof l.why, "%s", text);
    send(&l, sizeof l);
}

static void send_file(void *user, const char *name, const void *bytes, size_t size)
{
    letter l = {.magic = LETTER_MAGIC, .is = LETTER_FILE, .size = size};
    (void)user;
    snprintf(l.why, sizeof l.why, "%s", name);
    send(&l, sizeof l);
    send(bytes, size);
}

static void limit(int what, rlim_t most)
{
    struct rlimit l;
    if (getrlimit(what, &l) == 0 && (l.rlim_cur == RLIM_INFINITY || l.rlim_cur > most)) {
        l.rlim_cur = most;
        setrlimit(what, &l);
    }
}

/* The sanitizers take all addresses for themselves. gcc and clang say in different ways that they are there. */
#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define HAS_SANITIZER 1
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HAS_SANITIZER 1
#endif

/* Limit time and memory to what a valid file of this size needs, or the images of a scene. */
static void confine(size_t size, bool scene)
{
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_CPU, LETTER_SECONDS + size / MIB / LETTER_MIB_A_SECOND + (scene ? LETTER_SCENE_SECONDS : 0));
#ifndef HAS_SANITIZER
    limit(RLIMIT_AS, (scene ? SCENE_ROOM_MIB : ROOM_MIB) * MIB + TIMES * size);
#else
    (void)ROOM_MIB, (void)SCENE_ROOM_MIB, (void)TIMES;
#endif
}

static void send_triangles(const char *path, const import_listener *to, letter *l)
{
    mesh_data d;
    if (!import_model(path, to, &d, l->why)) {
        send(l, sizeof *l);
        return;
    }
    l->is = LETTER_DONE;
    l->data = d;
    l->data.at = NULL;
    l->data.skin = NULL;
    l->data.part = NULL;
    send(l, sizeof *l);
    send(d.at, sizeof *d.at * (size_t)d.n);
    send(d.skin, sizeof *d.skin * (size_t)d.n);
    send(d.part, sizeof *d.part * (size_t)d.parts);
}

/* argv: the arguments behind the path. */
static void send_scene(const char *path, int n, char **argv, const import_listener *to, letter *l)
{
    import_bump *bump = calloc((size_t)n, sizeof *bump);
    import_wish w = {argv[0], argv[1], argv[2], *argv[3] ? argv[3] : NULL, argv[4][0] == 'z', strtod(argv[5], NULL),
                     0,       bump};
    for (char **at = argv + LETTER_WISHES; bump && at + 3 <= argv + n; at += 3)
        bump[w.bumps++] = (import_bump){at[0], at[1], at[2], false};
    char *text = bump ? import_scene(path, &w, to, l->why) : NULL;
    l->is = text ? LETTER_DONE : LETTER_WRONG;
    l->size = text ? strlen(text) : 0;
    send(l, sizeof *l);
    send(text, l->size);
}

int main(int argc, char **argv)
{
    letter l = {.magic = LETTER_MAGIC, .is = LETTER_WRONG, .why = "out of memory"};
    const import_listener to = {send_opened, send_share, send_note, send_file, NULL};
    const bool scene = argc >= 2 + LETTER_WISHES;
    struct stat about;
    if ((argc != 2 && !scene) || fcntl(LETTER_FD, F_GETFD) < 0) {
        fputs("kage-import: a part of libkage, which starts it to read a model\n", stderr);
        return 2;
    }
    prctl(PR_SET_PDEATHSIG, SIGKILL); /* nobody waits for what it does when the caller is killed */
    confine(stat(argv[1], &about) == 0 ? (size_t)about.st_size : 0, scene);
    if (scene)
        send_scene(argv[1], argc - 2, argv + 2, &to, &l);
    else
        send_triangles(argv[1], &to, &l);
    _exit(0); /* the importer's memory is the system's to take back */
}
