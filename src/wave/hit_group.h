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

    /* the smooth hit. x and t are the wave's own where the group is all of it, else the picked ones. */
    const rays *x;
    const real *t; /* t_hit */
    struct {
        rays x;
        real t[LANES];
    } picked;
    int32_t part[LANES]; /* of the surface; u and w belong to it */
    real u[LANES], w[LANES];
    partials q;
    bool flat; /* the surface is: Quu, Quw and Qww are 0, and may not be set */

    /* the bump */
    bump_values bump;
    vec3s n_smooth; /* n = Qu x Qw, not normalised */
    vec3s n_bump;   /* n', unit */

    /* lanes where P, n', the shift or the place has no value (method/shift.h). The caller begins with 0. */
    int undefined;       /* how many */
    int32_t none[LANES]; /* 1: this one; only where some are */

    /* the method */
    real tau[LANES];      /* the shift */
    real t0[LANES];       /* t_hit + tau: the shadow ray starts at r + s t0 */
    int32_t order[LANES]; /* used; method_code's numbers */

    /* the place that is shaded: the smooth hit, or r + s t0, with (u,w), q, bump and normals there (render/place.h) */
    const real *t_shade;       /* t, or t_moved */
    real t_moved[LANES];       /* the next two only with r + s t0 */
    int32_t shade_part[LANES]; /* of the surface */

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

/* The group has rays of its own, which the caller has put in `picked`. */
static inline void hit_group_picked(hit_group *g)
{
    g->x = &g->picked.x;
    g->t = g->t_shade = g->picked.t;
}

#endif
