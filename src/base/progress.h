/* What long work gets from its caller: a callback that shows its progress and may stop it, the memory that it may
 * take, and limits for what it reads. */
#ifndef KAGE_BASE_PROGRESS_H
#define KAGE_BASE_PROGRESS_H

#include <stdbool.h>

#include "base/limits.h"
#include "base/memory.h"

/* `what`, while the objects of a scene are read. */
#define PROGRESS_OBJECTS "objects"

typedef struct progress {
    /* Called with the kind of work and the share of it that is done, 0..1. False: stop, with an error. May be NULL. */
    bool (*show)(void *user, const char *what, double share);
    void *user;
    memory *memory;       /* NULL: without a limit */
    const limits *limits; /* NULL: the built-in ones */
} progress;

/* For memory_new. w may be NULL. */
static inline memory *progress_memory(const progress *w) { return w ? w->memory : NULL; }

/* For limit_of; w may be NULL. And the limit that holds. */
static inline const limits *progress_limits(const progress *w) { return w ? w->limits : NULL; }
static inline cap progress_limit(const progress *w, limit_kind kind, int64_t built_in)
{
    return limit_of(progress_limits(w), kind, built_in);
}

/* False: stop. w may be NULL. */
static inline bool progress_show(const progress *w, const char *what, double share)
{
    return !w || !w->show || w->show(w->user, what, share);
}

/* A part of the work, from one share of it to another, whose progress is shown as that of the whole. */
typedef struct progress_part {
    const progress *whole; /* NULL: not shown */
    const char *what;      /* in place of the part's own; NULL: that */
    double from, to;
} progress_part;

/* progress.show, with a progress_part as the user. */
static inline bool progress_part_show(void *user, const char *what, double share)
{
    const progress_part *p = (const progress_part *)user;
    return progress_show(p->whole, p->what ? p->what : what, p->from + (p->to - p->from) * share);
}

/* What the part gets. *p must stay where it is. */
static inline progress progress_of_part(progress_part *p)
{
    return (progress){progress_part_show, p, progress_memory(p->whole), progress_limits(p->whole)};
}

#endif
