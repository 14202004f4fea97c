/* Reads files of Bezier patches; errors have line and column. */
#include "patch/patch_file.h"

#include "base/files.h"

#include "yaml/text.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_BYTES = 1 << 22, COUNT_MAX = PATCHES_MAX * 16 * 3, SHOWN = 40 };

static char *read_all(const char *path, const char *name, errors *e)
{
    const char *why;
    FILE *f = files_open_input(path, &why);
    char *text = f ? malloc(MAX_BYTES + 2) : NULL;
    size_t n = 0;
    errno = 0;
    if (text)
        n = fread(text, 1, MAX_BYTES + 1, f);
    if (f && (!text || ferror(f)))
        why = strerror(errno ? errno : ENOMEM);
    if (f)
        fclose(f);
    if (!why && n > MAX_BYTES)
        why = "the file is too large, expected at most 4 MiB";
    if (why) {
        errors_add(e, "%s: can't read the patches: %s", name, why);
        free(text);
        return NULL;
    }
    text[n] = 0;
    return text;
}

static bool wrong(const char *name, const char *text, const char *at, const char *message, errors *e)
{
    int line, column;
    text_place(text, (size_t)(at - text), &line, &column);
    return text_error(e, name, text, line, column, message);
}

static const char *skip(const char *at)
{
    for (;;) {
        at += strspn(at, " \t\r\n,");
        if (*at != '#')
            return at;
        at += strcspn(at, "\r\n");
    }
}

/* Read the number at *at and move *at behind it. */
static bool number(const char *name, const char *text, const char **at, double most, double *x, errors *e)
{
    char message[160];
    const size_t n = strcspn(*at, " \t\r\n,#");
    char *end;
    *x = strtod(*at, &end);
    /* strtod takes hexadecimal, infinity and NaN, too */
    if (strspn(*at, "+-.0123456789eE") < n || end != *at + n) {
        snprintf(message, sizeof message, "'%.*s' is no number, expected a coordinate of a control point",
                 (int)(n < SHOWN ? n : SHOWN), *at);
        return wrong(name, text, *at, message, e);
    }
    if (!(fabs(*x) <= most)) {
        snprintf(message, sizeof message, "%.*s is too far, expected a coordinate from %g to %g",
                 (int)(n < SHOWN ? n : SHOWN), *at, -most, most);
        return wrong(name, text, *at, message, e);
    }
    *at += n;
    return true;
}

/* Read all numbers of the text. Returns how many; -1 with an error. */
static int numbers(const char *name, const char *text, double most, cap allowed, double *v, errors *e)
{
    char message[160];
    int n = 0;
    for (const char *at = skip(text); *at; at = skip(at)) {
        if (n == 48 * allowed.most) {
            snprintf(message, sizeof message, "too many patches, expected at most %d%s", (int)allowed.most, allowed.by);
            wrong(name, text, at, message, e);
            return -1;
        }
        if (!number(name, text, &at, most, &v[n], e))
            return -1;
        n++;
    }
    if (n > 0 && n % 48 == 0)
        return n;
    snprintf(message, sizeof message,
             "the file ends after %d number%s, expected 48 for each patch: 16 control points of x, y and z", n,
             n == 1 ? "" : "s");
    const size_t end = strlen(text);
    wrong(name, text, text + end, message, e);
    return -1;
}

vec3 *patch_file_read(const char *path, const char *name, double most, cap allowed, int *patches, errors *e)
{
    char *text = read_all(path, name, e);
    double *v = text ? malloc(sizeof *v * COUNT_MAX) : NULL;
    vec3 *point = NULL;
    int n = v ? numbers(name, text, most, allowed, v, e) : -1;
    if (text && !v)
        errors_add(e, "out of memory");
    if (n > 0 && !(point = malloc(sizeof *point * (size_t)(n / 3))))
        errors_add(e, "out of memory");
    for (int k = 0; point && k < n / 3; k++)
        point[k] = (vec3){v[3 * k], v[3 * k + 1], v[3 * k + 2]};
    *patches = n / 48;
    free(v);
    free(text);
    return point;
}
