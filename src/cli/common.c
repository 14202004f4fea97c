/* Shared by the commands: loading the scene, printing errors, checking file names. */
#include "cli/command.h"

#include <stdarg.h>
#include <errno.h>
#include <libgen.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

static void print_text(const char *fmt, va_list args) CLI_PRINTF(1, 0);
static void print_text(const char *fmt, va_list args)
{
    va_list again;
    va_copy(again, args);
    const int n = vsnprintf(NULL, 0, fmt, args);
    char *text = n < 0 ? NULL : malloc((size_t)n + sizeof "kage: ");
    if (text) {
        memcpy(text, "kage: ", sizeof "kage: ");
        vsnprintf(text + strlen(text), (size_t)n + 1, fmt, again);
        print_message(text);
    } else {
        fputs("kage: ", stderr);
        vfprintf(stderr, fmt, again);
        fputs("\n", stderr);
    }
    va_end(again);
    free(text);
}

bool usage_error(const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    print_text(fmt, args);
    va_end(args);
    return false;
}

void tell(const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    print_text(fmt, args);
    va_end(args);
}

const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

int print_errors(kage_errors *e, int status)
{
    const int found = kage_errors_found(e), count = kage_errors_count(e);
    for (int k = 0; k < count; k++)
        print_message(kage_errors_get(e, k)->message);
    if (status == EXIT_INPUT && found > 1)
        fprintf(stderr, "%d errors%s\n", found, found > count ? ", the first of them above" : "");
    kage_errors_free(e);
    return status;
}

/* Report triangles without an area. The picture is the same without them, but they may be a mistake in the model. */
static void print_flat(const kage_scene_info *s)
{
    for (int k = 0; k < s->object_count; k++) {
        const kage_model_info *m = s->objects[k].model;
        if (m && m->flat)
            tell("object %s: %d of the %d triangles in %s have no area; they are left out", s->objects[k].name, m->flat,
                 m->triangles + m->flat, m->file);
    }
}

const char *limit_text(const kage_limit *l, char text[32])
{
    int unit = 0;
    int64_t n = l->most;
    for (; l->bytes && n % 1024 == 0 && unit < 3; unit++)
        n /= 1024;
    snprintf(text, 32, "%lld%.1s", (long long)n, &"\0KMG"[unit]);
    return text;
}

bool has_ending(const char *path, const char *ending)
{
    const size_t n = strlen(path), m = strlen(ending);
    return n > m && strcasecmp(path + n - m, ending) == 0;
}

bool outputs_spare_inputs(const kage_scene *s, const char *const *output, int outputs)
{
    for (int k = 0; k < outputs; k++)
        if (kage_scene_uses_file(s, output[k]))
            return usage_error("%s: the scene is made from this file, expected -o with another name", output[k]);
    return true;
}

/* A file by its folder and its name there, as it need not be there yet. */
typedef struct place {
    struct stat folder;
    char name[PATH_MAX];
} place;

/* Where an output will be. False: nowhere, or at the end of a pipe or a device. */
static bool find_place(const char *output, place *p)
{
    struct stat st;
    char part[PATH_MAX]; /* the file that all links lead to, with .part behind it */
    const size_t n = kage_file_part(output, part, sizeof part);
    if (n == 0 || n >= sizeof part || (stat(output, &st) == 0 && !S_ISREG(st.st_mode)))
        return false;
    strcpy(p->name, base_name(part));
    return stat(dirname(part), &p->folder) == 0;
}

bool outputs_differ(const char *const *output, int outputs)
{
    place a, b;
    for (int k = 1; k < outputs; k++)
        for (int j = 0; j < k; j++)
            if (find_place(output[j], &a) && find_place(output[k], &b) && strcmp(a.name, b.name) == 0 &&
                a.folder.st_dev == b.folder.st_dev && a.folder.st_ino == b.folder.st_ino)
                return usage_error("-o %s: the same file as -o %s, expected another one", output[k], output[j]);
    return true;
}

void tidy(const arguments *a, const char *output)
{
    kage_errors *notes;
    kage_file_tidy(output, &notes);
    if (!a->quiet)
        print_errors(notes, EXIT_OUTPUT);
    else
        kage_errors_free(notes);
}

/* All of standard input, which may have `most` bytes; 0: as the library allows. NULL: an error is on stderr. */
static char *read_stdin(int64_t most, size_t *size)
{
    enum { BLOCK = 1 << 16, MOST = 1 << 28 };
    char *text = NULL;
    size_t room = 0;
    for (*size = 0; !feof(stdin) && !ferror(stdin); *size += fread(text + *size, 1, room - *size, stdin)) {
        if (*size < room)
            continue;
        room = room ? 2 * room : BLOCK;
        char *more = room <= MOST ? realloc(text, room) : NULL;
        if (!more || (most && (int64_t)*size > most)) { /* the library refuses what is a little larger */
            free(more ? more : text);
            usage_error("-: the scene on standard input is too large%s", more ? " (--limit scene)" : "");
            return NULL;
        }
        text = more;
    }
    if (!ferror(stdin))
        return text;
    usage_error("-: standard input can't be read: %s", strerror(errno));
    free(text);
    return NULL;
}

/* From a file, or from standard input. */
static kage_status read_given(const char *path, const kage_load_options *o, kage_scene **s, kage_errors **e)
{
    size_t size;
    if (strcmp(path, "-") != 0)
        return kage_scene_load(path, o, s, e);
    char *text = read_stdin(o->limits->scene, &size);
    *s = NULL;
    *e = NULL;
    const kage_status status = text ? kage_scene_parse(text, size, "stdin", NULL, o, s, e) : KAGE_BAD_INPUT;
    free(text);
    return status;
}

kage_scene *load_scene(const arguments *a)
{
    kage_scene *s;
    kage_errors *e;
    progress_bar p;
    progress_bar_start(&p, a->quiet, base_name(a->operand[0]), 0);
    const kage_load_options o = {.sets = (const char *const *)a->set,
                                 .set_count = a->sets,
                                 .threads = a->threads,
                                 .progress = progress_bar_show,
                                 .user = &p,
                                 .limits = &a->limits,
                                 .survey = a->command == COMMAND_CHECK};
    const kage_status status = read_given(a->operand[0], &o, &s, &e);
    progress_bar_end(&p);
    if (status != KAGE_OK) {
        print_errors(e, EXIT_INPUT);
        return NULL;
    }
    if (!a->quiet && a->command != COMMAND_CHECK) /* `check` prints this itself */
        print_flat(kage_scene_get_info(s));
    return s;
}
