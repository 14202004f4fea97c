/* Things that several scenes use: each counts its other users. They may be in several threads. */
#ifndef KAGE_BASE_SHARED_H
#define KAGE_BASE_SHARED_H

#include <stdbool.h>

/* One user more. */
static inline void shared_add(int *others) { __atomic_add_fetch(others, 1, __ATOMIC_RELAXED); }

/* One user less. True: it was the last one, who frees the thing. */
static inline bool shared_drop(int *others) { return __atomic_fetch_sub(others, 1, __ATOMIC_ACQ_REL) == 0; }

#endif
