/* A patch subdivided into pieces, each nearly a parallelogram with a proven error. For a ray and a piece it is proved
 * that they miss each other, or that they meet at most once, or neither is. The error of a piece is such that
 *
 *     | Q(u,w) - (c + a A + b B) | <= e,   a and b the place in the piece's range, -1..1 from end to end,
 *     | Qu half - A | <= ea, | Qw half - B | <= eb,   half the range's width in u, in w.
 *
 * What a ray meets does not depend on how small the pieces are; only speed does.
 */
#ifndef KAGE_PATCH_PIECE_H
#define KAGE_PATCH_PIECE_H

#include <stdbool.h>

#include "base/progress.h"
#include "bvh/bvh.h"
#include "patch/patch.h"

/* All lengths in scene units. Where a partial has no bound A and B are 0, and e, ea or eb may be infinite. */
typedef struct piece {
    int32_t part;      /* of the patch */
    double u[2], w[2]; /* the range */
    vec3 c, A, B;      /* the parallelogram: its middle, and half its sides */
    double e, ea, eb;  /* the errors, as above */
    double box[2][3];  /* the least and the greatest coordinates of Q */
} piece;

/* The piece over a range of (u,w), within the patch's own. */
piece piece_of(const patch *q, int32_t part, const double u[2], const double w[2]);

/* One of its two halves: `which` is 0 or 1. It is cut across the direction in which it is longer. Where no length is
 * known, it is cut across the one in which it has the larger share of the patch's range. */
piece piece_half(const patch *q, const piece *f, int which);

/* All of the piece is within this distance of its middle c. */
double piece_radius(const piece *f);

/* A whole patch as pieces. */
typedef struct pieces {
    int n;
    piece *piece;        /* owned */
    double lo[3], hi[3]; /* the bounding box of all */
    bvh_space space;     /* the sphere about that box: all of Q is in it */
} pieces;

/* Subdivide a patch, with several threads. flat: by how much, in radians or as a share, Qu and Qw may change within a
 * piece that is not very small. w: progress, and what their memory is taken from; NULL: neither. False: out of
 * memory, stopped, or, with *bounded false, Q has no bounds or is a point. Call pieces_free in either case. */
bool pieces_of(const patch *q, double flat, const progress *w, pieces *out, bool *bounded);
void pieces_free(pieces *l);

typedef enum piece_answer {
    PIECE_MISSED, /* proved: the ray does not meet the piece */
    PIECE_ONCE,   /* proved: the ray meets it at most once, and Newton's iteration finds the root */
    PIECE_OPEN,   /* neither is proved */
} piece_answer;

/* The ray r + s t with lo <= t <= hi against a piece. PIECE_ONCE: (*a, *b) is about where in the piece it is met, from
 * -1 to 1; PIECE_OPEN: both are 0. */
piece_answer piece_intersect(const piece *f, vec3 r, vec3 s, double lo, double hi, double *a, double *b);

#endif
