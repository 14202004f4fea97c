/* The number of threads for a parallel loop. OpenMP's setting of the process is never changed. */
#ifndef KAGE_BASE_THREADS_H
#define KAGE_BASE_THREADS_H

#include <stdbool.h>

#if defined(_OPENMP)
#include <omp.h>
#endif

/* `asked`; 0: one for each processor. Without OpenMP always 1. */
static inline int threads_of(int asked)
{
#if defined(_OPENMP)
    return asked > 0 ? asked : omp_get_num_procs();
#else
    (void)asked;
    return 1;
#endif
}

/* How many threads run the parallel loop that this thread is in. */
static inline int threads_here(void)
{
#if defined(_OPENMP)
    return omp_get_num_threads();
#else
    return 1;
#endif
}

/* Is this the thread that started the parallel loop? */
static inline bool is_callers_thread(void)
{
#if defined(_OPENMP)
    return omp_get_thread_num() == 0;
#else
    return true;
#endif
}

#endif
