/* A crowd: many copies of one surface, each under an affine map of its own, as one surface. Its part is the copy and
 * the original's part. A wave of rays meets copies side by side, each lane under its own copy's map, by the original's
 * stages. So a million copies cost little more than ten, and memory for the maps and a hierarchy over their boxes.
 *
 * Copies may be of several kinds (for their materials): a hit has the id of the crowd plus its copy's kind.
 */
#ifndef KAGE_CROWD_CROWD_H
#define KAGE_CROWD_CROWD_H

#include "base/affine.h"
#include "bvh/wide.h"
#include "geometry/surface.h"

/* A copy's map, rounded as in geometry/transformed.c. */
typedef struct crowd_copy {
    real to[3][3], back[3][3]; /* images of the axes; the rows of the inverse */
    real o[3];                 /* the image of the origin */
    int32_t kind, row;         /* row: its place in the list that it is from */
} crowd_copy;

typedef struct crowd {
    surface base;
    surface_ops methods;
    const surface *from;     /* the original; not owned */
    int32_t n, parts, kinds; /* copies; parts of the original: on a mesh its triangles; kinds */
    real mirror, u_ends_sum; /* as in geometry/transformed.c: all maps mirror, or none */
    crowd_copy *copy;        /* in the hierarchy's order */
    wide_bvh *tree;
    double lo[3], hi[3];
} crowd;

/* What a crowd is made of: n >= 1 copies of kinds 0..kinds-1. `copy` gives the map and the kind of copy i, to several
 * threads at once. All maps mirror, or none. */
typedef struct crowd_list {
    int32_t n, kinds;
    affine (*copy)(const void *user, int32_t i, int32_t *kind);
    const void *user;
} crowd_list;

/* The most copies of a surface with so many parts: all have numbers, and the hierarchy has room. */
static inline int32_t crowd_most(int32_t parts)
{
    return INT32_MAX / parts < WIDE_MOST ? INT32_MAX / parts : WIDE_MOST;
}

/* `from` must outlive it. parts: of `from`; on a mesh its triangles. w: as wide_new. NULL: out of memory. */
crowd *crowd_new(const surface *from, int32_t parts, const crowd_list *list, int threads, const progress *w);

static inline int32_t crowd_copy_of(const crowd *f, int32_t part)
{
    return f->parts == 1 ? part : part / f->parts; /* a division costs as much as a hit */
}

/* How many copies are of a kind. */
int32_t crowd_count(const crowd *f, int32_t kind);

/* The map of copy k < n. */
affine crowd_map(const crowd *f, int32_t k);

/* Set lit[i] = 0 where another copy than that of part[i] is hit at a t in (0,1). */
void crowd_occlude_others(const crowd *f, int n, const rays *x, const int32_t *part, real *lit);

/* The same where the copy of part[i] itself is hit. Unlike in occlude_own, the rays start anywhere. */
void crowd_occlude_same(const crowd *f, int n, const rays *x, const int32_t *part, real *lit);

#endif
