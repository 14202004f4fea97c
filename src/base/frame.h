/* Directions about an axis, for surfaces that turn around one: u = 0 is towards x, and u goes from x to z. */
#ifndef KAGE_BASE_FRAME_H
#define KAGE_BASE_FRAME_H

#include "base/vec3.h"

/* Unit vectors at right angles with x x y = z, as the scene's own; y is the axis. */
typedef struct frame {
    vec3 x, y, z;
} frame;

/* x is the scene's +x as seen along the axis; where the axis is too near to that (26 degrees), the scene's +y. About +y
 * the frame is the scene's. The axis needs a length. */
static inline frame frame_about(vec3 axis)
{
    const vec3 y = vec3_unit(axis), e = fabs(y.x) < 0.9 ? (vec3){1, 0, 0} : (vec3){0, 1, 0};
    const vec3 x = vec3_unit(vec3_sub(e, vec3_scale(y, vec3_dot(e, y))));
    return (frame){x, y, vec3_cross(x, y)};
}

#endif
