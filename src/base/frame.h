/* An orthonormal frame about an axis, for surfaces of revolution. Their angle u is 0 at x and grows towards z. */
#ifndef KAGE_BASE_FRAME_H
#define KAGE_BASE_FRAME_H

#include "base/vec3.h"

/* Orthonormal, with x cross y = z, as in the scene; y is the axis. */
typedef struct frame {
    vec3 x, y, z;
} frame;

/* x is the scene's +x (+y if the axis is within 26 degrees of +x or -x), projected to the plane perpendicular to the
 * axis. For the axis +y the frame is the scene's. `axis` must not be 0. */
static inline frame frame_about(vec3 axis)
{
    const vec3 y = vec3_unit(axis), e = fabs(y.x) < 0.9 ? (vec3){1, 0, 0} : (vec3){0, 1, 0};
    const vec3 x = vec3_unit(vec3_sub(e, vec3_scale(y, vec3_dot(e, y))));
    return (frame){x, y, vec3_cross(x, y)};
}

#endif
