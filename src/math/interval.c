/* Products, quotients and elementary functions of intervals. */
#include "math/interval.h"

/* A larger angle counts as unknown: km_sin errs by an ulp of its argument at the most, 1.5e-11 at
 * 1e5, which must stay far below the 1e-9 in has_integer. */
#define LARGEST_ANGLE 1e5

/* x y at two ends. A product that underflows is not 0. */
static interval end_product(double x, double y)
{
    double p = x == 0 || y == 0 ? 0 : x * y;
    if (p == 0 && x != 0 && y != 0)
        return (x > 0) == (y > 0) ? (interval){0, INTERVAL_TINY} : (interval){-INTERVAL_TINY, 0};
    return interval_at(p);
}

interval interval_multiply(interval a, interval b)
{
    interval z = interval_hull(interval_hull(end_product(a.lo, b.lo), end_product(a.lo, b.hi)),
                               interval_hull(end_product(a.hi, b.lo), end_product(a.hi, b.hi)));
    return interval_widen(z, INTERVAL_ONE_ROUNDING);
}

interval interval_reciprocal(interval a)
{
    if ((a.lo < 0 && a.hi > 0) || interval_is(a, 0))
        return interval_all;
    interval z = {a.hi == 0 ? -KM_INF : 1 / a.hi, a.lo == 0 ? KM_INF : 1 / a.lo};
    return interval_widen(z, INTERVAL_ONE_ROUNDING);
}

/* The range of an increasing function from its values at the ends. */
static interval rising(double lo, double hi) { return interval_widen((interval){lo, hi}, INTERVAL_ROUNDINGS); }

/* A function that is extreme at the corners of a rectangle, from its values there. */
static interval corners(double a, double b, double c, double d)
{
    return rising(lesser(lesser(a, b), lesser(c, d)), greater(greater(a, b), greater(c, d)));
}

/* Is there an integer in lo..hi, or so near that rounding decides? */
static bool has_integer(double lo, double hi) { return floor(hi + 1e-9) >= ceil(lo - 1e-9); }

/* cos(x - 2 pi phase) for x in a, of which lo and hi are the values at the ends. */
static interval wave(interval a, double phase, double lo, double hi)
{
    const double turn = 2 * KM_PI;
    if (!(a.lo > -LARGEST_ANGLE && a.hi < LARGEST_ANGLE && a.hi - a.lo < turn))
        return (interval){-1, 1};
    double t0 = a.lo / turn - phase, t1 = a.hi / turn - phase;
    interval z = interval_between(lo, hi);
    return (interval){has_integer(t0 - 0.5, t1 - 0.5) ? -1 : greater(z.lo, -1),
                      has_integer(t0, t1) ? 1 : lesser(z.hi, 1)};
}

interval interval_sin(interval a) { return wave(a, 0.25, km_sin(a.lo), km_sin(a.hi)); }
interval interval_cos(interval a) { return wave(a, 0, km_cos(a.lo), km_cos(a.hi)); }

interval interval_tan(interval a)
{
    if (!(a.lo > -LARGEST_ANGLE && a.hi < LARGEST_ANGLE) || has_integer(a.lo / KM_PI - 0.5, a.hi / KM_PI - 0.5))
        return interval_all;
    return rising(km_tan(a.lo), km_tan(a.hi));
}

interval interval_asin(interval a)
{
    a = interval_clip(a, -1, 1);
    return rising(km_asin(a.lo), km_asin(a.hi));
}

interval interval_acos(interval a)
{
    a = interval_clip(a, -1, 1);
    return rising(km_acos(a.hi), km_acos(a.lo));
}

interval interval_atan(interval a) { return rising(km_atan(a.lo), km_atan(a.hi)); }

/* The angle of the point (x,y): extreme at corners, unless the rectangle touches the cut along x <= 0. */
interval interval_atan2(interval y, interval x)
{
    if (x.lo <= 0 && interval_has(y, 0))
        return interval_widen((interval){-KM_PI, KM_PI}, INTERVAL_ONE_ROUNDING);
    return corners(km_atan2(y.lo, x.lo), km_atan2(y.lo, x.hi), km_atan2(y.hi, x.lo), km_atan2(y.hi, x.hi));
}

interval interval_sinh(interval a) { return rising(km_sinh(a.lo), km_sinh(a.hi)); }

interval interval_cosh(interval a)
{
    a = interval_abs(a);
    return rising(km_cosh(a.lo), km_cosh(a.hi));
}

interval interval_tanh(interval a) { return rising(km_tanh(a.lo), km_tanh(a.hi)); }

/* The range of a function that is never negative; its upper end is not 0, even where it underflows. */
static interval not_negative(interval z) { return (interval){greater(z.lo, 0), greater(z.hi, INTERVAL_TINY)}; }

interval interval_exp(interval a) { return not_negative(rising(km_exp(a.lo), km_exp(a.hi))); }

interval interval_log(interval a)
{
    a = interval_clip(a, 0, KM_INF);
    return rising(km_log(a.lo), km_log(a.hi));
}

interval interval_sqrt(interval a)
{
    a = interval_clip(a, 0, KM_INF);
    return rising(sqrt(a.lo), sqrt(a.hi));
}

interval interval_floor(interval a) { return (interval){floor(a.lo), floor(a.hi)}; }

/* As C's fmod: the sign of a, and at most |a| and |b|. */
interval interval_mod(interval a, interval b)
{
    interval m = interval_abs(a), n = interval_abs(b);
    if (m.hi < n.lo)
        return a;
    return (interval){a.lo < 0 ? greater(a.lo, -n.hi) : 0, a.hi > 0 ? lesser(a.hi, n.hi) : 0};
}

/* a^b for a >= 0: it is monotonic in a and in b, so the extremes are at corners. */
static interval positive_power(interval a, interval b)
{
    return not_negative(corners(km_pow(a.lo, b.lo), km_pow(a.lo, b.hi), km_pow(a.hi, b.lo), km_pow(a.hi, b.hi)));
}

static interval power(interval a, interval b)
{
    if (a.lo >= 0)
        return positive_power(a, b);
    if (b.lo < b.hi) { /* a negative base has powers at integers b only: |a|^b with either sign */
        interval m = positive_power(interval_abs(a), b);
        return (interval){-m.hi, m.hi};
    }
    if (km_floor(b.lo) != b.lo)
        return positive_power(interval_clip(a, 0, KM_INF), b);
    if (km_floor(0.5 * b.lo) == 0.5 * b.lo)
        return positive_power(interval_abs(a), b);
    interval left = interval_negate(positive_power(interval_clip(interval_negate(a), 0, KM_INF), b));
    return a.hi < 0 ? left : interval_hull(left, positive_power(interval_clip(a, 0, KM_INF), b));
}

interval interval_pow(interval a, interval b) { return interval_known(power(a, b)); }
