/* kage-import FILE: reads a model for libkage in a process of its own, so that a broken file that crashes assimp or
 * takes too much time or memory does no harm. Writes messages (mesh/letter.h) to file descriptor 3. Exit status 0 after
 * the last message, 2 without a file or a reader.
 */
#include "import/import.h"
#include "mesh/letter.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

/* The limit of memory: ROOM_MIB, plus TIMES the file's size. A triangle takes some 30 bytes in a text file, and some
 * 1500 in assimp. */
enum { ROOM_MIB = 512, TIMES = 96 };

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

static void limit(int what, rlim_t most)
{
    struct rlimit l;
    if (getrlimit(what, &l) == 0 && (l.rlim_cur == RLIM_INFINITY || l.rlim_cur > most)) {
        l.rlim_cur = most;
        setrlimit(what, &l);
    }
}

/* Limit time and memory to what a valid file of this size needs. */
static void confine(size_t size)
{
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_CPU, LETTER_SECONDS + size / MIB / LETTER_MIB_A_SECOND);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) /* which have all addresses for themselves */
    limit(RLIMIT_AS, ROOM_MIB * MIB + TIMES * size);
#else
    (void)ROOM_MIB, (void)TIMES;
#endif
}

int main(int argc, char **argv)
{
    letter l = {.magic = LETTER_MAGIC, .is = LETTER_WRONG};
    struct stat about;
    if (argc != 2 || fcntl(LETTER_FD, F_GETFD) < 0) {
        fputs("kage-import: a part of libkage, which starts it to read a model\n", stderr);
        return 2;
    }
    confine(stat(argv[1], &about) == 0 ? (size_t)about.st_size : 0);
    if (import_model(argv[1], &(import_listener){send_opened, send_share, NULL}, &l.data, l.why))
        l.is = LETTER_DONE;
    const mesh_data d = l.data;
    l.data.at = NULL;
    l.data.skin = NULL;
    send(&l, sizeof l);
    if (l.is == LETTER_DONE) {
        send(d.at, sizeof *d.at * (size_t)d.n);
        send(d.skin, sizeof *d.skin * (size_t)d.n);
    }
    _exit(0); /* the importer's memory is the system's to take back */
}
