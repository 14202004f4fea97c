/* What the files of searched surfaces share: a sheet in leaves, and which of them a ray may meet. Private to searched*.c. */
#ifndef KAGE_SEARCHED_H
#define KAGE_SEARCHED_H

#include "bvh.h"
#include "leaf.h"
#include "surface.h"

typedef struct searched {
    surface base;
    surface_methods *methods; /* its own, as `parts` is */
    sheet *q;
    leaves l;
    bvh *tree; /* over the leaves; its unit is the sheet's radius, its origin the sheet's centre */
    bvh *rough; /* the same over what the leaves' rough surfaces may be in, with any P so far; NULL: not prepared */
    double lowest, highest, height; /* of those P, 0 among them: least, greatest, and the larger magnitude */
} searched;

/* For true displacement. */
extern const struct displaced searched_displaced;

/* The stretch of a ray within a sphere about the sheet's centre, and the same ray in the trees' units. False: there is none. */
bool searched_enter(const searched *f, double radius, vec3 r, vec3 s, double *from, double *to, float at[3], float way[3], float *end);

/* The rays that are searched, each from the place of it that is nearest to the sheet's centre on, so that no digit is lost to a
 * far eye: r + s (t - start) is where the ray is at t. */
typedef struct quest {
    const searched *f;
    vec3 r[LANES], s[LANES];
    double start[LANES];
    double from[LANES], to[LANES]; /* the roots that count are between these, as t - start; `to` becomes the first one found */
    bool found[LANES];
} quest;

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
