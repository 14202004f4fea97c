/* The elementary functions: the rule of each, the bounds of its value and derivatives, and the table of all. */
#include "expr/operation.h"
#include "expr/rule.h"

/* The loop over a function's rule, and the range of its value. */
#define FUNCTION(f)                                                                                                    \
    RULE1(f)                                                                                                           \
    static interval f##_value(const expr_ranges *r) { return interval_##f(r->x[0]); }

static expr_gradient slope(interval d) { return (expr_gradient){{d}}; }
static expr_hessian second(interval dd) { return (expr_hessian){{dd}}; }

/* The range of a positive, monotonic derivative from its values at the ends. Values below 1e-300 are inexact, because
 * of underflow and of the cut in tanh_at, and become 0 below and INTERVAL_TINY above. */
static interval positive(double x, double y)
{
    interval z = interval_between(x, y);
    return (interval){z.lo > 1e-300 ? z.lo : 0, greater(z.hi, INTERVAL_TINY)};
}

static interval at_least_0(interval a) { return interval_clip(a, 0, KM_INF); }

/* ---- sin, cos, tan ---- */

KM_INLINE rule1 sin_at(double a)
{
    double s = km_sin(a), c = km_cos(a);
    return (rule1){s, c, -s};
}

KM_INLINE rule1 cos_at(double a)
{
    double s = km_sin(a), c = km_cos(a);
    return (rule1){c, -s, -c};
}

KM_INLINE rule1 tan_at(double a)
{
    double t = km_tan(a), d = 1 + t * t;
    return (rule1){t, d, 2 * t * d};
}

FUNCTION(sin)
FUNCTION(cos)
FUNCTION(tan)

static expr_gradient sin_gradient(const expr_ranges *r) { return slope(interval_cos(r->x[0])); }
static expr_gradient cos_gradient(const expr_ranges *r) { return slope(interval_negate(interval_sin(r->x[0]))); }
static expr_gradient tan_gradient(const expr_ranges *r)
{
    return slope(interval_add(interval_one, interval_square(r->f)));
}

static expr_hessian sin_hessian(const expr_ranges *r) { return second(interval_negate(r->f)); }
static expr_hessian cos_hessian(const expr_ranges *r) { return second(interval_negate(r->f)); }
static expr_hessian tan_hessian(const expr_ranges *r)
{
    return second(interval_scale(2, interval_multiply(r->f, tan_gradient(r).d[0])));
}

/* ---- asin, acos, atan ---- */

KM_INLINE rule1 asin_at(double a)
{
    double d = 1 / sqrt((1 - a) * (1 + a));
    return (rule1){km_asin(a), d, a * d * d * d};
}

KM_INLINE rule1 acos_at(double a)
{
    double d = 1 / sqrt((1 - a) * (1 + a));
    return (rule1){km_acos(a), -d, -a * d * d * d};
}

KM_INLINE rule1 atan_at(double a)
{
    double d = 1 / (1 + a * a);
    return (rule1){km_atan(a), d, -2 * a * d * d};
}

FUNCTION(asin)
FUNCTION(acos)
FUNCTION(atan)

/* (1 - a^2)^(-1/2) and a (1 - a^2)^(-3/2): the first grows with |a|, the second with a. */
static interval asin_slope(interval a)
{
    const interval m = interval_abs(interval_clip(a, -1, 1));
    return positive(asin_at(m.lo).d, asin_at(m.hi).d);
}

static interval asin_second(interval a)
{
    const interval z = interval_clip(a, -1, 1);
    return interval_widen((interval){asin_at(z.lo).dd, asin_at(z.hi).dd}, 2 * INTERVAL_ROUNDINGS);
}

static expr_gradient asin_gradient(const expr_ranges *r) { return slope(asin_slope(r->x[0])); }
static expr_gradient acos_gradient(const expr_ranges *r) { return slope(interval_negate(asin_slope(r->x[0]))); }
static expr_gradient atan_gradient(const expr_ranges *r)
{
    const interval m = interval_abs(r->x[0]);
    return slope(positive(atan_at(m.lo).d, atan_at(m.hi).d));
}

static expr_hessian asin_hessian(const expr_ranges *r) { return second(asin_second(r->x[0])); }
static expr_hessian acos_hessian(const expr_ranges *r) { return second(interval_negate(asin_second(r->x[0]))); }
static expr_hessian atan_hessian(const expr_ranges *r)
{
    const interval d2 = interval_square(atan_gradient(r).d[0]);
    return second(interval_scale(-2, interval_multiply(r->x[0], d2)));
}

/* ---- sinh, cosh, tanh ---- */

KM_INLINE rule1 sinh_at(double a)
{
    double s = km_sinh(a);
    return (rule1){s, km_cosh(a), s};
}

KM_INLINE rule1 cosh_at(double a)
{
    double c = km_cosh(a);
    return (rule1){c, km_sinh(a), c};
}

/* 1 - tanh^2 = 4 (e + 1) / (e + 2)^2 with e = exp(2|a|) - 1, which does not cancel. */
KM_INLINE rule1 tanh_at(double a)
{
    double t = km_tanh(a), e = km_expm1_twice(a), d = 4 / (e + 2) * ((e + 1) / (e + 2));
    return (rule1){t, d, -2 * t * d};
}

FUNCTION(sinh)
FUNCTION(cosh)
FUNCTION(tanh)

static expr_gradient sinh_gradient(const expr_ranges *r) { return slope(interval_cosh(r->x[0])); }
static expr_gradient cosh_gradient(const expr_ranges *r) { return slope(interval_sinh(r->x[0])); }
static expr_gradient tanh_gradient(const expr_ranges *r)
{
    const interval m = interval_abs(r->x[0]);
    return slope(positive(tanh_at(m.lo).d, tanh_at(m.hi).d));
}

static expr_hessian sinh_hessian(const expr_ranges *r) { return second(r->f); }
static expr_hessian cosh_hessian(const expr_ranges *r) { return second(r->f); }
static expr_hessian tanh_hessian(const expr_ranges *r)
{
    return second(interval_scale(-2, interval_multiply(r->f, tanh_gradient(r).d[0])));
}

/* ---- exp, log, sqrt ---- */

KM_INLINE rule1 exp_at(double a)
{
    double e = km_exp(a);
    return (rule1){e, e, e};
}

KM_INLINE rule1 log_at(double a)
{
    double d = 1 / a;
    return (rule1){km_log(a), d, -d * d};
}

/* At 0: value 0, derivative +infinite. */
KM_INLINE rule1 sqrt_at(double a)
{
    double s = sqrt(a), d = 0.5 / s;
    return (rule1){s, d, -0.5 * d / a};
}

FUNCTION(exp)
FUNCTION(log)
FUNCTION(sqrt)

static expr_gradient exp_gradient(const expr_ranges *r) { return slope(r->f); }
static expr_gradient log_gradient(const expr_ranges *r) { return slope(interval_reciprocal(at_least_0(r->x[0]))); }
static expr_gradient sqrt_gradient(const expr_ranges *r)
{
    const interval z = at_least_0(r->x[0]);
    return slope(positive(sqrt_at(z.lo).d, sqrt_at(z.hi).d));
}

static expr_hessian exp_hessian(const expr_ranges *r) { return second(r->f); }
static expr_hessian log_hessian(const expr_ranges *r)
{
    return second(interval_negate(interval_square(log_gradient(r).d[0])));
}

/* -1 / (4 a sqrt a) */
static expr_hessian sqrt_hessian(const expr_ranges *r)
{
    const interval z = at_least_0(r->x[0]);
    return second(interval_scale(-0.25, interval_reciprocal(interval_multiply(z, interval_sqrt(z)))));
}

/* ---- abs, floor ---- */

/* The derivative at the edge is that of neither side, but 0. */
KM_INLINE rule1 abs_at(double a)
{
    double right = a > 0 ? 1 : 0, left = a < 0 ? 1 : 0;
    return (rule1){fabs(a), right - left, 0};
}

KM_INLINE rule1 floor_at(double a) { return (rule1){km_floor(a), 0, 0}; }

FUNCTION(abs)
FUNCTION(floor)

static expr_gradient abs_gradient(const expr_ranges *r)
{
    const interval a = r->x[0];
    return slope((interval){a.lo < 0 ? -1 : a.lo > 0, a.hi > 0 ? 1 : -(a.hi < 0)});
}

static expr_gradient floor_gradient(const expr_ranges *r)
{
    return slope(interval_is_point(r->f) ? interval_zero : interval_all);
}

static expr_hessian abs_hessian(const expr_ranges *r)
{
    return second(r->x[0].lo >= 0 || r->x[0].hi <= 0 ? interval_zero : interval_all);
}

static expr_hessian floor_hessian(const expr_ranges *r) { return second(floor_gradient(r).d[0]); }

/* ---- the table ---- */

#define ELEMENTARY(f, text, ...)                                                                                       \
    {                                                                                                                  \
        .name = #f, .least = 1, .most = 1, .operands = 1, .rule1 = rule_##f, .value = f##_value,                       \
        .gradient = f##_gradient, .hessian = f##_hessian, .pov = text, __VA_ARGS__                                     \
    }
#define ROW(f, text, ...) &(const expr_op)ELEMENTARY(f, text, __VA_ARGS__)
#define CURVED(f, text) ROW(f, text, .curved = EXPR_AA)

const expr_op expr_sqrt = ELEMENTARY(sqrt, "sqrt", .curved = EXPR_AA);

const expr_op *const expr_elementary[] = {
    CURVED(sin, "sin"),
    CURVED(cos, "cos"),
    CURVED(tan, "tan"),
    CURVED(asin, "asin"),
    CURVED(acos, "acos"),
    CURVED(atan, "atan"),
    CURVED(sinh, "sinh"),
    CURVED(cosh, "cosh"),
    CURVED(tanh, "tanh"),
    CURVED(exp, "exp"),
    CURVED(log, "ln"),
    &expr_sqrt,
    ROW(abs, "abs", .curved = 0),
    ROW(floor, "floor", .steps = true),
    NULL,
};
