/* A wave: some LANES rays that travel together through the stages of trace.c, each quantity in an array
 * of its own (structure of arrays), so that a stage is one plain loop over the lanes.
 *
 * Arrays hold LANES entries; the first n are in use. What lies beyond n is undefined and never read.
 */
#ifndef KAGE_WAVE_WAVE_H
#define KAGE_WAVE_WAVE_H

#include <stdint.h>

#include "base/real.h"
#include "base/vec3.h"

enum { LANES = 128 }; /* a tile of 16 x 8 pixels; all that one wave touches stays in a first-level cache */

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

/* Where each ray has met a smooth surface first. id < 0: nowhere, and then t is REAL_FAR. */
typedef struct hits {
    real t[LANES];
    int32_t id[LANES];   /* index of the object in the scene */
    int32_t part[LANES]; /* of its surface; set by displaced surfaces and meshes, others find it in `locate` */
} hits;

/* Where `take`, ray i has met object `id` at t. */
static inline void hits_take(hits *h, int i, int take, real t, int32_t id)
{
    h->t[i] = take ? t : h->t[i];
    h->id[i] = take ? id : h->id[i];
}

/* The starts of rays that leave a surface: the object, the part of its surface, and the place on its smooth shape.
 * There the ray begins for the surface itself, while r is where it begins for all others. */
typedef struct ray_origins {
    int32_t id[LANES], part[LANES];
    vec3s at;
} ray_origins;

/* Q(u,w) and its partial derivatives. */
typedef struct partials {
    vec3s Q, Qu, Qw, Quu, Quw, Qww;
} partials;

/* P(u,w), the height along the unit normal in scene units, and its partial derivatives. */
typedef struct bump_values {
    real P[LANES], Pu[LANES], Pw[LANES], Puu[LANES], Puw[LANES], Pww[LANES];
} bump_values;

/* Places in space as seen from a surface: the foot of the perpendicular (u,w), the height over it along n/|n|, and the
 * gradients of the three. */
typedef struct closest_points {
    real u[LANES], w[LANES], h[LANES];
    vec3s gu, gw, gh;
} closest_points;

#endif
