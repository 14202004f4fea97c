/* Constants, sums, products and quotients as operations. */
#include "expr/operation.h"
#include "expr/rule.h"

#define OPERATION(f, n, ...)                                                                                           \
    {                                                                                                                  \
        .operands = n, .value = f##_value, .gradient = f##_gradient, __VA_ARGS__                                       \
    }

/* ---- constants ---- */

static interval constant_value(const expr_ranges *r) { return interval_at(r->k); }

const expr_op expr_constant = {.steps = true, .run = jets_fill, .value = constant_value};

/* ---- sums ---- */

static interval add_k_value(const expr_ranges *r) { return interval_add(r->x[0], interval_at(r->k)); }
static interval add_value(const expr_ranges *r) { return interval_add(r->x[0], r->x[1]); }
static interval subtract_value(const expr_ranges *r) { return interval_add(r->x[0], interval_negate(r->x[1])); }

static expr_gradient add_gradient(const expr_ranges *r)
{
    (void)r;
    return (expr_gradient){{{1, 1}, {1, 1}}};
}

static expr_gradient subtract_gradient(const expr_ranges *r)
{
    (void)r;
    return (expr_gradient){{{1, 1}, {-1, -1}}};
}

const expr_op expr_add_k = {.operands = 1, .run = jets_shift, .value = add_k_value, .gradient = add_gradient};
const expr_op expr_add = OPERATION(add, 2, .run = jets_add, .pov = " + ", .binding = EXPR_SUM);
const expr_op expr_subtract = OPERATION(subtract, 2, .run = jets_subtract, .pov = " - ", .binding = EXPR_SUM);

/* ---- products ---- */

static interval multiply_k_value(const expr_ranges *r) { return interval_multiply(r->x[0], interval_at(r->k)); }
static interval multiply_value(const expr_ranges *r)
{
    return r->same ? interval_square(r->x[0]) : interval_multiply(r->x[0], r->x[1]);
}

static expr_gradient multiply_k_gradient(const expr_ranges *r)
{
    return (expr_gradient){{interval_known(interval_at(r->k))}};
}

static expr_gradient multiply_gradient(const expr_ranges *r) { return (expr_gradient){{r->x[1], r->x[0]}}; }
static expr_hessian multiply_hessian(const expr_ranges *r)
{
    (void)r;
    return (expr_hessian){{{0, 0}, {1, 1}}};
}

const expr_op expr_multiply_k = OPERATION(multiply_k, 1, .run = jets_scale);
const expr_op expr_multiply = OPERATION(multiply, 2, .run = jets_multiply, .curved = EXPR_AB,
                                        .hessian = multiply_hessian, .pov = "*", .binding = EXPR_PRODUCT);

/* ---- quotients ---- */

/* a/0 has no value: of an infinite one, atan and tanh would be finite, on one side of the pole only. */
KM_INLINE rule2 divide_at(double a, double b)
{
    double f = b == 0 ? KM_NAN : a / b, r = 1 / b;
    return (rule2){f, r, -f * r, 0, -r * r, 2 * f * r * r};
}

RULE2(divide)

static interval divide_value(const expr_ranges *r) { return interval_multiply(r->x[0], interval_reciprocal(r->x[1])); }

static expr_gradient divide_gradient(const expr_ranges *r)
{
    const interval i = interval_reciprocal(r->x[1]);
    return (expr_gradient){{i, interval_negate(interval_multiply(r->f, i))}};
}

static expr_hessian divide_hessian(const expr_ranges *r)
{
    const interval i2 = interval_square(interval_reciprocal(r->x[1]));
    return (expr_hessian){{{0, 0}, interval_negate(i2), {0, 0}, interval_scale(2, interval_multiply(r->f, i2))}};
}

const expr_op expr_divide = OPERATION(divide, 2, .rule2 = rule_divide, .curved = EXPR_AB | EXPR_BB,
                                      .hessian = divide_hessian, .pov = "/", .binding = EXPR_PRODUCT);
