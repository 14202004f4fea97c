/* The program kage-view: a window in which a scene is looked at and changed. `kage view` starts it. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "view/app.h"
#include "look/keys.h"

enum { EXIT_OUTPUT = 1, EXIT_INPUT = 2, MOST_SETS = 256 };

/* `kage view --help` prints the options before this. */
static int print_help(void)
{
    fputs("\nMouse and keys:\n", stdout);
    for (int k = 0; k < view_key_count; k++)
        if (view_keys[k].name)
            printf("  %-11s %s\n", view_keys[k].name, view_keys[k].help);
    return fflush(stdout) == 0 ? 0 : EXIT_OUTPUT;
}

static int complain(const char *what, const char *why)
{
    fprintf(stderr, "kage: %s%s%s\n", what, *why ? ": " : "", why);
    return EXIT_INPUT;
}

/* A whole number from 1 to `most`. */
static bool read_number(const char *text, int most, int *to)
{
    char *end;
    const long v = strtol(text, &end, 10);
    *to = (int)v;
    return *text >= '0' && *text <= '9' && !*end && v >= 1 && v <= most;
}

/* NAME=N, as `kage view` passes what --limit sets. */
static bool read_limit(const char *text, kage_limits *to)
{
    const size_t n = strcspn(text, "=");
    for (int k = 0; k < kage_limit_count() && text[n]; k++) {
        const kage_limit of = kage_limit_get(k);
        if (strncmp(of.name, text, n) == 0 && !of.name[n])
            return (*(int64_t *)((char *)to + of.offset) = strtoll(text + n + 1, NULL, 10)) > 0;
    }
    return false;
}

/* The arguments, as `kage view` passes them: changes all are --set. 0, or the exit status. */
static int read_arguments(app_options *o, int argc, char **argv)
{
    for (int k = 1; k < argc; k++) {
        const char *arg = argv[k], *value = k + 1 < argc ? argv[k + 1] : "";
        if (strcmp(arg, "--report") == 0) {
            o->report = true;
            continue;
        }
        if (strcmp(arg, "--set") == 0 && *value && o->set_count < MOST_SETS)
            o->sets[o->set_count++] = value;
        else if (strcmp(arg, "--threads") == 0) {
            if (!read_number(value, KAGE_MAX_THREADS, &o->threads))
                return complain("--threads", "expected a whole number, 1 or more");
        } else if (strcmp(arg, "--frames") == 0) {
            if (!read_number(value, 1000000, &o->frames))
                return complain("--frames", "expected a whole number, 1 to 1000000");
        } else if (strcmp(arg, "--max-memory") == 0) {
            if ((o->limits.memory = strtoll(value, NULL, 10)) <= 0)
                return complain("--max-memory", "expected bytes");
        } else if (strcmp(arg, "--limit") == 0) {
            if (!read_limit(value, &o->limits))
                return complain("--limit", "expected NAME=N; see kage view --help");
        } else if (*arg == '-' || o->path)
            return complain(arg, "not expected here; see kage view --help");
        else {
            o->path = arg;
            continue;
        }
        k++;
    }
    return o->path ? 0 : complain("'kage view' lacks a scene; see kage view --help", "");
}

/* While a scene is read before there is a window. */
static int show_progress(void *user, const char *what, double share)
{
    (void)user;
    if (isatty(STDERR_FILENO))
        fprintf(stderr, "\r%s %3.0f %%\r", what, 100 * share);
    return 0;
}

/* A scene that never was good ends the program as it ends `kage render`. */
static kage_scene *load(const app_options *o)
{
    const kage_load_options how = {.sets = o->sets,
                                   .set_count = o->set_count,
                                   .threads = o->threads,
                                   .progress = show_progress,
                                   .limits = &o->limits};
    kage_scene *s = NULL;
    kage_errors *e = NULL;
    if (kage_scene_load(o->path, &how, &s, &e) == KAGE_OK)
        return s;
    for (int k = 0; k < kage_errors_count(e); k++)
        fprintf(stderr, "%s\n", kage_errors_get(e, k)->message);
    if (kage_errors_found(e) > 1)
        fprintf(stderr, "%d errors\n", kage_errors_found(e));
    kage_errors_free(e);
    return NULL;
}

int main(int argc, char **argv)
{
    const char *sets[MOST_SETS];
    app_options o = {.sets = sets};
    app a;
    for (int k = 1; k < argc; k++)
        if (strcmp(argv[k], "--help") == 0 || strcmp(argv[k], "-h") == 0)
            return print_help();
    const int status = read_arguments(&o, argc, argv);
    if (status)
        return status;
    kage_scene *scene = load(&o);
    if (!scene)
        return EXIT_INPUT;
    if (!app_start(&a, &o, scene)) {
        fprintf(stderr, "kage: no window: %s\n", SDL_GetError());
        app_end(&a);
        return EXIT_OUTPUT;
    }
    if (o.frames)
        measure(&a);
    else
        while (app_step(&a, 50))
            ;
    app_end(&a);
    return 0;
}
