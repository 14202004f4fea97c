/* Stages that carry lanes between a wave and its groups. */
#ifndef KAGE_WAVE_GATHER_H
#define KAGE_WAVE_GATHER_H

#include "wave/hit_group.h"

/* No hits yet. */
void gather_begin(int n, hits *h);

/* Rays that have met the surface again on which they started: they began on its smooth shape. */
void gather_move_origins(int n, const ray_origins *from, const hits *h, rays *x);

/* Lanes lane[0..n-1] of a wave, side by side. */
void gather_rays(int n, const int32_t *lane, const rays *x, rays *to);
void gather_ray_origins(int n, const int32_t *lane, const ray_origins *from, ray_origins *to);

/* Take the lanes of one object out of the hits and put them into the group, side by side and in order. Returns the
 * object's id, -1 where no lane is left. */
int32_t gather_next_group(int n, const rays *x, hits *h, hit_group *g);

/* Put what a group has found out at its places in the wave. */
void scatter(const hit_group *g, const real *from, real *to);
void scatter_vec3s(const hit_group *g, const vec3s *from, vec3s *to);

#endif
