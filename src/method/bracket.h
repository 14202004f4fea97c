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

/* Each lane's ray relative to the surface (bs_view), its bracket, and its place within. */
typedef struct brackets {
    int n;
    int32_t lane[LANES]; /* in the group */
    real sn[LANES], a[LANES], b[LANES], curvature[LANES];
    real u[LANES], w[LANES];        /* of the smooth hit */
    real front[LANES], back[LANES]; /* as tau; front is the viewer's side. Both are tau where there is no bracket. */
    real tau[LANES];                /* the place */
    real pixels[LANES];             /* so many is an error of 1 in tau on the screen */
    int32_t order[LANES];           /* the method that found the place, as method_code has it */
} brackets;

/* The brackets of the lanes of g; the place is g->tau, by order 0. There is none where P has no bounds or the surface
 * is not regular. Neither `pixels` nor `lane` is set. Returns how many have none for want of bounds. */
int bracket_begin(const hit_group *g, const bump *P, brackets *k);

/* Copy lanes lane[0..n-1]; `lane` of the copies is that of the originals. */
void bracket_pick(int n, const int32_t *lane, const brackets *from, brackets *to);

/* The number of lanes whose bracket is wider than `error` pixels, and these lanes. */
int bracket_wide(const brackets *k, real error, int32_t *lane);

/* Draw the brackets together by bounds of P over what they cover. Returns how often P was looked up. */
long bracket_thin(brackets *k, const bump *P);

/* Find the place in each bracket to `error` pixels: steps through it to the first crossing, then secant steps. Returns
 * how often P was looked up. */
long bracket_search(brackets *k, const bump *P, real error);

#endif
