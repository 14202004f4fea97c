/* What the files of searched surfaces share: a sheet in leaves, and which of them a ray may meet. Private to
 * searched*.c. */
#ifndef KAGE_PATCH_SURFACE_H
#define KAGE_PATCH_SURFACE_H

#include "bvh/bvh.h"
#include "patch/piece.h"
#include "geometry/surface.h"

typedef struct patch_surface {
    surface base;
    surface_ops *methods; /* its own, as `parts` is */
    patch *q;
    pieces l;
    bvh *tree;   /* over the leaves; its unit is the sheet's radius, its origin the sheet's centre */
    bool broken; /* it may jump, or turn at once: then nothing is proved of some pieces, however small */
} patch_surface;

/* Whether a surface is one. */
bool patch_surface_is(const surface *f);

/* As patch_surface_new, with leaves as flat as that. */
patch_surface *patch_surface_make(patch *q, double flat);

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

/* The surface's methods, with what they have counted. looks: as above; unsure: hits. */
typedef struct patch_counts {
    long evaluations, unsure;
} patch_counts;

void patch_surface_intersect(const patch_surface *f, int n, const rays *x, int32_t id, hits *h, patch_counts *c);
void patch_surface_intersect_own(const patch_surface *f, int n, const rays *x, const ray_origins *from, int32_t id,
                                 hits *h, patch_counts *c);
void patch_surface_occlude(const patch_surface *f, int n, const rays *x, real *lit, patch_counts *c);
/* part: NULL: on any */
void patch_surface_occlude_own(const patch_surface *f, int n, const rays *x, const int32_t *part, real *lit,
                               patch_counts *c);

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
