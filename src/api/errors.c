/* The caller's view of a call: the list of errors, progress, and the C locale while the call runs. */
#include "api/api.h"

#include "base/clock.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct kage_errors {
    int found, count;
    kage_error item[];
};

/* The list where there is no memory for one. Never written or freed. */
static const struct {
    int found, count;
    kage_error item[1];
} no_memory = {1, 1, {{NULL, 0, 0, "out of memory", "out of memory"}}};

/* All texts lie behind the items, in one piece of memory. */
static char *put(char **at, const char *from, size_t n)
{
    char *text = *at;
    memcpy(text, from, n);
    text[n] = 0;
    *at += n + 1;
    return text;
}

static kage_errors *list_of(const errors *e)
{
    const size_t n = (size_t)e->items;
    kage_errors *list = n ? malloc(sizeof *list + n * sizeof *list->item + 3 * (e->size + n)) : NULL;
    if (!list)
        return (kage_errors *)&no_memory;
    char *at = (char *)&list->item[n];
    list->found = e->count;
    list->count = e->items;
    for (int k = 0; k < e->items; k++) {
        const error_item *from = &e->item[k];
        const char *message = e->text + from->start, *what = message + from->what;
        const size_t size = from->end - from->start;
        list->item[k] = (kage_error){
            .file = from->file ? put(&at, message, from->file) : NULL,
            .line = from->line,
            .column = from->column,
            .text = put(&at, what, strcspn(what, "\n")),
            .message = put(&at, message, size),
        };
    }
    return list;
}

/* Whether a message reports a lack of memory, by its words; so does an empty list. tests/unit/api/test_memory.c fails
 * where a message uses other words. */
static bool is_memory(const errors *e)
{
    const char *const words[] = {"out of memory", "not enough memory", strerror(ENOMEM)};
    for (int k = 0; k < e->items; k++) {
        const error_item *at = &e->item[k];
        for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
            const char *found = strstr(e->text + at->start + at->what, words[i]);
            if (found && found < e->text + at->end &&
                !memchr(e->text + at->start, '\n', (size_t)(found - e->text) - at->start))
                return true;
        }
    }
    return e->items == 0;
}

kage_status errors_give(errors *e, kage_status status, const watch *w, kage_errors **to)
{
    if (w && w->late) {
        errors_free(e);
        errors_add(e, "it takes more than the time that it may take (--max-seconds)");
        status = KAGE_OUT_OF_TIME;
    } else if (w && w->cancelled)
        status = KAGE_CANCELLED;
    else if (status != KAGE_OK && is_memory(e))
        status = KAGE_NO_MEMORY;
    if (to)
        *to = status == KAGE_OK || status == KAGE_CANCELLED ? NULL : list_of(e);
    errors_free(e);
    return status;
}

kage_status error_give(kage_status status, kage_errors **to, const char *fmt, ...)
{
    char text[512];
    errors e = {0};
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    errors_add(&e, "%s", text);
    return errors_give(&e, status, NULL, to);
}

int kage_errors_found(const kage_errors *e) { return e ? e->found : 0; }

int kage_errors_count(const kage_errors *e) { return e ? e->count : 0; }

const kage_error *kage_errors_get(const kage_errors *e, int k)
{
    return e && k >= 0 && k < e->count ? &e->item[k] : NULL;
}

void kage_errors_free(kage_errors *e)
{
    if ((const void *)e != &no_memory)
        free(e);
}

/* ---- progress and locale ---- */

c_locale c_locale_begin(void)
{
    c_locale l = {newlocale(LC_NUMERIC_MASK, "C", (locale_t)0), (locale_t)0};
    if (l.c)
        l.before = uselocale(l.c);
    return l;
}

void c_locale_end(c_locale *l)
{
    if (!l->c)
        return;
    uselocale(l->before);
    freelocale(l->c);
}

static bool show(void *user, const char *what, double share)
{
    watch *w = user;
    w->late = w->late || (w->end > 0 && clock_seconds() > w->end);
    if (watch_stopped(w) || !w->call)
        return !watch_stopped(w);
    const bool swaps = w->locale->c != (locale_t)0;
    if (swaps)
        uselocale(w->locale->before);
    w->cancelled = w->call(w->user, what, share) != 0;
    if (swaps)
        uselocale(w->locale->c);
    return !w->cancelled;
}

double watch_left(const watch *w) { return w->end > 0 ? fmax(w->end - clock_seconds(), 1e-9) : 0; }

bool watch_stopped(const watch *w) { return w->cancelled || w->late; }

progress watch_begin(watch *w, kage_progress *call, void *user, const c_locale *locale, const kage_limits *l,
                     const allowance *from)
{
    const bool own = l && l->memory != 0; /* else that of the scene or the film */
    *w = (watch){.call = call, .user = user, .locale = locale};
    if (from)
        w->memory = (memory){.from = from->budget, .limit = own ? limits_memory(l) : from->most};
    else
        limits_take(&w->limits, l);
    if (l && l->seconds > 0)
        w->end = clock_seconds() + l->seconds;
    return (progress){show, w, &w->memory, from ? &from->limits : &w->limits};
}
