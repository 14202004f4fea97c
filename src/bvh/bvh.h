/* Which of many boxes a ray passes, or are near a place. The answer is no more than candidates: it may hold boxes that
 * are missed by a rounding of float, and its order has no meaning. None that is met is left out. By Embree, version 3
 * or 4, which bvh_embree.c alone knows; coordinates should be about 1, as floats are kept there.
 */
#ifndef KAGE_BVH_BVH_H
#define KAGE_BVH_BVH_H

#include <stdbool.h>
#include <stdint.h>

#include "base/vec3.h"

typedef struct bvh bvh;

typedef struct bvh_box {
    float lo[3], hi[3];
} bvh_box;

/* Space as a hierarchy has it: of all that is in it the centre is the origin, and the radius the unit. (bvh_space.c) */
typedef struct bvh_space {
    vec3 centre;
    double radius;
} bvh_space;

bvh_space bvh_space_about(const double lo[3], const double hi[3]);

/* A box there, wider by more than float leaves of its place and of a ray's. */
bvh_box bvh_box_in(const bvh_space *p, const double lo[3], const double hi[3]);

/* The stretch of a ray, within from..to, that is in a sphere of radius `reach` about the centre, and as a ray there.
 * False: there is none. */
bool bvh_enter(const bvh_space *p, double reach, vec3 r, vec3 s, double *from, double *to, float at[3], float way[3],
               float *end);

/* Called with the index of each box. */
typedef void bvh_visit(void *user, int32_t box);

/* Copies the boxes. NULL: Embree failed, for want of memory. */
bvh *bvh_new(int n, const bvh_box *box);
void bvh_free(bvh *b);

/* The same for many boxes: tells now and then which share of the work is done. */
typedef void bvh_progress(void *user, double share);
bvh *bvh_new_with_progress(int n, const bvh_box *box, bvh_progress *progress, void *user);

/* The boxes that r + s t, 0 <= t <= end, passes. Reentrant. */
void bvh_along(const bvh *b, const float r[3], const float s[3], float end, bvh_visit *visit, void *user);

/* The same from near to far, more or less, and no farther than is told: `visit` returns the end from now on, which is
 * `end` or less; below 0 there is no need to go on. What lies beyond may still be visited. */
typedef float bvh_shorten(void *user, int32_t box, float end);
void bvh_toward(const bvh *b, const float r[3], const float s[3], float end, bvh_shorten *visit, void *user);

/* The boxes that are within `radius` of p. */
void bvh_around(const bvh *b, const float p[3], float radius, bvh_visit *visit, void *user);

#endif
