/* How rays are intersected with displaced surfaces over one family of smooth ones: closed.c, patch.c, mesh.c. Private
 * to displaced. */
#ifndef KAGE_DISPLACED_FORM_H
#define KAGE_DISPLACED_FORM_H

#include "displaced/displaced.h"
#include "patch/patch.h"

typedef struct displaced_form {
    /* Whether it is for this smooth surface. */
    bool (*fits)(const surface *smooth);

    /* Build what the searches need, in d. False: out of memory. NULL: they need nothing. */
    bool (*prepare)(displaced *d, const progress *w);

    /* As the members of surface_ops; part: NULL for segments that start elsewhere. */
    void (*hit)(const displaced *d, int n, const rays *x, const ray_origins *from, int32_t id, hits *h);
    void (*occlude)(const displaced *d, int n, const rays *x, const int32_t *part, real *lit);

    /* The closest points of the smooth surface to the hits r + s t, and the parts they are on: part[i] comes in as
     * `hit` has set it, and may be corrected. */
    void (*closest)(const displaced *d, int n, const rays *x, const real *t, int32_t *part, closest_points *p);
} displaced_form;

/* In offset_patch.c: X = Q + P n/|n| over a patch Q, n = Qu x Qw; both must outlive it. It is evaluated to order 1
 * only, and has no Hessian bounds. NULL: out of memory. */
patch *patch_offset_new(const patch *q, const bump *P);

extern const displaced_form displaced_over_closed, displaced_over_patch, displaced_over_mesh;

static inline void displaced_count(const displaced *d, long evaluations, long uncertain)
{
    if (!d->counts)
        return;
    d->counts->evaluations += evaluations;
    d->counts->uncertain += uncertain;
}

#endif
