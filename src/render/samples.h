/* What a wave finds out for each of its lanes. */
#ifndef KAGE_RENDER_SAMPLES_H
#define KAGE_RENDER_SAMPLES_H

#include "base/vec3.h"
#include "wave/hit_group.h"

/* All but rgb are layers (film.h). */
typedef struct samples {
    vec3s rgb;         /* linear */
    real depth[LANES]; /* t of the hit, infinite where there is none; all that follows is 0 there, order -1 */
    vec3s position, normal;
    real u[LANES], w[LANES], height[LANES], tau[LANES];
    int32_t order[LANES];
} samples;

/* Of n rays that meet nothing; the layers where asked for. */
void samples_background(int n, vec3 color, bool layers, samples *out);
void samples_dark(int n, real *visibility);

/* Put what a group has found out at its places in the wave. tinted: the light's visibility is the mean over g->tint. */
void samples_put(const hit_group *g, bool layers, bool bumped, samples *out);
void samples_put_visibility(const hit_group *g, bool tinted, real *visibility);

#endif
