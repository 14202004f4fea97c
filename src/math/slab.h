/* Clips a ray to a slab, the space between two parallel planes. */
#ifndef KAGE_MATH_SLAB_H
#define KAGE_MATH_SLAB_H

#include "base/real.h"

/* Reduce t0..t1 to the part where lo <= a + b t <= hi; t1 = -1 where there is none. */
static inline void clip(real a, real b, real lo, real hi, real *t0, real *t1)
{
    real x = (lo - a) / b, y = (hi - a) / b; /* b = 0: infinite, or NaN where a is lo or hi, and that is inside */
    real from = x < y ? x : y, to = x < y ? y : x;
    *t0 = from > *t0 ? from : *t0;
    *t1 = to < *t1 ? to : *t1;
    *t1 = (b == 0) & ((a < lo) | (a > hi)) ? R(-1) : *t1;
}

#endif
