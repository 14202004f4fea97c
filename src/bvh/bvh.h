/* Bounding volume hierarchy over boxes, by Embree 3 or 4: which boxes a ray passes, or are near a point. The answer is
 * a set of candidates: no box that is met is missing; boxes that are just missed may be among them, by float's
 * rounding, and in any order. So no picture depends on the processor, as long as the caller tests the candidates in
 * double. Coordinates should be about 1 in size: bvh_space scales them so.
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

/* The space of a hierarchy: the centre of all that is in it is the origin, and the radius the unit. */
typedef struct bvh_space {
    vec3 centre;
    double radius;
} bvh_space;

bvh_space bvh_space_about(const double lo[3], const double hi[3]);

/* A box in that space, widened by more than the roundings of its corners and of a ray to float. */
bvh_box bvh_box_in(const bvh_space *p, const double lo[3], const double hi[3]);

/* Cut the ray r + s t, *from <= t <= *to, to the sphere of radius `reach` about the centre. In the space of the
 * hierarchy what is left is at + way x, 0 <= x <= *end, with a unit vector `way`. False: nothing is left. */
bool bvh_enter(const bvh_space *p, double reach, vec3 r, vec3 s, double *from, double *to, float at[3], float way[3],
               float *end);

/* Called with the index of each box. */
typedef void bvh_visit(void *user, int32_t box);

/* The hierarchy of n boxes, which are copied; bvh_free. NULL: out of memory. */
bvh *bvh_new(int n, const bvh_box *box);
void bvh_free(bvh *b);

/* The same, calling `progress` now and then with the share of the work that is done. */
typedef void bvh_progress(void *user, double share);
bvh *bvh_new_with_progress(int n, const bvh_box *box, bvh_progress *progress, void *user);

/* Visit the boxes that r + s t, 0 <= t <= end, passes. Reentrant, as the other two are. */
void bvh_along(const bvh *b, const float r[3], const float s[3], float end, bvh_visit *visit, void *user);

/* The same, roughly from near to far, with an end that can come nearer: `visit` returns the new end, at most `end`, or
 * below 0 to stop. Boxes beyond it may still be visited. */
typedef float bvh_shorten(void *user, int32_t box, float end);
void bvh_toward(const bvh *b, const float r[3], const float s[3], float end, bvh_shorten *visit, void *user);

/* Visit the boxes that are within `radius` of p. */
void bvh_around(const bvh *b, const float p[3], float radius, bvh_visit *visit, void *user);

#endif
