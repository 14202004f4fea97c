/* The two searches behind a patch surface: the first roots of rays (intersect.c), and projections of points
 * (project.c). Both work on a wave at a time and are reentrant. */
#ifndef KAGE_PATCH_QUERY_H
#define KAGE_PATCH_QUERY_H

#include "patch/surface.h"

/* A wave of rays to intersect with a patch. Origins are moved to the point of each ray that is closest to the patch's
 * centre, so that a distant eye costs no precision: the ray is at r + s (t - start). */
typedef struct patch_query {
    const patch_surface *f;
    vec3 r[LANES], s[LANES];
    double start[LANES];
    double from[LANES], to[LANES]; /* only roots between these count, as t - start; `to` becomes the first root found */
    bool found[LANES], unsure[LANES];  /* unsure: it is not proved that no root comes before */
    int halvings[LANES], tries[LANES]; /* of pieces, for this ray so far; of those without a proof */
    bool gave_up[LANES];               /* it had more undecided pieces than it may halve: a root may be missing */
    bool any;                          /* any root will do, as for shadows; `to` is then undefined */
    long evaluations;                  /* of the patch, so far */
    const pulse *pulse;                /* asked between pieces that are subdivided; NULL: none */
} patch_query;

/* Begin a query without rays. */
void patch_query_begin(patch_query *k, const patch_surface *f, bool any, const pulse *p);

/* Put in ray i: r + s t, from < t < to. All of 0..n-1 are put in before the query runs. */
void patch_query_add(patch_query *k, int i, vec3 r, vec3 s, double from, double to);

/* Find the first root of each of the n rays. */
void patch_query_run(patch_query *k, int n);

/* Points in space within `off` of a patch, and the point of the patch that is closest to each. */
typedef struct projections {
    vec3 place[LANES];
    double off[LANES]; /* in scene units */
    int32_t part[LANES];
    double u[LANES], w[LANES];
} projections;

/* Find part, u and w of n points. only: the part of each; NULL: any part. A point that is not near the patch gets the
 * middle of its range. */
void patch_project(const patch_surface *f, int n, const int32_t *only, projections *s);

#endif
