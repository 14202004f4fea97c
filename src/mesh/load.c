/* Reads a model's triangles, by kage-import (reader.h). */
#include "mesh/reader.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Whether the parts have names and are parts of the triangles: their program may have been broken by the file. */
static bool good_parts(const mesh_data *d)
{
    bool good = true;
    for (int k = 0; k < d->parts; k++) {
        const mesh_part *p = &d->part[k];
        good = good && p->first >= 0 && p->n > 0 && p->first <= d->n - p->n && memchr(p->name, 0, sizeof p->name);
    }
    return good;
}

/* Where the triangles go. */
typedef struct taker {
    mesh_data *out;
    const progress *progress;
} taker;

static bool take_triangles(void *user, reader_pipe *p)
{
    const taker *to = user;
    mesh_data *out = to->out;
    memory *m = progress_memory(to->progress);
    char why[MESH_WHY];
    const mesh_data come = p->letter.data;
    if (p->letter.is != LETTER_DONE || come.parts <= 0 || come.parts > come.n)
        return reader_fails(p, "its reader failed, expected a valid file");
    if (!mesh_count_is_good(come.n, to->progress, why))
        return reader_fails(p, why);
    const size_t n = (size_t)come.n, parts = (size_t)come.parts;
    *out = (mesh_data){come.n,     memory_new(m, sizeof *out->at * n),       memory_new(m, sizeof *out->skin * n),
                       come.notes, memory_new(m, sizeof *out->part * parts), come.parts};
    if (!out->at || !out->skin || !out->part)
        return reader_fails(p, (mesh_refuse_memory(to->progress, why), why));
    return reader_receive(p, out->at, sizeof *out->at * n) && reader_receive(p, out->skin, sizeof *out->skin * n) &&
           reader_receive(p, out->part, sizeof *out->part * parts) &&
           (good_parts(out) || reader_fails(p, "its reader failed, expected a valid file"));
}

bool mesh_file_read(const char *path, const char *reader, const progress *w, files *opened, mesh_data *out,
                    char why[MESH_WHY])
{
    taker to = {out, w};
    const reader_call c = {
        .path = path, .reader = reader, .show = w, .opened = opened, .take = take_triangles, .user = &to};
    *out = (mesh_data){0};
    const bool good = reader_run(&c, why);
    if (!good)
        mesh_data_free(out);
    return good;
}

/* Say which parts there are, as many as there is room for. */
static bool refuse(const mesh_data *d, const char *name, char why[MESH_WHY])
{
    size_t n = (size_t)snprintf(why, MESH_WHY, "no part '%.100s', expected one of its %d: ", name, d->parts);
    for (int k = 0; k < d->parts; k++) {
        if (n + strlen(d->part[k].name) + 8 >= MESH_WHY) {
            snprintf(why + n, MESH_WHY - n, "...");
            break;
        }
        n += (size_t)snprintf(why + n, MESH_WHY - n, "%s'%s'", k ? ", " : "", d->part[k].name);
    }
    return false;
}

bool mesh_data_part(const mesh_data *d, const char *name, const progress *w, mesh_data *out, char why[MESH_WHY])
{
    int k = 0;
    while (k < d->parts && strcmp(d->part[k].name, name) != 0)
        k++;
    if (k == d->parts)
        return refuse(d, name, why);
    const int first = d->part[k].first, n = d->part[k].n;
    memory *m = progress_memory(w);
    *out = (mesh_data){
        .n = n, .at = memory_new(m, sizeof *out->at * (size_t)n), .skin = memory_new(m, sizeof *out->skin * (size_t)n)};
    if (!out->at || !out->skin) {
        mesh_data_free(out);
        return mesh_refuse_memory(w, why);
    }
    memcpy(out->at, d->at + first, sizeof *out->at * (size_t)n);
    memcpy(out->skin, d->skin + first, sizeof *out->skin * (size_t)n);
    return true;
}
