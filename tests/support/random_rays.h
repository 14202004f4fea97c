/* Rays for tests of surfaces about 1 in size, at the origin. */
#ifndef KAGE_RANDOM_RAYS_H
#define KAGE_RANDOM_RAYS_H

#include <math.h>

#include "support/random_in.h"
#include "wave/wave.h"

/* From 4 units off towards a place at most `wide` off the middle. */
static inline void random_ray(rays *x, int i, double wide)
{
    double a = random_in(0, 6.283), z = random_in(-1, 1), l = 4 * sqrt(1 - z * z), k = random_in(0.2, 3);
    double r[3] = {l * cos(a), 4 * z, l * sin(a)},
           to[3] = {random_in(-wide, wide), random_in(-1, 1), random_in(-wide, wide)};
    x->r.x[i] = (real)r[0], x->r.y[i] = (real)r[1], x->r.z[i] = (real)r[2];
    x->s.x[i] = (real)(k * (to[0] - r[0])), x->s.y[i] = (real)(k * (to[1] - r[1])),
    x->s.z[i] = (real)(k * (to[2] - r[2]));
}

static inline void no_hits(hits *h, int n)
{
    for (int i = 0; i < n; i++) {
        h->t[i] = REAL_FAR;
        h->id[i] = -1;
    }
}

#endif
