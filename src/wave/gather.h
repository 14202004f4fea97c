/* Stages that carry lanes between a wave and its groups. */
#ifndef KAGE_WAVE_GATHER_H
#define KAGE_WAVE_GATHER_H

#include "render/trace.h"

/* No hits yet. */
void wave_start(int n, hits *h);

/* Rays that have met the surface again on which they started: they began on its smooth shape. */
void wave_start_own(int n, const starts *from, const hits *h, rays *x);

/* The samples of rays that meet nothing, their layers too where asked for, with the visibilities of `lights`. */
void wave_background(int n, vec3 color, bool layers, int lights, workspace *v);

/* Lanes lane[0..n-1] of a wave, side by side. */
void wave_pick_rays(int n, const int32_t *lane, const rays *x, rays *to);
void wave_pick_starts(int n, const int32_t *lane, const starts *from, starts *to);

/* Take the lanes of one object out of the hits and put them into the group, side by side and in order. Returns the
 * object's id, -1 where no lane is left. */
int32_t wave_next_group(int n, const rays *x, hits *h, group *g);

/* Put what a group has found out back at its places in the wave. */
void wave_scatter(const group *g, bool layers, bool bumped, samples *out);
void wave_scatter_visibility(const group *g, bool tinted, real *visibility); /* tinted: the mean over g->tint */

#endif
