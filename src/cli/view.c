/* kage view: starts kage-view, the window, which is a program of its own so that this one does not load SDL2. */
#include "cli/command.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#ifndef KAGE_LIBEXEC
#define KAGE_LIBEXEC "/usr/local/libexec/kage"
#endif
#ifndef PATH_MAX
#define PATH_MAX 4096
#endif

/* FOLDER/kage-view, `n` letters of the folder and what follows. False: there is no such program. */
static bool has_view(const char *folder, int n, const char *below, char path[PATH_MAX])
{
    return snprintf(path, PATH_MAX, "%.*s%s/kage-view", n, folder, below) < PATH_MAX && access(path, X_OK) == 0;
}

/* Beside this program, in ../libexec/kage from there, or where kage was installed, as kage-import. */
static bool find_view(char path[PATH_MAX])
{
    char own[PATH_MAX];
    const ssize_t n = readlink("/proc/self/exe", own, sizeof own - 1);
    own[n > 0 ? n : 0] = 0;
    const char *slash = strrchr(own, '/');
    const int folder = slash ? (int)(slash - own) : 0;
    return (slash && (has_view(own, folder, "", path) || has_view(own, folder, "/../libexec/kage", path))) ||
           has_view(KAGE_LIBEXEC, (int)strlen(KAGE_LIBEXEC), "", path);
}

/* Become the program. Returns the exit status where that fails. */
static int start(char **argv)
{
    char path[PATH_MAX];
    if (!find_view(path)) {
        usage_error("no program kage-view to show a window, expected it beside kage or in " KAGE_LIBEXEC
                    "; it is built where SDL2, SDL2_ttf and fontconfig are installed");
        return EXIT_INPUT;
    }
    argv[0] = path;
    /* Its threads wait for each other many times a second. While they do, they should leave the processors to the
     * window and the screen. */
    setenv("OMP_WAIT_POLICY", "passive", 0);
    fflush(stdout);
    execv(path, argv);
    usage_error("%s can't be started: %s", path, strerror(errno));
    return EXIT_INPUT;
}

enum { LIMITS = 32, LIMIT_TEXT = 64 };

/* Add --max-memory and --limit, as numbers alone, in text[]. Returns how many words there are then. */
static int add_limits(const kage_limits *l, char text[LIMITS][LIMIT_TEXT], char **argv, int n)
{
    int used = 0;
    if (l->memory) {
        snprintf(text[used], LIMIT_TEXT, "%lld", (long long)l->memory);
        argv[n++] = (char *)"--max-memory";
        argv[n++] = text[used++];
    }
    for (int k = 0; k < kage_limit_count() && used < LIMITS; k++) {
        const kage_limit of = kage_limit_get(k);
        const int64_t most = *(const int64_t *)((const char *)l + of.offset);
        if (!most)
            continue;
        snprintf(text[used], LIMIT_TEXT, "%s=%lld", of.name, (long long)most);
        argv[n++] = (char *)"--limit";
        argv[n++] = text[used++];
    }
    return n;
}

int command_view(const arguments *a)
{
    char *argv[2 * MAX_SETS + 2 * LIMITS + 8], threads[16], frames[16], limit[LIMITS][LIMIT_TEXT];
    int n = add_limits(&a->limits, limit, argv, 1);
    for (int k = 0; k < a->sets; k++) {
        argv[n++] = (char *)"--set";
        argv[n++] = a->set[k];
    }
    if (a->threads) {
        snprintf(threads, sizeof threads, "%d", a->threads);
        argv[n++] = (char *)"--threads";
        argv[n++] = threads;
    }
    if (a->frames) {
        snprintf(frames, sizeof frames, "%d", a->frames);
        argv[n++] = (char *)"--frames";
        argv[n++] = frames;
    }
    if (a->report)
        argv[n++] = (char *)"--report";
    argv[n++] = (char *)a->operand[0];
    argv[n] = NULL;
    return start(argv);
}

int command_view_help(void)
{
    char path[PATH_MAX];
    if (!find_view(path))
        return 0;
    char *argv[] = {NULL, (char *)"--help", NULL};
    return start(argv);
}
