/* True displacement: where a ray meets Q + P n/|n| first. What the method is measured against, in kage's own engine.
 *
 * Candidates by bracketing: height over the smooth surface less P is the gap between a place on the ray and the rough surface;
 * it changes along the ray no faster than a bound that surface and perturbation know, so steps of gap/bound can't pass a
 * hit. Then Newton's iteration, kept within the bracket. As the foot of a place on the smooth surface is known in closed form,
 * the equation Q(u,w) + P n/|n| = r + s t has but one unknown, t.
 */
#ifndef KAGE_DISPLACE_H
#define KAGE_DISPLACE_H

#include "group.h"
#include "perturb.h"
#include "surface.h"

/* How a search went. */
typedef enum displace_end {
    DISPLACE_MISSED,    /* the ray passes */
    DISPLACE_HIT,       /* confirmed: the gap is 0 to the precision of the build */
    DISPLACE_UNCERTAIN, /* a crossing that Newton could not confirm, or a search that did not end */
} displace_end;

/* What searches cost, and how sure they are; sums. */
typedef struct displace_counts {
    long heights;   /* looks at P */
    long uncertain; /* hits that could not be confirmed */
} displace_counts;

/* The first hits with 0 < t < end[i] on one part of the surface: t[i], where found[i] is DISPLACE_HIT (or DISPLACE_UNCERTAIN: then
 * the best there is). on: the part on whose rough surface each ray starts, so that this hit at t = 0 does not count; NULL: they
 * start elsewhere. P must have bounds of value and gradient (displace_possible). Returns how often P was looked up. */
long displace_search(const surface *f, const perturb *P, int part, int n, const rays *x, const real *end, const int32_t *on,
                     real *t, int32_t *found);

/* The nearest hit over all parts, like surface_methods.hit; h->part too. Adds to *c. from: of rays that have left a surface, on their
 * rough place, as for hit_own; NULL: they have not. */
void displace_hit(const surface *f, const perturb *P, int n, const rays *x, const starts *from, int32_t id, hits *h,
                  displace_counts *c);

/* lit[i] = 0 where the rough surface lies across r + s t, 0 < t < 1. on: as above; such a ray is to leave to the side that is
 * seen. */
void displace_occlude(const surface *f, const perturb *P, int n, const rays *x, const int32_t *on, real *lit,
                      displace_counts *c);

/* A group that has met the rough surface itself, at g->t on g->part: (u,w), P and its gradient, the partials of Q at the foot,
 * in q.Q the hit, and in n_bump and n_smooth alike the unit normal of the rough surface. No shift. */
void displace_shape(const surface *f, const perturb *P, group *g);

/* Method `exact`, for a group that has met the smooth surface: tau to the first hit of the rough one. Where the ray passes
 * that, beside a silhouette, order 0. */
void displace_shift(const surface *f, const perturb *P, group *g, displace_counts *c);

/* Whether a search has bounds to go by. */
bool displace_possible(const perturb *P);

#endif
