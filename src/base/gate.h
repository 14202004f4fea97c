/* Work that threads share. The caller's thread shows how much is done, and may stop it; the others hear of that. */
#ifndef KAGE_BASE_GATE_H
#define KAGE_BASE_GATE_H

#include "base/progress.h"
#include "base/threads.h"

typedef struct gate {
    const progress *to; /* may be NULL */
    const char *what;
    long done, all;
    bool shut;
} gate;

/* False: stop. */
static inline bool gate_is_open(gate *g)
{
    bool shut;
#pragma omp atomic read
    shut = g->shut;
    return !shut;
}

/* n more are done. */
static inline void gate_pass(gate *g, long n)
{
    long done;
#pragma omp atomic capture
    done = g->done += n;
    if (is_callers_thread() && !progress_show(g->to, g->what, (double)done / (double)g->all)) {
#pragma omp atomic write
        g->shut = true;
    }
}

#endif
