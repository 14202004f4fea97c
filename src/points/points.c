/* Reads a list of points, of either kind. */
#include "points/parts.h"

#include "base/files.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "yaml/text.h"

bool points_error(const points *p, const char *name, int32_t row, const char *message, errors *e)
{
    if (!p->text || !p->line)
        return errors_add(e, "%s: vertex %d: %s", name, (int)row, message);
    return text_error(e, name, p->text, p->line[row], 1, message);
}

static char *read_all(const char *path, const char *name, memory *m, size_t *size, errors *e)
{
    const char *reason;
    FILE *f = files_open_input(path, &reason);
    char *text = NULL;
    size_t n = 0, room = 0;
    errno = 0;
    while (f && !ferror(f) && !feof(f)) {
        if (n + 1 >= room) {
            char *more = memory_resize(m, text, room = room ? 2 * room : 1 << 16);
            if (!more)
                break;
            text = more;
        }
        n += fread(text + n, 1, room - n - 1, f);
    }
    char words[MEMORY_WORDS];
    const char *why = !f ? reason : ferror(f) ? strerror(errno ? errno : EIO) : feof(f) ? NULL : memory_words(m, words);
    if (f)
        fclose(f);
    if (why) {
        errors_add(e, "%s: can't read the list: %s", name, why);
        memory_free(text);
        return NULL;
    }
    text[n] = 0;
    *size = n;
    return text;
}

bool points_read(const char *path, const char *name, const points_column *columns, const char *label, const progress *w,
                 points *p, errors *e)
{
    points_file f = {.name = name, .column = columns, .label = label, .progress = w, .p = p, .e = e};
    *p = (points){0};
    if (!(f.text = read_all(path, name, progress_memory(w), &f.size, e)))
        return false;
    p->text = f.text;
    const bool ply = strncmp(f.text, "ply\n", 4) == 0 || strncmp(f.text, "ply\r", 4) == 0;
    const bool good = (ply ? points_ply : points_csv)(&f);
    if (good && p->n == 0)
        return errors_add(e, "%s: a list without places, expected one or more", name);
    if (ply) {
        memory_free(p->text);
        p->text = NULL;
    }
    return good;
}

void points_free(points *p)
{
    for (int k = 0; k < POINTS_COLUMNS; k++)
        memory_free(p->v[k]);
    memory_free(p->label);
    memory_free(p->line);
    memory_free(p->text);
    *p = (points){0};
}
