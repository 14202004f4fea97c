/* The lanes of a wave that have hit one object, side by side, with all that the stages of trace.c find out about them.
 * Its arrays are never cleared: stages write before they read.
 */
#ifndef KAGE_WAVE_HIT_GROUP_H
#define KAGE_WAVE_HIT_GROUP_H

#include <stdbool.h>

#include "wave/wave.h"

typedef struct hit_group {
    int n;
    bool whole;          /* all the lanes of the wave, so in its order */
    int32_t lane[LANES]; /* their places in the wave */

    /* the smooth hit */
    rays x;
    real t[LANES];       /* t_hit */
    int32_t part[LANES]; /* of the surface; u and w are its own */
    real u[LANES], w[LANES];
    partials q;

    /* the bump */
    bump_values bump;
    vec3s n_smooth; /* n = Qu x Qw, not normalised */
    vec3s n_bump;   /* n', unit */

    /* the method */
    real tau[LANES];      /* the shift, */
    real t0[LANES];       /* t_hit + tau: the shifted place is r + s t0 */
    int32_t order[LANES]; /* really used; method_code's numbers */

    /* the light at hand: the segments to it, and 1 where it is seen, 0 where not */
    rays to_light;
    real lit[LANES];
    vec3s tint; /* what is left of it behind transparent casters, where a scene has some */

    vec3s color; /* of the material, where it is not constant */
    vec3s rgb;   /* linear, as the eye gets it */
} hit_group;

/* The place in the wave of a group's lane. */
static inline int hit_group_place(const hit_group *g, int i) { return g->whole ? i : g->lane[i]; }

#endif
