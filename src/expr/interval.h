/* Interval arithmetic, as far as bounds of a value (expr_bound_value.c) and of its partials (expr_gradient.c) both need
 * it. Private to the expr_* files.
 *
 * An operation's bounds are computed in the usual rounding and then widened by more than its error, so
 * they hold for the exact value and for the evaluated one. Zero stays zero, so that 0 <= u^2 is kept, and what does
 * not depend on a variable has the partial 0..0.
 */
#ifndef KAGE_EXPR_INTERVAL_H
#define KAGE_EXPR_INTERVAL_H

#include "expr/program.h"
#include "math/kmath.h"

typedef struct interval {
    double lo, hi;
} interval;

static const interval everything = {-KM_INF, KM_INF};

static inline double least(double x, double y) { return x < y ? x : y; }
static inline double most(double x, double y) { return x > y ? x : y; }
static inline interval hull(interval a, interval b) { return (interval){least(a.lo, b.lo), most(a.hi, b.hi)}; }
static inline interval negative(interval a) { return (interval){-a.hi, -a.lo}; }
static inline bool contains(interval a, double x) { return a.lo <= x && x <= a.hi; }
static inline bool is_point(interval a, double x) { return a.lo == x && a.hi == x; }

/* NaN: the ends are infinities that cancel, or the operation is defined nowhere. */
static inline interval known(interval a)
{
    return (interval){a.lo == a.lo ? a.lo : -KM_INF, a.hi == a.hi ? a.hi : KM_INF};
}

/* The part of a in lo..hi; everything where there is none, for then no point is in the domain. */
static inline interval clip(interval a, double lo, double hi)
{
    interval c = {most(a.lo, lo), least(a.hi, hi)};
    return c.lo <= c.hi ? c : (interval){lo, hi};
}

/* The errors: half an ulp for one operation of the hardware; 2 ulp for those of kmath.h, 8 for a power that
 * is multiplied out. */
#define ONE_ROUNDING 2.3e-16
#define SOME_ROUNDINGS 4e-15
#define TINY 1e-305 /* counts only where numbers are too small to round relatively */

/* How much to move an end. 0 is exact. */
static inline double margin(double x, double relative) { return x == 0 ? 0 : relative * fabs(x) + TINY; }

static inline interval widen(interval a, double relative)
{
    return known((interval){a.lo - margin(a.lo, relative), a.hi + margin(a.hi, relative)});
}

static inline interval magnitude(interval a)
{
    double l = fabs(a.lo), h = fabs(a.hi);
    return (interval){contains(a, 0) ? 0 : least(l, h), most(l, h)};
}

/* x y at two ends: 0 times infinity is 0, since infinity only bounds what is finite; and a product
 * that underflows is not 0. */
static inline interval end_product(double x, double y)
{
    double p = x == 0 || y == 0 ? 0 : x * y;
    if (p == 0 && x != 0 && y != 0)
        return (x > 0) == (y > 0) ? (interval){0, TINY} : (interval){-TINY, 0};
    return (interval){p, p};
}

static inline interval multiply(interval a, interval b)
{
    interval z = hull(hull(end_product(a.lo, b.lo), end_product(a.lo, b.hi)),
                      hull(end_product(a.hi, b.lo), end_product(a.hi, b.hi)));
    return widen(z, ONE_ROUNDING);
}

static inline interval add(interval a, interval b) { return widen((interval){a.lo + b.lo, a.hi + b.hi}, ONE_ROUNDING); }

static inline interval reciprocal(interval b)
{
    if ((b.lo < 0 && b.hi > 0) || (b.lo == 0 && b.hi == 0))
        return everything;
    interval z = {b.hi == 0 ? -KM_INF : 1 / b.hi, b.lo == 0 ? KM_INF : 1 / b.lo};
    return widen(z, ONE_ROUNDING);
}

/* Bounds of noise() and of its partials. */
typedef struct noise_bounds {
    interval f, x, y, xx, xy, yy;
} noise_bounds;

noise_bounds expr_noise_range(interval a, interval b);

/* Bounds of the value of one operation, from those of its operands in their slots. */
interval expr_value_range(const expr_code *p, const interval *slot);

#endif
