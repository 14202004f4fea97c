/* The nodes of a wide hierarchy, for what builds it and what goes through it. */
#ifndef KAGE_BVH_WIDE_NODE_H
#define KAGE_BVH_WIDE_NODE_H

#include "bvh/wide.h"

enum { WIDE_WIDTH = 8 }; /* boxes a node */

/* By so many of float's roundings boxes and rays are wider. */
#define WIDE_AIR (16 * 1.2e-7)

typedef struct wide_node {
    float lo[3][WIDE_WIDTH], hi[3][WIDE_WIDTH];
    int32_t child[WIDE_WIDTH]; /* a node, or ~item */
    unsigned present;          /* a bit for each child */
} wide_node;

struct wide_bvh {
    int n, nodes;
    wide_node *node; /* the first is the root */
};

#endif
