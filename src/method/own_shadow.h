/* Stages: the shadows that bumps cast on their own surface, by a march towards the light or by a horizon map.
 * include/bumpshadow.h has the formulas.
 */
#ifndef KAGE_METHOD_OWN_SHADOW_H
#define KAGE_METHOD_OWN_SHADOW_H

#include "texture/bump.h"
#include "texture/horizon.h"
#include "wave/hit_group.h"

/* The ways from a group's places on the rough surface to a light, as bs_way. */
typedef struct own_ways {
    real side[LANES], sn[LANES], a[LANES], b[LANES], curvature[LANES], end[LANES];
    real A[LANES], B[LANES]; /* bs_turn */
    real leave[LANES];       /* t from which on the way is above the smooth surface and the slab */
} own_ways;

/* The places on the rough surface, X = Q + P n/|n|, over the (u,w) that are shaded. */
void own_places(const hit_group *g, vec3s *X);

/* The ways along g->to_light, whose segments start at X. Needs Quu, Quw and Qww, unless the surface is flat. u and w:
 * beyond these the surface has no bumps. */
void own_begin(const hit_group *g, const bump *P, bool flat, const double u[2], const double w[2], own_ways *y);

/* Each sets g->lit = 0: where n' is turned away from the light; where the light is not above the horizon. */
void own_turned_away(hit_group *g, const own_ways *y);
void own_sink(hit_group *g, const own_ways *y, const real *above);

/* In own_march.c: g->lit = 0 where one of `steps` places on the way is below the rough surface. seen_from: only lanes
 * seen from this side, 1 or -1; 0: all. Returns how often P was evaluated. */
long own_march(hit_group *g, const bump *P, const own_ways *y, int steps, int seen_from);

/* How far the light's rise is above the horizon, for lanes seen from the front. */
void own_above(const hit_group *g, const own_ways *y, const horizon *h, real *above);

/* The shares of an area light above the horizon, from `above` in its middle and at the ends of its two half sides. */
void own_share(int n, const real *side, const real *middle, const real *along_u, const real *along_w, real *share);

/* Move the starts of g->to_light to where the ways leave the slab. */
void own_leave(hit_group *g, const own_ways *y);

#endif
