/* Where rays meet Q + P n/|n| first.
 *
 * The gap at a point of the ray is its height over the smooth surface minus P there. Over a window, a stretch of the
 * ray ahead, surface and bump give bounds of it and of its slope (window.h), so that steps cannot pass a hit. A change
 * of its sign is refined within the bracket (crossing.h). As the closest point of the smooth surface is known for each
 * place, Q(u,w) + P n/|n| = r + s t has one unknown, t.
 */
#ifndef KAGE_DISPLACED_MARCH_H
#define KAGE_DISPLACED_MARCH_H

#include "wave/hit_group.h"
#include "texture/bump.h"
#include "geometry/surface.h"

/* How a search went. */
typedef enum displaced_result {
    DISPLACED_MISSED,    /* no hit */
    DISPLACED_HIT,       /* confirmed: the gap is 0 to rounding */
    DISPLACED_UNCERTAIN, /* a crossing that could not be confirmed, or a search that did not end */
} displaced_result;

/* Rectangles of (u,w). */
typedef struct rectangles {
    real u0[LANES], u1[LANES], w0[LANES], w1[LANES];
} rectangles;

/* What a search runs over: for each ray a piece of a smooth surface, taken alone. lane[i]: the index that the i-th ray
 * had when the search began. The rest is as in surface.h. */
typedef struct domain domain;
struct domain {
    void (*bound)(const domain *g, int n, const rays *x, const real *end, real Pmin, real Pmax, real *t0, real *t1);
    void (*closest)(const domain *g, int n, const int32_t *lane, const rays *x, const real *t, closest_points *p);
    void (*bend)(const domain *g, int n, const int32_t *lane, const rays *x, const closest_points *p, path_bends *out);
    /* Change rectangles of closest points to ones that have all places at which P is looked up for these. */
    void (*places)(const domain *g, int n, const int32_t *lane, rectangles *r);
    /* Only where `unclamped`: closest points may be beyond the piece, where P has no bounds. Sets (u,w) to the nearest
     * place of the piece; P there is used. */
    void (*within)(const domain *g, int n, const int32_t *lane, const closest_points *p, real *u, real *w);
    bool unclamped;
    int steps; /* the most of a search; the shortest step is the stretch over this */
};

/* The first hits with 0 < t < end[i]: t[i], where found[i] is DISPLACED_HIT (or DISPLACED_UNCERTAIN: then the best
 * guess). own: 1 where the ray starts on this piece's displaced surface, so that the hit at t = 0 does not count; NULL:
 * none does. any: t[i] need not be refined: it is near a hit. P must satisfy displaced_has_bounds and be prepared.
 * Returns how often P was evaluated. */
long displaced_search(const domain *f, const bump *P, int n, const rays *x, const real *end, const int32_t *own,
                      bool any, real *t, int32_t *found);

#endif
