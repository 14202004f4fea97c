/* The list of messages: one text that grows, and where each message stands in it. */
#include "base/errors.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Add formatted text. False: there is no memory, and the text is as before. */
static bool append(errors *e, const char *fmt, va_list args)
{
    va_list again;
    va_copy(again, args);
    int n = vsnprintf(NULL, 0, fmt, args);
    char *text = n < 0 ? NULL : realloc(e->text, e->size + (size_t)n + 2);
    if (text) {
        vsnprintf(text + e->size, (size_t)n + 1, fmt, again);
        e->text = text;
        e->size += (size_t)n;
    }
    va_end(again);
    return text;
}

/* End the message that begins at `start`. Without memory it is lost, but counted. */
static bool finish(errors *e, bool good, error_item item)
{
    if (!good || !e->text)
        e->size = item.start;
    if (good) {
        item.end = e->size;
        e->item[e->items++] = item;
        e->text[e->size++] = '\n';
    }
    if (e->text)
        e->text[e->size] = 0;
    return false;
}

bool errors_add(errors *e, const char *fmt, ...)
{
    if (e->count++ >= ERRORS_SHOWN)
        return false;
    const error_item item = {.start = e->size};
    va_list args;
    va_start(args, fmt);
    const bool good = append(e, fmt, args);
    va_end(args);
    return finish(e, good, item);
}

static bool append_place(errors *e, const char *fmt, ...) KAGE_PRINTF(2, 3);
static bool append_place(errors *e, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    const bool good = append(e, fmt, args);
    va_end(args);
    return good;
}

bool errors_add_at(errors *e, const char *file, int line, int column, const char *what, const char *fmt, ...)
{
    if (e->count++ >= ERRORS_SHOWN)
        return false;
    error_item item = {.start = e->size, .file = strlen(file), .line = line, .column = column};
    bool good = append_place(e, "%s:%d:%d: ", file, line, column);
    item.what = e->size - item.start;
    va_list args;
    va_start(args, fmt);
    good = good && append_place(e, "%s", what) && append(e, fmt, args);
    va_end(args);
    return finish(e, good, item);
}

void errors_free(errors *e)
{
    free(e->text);
    *e = (errors){0};
}
