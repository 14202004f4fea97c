/* Gradient noise in the plane (Perlin 1985, with the quintic fade of Perlin 2002, so that second derivatives
 * are continuous), as one branch-free function for the loops of the stages.
 *
 * At every integer point (i,j) stands a gradient of length 1.4142135 at the angle 2 pi h(i,j) / 2^32, where h
 * hashes i and j modulo 2^32: the noise repeats after 2^32. With s(t) = 6t^5 - 15t^4 + 10t^3, and x = i + a,
 * y = j + b, 0 <= a,b < 1, the noise is the ramp g00.(a,b) of the corner (i,j) and those of the other three,
 * blended by s(a) along x and by s(b) along y. It is 0 at the integer points, and within [-1, 1]: at the
 * centre of a cell four ramps reach 1.4142135 sqrt(1/2) < 1 at the most. From 2^52 on all numbers are
 * integers, and the noise is 0.
 */
#ifndef KAGE_MATH_NOISE_H
#define KAGE_MATH_NOISE_H

#include "math/interval.h"

typedef struct noise_jet {
    double f, x, y, xx, xy, yy;
} noise_jet;

/* A permutation of 32-bit numbers without visible pattern ("lowbias32" of C. Wellons' hash-prospector). */
KM_INLINE uint64_t noise_mix(uint64_t h)
{
    const uint64_t low = 0xffffffffu;
    h = ((h ^ (h >> 16)) * 0x7feb352du) & low;
    h = ((h ^ (h >> 15)) * 0x846ca68bu) & low;
    return h ^ (h >> 16);
}

/* An integral x modulo 2^32; the numbers are exact throughout. */
KM_INLINE uint64_t noise_lattice(double x)
{
    double m = x - 4294967296.0 * km_floor(x * (1 / 4294967296.0));
    return km_bits(m + KM_TWO52) & 0xffffffffu;
}

typedef struct noise_gradient {
    double x, y;
} noise_gradient;

KM_INLINE noise_gradient noise_gradient_at(uint64_t h)
{
    double angle = (km_from_bits(h | 0x4330000000000000u) - KM_TWO52) * (6.28318530717958647693 / 4294967296.0);
    const double length = 1.4142135; /* just below sqrt 2, so that no rounding leaves [-1, 1] */
    noise_gradient g;
    g.x = length * km_cos(angle);
    g.y = length * km_sin(angle);
    return g;
}

KM_INLINE noise_jet noise_at(double x, double y)
{
    double i = km_floor(x), j = km_floor(y), a = x - i, b = y - j;
    uint64_t i0 = noise_lattice(i), i1 = i0 + 1, j0 = noise_lattice(j);
    uint64_t h0 = noise_mix(j0), h1 = noise_mix((j0 + 1) & 0xffffffffu);
    noise_gradient g00 = noise_gradient_at(noise_mix((i0 + h0) & 0xffffffffu));
    noise_gradient g10 = noise_gradient_at(noise_mix((i1 + h0) & 0xffffffffu));
    noise_gradient g01 = noise_gradient_at(noise_mix((i0 + h1) & 0xffffffffu));
    noise_gradient g11 = noise_gradient_at(noise_mix((i1 + h1) & 0xffffffffu));

    /* s(a), s'(a), s''(a); and along y. */
    double s = a * a * a * (a * (a * 6 - 15) + 10), t = b * b * b * (b * (b * 6 - 15) + 10);
    double s1 = 30 * a * a * (a - 1) * (a - 1), t1 = 30 * b * b * (b - 1) * (b - 1);
    double s2 = 60 * a * (a - 1) * (2 * a - 1), t2 = 60 * b * (b - 1) * (2 * b - 1);

    /* The ramps, and f = r00 + s A + t B + s t C, where A, B, C are linear in a and b. */
    double r00 = g00.x * a + g00.y * b, r10 = g10.x * (a - 1) + g10.y * b;
    double r01 = g01.x * a + g01.y * (b - 1), r11 = g11.x * (a - 1) + g11.y * (b - 1);
    double A = r10 - r00, Ax = g10.x - g00.x, Ay = g10.y - g00.y;
    double B = r01 - r00, Bx = g01.x - g00.x, By = g01.y - g00.y;
    double C = (r11 - r01) - A, Cx = (g11.x - g01.x) - Ax, Cy = (g11.y - g01.y) - Ay;

    noise_jet n;
    n.f = r00 + s * A + t * (B + s * C);
    n.x = g00.x + s * Ax + t * (Bx + s * Cx) + s1 * (A + t * C);
    n.y = g00.y + s * Ay + t * (By + s * Cy) + t1 * (B + s * C);
    n.xx = 2 * s1 * (Ax + t * Cx) + s2 * (A + t * C);
    n.yy = 2 * t1 * (By + s * Cy) + t2 * (B + s * C);
    n.xy = s1 * (Ay + t * Cy) + t1 * (Bx + s * Cx) + s1 * t1 * C;
    return n;
}

typedef struct noise_bounds {
    interval f, x, y, xx, xy, yy;
} noise_bounds;

/* Bounds of the noise and its partials over a rectangle: close if it is small; those of the whole plane if its sides
 * add up to 2 or more (noise_bounds.c). */
noise_bounds noise_bounds_over(interval a, interval b);

#endif
