/* A sheet in pieces that are so small, and so flat, that a ray meets most of them once at the most, and can be told to
 * miss them. Each is a parallelogram with a bound of how far the surface is from it:
 *
 *     | Q(u,w) - (c + a A + b B) | <= e,   a and b the place in the piece's range, -1..1 from end to end,
 *     | Qu half - A | <= ea, | Qw half - B | <= eb,   half the range's width in u, in w.
 */
#ifndef KAGE_PATCH_PIECE_H
#define KAGE_PATCH_PIECE_H

#include <stdbool.h>

#include "patch/patch.h"

typedef struct piece {
    int32_t part;
    double u[2], w[2]; /* the range */
    vec3 c, A, B;
    double e, ea, eb;
    double box[2][3]; /* Q is in it */
} piece;

/* The leaf over a range. */
piece piece_of(const patch *q, int32_t part, const double u[2], const double w[2]);

/* Its half, of two: `which` is 0 or 1; across the direction in which it is longer, or, where that
 * is not known, in which it has more of the sheet's range. */
piece piece_half(const patch *q, const piece *f, int which);

/* How far from its middle it reaches at most. */
double piece_radius(const piece *f);

/* A sheet as leaves. */
typedef struct pieces {
    int n;
    piece *piece; /* owned */
    vec3 centre;  /* all of Q is within `radius` of it */
    double radius;
} pieces;

/* flat: by how much, in radians or as a share, Qu and Qw may change within a leaf that is not very small. False: out of
 * memory, or Q has no bounds, when n is 0. pieces_free in either case. */
bool pieces_of(const patch *q, double flat, pieces *out);
void pieces_free(pieces *l);

/* A ray against a leaf. The ray is r + s t, lo <= t <= hi. */
typedef enum piece_answer {
    PIECE_MISSED, /* it does not meet it: proved */
    PIECE_ONCE,   /* once at the most, and Newton's iteration finds it: a and b are about where */
    PIECE_OPEN,   /* not known */
} piece_answer;

piece_answer piece_intersect(const piece *f, vec3 r, vec3 s, double lo, double hi, double *a, double *b);

#endif
