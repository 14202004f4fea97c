/* How many threads share a piece of work. The count comes from the caller: nothing changes the process's own setting.
 */
#ifndef KAGE_BASE_THREADS_H
#define KAGE_BASE_THREADS_H

#include <stdbool.h>

#if defined(_OPENMP)
#include <omp.h>
#endif

/* `asked`, or as many as there are processors where that is 0. Built without OpenMP, the caller's thread alone. */
static inline int threads_of(int asked)
{
#if defined(_OPENMP)
    return asked > 0 ? asked : omp_get_num_procs();
#else
    (void)asked;
    return 1;
#endif
}

/* Whether this thread is the one that began the parallel work. */
static inline bool is_callers_thread(void)
{
#if defined(_OPENMP)
    return omp_get_thread_num() == 0;
#else
    return true;
#endif
}

#endif
