/* The lanes of a wave that hit one object, and the results of all stages of trace.c for them. Arrays are not
 * initialised: each stage reads only what earlier stages wrote.
 */
#ifndef KAGE_WAVE_HIT_GROUP_H
#define KAGE_WAVE_HIT_GROUP_H

#include <stdbool.h>

#include "wave/wave.h"

typedef struct hit_group {
    int n;
    bool whole;          /* all lanes of the wave; then `lane` is not set */
    int32_t lane[LANES]; /* their lanes in the wave */

    /* the smooth hit */
    rays x;
    real t[LANES];       /* t_hit */
    int32_t part[LANES]; /* of the surface; u and w belong to it */
    real u[LANES], w[LANES];
    partials q;

    /* the bump */
    bump_values bump;
    vec3s n_smooth; /* n = Qu x Qw, not normalised */
    vec3s n_bump;   /* n', unit */

    /* the method */
    real tau[LANES];      /* the shift */
    real t0[LANES];       /* t_hit + tau: the shadow ray starts at r + s t0 */
    int32_t order[LANES]; /* used; method_code's numbers */

    /* the place that is shaded: the smooth hit, or r + s t0, with (u,w), q, bump and normals there (render/place.h) */
    real t_shade[LANES];
    int32_t shade_part[LANES]; /* of the surface; only with r + s t0 */

    vec3s rough; /* X = Q + P n/|n| over the place that is shaded; only for the bumps' own shadows */

    /* the current light: the segments to it; 1 lit, 0 in shadow */
    rays to_light;
    real lit[LANES];
    vec3s tint; /* its transmission by transparent casters, if the scene has some */

    vec3s color; /* of the material, if not constant */
    vec3s rgb;   /* linear, the result */
} hit_group;

/* The lane of the wave for a lane of the group. */
static inline int hit_group_place(const hit_group *g, int i) { return g->whole ? i : g->lane[i]; }

#endif
