/* Clusters: up to eight triangles that are near each other; and blocks of up to eight clusters. A ray is tested against
 * all boxes of a block at once, and then against all triangles of a cluster at once, in float, which leaves out nearly
 * all that it misses.
 *
 * The test is a bound, not a choice: it never leaves out a triangle that Woop's test in double (intersect.c) meets. So
 * hits do not depend on it. See cluster_near.
 */
#ifndef KAGE_MESH_CLUSTER_H
#define KAGE_MESH_CLUSTER_H

#include <stdint.h>

#include "base/bits.h"
#include "bvh/bvh.h"
#include "mesh/mesh_data.h"

enum { CLUSTER = 8 };

/* Coordinates are those of the hierarchy's space, so at most about 1. */
typedef struct mesh_cluster {
    float at[3][3][CLUSTER]; /* of corners by axis */
    float error[CLUSTER];    /* of the test, below 0 where there is no triangle */
    int32_t index[CLUSTER];  /* of the triangle in mesh_data */
} mesh_cluster;

/* A box, and a slab least <= across . p <= most. */
typedef struct mesh_slab {
    float lo[3], hi[3], across[3], least, most;
} mesh_slab;

/* Up to eight clusters, which are cluster[first] and those behind it, under one box of the hierarchy. */
typedef struct mesh_block {
    float lo[3][CLUSTER], hi[3][CLUSTER];                    /* of the clusters' boxes by axis */
    float across[3][CLUSTER], least[CLUSTER], most[CLUSTER]; /* a cluster is where least <= across . p <= most */
    mesh_slab all;                                           /* the same of the block */
    int32_t first;
} mesh_block;

typedef struct mesh_clusters {
    int n; /* blocks */
    mesh_block *block;
    mesh_cluster *cluster;
    /* both are owned */
} mesh_clusters;

/* Make the clusters and blocks, and the box of each block. The caller frees *box. The result does not depend on the
 * threads (0: one for each processor). False: out of memory. */
bool mesh_clusters_new(const mesh_data *d, const bvh_space *space, int threads, const progress *w, mesh_clusters *out,
                       bvh_box **box);
void mesh_clusters_free(mesh_clusters *c);

/* Rays as axes: z is the coordinate in which a ray's direction is largest, x and y the two that follow it. x and y are
 * sheared so that the ray runs along z. The ray is where x - sx z = cx and y - sy z = cy, in the hierarchy's space. */
typedef struct cluster_rays {
    int32_t z[BVH_PACKET], own[BVH_PACKET]; /* own: a triangle that the ray leaves out; -1: none */
    float sx[BVH_PACKET], sy[BVH_PACKET], cx[BVH_PACKET], cy[BVH_PACKET];
    float at[3][BVH_PACKET], way[3][BVH_PACKET], over[3][BVH_PACKET]; /* as in bvh_packet; 1 / way */
} cluster_rays;

/* Of the rays in `which`, bit i for ray i, those that may pass a block before end[i]. */
uint32_t block_pass(const mesh_block *b, const cluster_rays *k, const float end[BVH_PACKET], uint32_t which);

/* Of the rays in `which`, into met[j] those that may pass the box of the j-th cluster before end[i].
 */
void block_near(const mesh_block *b, const cluster_rays *k, const float end[BVH_PACKET], uint32_t which,
                uint32_t met[CLUSTER]);

/* The same for those whose lines may meet the triangle index[j]. False: none. */
bool cluster_near(const mesh_cluster *c, const cluster_rays *k, uint32_t which, uint32_t met[CLUSTER]);

#endif
