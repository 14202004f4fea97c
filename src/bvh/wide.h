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

#include "base/progress.h"
#include "base/real.h"
#include "base/vec3.h"

typedef struct wide_box {
    float lo[3], hi[3];
} wide_box;

typedef struct wide_bvh wide_bvh;

/* A box in float, wider than that by more than the rounding of hits in it. */
wide_box wide_box_of(const double lo[3], const double hi[3]);

enum { WIDE_MOST = 1 << 28 }; /* boxes: 8 times a node's number is an int32_t, too */

/* Build the hierarchy of 1 <= n <= WIDE_MOST boxes. order[n] becomes the boxes' order in space: neighbours there are
 * near each other in the hierarchy. Item k is box order[k]. Neither depends on the threads. show: what its memory is
 * taken from; NULL: no limit. NULL: out of memory. */
wide_bvh *wide_new(int n, const wide_box *box, int32_t *order, int threads, const progress *show);
void wide_free(wide_bvh *w);

enum { WIDE_STACK = 192 };

/* A ray r + s t in a hierarchy. */
typedef struct wide_walk {
    float low[3], high[3]; /* r, wider by its rounding: for a box's low and high sides */
    float over[3];         /* 1/s */
    int top;
    float enter[WIDE_STACK];  /* where the ray enters what is left to visit, the nearest last */
    int32_t left[WIDE_STACK]; /* a node, or ~item */
} wide_walk;

enum { WIDE_RAYS = 16 };

/* Up to 16 rays side by side. Where they are close to each other, a node is tested once for all of them. */
typedef struct wide_beam {
    int n, top;
    int work; /* nodes and items left to test before the beam gives up */
    float low[3][WIDE_RAYS], high[3][WIDE_RAYS], over[3][WIDE_RAYS];
    float end[WIDE_RAYS]; /* of each ray; negative: it is done */
    float far;            /* the largest end */
    /* For each axis all rays are at t within first + t slowest .. last + t fastest. So a box lo..hi is passed where t
     * slowest <= hi - first and t fastest >= lo - last: two bounds of t, each from below or from above. As a bound from
     * below it is (hi - first) slow[0], from above (hi - first) slow[1] + slow[2]; and so for the other. */
    float first[3], last[3], slow[3][3], fast[3][3];
    float enter[WIDE_STACK];
    int32_t left[WIDE_STACK]; /* a node, or ~(8 node + child) */
} wide_beam;

/* Begin with n rays r + s t, 0 <= t <= end: lanes lane[] of the arrays. An end below 0: the ray is done. */
void wide_beam_begin(wide_beam *k, int n, const int32_t *lane, const real *const r[3], const real *const s[3],
                     const real *end);

/* The rays have new ends. */
void wide_beam_shorten(wide_beam *k, const int32_t *lane, const real *end);

/* The next item that some rays may pass, roughly from near to far, and a bit for each of them. -1: none is left, or the
 * rays are too far from each other: then k->work < 0. */
int32_t wide_beam_next(const wide_bvh *w, wide_beam *k, unsigned *rays);

void wide_begin(wide_walk *k, vec3 r, vec3 s);

/* The next item whose box r + s t passes at 0 <= t <= end, roughly from near to far; -1: none is left. */
int32_t wide_next(const wide_bvh *w, wide_walk *k, double end);

#endif
