/* The files of a crowd among themselves. */
#ifndef KAGE_CROWD_PARTS_H
#define KAGE_CROWD_PARTS_H

#include "crowd/crowd.h"

/* The copies and the originals' parts of lanes on the crowd; and back. */
void crowd_split(const crowd *f, int n, const int32_t *part, int32_t *at, int32_t *its);
void crowd_join(const crowd *f, int n, const int32_t *at, const int32_t *its, int32_t *part);

/* The maps of some lanes, side by side. */
typedef struct crowd_maps {
    real m[3][3][LANES], o[3][LANES];
} crowd_maps;

/* Those from the originals of copies at[]; vectors by k times them; and places. */
void crowd_maps_to(const crowd *f, int n, const int32_t *at, crowd_maps *to);
void crowd_vectors_to(const crowd_maps *f, int n, real k, vec3s *v);
void crowd_places_to(const crowd_maps *f, int n, vec3s *v);

/* Map the rays of some lanes, NULL: of lanes 0..n-1, into the space of the originals of copies at[]; and places. */
void crowd_rays_back(const crowd *f, int n, const int32_t *at, const int32_t *lane, const rays *x, rays *y);
void crowd_places_back(const crowd *f, int n, const int32_t *at, vec3s *r);

/* The methods of surface_ops. */
void crowd_hit(const surface *base, int n, const rays *x, int32_t id, hits *h);
void crowd_hit_own(const surface *base, int n, const rays *x, const ray_origins *from, int32_t id, hits *h);
void crowd_occlude(const surface *base, int n, const rays *x, real *lit);

#endif
