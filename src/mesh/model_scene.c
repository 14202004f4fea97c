/* Takes a model as a scene from kage-import. */
#include "mesh/model_scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "mesh/reader.h"

/* More room for a list, by one. NULL: out of memory. */
static void *one_more(void *list, int n, size_t size) { return realloc(list, ((size_t)n + 1) * size); }

/* n bytes from the pipe, and a 0. NULL: a reason is given. */
static void *take_bytes(reader_pipe *p, size_t n)
{
    char *bytes = n < SIZE_MAX ? malloc(n + 1) : NULL;
    if (!bytes) {
        reader_fails(p, "out of memory");
        return NULL;
    }
    bytes[n] = 0;
    if (reader_receive(p, bytes, n))
        return bytes;
    free(bytes);
    return NULL;
}

static bool take_note(model_scene *s, reader_pipe *p)
{
    char **more = one_more(s->note, s->notes, sizeof *more);
    s->note = more ? more : s->note;
    char *line = more ? strdup(p->letter.why) : NULL;
    if (!line)
        return reader_fails(p, "out of memory");
    s->note[s->notes++] = line;
    return true;
}

static bool take_file(model_scene *s, reader_pipe *p)
{
    model_file *more = one_more(s->file, s->files, sizeof *more);
    s->file = more ? more : s->file;
    char *name = more ? strdup(p->letter.why) : NULL;
    if (!name)
        return reader_fails(p, "out of memory");
    s->file[s->files++] = (model_file){name, NULL, 0};
    model_file *f = &s->file[s->files - 1];
    f->size = p->letter.size;
    f->bytes = take_bytes(p, f->size);
    return f->bytes && (!strchr(name, '/') || reader_fails(p, "its reader failed, expected a valid file"));
}

static bool take(void *user, reader_pipe *p)
{
    model_scene *s = user;
    if (p->letter.is == LETTER_NOTE)
        return take_note(s, p);
    if (p->letter.is == LETTER_FILE)
        return take_file(s, p);
    s->text = take_bytes(p, p->letter.size);
    return s->text;
}

bool model_scene_read(const char *path, const char *reader, int count, const char *const *argument, const progress *w,
                      files *opened, model_scene *out, char why[MESH_WHY])
{
    const reader_call c = {.path = path,
                           .reader = reader,
                           .count = count,
                           .argument = argument,
                           .show = w,
                           .opened = opened,
                           .take = take,
                           .user = out};
    return reader_run(&c, why);
}

void model_scene_free(model_scene *s)
{
    for (int k = 0; k < s->files; k++) {
        free(s->file[k].name);
        free(s->file[k].bytes);
    }
    for (int k = 0; k < s->notes; k++)
        free(s->note[k]);
    free(s->file);
    free(s->note);
    free(s->text);
    *s = (model_scene){0};
}
