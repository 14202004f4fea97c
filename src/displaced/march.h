/* Where rays meet Q + P n/|n| first.
 *
 * The gap of a place on the ray is its height over the smooth surface less P there. It changes along the ray no faster
 * than a Lipschitz bound that surface and bump know, so steps of gap/bound cannot pass a hit. A change of its sign is
 * refined by Newton's iteration, kept within the bracket. As the closest point of the smooth surface is known for each
 * place, Q(u,w) + P n/|n| = r + s t has one unknown, t.
 */
#ifndef KAGE_DISPLACED_MARCH_H
#define KAGE_DISPLACED_MARCH_H

#include "wave/hit_group.h"
#include "texture/bump.h"
#include "geometry/surface.h"

/* How a search went. */
typedef enum displaced_result {
    DISPLACED_MISSED,    /* the ray passes */
    DISPLACED_HIT,       /* confirmed: the gap is 0 to rounding */
    DISPLACED_UNCERTAIN, /* a crossing that Newton could not confirm, or a search that did not end */
} displaced_result;

/* What a search goes over: for each ray a piece of a smooth surface, as if it alone were there. lane[i]: which of the
 * rays that the search began with is the i-th now. The rest is as in surface.h. */
typedef struct domain domain;
struct domain {
    void (*bound)(const domain *g, int n, const rays *x, const real *end, real Pmin, real Pmax, real *t0, real *t1);
    void (*closest)(const domain *g, int n, const int32_t *lane, const rays *x, const real *t, closest_points *p);
    void (*lipschitz)(const domain *g, int n, const int32_t *lane, const rays *x, const closest_points *p, real Pu_max,
                      real Pw_max, real *rate, real *reach);
    /* Where `unclamped`, as closest points may be beyond the piece, and P has no bounds there: (u,w) of the nearest
     * place of the piece, so that the displaced surface goes on from there; their own where they are on it. */
    void (*within)(const domain *g, int n, const int32_t *lane, const closest_points *p, real *u, real *w);
    bool unclamped;
    int steps; /* of a search at most: where the bounds are no help steps are this share of the stretch */
};

/* The first hits with 0 < t < end[i]: t[i], where found[i] is DISPLACED_HIT (or DISPLACED_UNCERTAIN: then the best
 * there is). own: 1 where the ray starts on this piece's displaced surface, so that the hit at t = 0 does not count;
 * NULL: none does. P must satisfy displaced_has_bounds. Returns how often P was evaluated. */
long displaced_search(const domain *f, const bump *P, int n, const rays *x, const real *end, const int32_t *own,
                      real *t, int32_t *found);

#endif
