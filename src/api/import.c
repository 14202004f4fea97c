/* kage_model_import: a model becomes a scene file. kage-import makes the scene's text, in a process of its own; here
 * names of files are made relative to the scene, the scene is read as a test, and the files are written.
 */
#define _GNU_SOURCE /* realpath */
#include "api/api.h"

#include "base/file_writer.h"
#include "mesh/letter.h"
#include "mesh/model_scene.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- names of files ---- */

static const char *base_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* The folder of a file, with all links followed, and a slash at its end. To be freed; NULL: there is none, or out of
 * memory, as errno says. */
static char *folder_of(const char *path)
{
    const size_t n = (size_t)(base_of(path) - path);
    char *folder = n ? strndup(path, n) : strdup("."), *whole = folder ? realpath(folder, NULL) : NULL;
    const size_t size = whole ? strlen(whole) : 0;
    char *out = whole ? malloc(size + 2) : NULL;
    if (out) {
        memcpy(out, whole, size + 1);
        if (size > 1)
            strcpy(out + size, "/");
    }
    free(folder);
    free(whole);
    return out;
}

/* The folder `to` as seen from `from`: "" or with a slash at its end. Both are from folder_of. */
static char *folder_between(const char *from, const char *to)
{
    size_t same = 0, ups = 0;
    for (size_t k = 0; from[k] && from[k] == to[k]; k++)
        same = from[k] == '/' ? k + 1 : same;
    for (const char *c = from + same; *c; c++)
        ups += *c == '/';
    char *out = malloc(3 * ups + strlen(to + same) + 1), *at = out;
    for (size_t k = 0; out && k < ups; k++, at += 3)
        memcpy(at, "../", 3);
    if (out)
        strcpy(at, to + same);
    return out;
}

/* The folder of a file as seen from another one; as it is where it does not exist. To be freed. NULL: out of memory. */
static char *folder_from(const char *from, const char *path)
{
    char *to = folder_of(path), *seen = NULL;
    if (to)
        seen = folder_between(from, to);
    else if (errno != ENOMEM)
        seen = strndup(path, (size_t)(base_of(path) - path));
    free(to);
    return seen;
}

/* The same of the file itself. */
static char *name_from(const char *from, const char *path)
{
    char *folder = folder_from(from, path);
    const char *base = base_of(path);
    char *name = folder ? malloc(strlen(folder) + strlen(base) + 1) : NULL;
    if (name)
        strcat(strcpy(name, folder), base);
    free(folder);
    return name;
}

/* ---- what kage-import is asked for ---- */

typedef struct wishes {
    char **text; /* the arguments; owned */
    int n;
    char brightness[32];
} wishes;

static void wishes_free(wishes *w)
{
    for (int k = 0; w->text && k < w->n; k++)
        free(w->text[k]);
    free(w->text);
}

/* Append a text, which is owned then. False: it is NULL. */
static bool add(wishes *w, char *text)
{
    if (text)
        w->text[w->n++] = text;
    return text;
}

/* OBJECT=MAP[,KEY=VALUE...] as three texts. */
static bool add_bump(wishes *w, const char *from, const char *said, errors *e)
{
    const char *equals = strchr(said, '=');
    const size_t n = equals ? strcspn(equals + 1, ",") : 0;
    if (!equals || equals == said || n == 0)
        return errors_add(
            e, "bump '%s': expected OBJECT=MAP,scale=S and other keys of a bump, as Wall=bricks.png,scale=0.05", said);
    if (!strstr(equals + 1 + n, ",scale="))
        return errors_add(
            e, "bump '%s': it lacks its scale, expected one, as %.*s,scale=0.05: the height of white above black", said,
            (int)(equals + 1 + n - said), said);
    char *map = strndup(equals + 1, n), *name = map ? name_from(from, map) : NULL;
    free(map);
    return (add(w, strndup(said, (size_t)(equals - said))) && add(w, name) &&
            add(w, strdup(equals + 1 + n + (equals[1 + n] == ',')))) ||
           errors_add(e, "out of memory");
}

static char *stem_of(const char *path)
{
    const char *base = base_of(path), *dot = strrchr(base, '.');
    return dot && dot != base ? strndup(base, (size_t)(dot - base)) : strdup(base);
}

static bool make_wishes(wishes *w, const char *model, const char *file, const char *from, const kage_import_options *o,
                        errors *e)
{
    w->text = calloc((size_t)LETTER_WISHES + 3 * (size_t)o->bump_count, sizeof *w->text);
    snprintf(w->brightness, sizeof w->brightness, "%.17g", o->brightness > 0 ? o->brightness : 1);
    bool good = w->text && add(w, name_from(from, model)) && add(w, folder_from(from, model)) &&
                add(w, stem_of(file)) && add(w, strdup(o->camera ? o->camera : "")) &&
                add(w, strdup(o->z_up ? "z" : "y")) && add(w, strdup(w->brightness));
    if (!good)
        return errors_add(e, "out of memory");
    for (int k = 0; k < o->bump_count && good; k++)
        good = add_bump(w, from, o->bumps[k], e);
    return good;
}

/* ---- files ---- */

static bool has_bytes(const char *path, const void *bytes, size_t size)
{
    const char *why;
    FILE *f = files_open_input(path, &why);
    char *there = f ? malloc(size + 1) : NULL;
    const bool same = there && fread(there, 1, size + 1, f) == size && memcmp(there, bytes, size) == 0;
    free(there);
    if (f)
        fclose(f);
    return same;
}

static bool write_file(const char *path, const void *bytes, size_t size, errors *e)
{
    file_writer w;
    return file_writer_open(&w, path, e) &&
           file_writer_close(&w, file_writer_write(&w, bytes, size, 0) ? NULL : "it can't be written", e);
}

struct import_report {
    kage_import_report shown; /* first, as the caller has its address */
    model_scene made;
    char **path;    /* of the files, then of the scene; owned */
    bool *is_new;   /* of the files */
    bool unwritten; /* one of them can't be written */
};

/* An error of the scene's file comes before the work. */
static bool can_write(struct import_report *r, const char *path, errors *e)
{
    r->unwritten = !file_writer_probe(path, e);
    return !r->unwritten;
}

/* Remove the files that were not there before. */
static void take_back(struct import_report *r)
{
    for (int k = 0; k < r->made.files; k++)
        if (r->is_new && r->is_new[k])
            unlink(r->path[k]);
}

/* Whether nothing but what may be replaced is at a path. *fresh: nothing is there at all. */
static bool may_write(const char *path, const void *bytes, size_t size, const kage_import_options *o,
                      const files *opened, bool *fresh, errors *e)
{
    *fresh = access(path, F_OK) != 0;
    if (files_have_path(opened, path))
        return errors_add(e, "%s: the model is made from this file, expected another name", path);
    return *fresh || o->overwrite || (bytes && has_bytes(path, bytes, size)) ||
           errors_add(e, "%s: it exists, expected a new name, or --overwrite", path);
}

static bool write_images(struct import_report *r, const char *file, const kage_import_options *o, const files *opened,
                         errors *e)
{
    const int n = r->made.files, folder = (int)(base_of(file) - file);
    r->path = calloc((size_t)n + 1, sizeof *r->path);
    r->is_new = calloc((size_t)n + 1, sizeof *r->is_new);
    if (!r->path || !r->is_new)
        return errors_add(e, "out of memory");
    for (int k = 0; k < n; k++) {
        const model_file *f = &r->made.file[k];
        bool fresh;
        if (!(r->path[k] = malloc((size_t)folder + strlen(f->name) + 1)))
            return errors_add(e, "out of memory");
        sprintf(r->path[k], "%.*s%s", folder, file, f->name);
        if (!may_write(r->path[k], f->bytes, f->size, o, opened, &fresh, e))
            return false;
        r->unwritten = !has_bytes(r->path[k], f->bytes, f->size) && !write_file(r->path[k], f->bytes, f->size, e);
        if (r->unwritten)
            return false;
        r->is_new[k] = fresh;
    }
    return true;
}

/* ---- the call ---- */

/* Read the scene's text as it will stand in the file. */
static kage_status try_scene(struct import_report *r, const char *file, const kage_import_options *o, double seconds,
                             kage_errors **to)
{
    const int folder = (int)(base_of(file) - file);
    char *path = strndup(file, (size_t)folder);
    kage_limits left = o->limits ? *o->limits : (kage_limits){0};
    left.seconds = seconds;
    const kage_load_options how = {.sets = o->sets,
                                   .set_count = o->set_count,
                                   .threads = o->threads,
                                   .progress = o->progress,
                                   .user = o->user,
                                   .model_reader = o->model_reader,
                                   .limits = &left};
    if (!path)
        return error_give(KAGE_NO_MEMORY, to, "out of memory");
    const kage_status s = kage_scene_parse(r->made.text, strlen(r->made.text), file, path, &how, &r->shown.scene, to);
    free(path);
    return s;
}

/* Run kage-import and write the images. */
static bool make(struct import_report *r, const char *model, const char *file, const kage_import_options *o,
                 const progress *p, errors *e)
{
    char why[MESH_WHY], *from = folder_of(file);
    wishes w = {0};
    files opened = {0};
    bool fresh, good = from || (errno == ENOMEM ? errors_add(e, "out of memory")
                                                : errors_add(e, "%s: its folder does not exist", file));
    good = good && may_write(file, NULL, 0, o, &opened, &fresh, e) && can_write(r, file, e) &&
           make_wishes(&w, model, file, from, o, e);
    if (good && !model_scene_read(model, o->model_reader, w.n, (const char *const *)w.text, p, &opened, &r->made, why))
        good = errors_add(e, "%s: %s", model, why);
    good = good && may_write(file, NULL, 0, o, &opened, &fresh, e) && write_images(r, file, o, &opened, e);
    files_free(&opened);
    wishes_free(&w);
    free(from);
    return good;
}

static void show(struct import_report *r)
{
    r->shown.note_count = r->made.notes;
    r->shown.notes = (const char *const *)r->made.note;
    r->shown.file_count = r->made.files;
    r->shown.files = (const char *const *)r->path;
}

kage_status kage_model_import(const char *model, const char *file, const kage_import_options *given,
                              kage_import_report **out, kage_errors **to)
{
    const kage_import_options o = given ? *given : (kage_import_options){0};
    *out = NULL;
    if (o.threads < 0 || o.threads > KAGE_MAX_THREADS || o.bump_count < 0 || o.set_count < 0)
        return error_give(KAGE_BAD_OPTION, to, "%d threads, %d bumps and %d changes, expected 0 to %d and 0 or more",
                          o.threads, o.bump_count, o.set_count, KAGE_MAX_THREADS);
    errors e = {0};
    c_locale l = c_locale_begin();
    watch w;
    const progress p = watch_begin(&w, o.progress, o.user, &l, o.limits, NULL);
    struct import_report *r = calloc(1, sizeof *r);
    const bool good = !limits_are_good(o.limits, &e) ? false
                      : r                            ? make(r, model, file, &o, &p, &e)
                                                     : errors_add(&e, "out of memory");
    c_locale_end(&l);
    const kage_status bad = r && r->unwritten ? KAGE_NOT_WRITTEN : KAGE_BAD_INPUT;
    kage_status status = errors_give(&e, good ? KAGE_OK : bad, &w, to);
    if (status == KAGE_OK)
        status = try_scene(r, file, &o, watch_left(&w), to);
    if (status == KAGE_OK && !write_file(file, r->made.text, strlen(r->made.text), &e))
        status = errors_give(&e, KAGE_NOT_WRITTEN, NULL, to);
    if (status == KAGE_OK) {
        show(r);
        *out = &r->shown;
        return KAGE_OK;
    }
    if (r)
        take_back(r);
    kage_import_report_free((kage_import_report *)r);
    return status;
}

void kage_import_report_free(kage_import_report *shown)
{
    struct import_report *r = (struct import_report *)shown;
    if (!r)
        return;
    for (int k = 0; r->path && k < r->made.files; k++)
        free(r->path[k]);
    free(r->path);
    free(r->is_new);
    kage_scene_free(r->shown.scene);
    model_scene_free(&r->made);
    free(r);
}
