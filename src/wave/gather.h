/* Copies lanes from a wave to its groups and back. */
#ifndef KAGE_WAVE_GATHER_H
#define KAGE_WAVE_GATHER_H

#include "wave/hit_group.h"

/* Clear n lanes: no hits. */
void gather_begin(int n, hits *h);

/* The rays that hit the surface on which they start, own[i] != 0: change r to their start on its smooth shape. */
void gather_move_origins(int n, const ray_origins *from, const int32_t *own, rays *x);

/* Copy lanes lane[0..n-1] of a wave to lanes 0..n-1. */
void gather_rays(int n, const int32_t *lane, const rays *x, rays *to);
void gather_ray_origins(int n, const int32_t *lane, const ray_origins *from, ray_origins *to);

/* How many lanes have a hit. */
int gather_hits(int n, const hits *h);

/* Move the lanes of one object from the hits to the group, in their order. Where they are the whole wave, x and h->t
 * are not copied, and the group needs them. Returns the object's id; -1: no lane is left. */
int32_t gather_next_group(int n, const rays *x, hits *h, hit_group *g);

/* Copy a group's results to their lanes of the wave. */
void scatter(const hit_group *g, const real *from, real *to);
void scatter_vec3s(const hit_group *g, const vec3s *from, vec3s *to);

#endif
