/* Bounds of partials, as far as those of first (expr_gradient.c) and of second order (expr_bend.c) share them. Private
 * to the expr_* files. As everywhere there, 0 times infinity is 0: what does not change, changes nothing.
 */
#ifndef KAGE_EXPR_BOUND_SLOPES_H
#define KAGE_EXPR_BOUND_SLOPES_H

#include "expr/interval.h"

enum { ALONG_U, ALONG_W, DIRECTIONS };

typedef struct slope {
    interval along[DIRECTIONS];
} slope;

/* f_a and f_b of an operation f(a,b) */
typedef struct pair {
    interval a, b;
} pair;

static const interval zero = {0, 0}, one = {1, 1};

/* A term of the chain rule: exact where a factor is 1 or -1, as in sums. */
static inline interval term(interval x, interval y)
{
    if (is_point(x, 1) || is_point(x, -1))
        return x.lo > 0 ? y : negative(y);
    if (is_point(y, 1) || is_point(y, -1))
        return y.lo > 0 ? x : negative(x);
    return multiply(x, y);
}

static inline interval plus(interval x, interval y)
{
    if (is_point(x, 0) || is_point(y, 0))
        return is_point(x, 0) ? y : x;
    return add(x, y);
}

/* The range of another function of the language: derivatives are made of them. */
static inline interval range(enum expr_op op, interval a, interval b)
{
    const expr_code c = {.op = (uint8_t)op, .arg = {0, 1}};
    return expr_value_range(&c, (const interval[]){a, b});
}

static inline interval square(interval a) { return multiply(magnitude(a), magnitude(a)); }

static inline bool expr_chooses(const expr_code *p)
{
    return p->op == OP_MIN || p->op == OP_MAX || p->op == OP_SELECT || p->op == OP_SELECT4;
}

static inline void expr_put_bounds(interval v, slope s, expr_bounds *out)
{
    const interval u = s.along[ALONG_U], w = s.along[ALONG_W];
    *out = (expr_bounds){{v.lo, v.hi}, {u.lo, u.hi}, {w.lo, w.hi}};
}

/* f_a and f_b over all the values of the operands a and b, of an operation that does not choose; f is its own range. */
pair expr_partials_range(const expr_code *p, interval a, interval b, interval f);

/* The slope of one operation, from the values and slopes in its operands' slots; f is its range. */
slope expr_slope_range(const expr_code *p, const interval *value, const slope *s, interval f);

/* Which operands of one that chooses the result is equal to somewhere: bit k for arg[k]. */
int expr_reached(const expr_code *p, const interval *value);

#endif
