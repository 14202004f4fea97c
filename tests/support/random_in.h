/* Pseudorandom numbers for tests: the same on every run (Marsaglia's xorshift64). */
#ifndef KAGE_RANDOM_IN_H
#define KAGE_RANDOM_IN_H

#include <stdint.h>

static inline double random_in(double lo, double hi)
{
    static uint64_t state = 88172645463325252u;
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return lo + (hi - lo) * (double)(state >> 11) / 9007199254740992.0;
}

#endif
