/* Top-level hierarchy: the objects that each ray of a wave may meet. Unbounded objects, such as planes, are candidates
 * for every ray.
 */
#ifndef KAGE_SCENE_OBJECT_BVH_H
#define KAGE_SCENE_OBJECT_BVH_H

#include <stdbool.h>

#include "base/progress.h"
#include "wave/wave.h"

struct scene;
typedef struct object_bvh object_bvh;

/* A hierarchy over the boxes of the scene's objects, built with several threads (0: all processors). NULL with *good:
 * few objects, testing all is faster. NULL without: out of memory. */
object_bvh *object_bvh_new(const struct scene *s, int threads, const progress *w, bool *good);
void object_bvh_free(object_bvh *c);

/* For each object the rays of a wave that may meet it. One for each thread. */
typedef struct candidates candidates;
candidates *candidates_new(const object_bvh *c, memory *of); /* NULL: out of memory */
void candidates_free(candidates *m);

/* Find them, for n rays r + s t, 0 < t < end[i]. own: the object that each ray starts on, always a candidate; NULL:
 * none. */
void object_bvh_find(const object_bvh *c, int n, const rays *x, const real *end, const int32_t *own, candidates *m);

/* The next object after `after` (-1: the first) that some ray may meet; -1: there is none. */
int32_t candidates_next(const candidates *m, int32_t after);

/* The rays that may meet object `id`, in order, into lane[LANES]. Returns how many. */
int candidates_rays(const candidates *m, int32_t id, int32_t *lane);

#endif
