/* Functions of two and three operands, and powers: the rule of each, the bounds of its value and partials, and the
 * table of all. Bounds of second partials are in the order aa ab ac bb bc cc.
 */
#include "expr/operation.h"
#include "expr/rule.h"
#include "math/noise.h"

/* ---- noise ---- */

KM_INLINE rule2 gradient_noise_at(double a, double b)
{
    noise_jet n = noise_at(a, b);
    return (rule2){n.f, n.x, n.y, n.xx, n.xy, n.yy};
}

RULE2(gradient_noise)

static interval gradient_noise_value(const expr_ranges *r) { return noise_bounds_over(r->x[0], r->x[1]).f; }

static expr_gradient gradient_noise_gradient(const expr_ranges *r)
{
    const noise_bounds n = noise_bounds_over(r->x[0], r->x[1]);
    return (expr_gradient){{n.x, n.y}};
}

static expr_hessian gradient_noise_hessian(const expr_ranges *r)
{
    const noise_bounds n = noise_bounds_over(r->x[0], r->x[1]);
    return (expr_hessian){{n.xx, n.xy, {0, 0}, n.yy}};
}

/* ---- atan2 ---- */

/* The angle of the point (b,a). */
KM_INLINE rule2 atan2_at(double a, double b)
{
    double r = 1 / (a * a + b * b), x = b * r, y = a * r;
    return (rule2){km_atan2(a, b), x, -y, -2 * x * y, y * y - x * x, 2 * x * y};
}

RULE2(atan2)

static interval atan2_value(const expr_ranges *r) { return interval_atan2(r->x[0], r->x[1]); }

/* Across the cut along b <= 0 the angle jumps; on it, too, since a may be -0. */
static bool on_cut(const expr_ranges *r) { return r->x[1].lo <= 0 && interval_has(r->x[0], 0); }

static interval distance_squared(const expr_ranges *r)
{
    return interval_add(interval_square(r->x[0]), interval_square(r->x[1]));
}

/* t / (a^2 + b^2), with t = b or -a: nowhere more than 1 / sqrt(a^2 + b^2). */
static interval angle_by(interval t, interval r2)
{
    interval z = interval_multiply(t, interval_reciprocal(r2));
    double steepest = interval_reciprocal(interval_sqrt(r2)).hi * (1 + INTERVAL_ROUNDINGS);
    return interval_widen((interval){greater(z.lo, -steepest), lesser(z.hi, steepest)}, INTERVAL_ROUNDINGS);
}

static expr_gradient atan2_gradient(const expr_ranges *r)
{
    if (on_cut(r))
        return (expr_gradient){{interval_all, interval_all}};
    const interval r2 = distance_squared(r);
    return (expr_gradient){{angle_by(r->x[1], r2), angle_by(interval_negate(r->x[0]), r2)}};
}

/* With x = b/r^2 and y = a/r^2: -2xy, y^2 - x^2 and 2xy. */
static expr_hessian atan2_hessian(const expr_ranges *r)
{
    if (on_cut(r))
        return (expr_hessian){{interval_all, interval_all, {0, 0}, interval_all}};
    const interval i = interval_reciprocal(distance_squared(r));
    const interval x = interval_multiply(r->x[1], i), y = interval_multiply(r->x[0], i);
    const interval xy = interval_scale(2, interval_multiply(x, y));
    const interval ab = interval_add(interval_square(y), interval_negate(interval_square(x)));
    return (expr_hessian){{interval_negate(xy), ab, {0, 0}, xy}};
}

/* ---- mod ---- */

/* a - b trunc(a/b), where trunc is constant. */
KM_INLINE rule2 mod_at(double a, double b)
{
    double f = km_mod(a, b), q = km_round((a - f) / b);
    return (rule2){f, 1, -q, 0, 0, 0};
}

RULE2(mod)

static interval mod_value(const expr_ranges *r) { return interval_mod(r->x[0], r->x[1]); }

/* 1 and -trunc(a/b), which jumps where the quotient crosses an integer other than 0. */
static expr_gradient mod_gradient(const expr_ranges *r)
{
    interval q = interval_multiply(r->x[0], interval_reciprocal(r->x[1]));
    double lo = q.lo < 0 ? ceil(q.lo) : floor(q.lo), hi = q.hi < 0 ? ceil(q.hi) : floor(q.hi);
    if (lo != hi || !(fabs(lo) < KM_TWO52))
        return (expr_gradient){{interval_all, interval_all}};
    return (expr_gradient){{interval_one, interval_at(-lo)}};
}

static expr_hessian mod_hessian(const expr_ranges *r)
{
    const bool jumps = !interval_is_point(mod_gradient(r).d[1]);
    return jumps ? (expr_hessian){{interval_all, interval_all, {0, 0}, interval_all}} : (expr_hessian){{{0, 0}}};
}

/* ---- smoothstep ---- */

/* s(t) = t^2 (3 - 2t) with t = (x - a) / (b - a) between 0 and 1, and beyond that 0 or 1, without slope; so it is a
 * step where b = a. At the edges the second partials are 0, those of the outer side. */
KM_INLINE rule3 smoothstep_at(double a, double b, double x)
{
    double t = (x - a) / (b - a), c = t < 0 ? 0 : t, d = t > 0 ? 1 / (b - a) : 0; /* NaN stays NaN */
    c = c > 1 ? 1 : c;
    d = t < 1 ? d : 0; /* 1/(b - a) between, 0 beyond */
    double s1 = 6 * c * (1 - c) * d, s2 = (6 - 12 * c) * d * d, s1d = s1 * d;
    return (rule3){.f = c * c * (3 - 2 * c),
                   .a = s1 * (c - 1),
                   .b = -s1 * c,
                   .c = s1,
                   .aa = (2 * s1d + s2 * (c - 1)) * (c - 1),
                   .ab = 2 * s1d * (1 - 2 * c),
                   .ac = s1d + s2 * (c - 1),
                   .bb = (2 * s1d + s2 * c) * c,
                   .bc = -s1d - s2 * c,
                   .cc = s2};
}

RULE3(smoothstep)

/* Bounds of t in 0..1, 1/(b - a), s' and s''. */
typedef struct step_bounds {
    interval t, d, s1, s2;
} step_bounds;

static step_bounds step_over(const expr_ranges *r)
{
    const interval a = interval_negate(r->x[0]), width = interval_add(r->x[1], a);
    const interval d = interval_has(width, 0) ? interval_all : interval_reciprocal(width); /* it jumps where b = a */
    const interval t = interval_multiply(interval_add(r->x[2], a), d);
    const double lo = lesser(greater(t.lo, 0), 1), hi = lesser(greater(t.hi, 0), 1);
    step_bounds z = {{lo, hi}, d, interval_between(6 * lo * (1 - lo), 6 * hi * (1 - hi)), {0, 0}};
    if (lo <= 0.5 && hi >= 0.5)
        z.s1.hi = 1.5 * (1 + INTERVAL_ROUNDINGS);
    if (lo < hi || (t.lo > 0 && t.hi < 1))
        z.s2 = interval_between(6 - 12 * lo, 6 - 12 * hi);
    if (t.lo <= 0 || t.hi >= 1)
        z.s2 = interval_hull(z.s2, interval_zero);
    return z;
}

static interval smoothstep_value(const expr_ranges *r)
{
    const interval t = step_over(r).t;
    return interval_clip(interval_between(t.lo * t.lo * (3 - 2 * t.lo), t.hi * t.hi * (3 - 2 * t.hi)), 0, 1);
}

static expr_gradient smoothstep_gradient(const expr_ranges *r)
{
    const step_bounds s = step_over(r);
    const interval by_x = interval_multiply(s.s1, s.d), less = interval_add(s.t, interval_at(-1));
    return (expr_gradient){{interval_multiply(by_x, less), interval_negate(interval_multiply(by_x, s.t)), by_x}};
}

/* With t_a = (t - 1) d, t_b = -t d and t_x = d: s' t_ij + s'' t_i t_j. */
static expr_hessian smoothstep_hessian(const expr_ranges *r)
{
    const step_bounds s = step_over(r);
    const interval d2 = interval_square(s.d), t = s.t, u = interval_add(t, interval_at(-1));
    const interval s1 = interval_multiply(s.s1, d2), s2 = interval_multiply(s.s2, d2), twice = interval_scale(2, s1);
    const interval middle = interval_add(interval_one, interval_scale(-2, t));
    const interval ac = interval_add(s1, interval_multiply(s2, u)), bc = interval_add(s1, interval_multiply(s2, t));
    return (expr_hessian){{
        interval_multiply(interval_add(twice, interval_multiply(s2, u)), u),
        interval_multiply(twice, middle),
        ac,
        interval_multiply(interval_add(twice, interval_multiply(s2, t)), t),
        interval_negate(bc),
        s2,
    }};
}

/* ---- powers ---- */

/* a^b. At a = 0 < b, where f/a is 0/0, the limits along a stand, and 0 for what depends on b. */
KM_INLINE rule2 pow_at(double a, double b)
{
    double f = km_pow(a, b), l = km_log(a), g = f / a, d = b * g, dd = b * (b - 1) * (g / a);
    double d0 = b == 1 ? 1 : KM_INF, dd0 = b == 2 ? 2 : KM_INF, steep = b == 1 ? 0 : -KM_INF;
    d0 = b > 1 ? 0 : d0;
    dd0 = b > 2 ? 0 : dd0;
    dd0 = b > 1 ? dd0 : steep;
    int origin = a == 0 && b > 0;
    g = origin ? 0 : g;
    l = origin ? 0 : l;
    return (rule2){f, origin ? d0 : d, f * l, origin ? dd0 : dd, g * (1 + b * l), f * l * l};
}

RULE2(pow)

static interval pow_value(const expr_ranges *r) { return interval_pow(r->x[0], r->x[1]); }

/* b a^(b-1) */
static interval pow_by_base(interval a, interval b)
{
    bool integer = interval_is_point(b) && km_floor(b.lo) == b.lo; /* then b - 1 is one, too: a may be negative */
    if (a.lo < 0 && !integer) {
        if (!interval_is_point(b)) /* defined at isolated b */
            return interval_all;
        a = interval_clip(a, 0, KM_INF);
    }
    const interval less = integer ? interval_at(b.lo - 1) : interval_add(b, interval_at(-1));
    return interval_multiply(b, interval_pow(a, less));
}

/* and a^b log a */
static expr_gradient pow_gradient(const expr_ranges *r)
{
    const interval a = r->x[0];
    return (expr_gradient){
        {pow_by_base(a, r->x[1]), a.lo < 0 ? interval_all : interval_multiply(r->f, interval_log(a))}};
}

static expr_hessian pow_hessian(const expr_ranges *r)
{
    const interval a = r->x[0], b = r->x[1];
    if (!interval_is_point(b) || a.lo <= 0)
        return (expr_hessian){{interval_all, interval_all, {0, 0}, interval_all}};
    const interval p = interval_pow(a, interval_at(b.lo - 2));
    return (expr_hessian){{interval_scale(b.lo * (b.lo - 1), p), interval_all, {0, 0}, interval_all}};
}

/* a^k, with p = a^(k-2) by squaring: a^k = p a a, k p a and k (k-1) p, which holds at any a. */
STAGE static void stage_powi(int n, int order, const double *restrict a, double k, double *restrict f,
                             double *restrict d, double *restrict dd)
{
    int power = (int)k - 2, bit = EXPR_MAX_POWER;
    for (int i = 0; i < n; i++)
        f[i] = 1;
    while (bit > power)
        bit >>= 1;
    for (; bit; bit >>= 1) {
        for (int i = 0; i < n; i++)
            f[i] *= f[i];
        if (power & bit)
            for (int i = 0; i < n; i++)
                f[i] *= a[i];
    }
    if (order > 1)
        for (int i = 0; i < n; i++)
            dd[i] = k * (k - 1) * f[i];
    if (order > 0)
        for (int i = 0; i < n; i++)
            d[i] = k * (f[i] * a[i]);
    for (int i = 0; i < n; i++)
        f[i] = f[i] * a[i] * a[i];
}

static void run_powi(int n, expr_view z, const expr_view *x, double k)
{
    const int order = z.has & HAS_SECOND ? 2 : z.has & HAS_FIRST ? 1 : 0;
    expr_partials p;
    stage_powi(n, order, expr_part(x[0], PART_V), k, expr_part(z, PART_V), p.d[0], p.dd[0]);
    jets_chain(n, z, 1, x, &p, EXPR_AA);
}

static interval powi_value(const expr_ranges *r) { return interval_pow(r->x[0], interval_at(r->k)); }

static expr_gradient powi_gradient(const expr_ranges *r)
{
    return (expr_gradient){{pow_by_base(r->x[0], interval_at(r->k))}};
}

static expr_hessian powi_hessian(const expr_ranges *r)
{
    const interval a = r->x[0], p = r->k == 2 ? interval_one : r->k == 3 ? a : interval_pow(a, interval_at(r->k - 2));
    return (expr_hessian){{interval_scale(r->k * (r->k - 1), p)}};
}

const expr_op expr_power_k = {.operands = 1,
                              .curved = EXPR_AA,
                              .run = run_powi,
                              .value = powi_value,
                              .gradient = powi_gradient,
                              .hessian = powi_hessian,
                              .pov = "pow"};

/* a^k for those k that are cheaper, and more exact, without logarithm. */
static operand build_pow(emitter *e, int n, const operand *arg)
{
    const operand a = arg[0], b = arg[1];
    const double k = b.k;
    if (a.constant || !b.constant)
        return expr_emit(e, &expr_pow, n, arg);
    if (k == 0)
        return expr_emit_constant(1);
    if (k == 0.5)
        return expr_emit(e, &expr_sqrt, 1, &a);
    if (k != floor(k) || fabs(k) > EXPR_MAX_POWER)
        return expr_emit(e, &expr_pow, n, arg);
    const operand z = fabs(k) == 1 ? a : expr_emit_with(e, &expr_power_k, a, fabs(k));
    return k > 0 ? z : expr_emit(e, &expr_divide, 2, (operand[]){expr_emit_constant(1), z});
}

/* ---- the table ---- */

#define ROW(text, f, n, ...)                                                                                           \
    {                                                                                                                  \
        .name = text, .least = n, .most = n, .operands = n, .value = f##_value, .gradient = f##_gradient,              \
        .hessian = f##_hessian, __VA_ARGS__                                                                            \
    }

const expr_op expr_pow = ROW("pow", pow, 2, .rule2 = rule_pow, .build = build_pow, .curved = EXPR_ALL, .pov = "pow");

const expr_op *const expr_functions[] = {
    &(const expr_op)ROW("noise", gradient_noise, 2, .rule2 = rule_gradient_noise, .curved = EXPR_ALL),
    &(const expr_op)ROW("atan2", atan2, 2, .rule2 = rule_atan2, .curved = EXPR_ALL, .pov = "atan2"),
    &(const expr_op)ROW("mod", mod, 2, .rule2 = rule_mod, .pov = "mod"),
    &expr_pow,
    /* the formula has $3 once: t^2 (3 - 2t) = 1/2 + 1/2 sin(3 asin(t - 1/2)) */
    &(const expr_op)ROW("smoothstep", smoothstep, 3, .rule3 = rule_smoothstep, .curved = EXPR_ALL,
                        .pov = "0.5 + 0.5*sin(3*asin(min(max(($3 - $1)/($2 - $1), 0), 1) - 0.5))"),
    NULL,
};
