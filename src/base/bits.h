/* Sets as the bits of a number. */
#ifndef KAGE_BASE_BITS_H
#define KAGE_BASE_BITS_H

#include <stdint.h>

/* The index of the lowest bit of a set that is not empty. */
static inline int lowest_bit(uint32_t set)
{
#if defined(__GNUC__)
    return __builtin_ctz(set);
#else
    int k = 0;
    for (; !(set & 1); set >>= 1)
        k++;
    return k;
#endif
}

#endif
