/* The displaced surface X = Q + P n/|n| over a smooth one that is known by its partials, for one lane. */
#ifndef KAGE_DISPLACED_OFFSET_H
#define KAGE_DISPLACED_OFFSET_H

#include "wave/lane.h"

/* At the height h over Q: the unit normal n of the smooth surface, and the partials of Q + h n while h stays the same.
 */
typedef struct offset {
    bs_vec3 n, U, W;
} offset;

static inline bs_vec3 offset_mix(bs_vec3 a, real k, bs_vec3 b)
{
    bs_vec3 x = {a.x + k * b.x, a.y + k * b.y, a.z + k * b.z};
    return x;
}

/* k v, of any length: v + (k - 1) v has no digit left where k is small. */
static inline bs_vec3 offset_scale(bs_vec3 v, real k)
{
    bs_vec3 x = {k * v.x, k * v.y, k * v.z};
    return x;
}

/* In double: the square of a length that float holds may be beyond its range. */
static inline real offset_length(bs_vec3 v)
{
    const double x = (double)v.x, y = (double)v.y, z = (double)v.z;
    return (real)sqrt(x * x + y * y + z * z);
}

static inline bs_vec3 offset_unit(bs_vec3 v) { return offset_scale(v, 1 / offset_length(v)); }

/* The derivatives of n/|n| are those of n without their parts along n, over |n|; n_u = Quu x Qw + Qu x Quw. */
static inline offset offset_of(bs_vec3 Qu, bs_vec3 Qw, bs_vec3 Quu, bs_vec3 Quw, bs_vec3 Qww, real h)
{
    const bs_vec3 N = bs_cross(Qu, Qw);
    const real il = 1 / offset_length(N);
    offset o;
    o.n = offset_scale(N, il);
    bs_vec3 nu = offset_mix(bs_cross(Quu, Qw), 1, bs_cross(Qu, Quw)),
            nw = offset_mix(bs_cross(Quw, Qw), 1, bs_cross(Qu, Qww));
    o.U = offset_mix(Qu, h * il, offset_mix(nu, -bs_dot(nu, o.n), o.n));
    o.W = offset_mix(Qw, h * il, offset_mix(nw, -bs_dot(nw, o.n), o.n));
    return o;
}

/* The unit normal of the displaced surface, on the side of n: Xu x Xw, Xu = U + Pu n, Xw = W + Pw n. */
static inline bs_vec3 offset_normal(offset o, real Pu, real Pw)
{
    const bs_vec3 N = bs_cross(offset_mix(o.U, Pu, o.n), offset_mix(o.W, Pw, o.n));
    const real side = bs_dot(N, o.n) < 0 ? R(-1) : R(1);
    return offset_scale(offset_unit(N), side);
}

#endif
