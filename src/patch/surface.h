/* What the files of searched surfaces share: a sheet in leaves, and which of them a ray may meet. Private to searched*.c. */
#ifndef KAGE_PATCH_SURFACE_H
#define KAGE_PATCH_SURFACE_H

#include "bvh/bvh.h"
#include "patch/piece.h"
#include "geometry/surface.h"

typedef struct searched {
    surface base;
    surface_methods *methods; /* its own, as `parts` is */
    sheet *q;
    leaves l;
    bvh *tree; /* over the leaves; its unit is the sheet's radius, its origin the sheet's centre */
    bool broken; /* it may jump, or turn at once: then nothing is proved of some pieces, however small */
    struct rough_form *rough; /* its rough surfaces so far */
} searched;

/* A rough surface of it, as a surface of its own. */
typedef struct rough_form rough_form;
struct rough_form {
    const struct perturb *P;
    surface *shape;
    rough_form *next;
};

/* As searched_new, with leaves as flat as that. */
searched *searched_make(sheet *q, double flat);

void searched_free_rough(rough_form *first);

/* For true displacement. */
extern const struct displaced searched_displaced;

/* The rays that are searched, each from the place of it that is nearest to the sheet's centre on, so that no digit is lost to a
 * far eye: r + s (t - start) is where the ray is at t. */
typedef struct quest {
    const searched *f;
    vec3 r[LANES], s[LANES];
    double start[LANES];
    double from[LANES], to[LANES]; /* the roots that count are between these, as t - start; `to` becomes the first one found */
    bool found[LANES], unsure[LANES]; /* unsure: that it is the first one is not proved */
    bool any;                         /* any root will do */
    long looks;                       /* how often the sheet was evaluated */
} quest;

/* An empty one. */
void quest_begin(quest *k, const searched *f, bool any);

/* The surface's methods, with what they have counted. looks: as above; unsure: hits. */
typedef struct quest_counts {
    long looks, unsure;
} quest_counts;

void searched_hits(const searched *f, int n, const rays *x, int32_t id, hits *h, quest_counts *c);
void searched_hits_own(const searched *f, int n, const rays *x, const starts *from, int32_t id, hits *h, quest_counts *c);
void searched_darken(const searched *f, int n, const rays *x, real *lit, quest_counts *c);
/* part: NULL: on any */
void searched_darken_own(const searched *f, int n, const rays *x, const int32_t *part, real *lit, quest_counts *c);

/* Put ray i into the quest: r + s t, from < t < to. */
void quest_add(quest *k, int i, vec3 r, vec3 s, double from, double to);

/* Find the first root of each of n rays. */
void quest_run(quest *k, int n);

/* Places that are on the surface but for `off`, and where on it each is: the nearest place. */
typedef struct spots {
    vec3 place[LANES];
    double off[LANES];
    int32_t part[LANES];
    double u[LANES], w[LANES];
} spots;

/* Find part, u and w of n places. only: on this part alone; NULL: on any. */
void settle(const searched *f, int n, const int32_t *only, spots *s);

#endif
