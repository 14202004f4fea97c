/* Somebody who wants to see how far a long piece of work has come, and may end it. */
#ifndef KAGE_BASE_PROGRESS_H
#define KAGE_BASE_PROGRESS_H

#include <stdbool.h>

/* What the reader of a scene shows between two objects. */
#define PROGRESS_OBJECTS "objects"

typedef struct progress {
    /* `what` is done, and this share of it, 0..1. False: the work is to end, with an error. NULL: nobody is there. */
    bool (*show)(void *user, const char *what, double share);
    void *user;
} progress;

/* False: the work is to end. */
static inline bool progress_show(const progress *w, const char *what, double share)
{
    return !w || !w->show || w->show(w->user, what, share);
}

#endif
