/* A vector in double. Waves store vectors as arrays (wave/wave.h). */
#ifndef KAGE_BASE_VEC3_H
#define KAGE_BASE_VEC3_H

#include "base/real.h"

typedef struct vec3 {
    double x, y, z;
} vec3;

static inline vec3 vec3_add(vec3 a, vec3 b) { return (vec3){a.x + b.x, a.y + b.y, a.z + b.z}; }
static inline vec3 vec3_sub(vec3 a, vec3 b) { return (vec3){a.x - b.x, a.y - b.y, a.z - b.z}; }
static inline vec3 vec3_scale(vec3 a, double k) { return (vec3){k * a.x, k * a.y, k * a.z}; }
static inline double vec3_dot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline vec3 vec3_cross(vec3 a, vec3 b)
{
    return (vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline double vec3_length(vec3 a) { return sqrt(vec3_dot(a, a)); }
static inline vec3 vec3_unit(vec3 a) { return vec3_scale(a, 1 / vec3_length(a)); }

#endif
