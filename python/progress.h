/* The progress of a call as Python hears it: not oftener than it matters, because each time takes Python's lock. */
#ifndef KAGE_PYTHON_PROGRESS_H
#define KAGE_PYTHON_PROGRESS_H

#include "kage.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

/* The `user` of kage_py_progress. handle: of cffi, for Python's object; the rest begins as 0. */
typedef struct kage_py_call {
    void *handle;
    char what[24]; /* the step that Python was told last */
    double told;   /* when, in seconds */
} kage_py_call;

/* In Python: nonzero ends the call. */
static int kage_py_listen(void *handle, const char *what, double share);

static double kage_py_clock(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* A kage_progress: tells Python of a new step at once, and of the same one 20 times a second. There Python also sees
 * Ctrl-C. */
static int kage_py_progress(void *user, const char *what, double share)
{
    kage_py_call *call = (kage_py_call *)user;
    const double now = kage_py_clock();
    if (strncmp(call->what, what, sizeof call->what - 1) == 0 && now - call->told < 0.05)
        return 0;
    snprintf(call->what, sizeof call->what, "%s", what);
    call->told = now;
    return kage_py_listen(call->handle, what, share);
}

#endif
