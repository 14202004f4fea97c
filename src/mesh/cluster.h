/* Clusters: up to eight triangles that are near each other, under one box of the hierarchy. Of those that a ray comes
 * near to, a test in float that is one vector operation leaves out nearly all that it misses.
 *
 * The test is a bound, not a choice: it never leaves out a triangle that Woop's test in double (intersect.c) meets. So
 * hits do not depend on it. See cluster_near.
 */
#ifndef KAGE_MESH_CLUSTER_H
#define KAGE_MESH_CLUSTER_H

#include <stdint.h>

#include "bvh/bvh.h"
#include "mesh/mesh_data.h"

enum { CLUSTER = 8 };

/* Coordinates are those of the hierarchy's space, so at most about 1. */
typedef struct mesh_cluster {
    float at[3][3][CLUSTER]; /* of corners by axis */
    float error[CLUSTER];    /* of the test, below 0 where there is no triangle */
    int32_t index[CLUSTER];  /* of the triangle in mesh_data */
} mesh_cluster;

typedef struct mesh_clusters {
    int n;
    mesh_cluster *cluster; /* owned */
} mesh_clusters;

/* Make the clusters, and the box of each. The caller frees *box. The result does not depend on the threads (0: one for
 * each processor). False: out of memory. */
bool mesh_clusters_new(const mesh_data *d, const bvh_space *space, int threads, mesh_clusters *out, bvh_box **box);
void mesh_clusters_free(mesh_clusters *c);

/* Rays as axes: z is the coordinate in which a ray's direction is largest, x and y the two that follow it. x and y are
 * sheared so that the ray runs along z. The ray is where x - sx z = cx and y - sy z = cy, in the hierarchy's space. */
typedef struct cluster_rays {
    int32_t z[BVH_PACKET];
    float sx[BVH_PACKET], sy[BVH_PACKET], cx[BVH_PACKET], cy[BVH_PACKET];
} cluster_rays;

/* Into met[0..n-1] the triangles that the lines of the rays ray[0..n-1] may meet, bit i for index[i]. */
void cluster_near(const mesh_cluster *c, const cluster_rays *k, int n, const int32_t *ray, uint32_t *met);

#endif
