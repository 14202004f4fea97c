/* Constants, sums, products and quotients as operations. */
#include "expr/operation.h"
#include "expr/rule.h"

/* ---- constants ---- */

static void run_constant(const expr_code *c, int n, int order, expr_view z, const expr_view *x)
{
    (void)order, (void)x;
    jets_fill(n, z, c->k);
}

static interval constant_value(const expr_ranges *r) { return interval_at(r->k); }
static expr_gradient constant_gradient(const expr_ranges *r)
{
    (void)r;
    return (expr_gradient){{{0, 0}}};
}

const expr_op expr_constant = {
    .steps = true, .run = run_constant, .value = constant_value, .gradient = constant_gradient};

/* ---- sums ---- */

static void run_add_k(const expr_code *c, int n, int order, expr_view z, const expr_view *x)
{
    (void)order;
    jets_shift(n, z, x[0], c->k);
}

static void run_add(const expr_code *c, int n, int order, expr_view z, const expr_view *x)
{
    (void)c, (void)order;
    jets_add(n, z, x[0], x[1]);
}

static void run_subtract(const expr_code *c, int n, int order, expr_view z, const expr_view *x)
{
    (void)c, (void)order;
    jets_subtract(n, z, x[0], x[1]);
}

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

const expr_op expr_add_k = {.operands = 1, .run = run_add_k, .value = add_k_value, .gradient = add_gradient};
const expr_op expr_add = {
    .operands = 2, .run = run_add, .value = add_value, .gradient = add_gradient, .pov = " + ", .binding = EXPR_SUM};
const expr_op expr_subtract = {.operands = 2,
                               .run = run_subtract,
                               .value = subtract_value,
                               .gradient = subtract_gradient,
                               .pov = " - ",
                               .binding = EXPR_SUM};

/* ---- products ---- */

static void run_multiply_k(const expr_code *c, int n, int order, expr_view z, const expr_view *x)
{
    (void)order;
    jets_scale(n, z, x[0], c->k);
}

static void run_multiply(const expr_code *c, int n, int order, expr_view z, const expr_view *x)
{
    (void)c, (void)order;
    jets_multiply(n, z, x[0], x[1]);
}

static interval multiply_k_value(const expr_ranges *r) { return interval_multiply(r->x[0], interval_at(r->k)); }
static interval multiply_value(const expr_ranges *r)
{
    return r->same ? interval_square(r->x[0]) : interval_multiply(r->x[0], r->x[1]);
}

static expr_gradient multiply_k_gradient(const expr_ranges *r) { return (expr_gradient){{interval_at(r->k)}}; }
static expr_gradient multiply_gradient(const expr_ranges *r) { return (expr_gradient){{r->x[1], r->x[0]}}; }
static expr_hessian multiply_hessian(const expr_ranges *r)
{
    (void)r;
    return (expr_hessian){{{0, 0}, {1, 1}}};
}

const expr_op expr_multiply_k = {
    .operands = 1, .run = run_multiply_k, .value = multiply_k_value, .gradient = multiply_k_gradient};
const expr_op expr_multiply = {.operands = 2,
                               .curved = EXPR_AB,
                               .run = run_multiply,
                               .value = multiply_value,
                               .gradient = multiply_gradient,
                               .hessian = multiply_hessian,
                               .pov = "*",
                               .binding = EXPR_PRODUCT};

/* ---- quotients ---- */

KM_INLINE rule2 divide_at(double a, double b)
{
    double f = a / b, r = 1 / b;
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

const expr_op expr_divide = {.operands = 2,
                             .curved = EXPR_AB | EXPR_BB,
                             .run = expr_run_rule,
                             .rule2 = rule_divide,
                             .value = divide_value,
                             .gradient = divide_gradient,
                             .hessian = divide_hessian,
                             .pov = "/",
                             .binding = EXPR_PRODUCT};
