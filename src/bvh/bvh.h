/* A bounding volume hierarchy over boxes, by Embree 3 or 4. It finds the boxes that a ray passes, and those near a
 * point. The result is a set of candidates, in any order: it includes all boxes that are hit, and because of float's
 * rounding perhaps some that are just missed. The caller tests the candidates in double, so that pictures are the same
 * on every processor. Coordinates should be at most about 1: bvh_space scales them.
 */
#ifndef KAGE_BVH_BVH_H
#define KAGE_BVH_BVH_H

#include <stdbool.h>
#include <stdint.h>

#include "base/progress.h"
#include "base/vec3.h"

typedef struct bvh bvh;

typedef struct bvh_box {
    float lo[3], hi[3];
} bvh_box;

/* The space of a hierarchy: its origin is the centre of all boxes, its unit their bounding sphere's radius. */
typedef struct bvh_space {
    vec3 centre;
    double radius;
} bvh_space;

bvh_space bvh_space_about(const double lo[3], const double hi[3]);

/* A box in that space, enlarged by more than the rounding of boxes and rays to float. */
bvh_box bvh_box_in(const bvh_space *p, const double lo[3], const double hi[3]);

/* Clip the ray r + s t, *from <= t <= *to, to the sphere of radius `reach` about the centre. In the space of the
 * hierarchy the clipped ray is at + way x, 0 <= x <= *end, with a unit vector `way`. False: it misses the sphere. */
bool bvh_enter(const bvh_space *p, double reach, vec3 r, vec3 s, double *from, double *to, float at[3], float way[3],
               float *end);

/* Called with the index of each box. */
typedef void bvh_visit(void *user, int32_t box);

/* Build the hierarchy of n boxes, which are copied, with several threads; 0: one for each processor. Shows "building"
 * in w, which may be NULL and cannot stop it. The caller frees it with bvh_free. NULL: out of memory. */
bvh *bvh_new(int n, const bvh_box *box, int threads, const progress *w);
void bvh_free(bvh *b);

/* Visit the boxes that r + s t, 0 <= t <= end, passes. Reentrant, as are bvh_packet_toward and bvh_around. */
void bvh_along(const bvh *b, const float r[3], const float s[3], float end, bvh_visit *visit, void *user);

/* Rays at + way x, 0 <= x <= end. end < 0: there is no such ray. */
enum { BVH_PACKET = 16 };
typedef struct bvh_packet {
    float at[3][BVH_PACKET], way[3][BVH_PACKET], end[BVH_PACKET];
} bvh_packet;

/* bvh_enter for the rays r + s t, from[i] <= t <= to[i], of a packet; x->end is -1 where a ray misses the sphere, or
 * from > to. */
void bvh_enter_packet(const bvh_space *p, double reach, const double r[3][BVH_PACKET], const double s[3][BVH_PACKET],
                      double from[BVH_PACKET], double to[BVH_PACKET], bvh_packet *x);

/* Called with a box and rays, bit i for ray i: those that reach it, perhaps not all at once, and of a coherent packet
 * many that miss it. It may lower end[i] of these rays, then it returns true; a negative number stops the ray. Boxes
 * beyond the new end may still be visited. */
typedef bool bvh_meet(void *user, int32_t box, uint32_t which, float end[BVH_PACKET]);

/* Visit the boxes of a packet's rays, roughly from near to far. Rays that go nearly the same way share the hierarchy's
 * memory and the calls. x->end becomes where each ray ended. */
void bvh_packet_toward(const bvh *b, bvh_packet *x, bvh_meet *visit, void *user);

/* Visit the boxes that are within `radius` of p. */
void bvh_around(const bvh *b, const float p[3], float radius, bvh_visit *visit, void *user);

#endif
