/* A growing list of messages. */
#include "base/errors.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

bool errors_add(errors *e, const char *fmt, ...)
{
    va_list args, again;
    if (e->count++ >= ERRORS_SHOWN)
        return false;
    va_start(args, fmt);
    va_copy(again, args);
    int n = vsnprintf(NULL, 0, fmt, args);
    va_end(args);
    char *text = n < 0 ? NULL : realloc(e->text, e->size + (size_t)n + 2);
    if (text) { /* without memory the message is lost, its count is not */
        vsnprintf(text + e->size, (size_t)n + 1, fmt, again);
        e->text = text;
        e->size += (size_t)n;
        e->text[e->size++] = '\n';
        e->text[e->size] = 0;
    }
    va_end(again);
    return false;
}

void errors_free(errors *e)
{
    free(e->text);
    *e = (errors){0};
}
