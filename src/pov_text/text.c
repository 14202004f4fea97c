/* The text of a POV-Ray file: the buffer, numbers, and identifiers. */
#include "pov_text/text.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool pov_begin(pov_text *t, const char *path, errors *e)
{
    t->size = 0;
    t->used = 0;
    return file_writer_open(&t->file, path, e);
}

static void flush(pov_text *t)
{
    file_writer_write(&t->file, t->buffer, t->used, t->size);
    t->size += t->used;
    t->used = 0;
}

bool pov_end(pov_text *t, const char *why, errors *e)
{
    flush(t);
    return file_writer_close(&t->file, why, e);
}

void pov_put(pov_text *t, const char *from, size_t n)
{
    while (n > 0) {
        size_t room = sizeof t->buffer - t->used, m = n < room ? n : room;
        memcpy(t->buffer + t->used, from, m);
        t->used += m;
        from += m;
        n -= m;
        if (t->used == sizeof t->buffer)
            flush(t);
    }
}

/* In some locales the decimal sign is not a point, and may have several bytes. */
pov_digits pov_number(double x, int digits)
{
    pov_digits d;
    char raw[sizeof d.text];
    size_t n = 0;
    snprintf(raw, sizeof raw, "%.*g", digits, x == 0 ? 0 : x); /* no -0 */
    for (const char *c = raw; *c; c++) {
        bool plain = strchr("0123456789+-abcdefghijklmnopqrstuvwxyz", *c);
        if (plain || n == 0 || d.text[n - 1] != '.')
            d.text[n++] = plain ? *c : '.';
    }
    d.text[n] = 0;
    return d;
}

pov_digits pov_exact(double x)
{
    char raw[40];
    int digits = 6;
    for (; digits < 17; digits++) {
        snprintf(raw, sizeof raw, "%.*g", digits, x);
        if (strtod(raw, NULL) == x)
            break;
    }
    return pov_number(x, digits);
}

void pov_print(pov_text *t, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    for (const char *c = fmt; *c;) {
        size_t plain = strcspn(c, "%");
        pov_put(t, c, plain);
        c += plain;
        if (!*c)
            break;
        if (c[1] == 's') {
            const char *s = va_arg(args, const char *);
            pov_put(t, s, strlen(s));
        } else if (c[1] == 'd') {
            char text[16];
            pov_put(t, text, (size_t)snprintf(text, sizeof text, "%d", va_arg(args, int)));
        } else if (c[1] == 'g') {
            const pov_digits d = pov_number(va_arg(args, double), 9);
            pov_put(t, d.text, strlen(d.text));
        } else {
            const vec3 v = va_arg(args, vec3);
            pov_print(t, "<%g, %g, %g>", v.x, v.y, v.z);
        }
        c += 2;
    }
    va_end(args);
}

void pov_matrix(pov_text *t, vec3 x, vec3 y, vec3 z, vec3 origin, const char *after)
{
    pov_print(t, "  matrix <%g, %g, %g,  %g, %g, %g,  %g, %g, %g,  %g, %g, %g>%s", x.x, x.y, x.z, y.x, y.y, y.z, z.x,
              z.y, z.z, origin.x, origin.y, origin.z, after);
}

pov_identifier pov_identify(const char *kind, const char *name, int index)
{
    pov_identifier d;
    if (strchr(name, '-'))
        snprintf(d.text, sizeof d.text, "%s%d_%s", kind, index, name);
    else
        snprintf(d.text, sizeof d.text, "%s_%s", kind, name);
    for (char *c = d.text; *c; c++)
        *c = *c == '-' ? '_' : *c;
    return d;
}
