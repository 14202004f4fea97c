/* The files of a crowd among themselves. */
#ifndef KAGE_CROWD_PARTS_H
#define KAGE_CROWD_PARTS_H

#include "crowd/crowd.h"

/* A place, or a ray, from lane i into the space of a copy's original, to lane j. */
void crowd_place_back(const crowd_copy *c, const vec3s *r, int i, vec3s *to, int j);
void crowd_ray_back(const crowd_copy *c, const rays *x, int i, rays *y, int j);

/* The methods of surface_ops. */
void crowd_hit(const surface *base, int n, const rays *x, int32_t id, hits *h);
void crowd_hit_own(const surface *base, int n, const rays *x, const ray_origins *from, int32_t id, hits *h);
void crowd_occlude(const surface *base, int n, const rays *x, real *lit);

#endif
