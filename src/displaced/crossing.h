/* Crossings of rays with the displaced surface, refined side by side. Private to displaced. */
#ifndef KAGE_DISPLACED_CROSSING_H
#define KAGE_DISPLACED_CROSSING_H

#include "displaced/path.h"

/* Brackets a..b: at a the gap is on the side that the ray comes from, at b on the other. */
typedef struct crossings {
    paths at; /* t: the best place so far */
    real side[LANES], a[LANES], b[LANES];
    real above_a[LANES], above_b[LANES]; /* the gaps there, times side; more than 0, and not */
    real tolerance[LANES], least[LANES]; /* the gap at the best place */
    int32_t own[LANES];
} crossings;

/* Refine all; t and found are by lane. */
void crossings_refine(const domain *f, const bump *P, crossings *c, real *t, int32_t *found);

#endif
