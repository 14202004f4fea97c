/* Somebody who wants to see how far a long piece of work has come; the library itself prints nothing. */
#ifndef KAGE_BASE_PROGRESS_H
#define KAGE_BASE_PROGRESS_H

typedef struct watch {
    void (*show)(void *user, const char *what, double share); /* `what` is done, and this share of it; NULL: nobody is there */
    void *user;
} watch;

static inline void watch_show(const watch *w, const char *what, double share)
{
    if (w && w->show)
        w->show(w->user, what, share);
}

#endif
