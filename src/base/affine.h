/* Affine maps in double: the transforms of a scene. */
#ifndef KAGE_BASE_AFFINE_H
#define KAGE_BASE_AFFINE_H

#include "base/vec3.h"

/* p -> x p.x + y p.y + z p.z + o; the four rows of POV-Ray's `matrix`. */
typedef struct affine {
    vec3 x, y, z, o;
} affine;

static inline affine affine_identity(void) { return (affine){{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}}; }

static inline vec3 affine_vector(const affine *m, vec3 v)
{
    return vec3_add(vec3_add(vec3_scale(m->x, v.x), vec3_scale(m->y, v.y)), vec3_scale(m->z, v.z));
}

static inline vec3 affine_point(const affine *m, vec3 p) { return vec3_add(affine_vector(m, p), m->o); }

/* First m, then next. */
static inline affine affine_then(const affine *m, const affine *next)
{
    return (affine){affine_vector(next, m->x), affine_vector(next, m->y), affine_vector(next, m->z),
                    affine_point(next, m->o)};
}

/* The determinant; negative where the map mirrors. */
static inline double affine_volume(const affine *m) { return vec3_dot(vec3_cross(m->x, m->y), m->z); }

/* The inverse, as rows x, y, z: it maps a vector v to (x.v, y.v, z.v). So m maps gradients and normals by these rows.
 * o is that of m, unchanged. The determinant must not be 0. */
static inline affine affine_back(const affine *m)
{
    const double k = 1 / affine_volume(m);
    return (affine){vec3_scale(vec3_cross(m->y, m->z), k), vec3_scale(vec3_cross(m->z, m->x), k),
                    vec3_scale(vec3_cross(m->x, m->y), k), m->o};
}

/* The factor by which m scales lengths, if it keeps angles; else 0. The tolerance, 1e-12, is far above the rounding of
 * a product of transforms. */
static inline double affine_scale(const affine *m)
{
    const double xx = vec3_dot(m->x, m->x), yy = vec3_dot(m->y, m->y), zz = vec3_dot(m->z, m->z), least = 1e-12 * xx;
    const int same = fabs(yy - xx) <= least && fabs(zz - xx) <= least;
    const int square = fabs(vec3_dot(m->x, m->y)) <= least && fabs(vec3_dot(m->y, m->z)) <= least &&
                       fabs(vec3_dot(m->z, m->x)) <= least;
    return same && square ? sqrt(xx) : 0;
}

#endif
