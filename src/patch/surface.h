/* A patch as a surface: the patch in pieces, and a hierarchy over them. */
#ifndef KAGE_PATCH_SURFACE_H
#define KAGE_PATCH_SURFACE_H

#include "bvh/bvh.h"
#include "patch/piece.h"
#include "base/pulse.h"
#include "geometry/closed_form.h"

/* Counts of work: evaluations of the patch, and hits that are not proved to be the first. In: what is asked during long
 * searches, or NULL. */
typedef struct patch_counts {
    long evaluations, unsure;
    const pulse *pulse;
} patch_counts;

/* A copy of the struct is the same surface; it is valid as long as the original. */
typedef struct patch_surface {
    surface base;
    surface_ops *methods; /* owned: `kind` and `parts` are the patch's */
    patch *q;             /* owned */
    pieces l;
    bvh *tree;            /* over the pieces, in l.space */
    patch_counts *counts; /* what this copy's hits and shadows add to; NULL: they are not counted */
    bool broken;          /* Q or its normal may jump, and there nothing is proved of pieces of any size */
} patch_surface;

/* Whether a surface is one. */
bool patch_surface_is(const surface *f);

/* The surface of a patch; n = Qu x Qw counts as outward. Owns q, also on failure. w: as pieces_of. NULL: Q has no
 * bounds over its range, or is a point, or out of memory. */
surface *patch_surface_new(patch *q, const progress *w);

/* The same; *bounded is false where Q has no bounds or is a point. */
surface *patch_surface_new_bounded(patch *q, const progress *w, bool *bounded);

/* The image of a patch surface by an affine map, which unlike that by surface_transformed can be displaced. `base` must
 * outlive it. Where the map mirrors, u runs the other way. NULL: as patch_surface_new. */
surface *patch_surface_affine(const surface *base, const affine *m, const progress *w);

/* A closed form's formula as a patch surface, for true displacement of shapes whose closest points have no closed form.
 * `kind` must outlive it; threads: as patch.threads. NULL: out of memory. */
surface *patch_surface_formula(const char *kind, const form_formula *f, int threads, const progress *w);

/* As patch_surface_new_bounded, with the flatness of its pieces (pieces_of). */
patch_surface *patch_surface_make(patch *q, double flat, const progress *w, bool *bounded);

/* A copy that adds to *c, for one thread. It owns nothing. */
patch_surface patch_surface_counting(const surface *f, patch_counts *c);

/* Hits of rays and shadows of segments, as the members of surface_ops; work is added to *c. from: NULL where no ray
 * starts on the surface. own: whether all segments do, and then part[i], or NULL: on any part. */
void patch_surface_intersect(const patch_surface *f, int n, const rays *x, const ray_origins *from, int32_t id, hits *h,
                             patch_counts *c);
void patch_surface_occlude(const patch_surface *f, int n, const rays *x, bool own, const int32_t *part, real *lit,
                           patch_counts *c);

/* In partials.c: as the member of surface_ops. */
void patch_surface_eval(const surface *base, int n, const int32_t *part, const real *u, const real *w, int order,
                        partials *q);

#endif
