/* What the files of patch surfaces share among them: the roots of many rays, and the projection of many places.
 */
#ifndef KAGE_PATCH_QUERY_H
#define KAGE_PATCH_QUERY_H

#include "patch/surface.h"

/* The rays that are searched, each from the place of it that is nearest to the sheet's centre on, so that no digit is
 * lost to a far eye: r + s (t - start) is where the ray is at t. */
typedef struct patch_query {
    const patch_surface *f;
    vec3 r[LANES], s[LANES];
    double start[LANES];
    double from[LANES],
        to[LANES]; /* the roots that count are between these, as t - start; `to` becomes the first one found */
    bool found[LANES], unsure[LANES]; /* unsure: that it is the first one is not proved */
    bool any;                         /* any root will do */
    long evaluations;                 /* how often the sheet was evaluated */
} patch_query;

/* An empty one. */
void patch_query_begin(patch_query *k, const patch_surface *f, bool any);

/* Put ray i into the quest: r + s t, from < t < to. */
void patch_query_add(patch_query *k, int i, vec3 r, vec3 s, double from, double to);

/* Find the first root of each of n rays. */
void patch_query_run(patch_query *k, int n);

/* Places that are on the surface but for `off`, and where on it each is: the nearest place. */
typedef struct projections {
    vec3 place[LANES];
    double off[LANES];
    int32_t part[LANES];
    double u[LANES], w[LANES];
} projections;

/* Find part, u and w of n places. only: on this part alone; NULL: on any. */
void patch_project(const patch_surface *f, int n, const int32_t *only, projections *s);

#endif
