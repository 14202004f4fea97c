/* The list of messages: one text that grows, and the place of each message in it. */
#include "base/errors.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Control characters become '?', but for tabs and ends of lines: a file must not steer the terminal. */
static void clean(char *text)
{
    for (unsigned char *c = (unsigned char *)text; *c; c++)
        if ((*c < 0x20 && *c != '\t' && *c != '\n') || *c == 0x7f)
            *c = '?';
        else if (c[0] == 0xc2 && c[1] >= 0x80 && c[1] < 0xa0) /* U+0080 to U+009F */
            c[0] = c[1] = '?';
}

/* Add formatted text and a newline. False: there is no memory, and the text is as before. */
static bool append(errors *e, const char *fmt, va_list args)
{
    va_list again;
    va_copy(again, args);
    const int n = vsnprintf(NULL, 0, fmt, args);
    char *text = n < 0 ? NULL : realloc(e->text, e->size + (size_t)n + 2);
    if (text) {
        vsnprintf(text + e->size, (size_t)n + 1, fmt, again);
        clean(text + e->size);
        e->text = text;
        e->size += (size_t)n;
        strcpy(e->text + e->size++, "\n");
    }
    va_end(again);
    return text;
}

bool errors_add(errors *e, const char *fmt, ...)
{
    if (e->count++ >= ERRORS_SHOWN)
        return false;
    error_item item = {.start = e->size};
    va_list args;
    va_start(args, fmt);
    if (append(e, fmt, args)) {
        item.end = e->size - 1;
        e->item[e->items++] = item;
    }
    va_end(args);
    return false;
}

bool errors_add_at(errors *e, const char *file, int line, int column, const char *what, const char *excerpt)
{
    const int items = e->items;
    errors_add(e, "%s:%d:%d: %s%s", file, line, column, what, excerpt);
    if (e->items > items) {
        error_item *k = &e->item[items];
        k->file = strlen(file);
        k->line = line;
        k->column = column;
        k->what = (size_t)snprintf(NULL, 0, "%s:%d:%d: ", file, line, column);
    }
    return false;
}

void errors_free(errors *e)
{
    free(e->text);
    *e = (errors){0};
}
