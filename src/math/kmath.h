/* Elementary functions in double for the loops of the stages: branch-free (comparisons select, nothing
 * jumps), without tables and without libm, so that gcc and clang turn a loop that calls them into SIMD for
 * SSE2 and for AVX2 alike. Only + - * /, sqrt, comparisons and bit operations are used, so every processor
 * gives the same bytes as long as nothing is contracted (-ffp-contract=off).
 *
 * Largest errors measured against mpmath, in units of the last place (ulp), 400 000 points a function:
 *
 *   km_sin km_cos km_tan     |x| <= 1.6e6     1.5  1.5  2.9
 *   km_asin km_acos          [-1, 1]          0.9  0.8
 *   km_atan km_atan2         all              0.9  1.6
 *   km_sinh km_cosh km_tanh  all              1.9  1.3  2.2
 *   km_exp km_log            all              0.9  0.8
 *   km_pow                   all              1.1
 *   km_floor                 exact
 *   km_mod                   exact while |a/b| < 2^52
 *
 * Beyond 1.6e6 the trigonometric functions lose accuracy gradually, in absolute terms about an ulp of x; from
 * 2^45 on, where neighbouring numbers are 2^-7 apart and more, they answer as for 0. sin and cos stay within
 * [-1, 1] for any finite x and are NaN at infinity. Exceptional arguments of all functions give what annex F
 * of C99 says, up to the sign of a zero, which does not count in a base of km_pow; but powers of -infinity that are
 * not whole are NaN, as those of all numbers below 0 are.
 *
 * Polynomial and rational coefficients: fdlibm 5.3 (Sun Microsystems, 1993) for sin, cos, asin, exp and
 * log; Cephes 2.8 (S. L. Moshier) for atan.
 */
#ifndef KAGE_MATH_KMATH_H
#define KAGE_MATH_KMATH_H

#include <math.h>
#include <stdint.h>
#include <string.h>

/* A loop vectorises only if all it calls has been inlined, however large. */
#if defined(__GNUC__)
#define KM_INLINE static inline __attribute__((always_inline))
#else
#define KM_INLINE static inline
#endif

#define KM_INF ((double)INFINITY)
#define KM_NAN ((double)NAN)
#define KM_SIGN ((uint64_t)1 << 63)
#define KM_TWO52 4503599627370496.0
#define KM_ROUND (1.5 * KM_TWO52) /* x + KM_ROUND has no bit below 1: its low bits are round(x) as an integer */
#define KM_PI 3.14159265358979323846
#define KM_PI_2 1.57079632679489655800e+00
#define KM_PI_2_LO 6.12323399573676603587e-17

KM_INLINE uint64_t km_bits(double x)
{
    uint64_t b;
    memcpy(&b, &x, sizeof b);
    return b;
}

KM_INLINE double km_from_bits(uint64_t b)
{
    double x;
    memcpy(&x, &b, sizeof x);
    return x;
}

/* |x| with the sign of s. */
KM_INLINE double km_copysign(double x, double s)
{
    return km_from_bits((km_bits(x) & ~KM_SIGN) | (km_bits(s) & KM_SIGN));
}

/* x without its 27 lowest bits: the product of two such numbers is exact. */
KM_INLINE double km_high(double x) { return km_from_bits(km_bits(x) & ~(((uint64_t)1 << 27) - 1)); }

/* The nearest integer, while |x| < 2^51. */
KM_INLINE double km_round(double x) { return (x + KM_ROUND) - KM_ROUND; }

KM_INLINE double km_floor(double x)
{
    double a = fabs(x);
    double r = km_copysign((a + KM_TWO52) - KM_TWO52, x);
    r = r > x ? r - 1 : r;
    return a < KM_TWO52 ? r : x;
}

/* As C's fmod: a - b trunc(a/b), with the sign of a. Exact while |a/b| < 2^52, 0 beyond; |b| < 1e300. */
KM_INLINE double km_mod(double a, double b)
{
    double x = fabs(a), y = fabs(b);
    double q = km_floor(x / y);
    /* x - q y without rounding: Dekker's product, on Veltkamp's halves of q and y. */
    double qs = 134217729.0 * q, ys = 134217729.0 * y;
    double qh = qs - (qs - q), yh = ys - (ys - y), ql = q - qh, yl = y - yh;
    double p = q * y;
    double e = ((qh * yh - p) + qh * yl + ql * yh) + ql * yl;
    double r = (x - p) - e;
    r = r < 0 ? r + y : r; /* the quotient was rounded up to an integer */
    r = r >= y ? r - y : r;
    r = x / y < KM_TWO52 ? r : 0 * x * y;
    r = x < y ? x : r;
    r = y > 0 ? r : KM_NAN;
    return x < KM_INF ? km_copysign(r, a) : KM_NAN;
}

/* sin and cos of x, up to the exchange and the signs that the quadrant asks for. */
typedef struct km_circle {
    double s, c;
    uint64_t quadrant; /* modulo 4 */
} km_circle;

KM_INLINE km_circle km_reduced_circle(double x)
{
    x = fabs(x) < 35184372088832.0 ? x : 0 * x;
    /* Cody and Waite: pi/2 in three parts, the first two of 33 bits, so that their products with q are
     * exact while q < 2^20. */
    double t = x * 6.36619772367581382433e-01 + KM_ROUND;
    double q = t - KM_ROUND;
    double a = x - q * 1.57079632673412561417e+00, b = q * 6.07710050630396597660e-11;
    double r = a - b;
    r = r - (q * 2.02226624879595063154e-21 - ((a - r) - b));

    double z = r * r;
    double s = -1.66666666666666324348e-01 +
               z * (8.33333333332248946124e-03 +
                    z * (-1.98412698298579493134e-04 +
                         z * (2.75573137070700676789e-06 +
                              z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10))));
    double c = 4.16666666666666019037e-02 +
               z * (-1.38888888888741095749e-03 +
                    z * (2.48015872894767294178e-05 +
                         z * (-2.75573143513906633035e-07 +
                              z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11))));
    km_circle k;
    k.s = r + z * r * s;
    k.c = 1 - (0.5 * z - z * z * c);
    k.quadrant = km_bits(t) & 3;
    return k;
}

/* The one or the other by the lowest bit of `odd`, negated by its second bit. As bit operations, since
 * SSE2 has no 64-bit integer comparison. */
KM_INLINE double km_quadrant(double even, double odd, uint64_t quadrant)
{
    uint64_t mask = (uint64_t)0 - (quadrant & 1);
    return km_from_bits(((km_bits(even) & ~mask) | (km_bits(odd) & mask)) ^ ((quadrant & 2) << 62));
}

KM_INLINE double km_sin(double x)
{
    km_circle k = km_reduced_circle(x);
    return km_quadrant(k.s, k.c, k.quadrant);
}

KM_INLINE double km_cos(double x)
{
    km_circle k = km_reduced_circle(x);
    return km_quadrant(k.c, k.s, k.quadrant ^ ((k.quadrant & 1) << 1));
}

KM_INLINE double km_tan(double x)
{
    km_circle k = km_reduced_circle(x);
    return km_quadrant(k.s, -k.c, k.quadrant & 1) / km_quadrant(k.c, k.s, k.quadrant & 1);
}

/* asin(s) = s + s R(z), z = s^2 <= 1/4: at s = |x| below 1/2, and at s = sqrt((1 - |x|)/2) above, where
 * asin|x| = pi/2 - 2 asin(s). */
typedef struct km_arc {
    double s, sl; /* s + sl is that s with the root's rounding error */
    double sr;    /* s R(z) */
} km_arc;

KM_INLINE km_arc km_small_arc(double x)
{
    double a = fabs(x);
    double z = a < 0.5 ? x * x : 0.5 * (1 - a);
    double p = z * (1.66666666666666657415e-01 +
                    z * (-3.25565818622400915405e-01 +
                         z * (2.01212532134862925881e-01 +
                              z * (-4.00555345006794114027e-02 +
                                   z * (7.91534994289814532176e-04 + z * 3.47933107596021167570e-05)))));
    double q =
        1 + z * (-2.40339491173441421878e+00 +
                 z * (2.02094576023350569471e+00 + z * (-6.88283971605453293030e-01 + z * 7.70381505559019352791e-02)));
    double root = sqrt(z), h = km_high(root);
    double rest = (z - h * h) / (root > 0 ? root + h : 1);
    km_arc k;
    k.s = a < 0.5 ? a : h;
    k.sl = a < 0.5 ? 0 : rest;
    k.sr = (a < 0.5 ? a : root) * (p / q);
    return k;
}

KM_INLINE double km_asin(double x)
{
    km_arc k = km_small_arc(x);
    double below = k.s + k.sr;
    double above = 0.5 * KM_PI_2 - ((2 * k.sr - (KM_PI_2_LO - 2 * k.sl)) - (0.5 * KM_PI_2 - 2 * k.s));
    return km_copysign(fabs(x) < 0.5 ? below : above, x);
}

KM_INLINE double km_acos(double x)
{
    km_arc k = km_small_arc(x);
    double middle = KM_PI_2 - (km_copysign(k.s, x) - (KM_PI_2_LO - km_copysign(k.sr, x)));
    double right = 2 * (k.s + (k.sl + k.sr));
    double left = 2 * (KM_PI_2 - (k.s + ((k.sl + k.sr) - KM_PI_2_LO)));
    double above = x > 0 ? right : left;
    return fabs(x) < 0.5 ? middle : above;
}

/* atan of x >= 0: reduced by the tangents of 3 pi/8 and (about) 3 pi/16. */
KM_INLINE double km_atan_positive(double x)
{
    int far = x > 2.41421356237309504880, mid = x > 0.66;
    double num = far ? -1 : mid ? x - 1 : x;
    double den = far ? x : mid ? x + 1 : 1;
    double base = far ? KM_PI_2 : mid ? 0.5 * KM_PI_2 : 0;
    double low = far ? KM_PI_2_LO : mid ? 0.5 * KM_PI_2_LO : 0;
    double t = num / den, z = t * t;
    double p =
        -6.485021904942025371773e1 +
        z * (-1.228866684490136173410e2 +
             z * (-7.500855792314704667340e1 + z * (-1.615753718733365076637e1 + z * -8.750608600031904122785e-1)));
    double q =
        1.945506571482613964425e2 +
        z * (4.853903996359136964868e2 +
             z * (4.328810604912902668951e2 + z * (1.650270098316988542046e2 + z * (2.485846490142306297962e1 + z))));
    return base + (t + (t * (z * (p / q)) + low));
}

KM_INLINE double km_atan(double x) { return km_copysign(km_atan_positive(fabs(x)), x); }

KM_INLINE double km_atan2(double y, double x)
{
    double ax = fabs(x), ay = fabs(y);
    int steep = ay > ax;
    double num = steep ? ax : ay, den = steep ? ay : ax;
    double t = den > 0 ? num / den : num + den; /* the sum: 0, or NaN */
    t = ax == KM_INF && ay == KM_INF ? 1 : t;
    double a = km_atan_positive(t);
    a = steep ? KM_PI_2 - (a - KM_PI_2_LO) : a;
    a = km_copysign(1, x) < 0 ? 2 * KM_PI_2 - (a - 2 * KM_PI_2_LO) : a;
    return km_copysign(a, y);
}

/* exp(x + xl) = 2^k (1 + p), |p| < 0.42; xl is a correction far below x. */
typedef struct km_power {
    double k, p;
} km_power;

KM_INLINE km_power km_exp_parts(double x, double xl)
{
    km_power e;
    e.k = km_round(x * 1.44269504088896338700e+00);
    double hi = x - e.k * 6.93147180369123816490e-01;
    double lo = e.k * 1.90821492927058770002e-10 - xl;
    double r = hi - lo, z = r * r;
    double c = r - z * (1.66666666666666019037e-01 +
                        z * (-2.77777777770155933842e-03 +
                             z * (6.61375632143793436117e-05 +
                                  z * (-1.65339022054652515390e-06 + z * 4.13813679705723846039e-08))));
    e.p = hi - (lo - r * c / (2 - c));
    return e;
}

/* 2^k for an integer -1022 <= k <= 1023: k + 1023, moved into the exponent's place. */
KM_INLINE double km_exp2_integer(double k) { return km_from_bits(km_bits(k + (KM_TWO52 + 1023)) << 52); }

/* x 2^k for an integer |k| <= 2044, in two steps: the first is exact, the second may overflow or underflow
 * as it should. */
KM_INLINE double km_scale(double x, double k)
{
    double half = km_round(0.5 * k);
    return x * km_exp2_integer(half) * km_exp2_integer(k - half);
}

KM_INLINE double km_exp(double x)
{
    x = x > 710 ? 710 : x;
    x = x < -746 ? -746 : x;
    km_power e = km_exp_parts(x, 0);
    return km_scale(1 + e.p, e.k);
}

/* exp(x) - 1 for 0 <= x <= 700 without cancellation. */
KM_INLINE double km_expm1_positive(double x)
{
    km_power e = km_exp_parts(x, 0);
    double s = km_exp2_integer(e.k);
    return s * e.p + (s - 1);
}

/* sinh and cosh reach a little further than exp: exp(|x|)/2 without the overflow of exp(|x|). */
KM_INLINE double km_half_exp(double a)
{
    km_power e = km_exp_parts(a > 712 ? 712 : a, 0);
    return km_scale(1 + e.p, e.k - 1);
}

KM_INLINE double km_sinh(double x)
{
    double a = fabs(x), e = km_expm1_positive(a > 22 ? 22 : a), h = km_half_exp(a);
    double near = 0.5 * (e + e / (e + 1));
    return km_copysign(a > 22 ? h : near, x);
}

KM_INLINE double km_cosh(double x)
{
    double h = km_half_exp(fabs(x));
    return h + 0.25 / h;
}

/* exp(2|x|) - 1, cut where tanh has long been 1. */
KM_INLINE double km_expm1_twice(double x)
{
    double a = 2 * fabs(x);
    return km_expm1_positive(a > 700 ? 700 : a);
}

KM_INLINE double km_tanh(double x)
{
    double e = km_expm1_twice(x);
    return km_copysign(e / (e + 2), x);
}

/* x = 2^k m, sqrt(1/2) <= m < sqrt(2), for finite x > 0. */
typedef struct km_parts {
    double k, m;
} km_parts;

KM_INLINE km_parts km_split(double x)
{
    const uint64_t root = 0x3fe6a09e667f3bcdu, bias = (uint64_t)1023 << 52; /* the bits of sqrt(1/2) */
    int tiny = x < 2.2250738585072014e-308;
    double scaled = tiny ? x * 18014398509481984.0 : x;
    uint64_t b = km_bits(scaled) - root + bias;
    km_parts s;
    s.k = km_from_bits(b >> 52 | 0x4330000000000000u) - (KM_TWO52 + 1023) - (tiny ? 54 : 0);
    s.m = km_from_bits((b & (((uint64_t)1 << 52) - 1)) + root);
    return s;
}

KM_INLINE double km_log(double x)
{
    km_parts t = km_split(x);
    double f = t.m - 1, s = f / (2 + f), z = s * s, w = z * z, half = 0.5 * f * f;
    double odd = z * (6.666666666666735130e-01 +
                      w * (2.857142874366239149e-01 + w * (1.818357216161805012e-01 + w * 1.479819860511658591e-01)));
    double even = w * (3.999999999940941908e-01 + w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01));
    double r =
        s * (half + (odd + even)) + t.k * 1.90821492927058770002e-10 - half + f + t.k * 6.93147180369123816490e-01;
    r = x < KM_INF ? r : x;
    r = x > 0 ? r : KM_NAN;
    return x == 0 ? -KM_INF : r;
}

/* log x = hi + lo to about 2^-65 of itself, with hi short enough for exact products (km_high). */
typedef struct km_long {
    double hi, lo;
} km_long;

KM_INLINE km_long km_log_long(double x)
{
    km_parts t = km_split(x);
    /* s = (m - 1)/(m + 1) = s + sl */
    double f = t.m - 1, den = t.m + 1, denh = km_high(den), denl = t.m - (denh - 1);
    double q = f / den, s = km_high(q), sl = ((f - s * denh) - s * denl) / den;
    /* log m = 2 atanh(s) = (2/3) s (3 + s^2 + r), r = 3 s^4/5 + 3 s^6/7 + ... */
    double z = q * q;
    double r = z * z *
               (3. / 5 +
                z * (3. / 7 +
                     z * (3. / 9 +
                          z * (3. / 11 +
                               z * (3. / 13 +
                                    z * (3. / 15 + z * (3. / 17 + z * (3. / 19 + z * (3. / 21 + z * (3. / 23))))))))));
    double zh = s * s, zl = sl * (s + q) + r;
    double th = km_high(3 + zh + zl), tl = zl - ((th - 3) - zh);
    double u = s * th, v = sl * th + tl * q;
    double ph = km_high(u + v), pl = v - (ph - u);
    const double c = 2. / 3, ch = 0.6666666567325592, cl = 9.934107462565104e-09; /* 2/3 = ch + cl */
    double lh = ch * ph, ll = cl * ph + c * pl;
    /* + k log 2, the larger first */
    double kh = t.k * 6.93147180369123816490e-01;
    double sum = kh + lh, back = sum - kh;
    double rest = ((kh - (sum - back)) + (lh - back)) + (ll + t.k * 1.90821492927058770002e-10);
    km_long l;
    l.hi = km_high(sum + rest);
    l.lo = (sum - l.hi) + rest;
    return l;
}

KM_INLINE double km_pow(double x, double y)
{
    double a = fabs(x);
    km_long l = km_log_long(a);
    double yh = km_high(y), h = yh * l.hi, low = (y - yh) * l.hi + y * l.lo;
    double sum = h + low, rest = (h - sum) + low;
    int inside = fabs(sum) < 746;
    double end = y * l.hi > 0 ? 746 : -746;
    km_power e = km_exp_parts(inside ? sum : end, inside ? rest : 0);
    double r = km_scale(1 + e.p, e.k);

    double vanish = y < 0 ? KM_INF : 0, grow = y < 0 ? 0 : KM_INF;
    r = a > 0 ? r : vanish;
    r = a < KM_INF ? r : grow;
    r = a == 1 ? 1 : r;
    int integer = km_floor(y) == y, odd = integer && km_floor(0.5 * y) != 0.5 * y;
    r = x < 0 && odd ? -r : r;
    r = x < 0 && !integer ? KM_NAN : r;
    r = x != x || y != y ? KM_NAN : r;
    r = y == 1 ? x : r;
    r = y == 2 ? x * x : r;
    return y == 0 || x == 1 ? 1 : r;
}

#endif
