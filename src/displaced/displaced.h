/* True displacement: the surface X = Q + P n/|n| over a smooth surface Q and a bump P, as a surface of its own. It is
 * what the paper's method is measured against. Rays meet it where it is, so it needs no shifted shadow rays.
 *
 * How hits are found depends on the smooth surface (displaced_form): closed.c for those whose closest points have
 * closed forms, patch.c for patches, mesh.c for meshes.
 */
#ifndef KAGE_DISPLACED_DISPLACED_H
#define KAGE_DISPLACED_DISPLACED_H

#include "base/pulse.h"
#include "geometry/surface.h"
#include "texture/bump.h"
#include "wave/hit_group.h"

struct bvh;

/* Sums over the searches of a thread. */
typedef struct displaced_counts {
    long evaluations; /* of P */
    long uncertain;   /* hits that could not be confirmed */
} displaced_counts;

/* A copy of the struct is the same surface; it is valid as long as the original. */
typedef struct displaced {
    surface base;
    const struct displaced_form *form;
    const surface *smooth;
    const bump *P;
    displaced_counts *counts; /* what this copy's searches add to; NULL: they are not counted */
    const pulse *pulse;       /* asked by long searches of this copy; NULL: none */
    surface *offset;          /* over a patch: X as a patch surface */
    bool unbounded;           /* it has no bounds, and is not made */
    struct bvh *prisms;       /* over a mesh: what the surface over each triangle lies in */
} displaced;

/* Whether surfaces like f can be displaced, and whether P has the finite bounds of value and slope that this needs. */
bool displaced_has_form(const surface *f);
bool displaced_has_bounds(const bump *P);

/* X over f by P, which is prepared for it. Both must outlive it, and the two functions above must be true of them.
 * w: as bump_prepare. NULL: out of memory, or *bounded is false: over a patch X has no bounds, as f is a line or has no
 * normal. */
surface *displaced_new(const surface *f, bump *P, const progress *w, bool *bounded);

/* Whether a surface is one. It has no `eval`: Q and its partials are not known, displaced_shape stands for it. */
bool displaced_is(const surface *f);

/* For a group that has hit f at g->t on g->part, set (u,w), P and its gradient, q.Q to the hit, and both n_smooth and
 * n_bump to its unit normal. tau is 0. */
void displaced_shape(const surface *f, hit_group *g);

/* A copy that adds to *c, for one thread. It owns nothing. */
displaced displaced_counting(const surface *f, displaced_counts *c);

/* Method `exact`, for a group that has met the smooth surface: tau to the first hit with the displaced one, f. Order 0
 * where the ray misses f, near a silhouette. */
void displaced_shift(const surface *f, hit_group *g);

#endif
