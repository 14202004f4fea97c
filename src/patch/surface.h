/* What the files of searched surfaces share: a sheet in leaves, and which of them a ray may meet. Private to
 * searched*.c. */
#ifndef KAGE_PATCH_SURFACE_H
#define KAGE_PATCH_SURFACE_H

#include "bvh/bvh.h"
#include "patch/piece.h"
#include "geometry/surface.h"

typedef struct patch_surface {
    surface base;
    surface_ops *methods; /* its own, as `parts` is */
    patch *q;
    pieces l;
    bvh *tree;   /* over the leaves; its unit is the sheet's radius, its origin the sheet's centre */
    bool broken; /* it may jump, or turn at once: then nothing is proved of some pieces, however small */
    struct displaced_form *rough; /* its rough surfaces so far */
} patch_surface;

/* A rough surface of it, as a surface of its own. */
typedef struct displaced_form displaced_form;
struct displaced_form {
    const struct bump *P;
    surface *shape;
    displaced_form *next;
};

/* Q(u,w) from its points alone (patch.h): three expressions, or Bezier patches, each a part. n = Qu x Qw is outward by
 * definition. Owns q, also on failure. NULL where Q has no bounds over its range, or is all in one place (then only: or
 * out of memory). */
surface *patch_surface_new(patch *q);

/* The image of such a surface by an affine map, in pieces of its own: what surface_transformed makes of it has no true
 * displacement. `from` must outlive it; as there, where the map mirrors u runs the other way. NULL: as
 * patch_surface_new. */
surface *patch_surface_affine(const surface *from, const affine *m);

/* As patch_surface_new, with leaves as flat as that. */
patch_surface *patch_surface_make(patch *q, double flat);

void patch_surface_free_displaced(displaced_form *first);

/* For true displacement. */
extern const struct displaced_ops patch_surface_displaced;

/* The surface's methods, with what they have counted. looks: as above; unsure: hits. */
typedef struct patch_counts {
    long evaluations, unsure;
} patch_counts;

void patch_surface_intersect(const patch_surface *f, int n, const rays *x, int32_t id, hits *h, patch_counts *c);
void patch_surface_intersect_own(const patch_surface *f, int n, const rays *x, const ray_origins *from, int32_t id,
                                 hits *h, patch_counts *c);
void patch_surface_occlude(const patch_surface *f, int n, const rays *x, real *lit, patch_counts *c);
/* part: NULL: on any */
void patch_surface_occlude_own(const patch_surface *f, int n, const rays *x, const int32_t *part, real *lit,
                               patch_counts *c);

/* In partials.c: as the member of surface_ops. */
void patch_surface_eval(const surface *base, int n, const int32_t *part, const real *u, const real *w, int order,
                        partials *q);

#endif
