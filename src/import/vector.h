/* Vectors of a model's camera and lights, in double. */
#ifndef KAGE_IMPORT_VECTOR_H
#define KAGE_IMPORT_VECTOR_H

#include <math.h>

#define DEGREES (180 / 3.14159265358979323846)

static inline double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline double length(const double v[3]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/* Make a direction a unit vector; `otherwise` where it has none. */
static inline void make_unit(double v[3], const double otherwise[3])
{
    const double l = length(v);
    for (int k = 0; k < 3; k++)
        v[k] = l > 1e-30 && l < 1e30 ? v[k] / l : otherwise[k];
}

/* from + t dir */
static inline void along(const double from[3], double t, const double dir[3], double to[3])
{
    for (int k = 0; k < 3; k++)
        to[k] = from[k] + t * dir[k];
}

#endif
