/* A wave: up to LANES rays that go through the stages of trace.c together, as a structure of arrays, so that a stage
 * is one plain loop. The first n entries of each array are in use; the others are undefined and never read.
 */
#ifndef KAGE_WAVE_WAVE_H
#define KAGE_WAVE_WAVE_H

#include <stdint.h>

#include "base/real.h"
#include "base/vec3.h"

enum { LANES = 128 }; /* a tile of 16 x 8 pixels; a wave's data fit the first-level cache */

/* The k-th lane of n, where a whole wave, which is mostly a tile, goes by squares of 4 x 4 pixels. */
static inline int wave_lane(int n, int k)
{
    const int square = k / 16, in = k % 16;
    return n < LANES ? k : (square / 4 * 4 + in / 4) * 16 + square % 4 * 4 + in % 4;
}

typedef struct vec3s {
    real x[LANES], y[LANES], z[LANES];
} vec3s;

static inline void vec3s_fill(vec3s *v, int n, real x, real y, real z)
{
    for (int i = 0; i < n; i++) {
        v->x[i] = x;
        v->y[i] = y;
        v->z[i] = z;
    }
}

/* One lane as a vector in double, and back. */
static inline vec3 vec3s_get(const vec3s *v, int i)
{
    return (vec3){(double)v->x[i], (double)v->y[i], (double)v->z[i]};
}

static inline void vec3s_set(vec3s *v, int i, vec3 x)
{
    v->x[i] = (real)x.x;
    v->y[i] = (real)x.y;
    v->z[i] = (real)x.z;
}

/* A vector that is the same for all lanes, rounded to `real`. */
static inline void vec3_round(real to[3], vec3 v)
{
    to[0] = (real)v.x;
    to[1] = (real)v.y;
    to[2] = (real)v.z;
}

/* The rays r + s t. s need not be a unit vector. */
typedef struct rays {
    vec3s r, s;
} rays;

/* The first hit of each ray with a smooth surface. id < 0: none, and t is REAL_FAR. */
typedef struct hits {
    real t[LANES];
    int32_t id[LANES];   /* index of the object in the scene */
    int32_t part[LANES]; /* of its surface; set only by displaced surfaces, meshes and copies */
} hits;

/* If `take`, ray i hits object `id` at t. */
static inline void hits_take(hits *h, int i, int take, real t, int32_t id)
{
    h->t[i] = take ? t : h->t[i];
    h->id[i] = take ? id : h->id[i];
}

/* The starts of rays that leave a surface: the object, the part of its surface, and the point on its smooth shape. For
 * hits with this surface the ray starts there, for all others at r. */
typedef struct ray_origins {
    int32_t id[LANES], part[LANES];
    vec3s at;
} ray_origins;

/* Q(u,w) and its partial derivatives. */
typedef struct partials {
    vec3s Q, Qu, Qw, Quu, Quw, Qww;
} partials;

/* P(u,w), the height along the unit normal in scene units, and its partial derivatives. Where a function has no value
 * they are 0: there the surface is smooth. */
typedef struct bump_values {
    real P[LANES], Pu[LANES], Pw[LANES], Puu[LANES], Puw[LANES], Pww[LANES];
    int undefined;       /* how many lanes are without a value */
    int32_t none[LANES]; /* 1: this one is; only where some are */
} bump_values;

/* The closest points of a surface to points in space: (u,w), the height above it along n/|n|, and the gradients of the
 * three. */
typedef struct closest_points {
    real u[LANES], w[LANES], h[LANES];
    vec3s gu, gw, gh;
} closest_points;

#endif
