/* Somebody who wants to see how far a long piece of work has come; the library itself prints nothing. */
#ifndef KAGE_BASE_PROGRESS_H
#define KAGE_BASE_PROGRESS_H

typedef struct progress {
    void (*show)(void *user, const char *what,
                 double share); /* `what` is done, and this share of it; NULL: nobody is there */
    void *user;
} progress;

static inline void progress_show(const progress *w, const char *what, double share)
{
    if (w && w->show)
        w->show(w->user, what, share);
}

#endif
