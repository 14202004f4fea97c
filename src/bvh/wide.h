/* A hierarchy over many boxes whose rays can stop at each box that they reach, and go on later with a shorter end. So a
 * wave of rays takes one box each, the things in these boxes are tested side by side, and the rays go on.
 *
 * Unlike the hierarchy of bvh.h it is in scene units and does its own arithmetic. Boxes and rays are wider than the
 * rounding of float, and of equal numbers the same boxes are reached on every processor and with any threads.
 */
#ifndef KAGE_BVH_WIDE_H
#define KAGE_BVH_WIDE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/vec3.h"

typedef struct wide_box {
    float lo[3], hi[3];
} wide_box;

typedef struct wide_bvh wide_bvh;

/* A box in float, wider than that by more than the rounding of hits in it. */
wide_box wide_box_of(const double lo[3], const double hi[3]);

/* Build the hierarchy of n >= 1 boxes. order[n] becomes the boxes' order in space: neighbours there are near each other
 * in the hierarchy. Item k is box order[k]. Neither depends on the threads. NULL: out of memory. */
wide_bvh *wide_new(int n, const wide_box *box, int32_t *order, int threads);
void wide_free(wide_bvh *w);

/* Bytes in memory. */
size_t wide_size(const wide_bvh *w);

enum { WIDE_STACK = 192 };

/* A ray r + s t in a hierarchy. */
typedef struct wide_walk {
    float low[3], high[3]; /* r, wider by its rounding: for a box's low and high sides */
    float over[3];         /* 1/s */
    int top;
    float enter[WIDE_STACK];  /* where the ray enters what is left to visit, the nearest last */
    int32_t left[WIDE_STACK]; /* a node, or ~item */
} wide_walk;

void wide_begin(wide_walk *k, vec3 r, vec3 s);

/* The next item whose box r + s t passes at 0 <= t <= end, roughly from near to far; -1: none is left. */
int32_t wide_next(const wide_bvh *w, wide_walk *k, double end);

#endif
