/* Rays that go through a mesh's hierarchy together. */
#ifndef KAGE_MESH_PACKET_H
#define KAGE_MESH_PACKET_H

#include "mesh/mesh.h"

/* The first hits of r + s t with from < t < to. The caller sets all up to `own`, for the first n rays. */
typedef struct mesh_packet {
    const mesh *f;
    bool any; /* any hit will do, as for shadows */
    int n;
    double r[3][BVH_PACKET], s[3][BVH_PACKET], from[BVH_PACKET], to[BVH_PACKET];
    int32_t own[BVH_PACKET]; /* a triangle that does not count; -1: none */

    /* Results: the triangle that is met, -1: none; to[i] is t there. */
    int32_t index[BVH_PACKET];

    /* the rays as axes: the shear of x and y per z, and t per z */
    double sx[BVH_PACKET], sy[BVH_PACKET], sz[BVH_PACKET];
    cluster_rays axis;

    /* the rays in the hierarchy: t where they enter its sphere, and their length in radii for each t */
    double enter[BVH_PACKET], unit[BVH_PACKET];
    bvh_packet x;
} mesh_packet;

void mesh_packet_intersect(mesh_packet *k);

/* For rays that all start on the mesh itself, at r on own[i], which is then left out: move r to its place in double,
 * and set `from`. The end of the ray, r + s, stays where it is if `segments`. */
void mesh_packet_start(mesh_packet *k, bool segments);

#endif
