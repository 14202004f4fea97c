/* Brackets for the method auto: for each lane two places on the viewing ray between which the rough surface lies, and
 * how they are drawn together. They depend on nothing but the lane's own ray, so a lane has the same result in any
 * group.
 *
 * The first bracket is the slab between the surfaces offset by the lowest and the highest P, the smooth surface's
 * curvature included to the second order: on planes that is a proof, elsewhere an error of the third order in tau is
 * left.
 */
#ifndef KAGE_METHOD_BRACKET_H
#define KAGE_METHOD_BRACKET_H

#include "texture/bump.h"
#include "wave/hit_group.h"

/* Each lane's ray relative to the surface (bs_view), and its bracket. */
typedef struct brackets {
    int n;
    real sn[LANES], a[LANES], b[LANES], curvature[LANES];
    real front[LANES], back[LANES]; /* as tau; front is the viewer's side. Both are tau where there is no bracket. */
} brackets;

/* Some lanes of a group, whose place is sought. */
typedef struct places {
    brackets k;
    int32_t lane[LANES]; /* of the group */
    rays x;
    real t[LANES];           /* t_hit */
    real u[LANES], w[LANES]; /* of the smooth hit */
    real P[LANES], Pu[LANES], Pw[LANES];
    real tau[LANES];      /* the place, in the bracket */
    real pixels[LANES];   /* so many is an error of 1 in tau on the screen */
    int32_t order[LANES]; /* the method that found it, as method_code has it */
} places;

/* g->tau and g->order by order 0, kept within the bracket, and the brackets. There is no bracket where the surface is
 * not regular, or where P has no bounds. flat: the surface is, and its second derivatives need not be set. */
void bracket_begin(hit_group *g, const bump *P, bool flat, brackets *k);

/* Pick lanes lane[0..n-1] of a group, with g's places; `pixels` is 0. And put their places back. */
void places_pick(const hit_group *g, const brackets *k, int n, const int32_t *lane, places *p);
void places_put(const places *p, hit_group *g);

/* The steps through a bracket: as many as there are stretches of so many pixels, from `least` to `most`. */
typedef struct search_steps {
    real pixels, least, most;
} search_steps;

/* Find the places to `error` pixels, by an estimate of the first order: steps through each bracket to the first
 * crossing, then secants. A bump that is narrower than a step may be missed. Returns how often P was looked up. */
long places_search(places *p, const bump *P, real error, search_steps steps);

#endif
