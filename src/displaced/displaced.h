/* True displacement: the surface X = Q + P n/|n| over a smooth surface Q and a bump P, as a surface of its own. It is
 * what the paper's method is measured against. Rays meet it where it is, so it needs no shifted shadow rays.
 *
 * How hits are found depends on the smooth surface (displaced_form): closed.c for those whose closest points have
 * closed forms, patch.c for patches, mesh.c for meshes.
 */
#ifndef KAGE_DISPLACED_DISPLACED_H
#define KAGE_DISPLACED_DISPLACED_H

#include "geometry/surface.h"
#include "texture/bump.h"
#include "wave/hit_group.h"

struct bvh;

/* What searches cost, and how sure they are; sums. */
typedef struct displaced_counts {
    long evaluations; /* of P */
    long uncertain;   /* hits that could not be confirmed */
} displaced_counts;

/* The displaced surface, as one thread uses it. A plain copy is the same surface: it lives as long as the original. */
typedef struct displaced {
    surface base;
    const struct displaced_form *form;
    const surface *smooth;
    const bump *P;
    displaced_counts *counts; /* what this copy's searches add to; NULL: they are not counted */
    surface *offset;          /* over a patch: X as a patch surface */
    struct bvh *prisms;       /* over a mesh: what the surface over each triangle lies in */
} displaced;

/* Whether the displaced surface of f can be found, and whether P has the bounds of value and slope that this takes. */
bool displaced_has_form(const surface *f);
bool displaced_has_bounds(const bump *P);

/* X over f by P, which both must outlive it and satisfy the two questions above. NULL: out of memory. */
surface *displaced_new(const surface *f, const bump *P);

/* Whether a surface is one. It has the methods of any other, and no `eval`, as its Q and partials are not known: */
bool displaced_is(const surface *f);

/* A group that has met it at g->t on g->part: (u,w), P and its gradient, in q.Q the hit, and in n_smooth and n_bump
 * alike its unit normal. No shift. */
void displaced_shape(const surface *f, hit_group *g);

/* A copy that adds to *c, for one thread. It owns nothing. */
displaced displaced_counting(const surface *f, displaced_counts *c);

/* Method `exact`, for a group that has met the smooth surface: tau to the first hit with the displaced one, f. Where
 * the ray passes that, beside a silhouette, order 0. */
void displaced_shift(const surface *f, hit_group *g);

#endif
