/* A text that grows. Numbers are written by printf in the C locale, which is that of this program. */
#include "import/text.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void text_add(text *t, const char *fmt, ...)
{
    va_list args, again;
    va_start(args, fmt);
    va_copy(again, args);
    const int n = vsnprintf(NULL, 0, fmt, args);
    va_end(args);
    if (n >= 0 && !t->failed && t->n + (size_t)n + 1 > t->room) {
        const size_t room = 2 * (t->n + (size_t)n) + 256;
        char *more = realloc(t->s, room);
        t->failed = !more;
        t->s = more ? more : t->s;
        t->room = more ? room : t->room;
    }
    if (n >= 0 && !t->failed) {
        vsnprintf(t->s + t->n, (size_t)n + 1, fmt, again);
        t->n += (size_t)n;
    }
    va_end(again);
}

void text_number(text *t, double x, int digits)
{
    char s[32];
    snprintf(s, sizeof s, "%.*g", digits, x);
    text_add(t, "%s", strcmp(s, "-0") == 0 ? "0" : s);
}

void text_vector(text *t, const double v[3])
{
    for (int k = 0; k < 3; k++) {
        text_add(t, k ? ", " : "[");
        text_number(t, v[k], 7);
    }
    text_add(t, "]");
}

void text_vector_of(text *t, const char *key, const double v[3], const char *end)
{
    text_add(t, "%s: ", key);
    text_vector(t, v);
    text_add(t, "%s", end);
}

/* Words that YAML might take for something else than a string begin with no letter, or are among these. A path may
 * begin with ../ */
static bool is_plain(const char *s)
{
    static const char *const others[] = {"true", "false", "null", "yes", "no", "on", "off", "nan", "inf"};
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        if (strcmp(s, others[k]) == 0)
            return false;
    const char first = (char)(*s | 0x20);
    const bool above = strncmp(s, "../", 3) == 0;
    return (above || (first >= 'a' && first <= 'z')) &&
           strspn(s, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./") == strlen(s);
}

void text_string(text *t, const char *s)
{
    if (is_plain(s)) {
        text_add(t, "%s", s);
        return;
    }
    text_add(t, "\"");
    for (; *s; s++)
        if ((unsigned char)*s < 0x20 || *s == 0x7f)
            text_add(t, "\\x%02x", (unsigned)(unsigned char)*s);
        else
            text_add(t, *s == '"' || *s == '\\' ? "\\%c" : "%c", *s);
    text_add(t, "\"");
}

void text_scene_name(char to[TEXT_NAME], const char *name)
{
    int n = 0;
    for (; *name && n < TEXT_NAME - 1; name++) {
        const char c = *name, low = (char)(c | 0x20);
        const bool good = (low >= 'a' && low <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
        if (((unsigned char)c & 0xc0) != 0x80) /* a character of several bytes becomes one */
            to[n++] = '_';
        if (good)
            to[n - 1] = c;
    }
    to[n] = 0;
    if (n == 0)
        strcpy(to, "unnamed");
}

static bool is_among(const char *name, char (*taken)[TEXT_NAME], int n)
{
    for (int k = 0; k < n; k++)
        if (strcmp(name, taken[k]) == 0)
            return true;
    return false;
}

void text_unique(char name[TEXT_NAME], char (*taken)[TEXT_NAME], int n)
{
    char first[TEXT_NAME];
    strcpy(first, name);
    for (int k = 2; is_among(name, taken, n); k++)
        snprintf(name, TEXT_NAME, "%.*s_%d", TEXT_NAME - 12, first, k);
}
