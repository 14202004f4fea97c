/* The results of a wave: colour and layers of each lane. */
#ifndef KAGE_RENDER_SAMPLES_H
#define KAGE_RENDER_SAMPLES_H

#include "base/vec3.h"
#include "wave/hit_group.h"

/* Except for rgb, these are the layers (film.h). */
typedef struct samples {
    vec3s rgb;         /* linear */
    real depth[LANES]; /* t of the hit; without one infinite, order -1 and the other layers 0 */
    vec3s position, normal;
    real u[LANES], w[LANES], height[LANES], tau[LANES];
    int32_t order[LANES];
} samples;

/* The results of n rays without a hit; `layers`: the layers, too. samples_dark: visibility 0. */
void samples_background(int n, vec3 color, bool layers, samples *out);
void samples_dark(int n, real *visibility);

/* Light that is beyond float's range, or nearly: REAL_FAR at most. */
void samples_bound(int n, vec3s *rgb);

/* Copy a group's results to its lanes. tinted: the visibility is g->lit times the mean of g->tint. */
void samples_put(const hit_group *g, bool layers, bool bumped, samples *out);
void samples_put_visibility(const hit_group *g, bool tinted, real *visibility);

#endif
