/* Places on rays, and the gap between each and the displaced surface. Private to displaced. */
#ifndef KAGE_DISPLACED_PATH_H
#define KAGE_DISPLACED_PATH_H

#include "displaced/march.h"

typedef struct paths {
    int n;
    int32_t lane[LANES]; /* whose ray it is */
    rays x;
    real t[LANES];
    closest_points p;
    bump_values h;
    real gap[LANES]; /* height - P */
    /* derivatives by t: of (u,w), the height and, at order 1, the gap */
    real du[LANES], dw[LANES], dh[LANES], slope[LANES];
    long evaluations; /* of P */
} paths;

/* Set all that follows from the rays and t. */
void paths_evaluate(const domain *f, const bump *P, int order, paths *k);

/* Lane `from` of one becomes lane `to` of the other, ray and t. */
void paths_copy(const paths *k, int from, paths *other, int to);

#endif
