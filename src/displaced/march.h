/* True displacement: where a ray meets Q + P n/|n| first. What the method is measured against, in kage's own engine.
 *
 * Candidates by bracketing: height over the smooth surface less P is the gap between a place on the ray and the rough
 * surface; it changes along the ray no faster than a bound that surface and perturbation know, so steps of gap/bound
 * can't pass a hit. Then Newton's iteration, kept within the bracket. As the foot of a place on the smooth surface is
 * known in closed form, the equation Q(u,w) + P n/|n| = r + s t has but one unknown, t.
 */
#ifndef KAGE_DISPLACED_MARCH_H
#define KAGE_DISPLACED_MARCH_H

#include "wave/hit_group.h"
#include "texture/bump.h"
#include "geometry/surface.h"

/* How a search went. */
typedef enum displaced_result {
    DISPLACED_MISSED,    /* the ray passes */
    DISPLACED_HIT,       /* confirmed: the gap is 0 to the precision of the build */
    DISPLACED_UNCERTAIN, /* a crossing that Newton could not confirm, or a search that did not end */
} displaced_result;

/* What a search goes over: for each lane a piece of a smooth surface that is taken as if it alone were there. lane[i]:
 * which of the rays that the search began with is the i-th now. The rest is as in surface.h. */
typedef struct domain domain;
struct domain {
    void (*shell)(const domain *g, int n, const rays *x, const real *end, real Pmin, real Pmax, real *t0, real *t1);
    void (*foot)(const domain *g, int n, const int32_t *lane, const rays *x, const real *t, closest_points *p);
    void (*steep)(const domain *g, int n, const int32_t *lane, const rays *x, const closest_points *p, real Pu_max,
                  real Pw_max, real *rate, real *reach);
    /* Where `loose`, as feet may be beyond the piece, and P has no bounds there: (u,w) of the nearest place of the
     * piece, so that the rough surface goes on from there; the foot's own where that is one. */
    void (*within)(const domain *g, int n, const int32_t *lane, const closest_points *p, real *u, real *w);
    bool loose;
    int steps; /* of a search at most: where the bounds are no help it goes on by this share of the shell */
};

/* The first hits with 0 < t < end[i]: t[i], where found[i] is DISPLACED_HIT (or DISPLACED_UNCERTAIN: then the best
 * there is). own: 1 where the ray starts on this piece's rough surface, so that the hit at t = 0 does not count; NULL:
 * none does. P must have bounds of value and gradient (displaced_possible). Returns how often P was looked up. */
long displaced_search(const domain *g, const bump *P, int n, const rays *x, const real *end, const int32_t *own,
                      real *t, int32_t *found);

#endif
