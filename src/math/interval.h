/* Interval arithmetic: the range of a function over intervals of its arguments.
 *
 * Ends are computed as usual and then widened by more than their rounding error. So a range includes the exact values
 * and those computed in floating point. An end that is 0 stays 0, so that u^2 >= 0. Arguments outside the function's
 * domain are ignored; if there are no others, or infinities cancel, an end is infinite. 0 times infinity is 0, because
 * an infinite end is a bound of finite numbers.
 */
#ifndef KAGE_MATH_INTERVAL_H
#define KAGE_MATH_INTERVAL_H

#include <stdbool.h>

#include "base/real.h"
#include "math/kmath.h"

typedef struct interval {
    double lo, hi; /* lo <= hi, never NaN */
} interval;

static const interval interval_all = {-KM_INF, KM_INF}, interval_zero = {0, 0}, interval_one = {1, 1};

static inline interval interval_at(double x) { return (interval){x, x}; }
static inline interval interval_hull(interval a, interval b)
{
    return (interval){lesser(a.lo, b.lo), greater(a.hi, b.hi)};
}
static inline interval interval_negate(interval a) { return (interval){-a.hi, -a.lo}; }
static inline bool interval_has(interval a, double x) { return a.lo <= x && x <= a.hi; }
static inline bool interval_is(interval a, double x) { return a.lo == x && a.hi == x; }
static inline bool interval_is_point(interval a) { return a.lo == a.hi; }

/* Replace an end that is NaN by an infinite one. */
static inline interval interval_known(interval a)
{
    return (interval){a.lo == a.lo ? a.lo : -KM_INF, a.hi == a.hi ? a.hi : KM_INF};
}

/* The part of a in the domain lo..hi; all of lo..hi if there is none. */
static inline interval interval_clip(interval a, double lo, double hi)
{
    interval c = {greater(a.lo, lo), lesser(a.hi, hi)};
    return c.lo <= c.hi ? c : (interval){lo, hi};
}

/* Relative errors, rounded up: half an ulp (1.1e-16) for one operation of the hardware; up to 3 ulp for a function of
 * kmath.h, 8 for a power that is multiplied out. */
#define INTERVAL_ONE_ROUNDING 2.3e-16
#define INTERVAL_ROUNDINGS 4e-15
/* The absolute error where a result is too small to be rounded relatively (below 2.2e-308). */
#define INTERVAL_TINY 1e-305

/* Move both ends outwards by a relative error. An end that is 0 is exact. */
static inline interval interval_widen(interval a, double relative)
{
    const double below = a.lo == 0 ? 0 : relative * fabs(a.lo) + INTERVAL_TINY;
    const double above = a.hi == 0 ? 0 : relative * fabs(a.hi) + INTERVAL_TINY;
    return interval_known((interval){a.lo - below, a.hi + above});
}

/* |a| */
static inline interval interval_abs(interval a)
{
    double l = fabs(a.lo), h = fabs(a.hi);
    return (interval){interval_has(a, 0) ? 0 : lesser(l, h), greater(l, h)};
}

static inline interval interval_add(interval a, interval b)
{
    return interval_widen((interval){a.lo + b.lo, a.hi + b.hi}, INTERVAL_ONE_ROUNDING);
}

interval interval_multiply(interval a, interval b);
interval interval_reciprocal(interval a);

static inline interval interval_square(interval a) { return interval_multiply(interval_abs(a), interval_abs(a)); }
static inline interval interval_scale(double k, interval a) { return interval_multiply(interval_at(k), a); }

/* The range of a monotonic function from its values at the two ends, which may be wrong by 8 ulp. */
static inline interval interval_between(double x, double y)
{
    return interval_widen((interval){lesser(x, y), greater(x, y)}, INTERVAL_ROUNDINGS);
}

/* The ranges of the functions of kmath.h. */
interval interval_sin(interval a);
interval interval_cos(interval a);
interval interval_tan(interval a);
interval interval_asin(interval a);
interval interval_acos(interval a);
interval interval_atan(interval a);
interval interval_atan2(interval y, interval x);
interval interval_sinh(interval a);
interval interval_cosh(interval a);
interval interval_tanh(interval a);
interval interval_exp(interval a);
interval interval_log(interval a);
interval interval_sqrt(interval a);
interval interval_floor(interval a);
interval interval_mod(interval a, interval b);
interval interval_pow(interval a, interval b);

#endif
