/* Bounds of the noise (noise.h) and of its partials over a rectangle. */
#ifndef KAGE_MATH_NOISE_BOUNDS_H
#define KAGE_MATH_NOISE_BOUNDS_H

#include "math/interval.h"

typedef struct noise_bounds {
    interval f, x, y, xx, xy, yy;
} noise_bounds;

/* Close where the rectangle is small, the bounds of the whole plane where its sides add up to 2 or more. */
noise_bounds noise_bounds_over(interval a, interval b);

#endif
