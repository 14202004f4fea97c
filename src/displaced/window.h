/* How far along each ray there is no hit, by bounds over a window, t to t + size, of the gap's value and slope. Private
 * to displaced. */
#ifndef KAGE_DISPLACED_WINDOW_H
#define KAGE_DISPLACED_WINDOW_H

#include "displaced/path.h"

typedef struct windows {
    real size[LANES];   /* in t; made smaller where the bounds do not reach so far */
    real step[LANES];   /* up to `size`: there is no hit before */
    int32_t one[LANES]; /* the gap falls all over the window: it has one hit at most, and step is size */
} windows;

/* k is evaluated and differentiated; where P has no bounds of its second partials, the gap's slope does not matter.
 * side: 1 where the gap is above 0, -1 where it is below. tolerance: of places. */
void windows_clear(const domain *f, const bump *P, const paths *k, const real *side, const real *tolerance,
                   windows *out);

#endif
