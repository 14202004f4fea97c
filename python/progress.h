/* The progress of a call, kept where another thread of Python can look: the thread that makes the call never needs
 * Python's lock for it. */
#ifndef KAGE_PYTHON_PROGRESS_H
#define KAGE_PYTHON_PROGRESS_H

#include "kage.h"

#include <pthread.h>
#include <stdio.h>

/* The `user` of kage_py_progress. All zero but for the lock, which kage_py_begin makes. */
typedef struct kage_py_call {
    pthread_mutex_t lock; /* of the rest */
    char what[24];        /* the step; empty: none yet */
    double share;         /* of it, that is done */
    int stop;             /* not 0: the call is to end */
} kage_py_call;

static void kage_py_begin(kage_py_call *call) { pthread_mutex_init(&call->lock, NULL); }

/* A kage_progress: notes the step, and ends the call where it is to stop. */
static int kage_py_progress(void *user, const char *what, double share)
{
    kage_py_call *call = (kage_py_call *)user;
    pthread_mutex_lock(&call->lock);
    snprintf(call->what, sizeof call->what, "%s", what);
    call->share = share;
    const int stop = call->stop;
    pthread_mutex_unlock(&call->lock);
    return stop;
}

/* The step, and the share of it that is done. */
static double kage_py_look(kage_py_call *call, char what[24])
{
    pthread_mutex_lock(&call->lock);
    snprintf(what, sizeof call->what, "%s", call->what);
    const double share = call->share;
    pthread_mutex_unlock(&call->lock);
    return share;
}

static void kage_py_stop(kage_py_call *call)
{
    pthread_mutex_lock(&call->lock);
    call->stop = 1;
    pthread_mutex_unlock(&call->lock);
}

#endif
