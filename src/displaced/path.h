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
    real gap[LANES];                      /* height - P */
    real du[LANES], dw[LANES], dh[LANES]; /* derivatives by t of (u,w) and the height */
    real slope[LANES];                    /* and of the gap */
    long evaluations;                     /* of P */
} paths;

/* Set what follows from the rays and t: p, h and the gap; and the derivatives by t, that of the gap only by an h of
 * order 1. */
void paths_evaluate(const domain *f, const bump *P, int order, paths *k);
void paths_differentiate(int order, paths *k);

/* Lane `from` of one becomes lane `to` of the other, ray and t. */
void paths_copy(const paths *k, int from, paths *other, int to);

#endif
