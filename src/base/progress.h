/* A callback for the progress of long work; the library itself prints nothing. */
#ifndef KAGE_BASE_PROGRESS_H
#define KAGE_BASE_PROGRESS_H

typedef struct progress {
    /* Called with the name of the work and the share of it that is done, 0 to 1; NULL: nobody wants to know. */
    void (*show)(void *user, const char *what, double share);
    void *user;
} progress;

static inline void progress_show(const progress *w, const char *what, double share)
{
    if (w && w->show)
        w->show(w->user, what, share);
}

#endif
