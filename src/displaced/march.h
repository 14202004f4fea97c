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

/* What searches cost, and how sure they are; sums. */
typedef struct displaced_counts {
    long evaluations; /* looks at P */
    long uncertain;   /* hits that could not be confirmed */
} displaced_counts;

/* What a surface does itself that has no closed forms for a search: shell, foot and steep of surface.h are not there.
 */
typedef struct displaced_ops {
    /* Before the first search. False: out of memory. */
    bool (*prepare)(surface *f, const bump *P);

    /* As displaced_hit, where h->part is the surface's own secret, for feet; and as displaced_occlude, own: the
     * segments start on the rough surface. */
    void (*hit)(const surface *f, const bump *P, int n, const rays *x, const ray_origins *from, int32_t id, hits *h,
                displaced_counts *c);
    void (*occlude)(const surface *f, const bump *P, int n, const rays *x, bool own, real *lit, displaced_counts *c);

    /* The feet of hits, and the parts that they are on. */
    void (*closest_points)(const surface *f, const bump *P, int n, const rays *x, const real *t, int32_t *part,
                           closest_points *p);
} displaced_ops;

/* Once for each object whose true hits are asked for. False: out of memory. */
bool displaced_prepare(surface *f, const bump *P);

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
long displaced_search_over(const domain *g, const bump *P, int n, const rays *x, const real *end, const int32_t *own,
                           real *t, int32_t *found);

/* The same on one part of a surface. on: the part on whose rough surface each ray starts; NULL: they start elsewhere.
 */
long displaced_search(const surface *f, const bump *P, int part, int n, const rays *x, const real *end,
                      const int32_t *on, real *t, int32_t *found);

/* The nearest hit over all parts, like surface_ops.hit; h->part too. Adds to *c. from: of rays that have left a
 * surface, on their rough place, as for hit_own; NULL: they have not. */
void displaced_hit(const surface *f, const bump *P, int n, const rays *x, const ray_origins *from, int32_t id, hits *h,
                   displaced_counts *c);

/* lit[i] = 0 where the rough surface lies across r + s t, 0 < t < 1. on: as above; such a ray is to leave to the side
 * that is seen. */
void displaced_occlude(const surface *f, const bump *P, int n, const rays *x, const int32_t *on, real *lit,
                       displaced_counts *c);

/* A group that has met the rough surface itself, at g->t on g->part: (u,w), P and its gradient, the partials of Q at
 * the foot, in q.Q the hit, and in n_bump and n_smooth alike the unit normal of the rough surface. No shift. */
void displaced_shape(const surface *f, const bump *P, hit_group *g);

/* Method `exact`, for a group that has met the smooth surface: tau to the first hit of the rough one. Where the ray
 * passes that, beside a silhouette, order 0. */
void displaced_shift(const surface *f, const bump *P, hit_group *g, displaced_counts *c);

/* Whether a search has bounds to go by. */
bool displaced_possible(const bump *P);

#endif
