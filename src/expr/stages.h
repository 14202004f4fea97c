/* The loops that evaluation is made of: each one plain loop over the first n points of a batch. The result z
 * is never an operand. Part of expr_eval.c; all are static, since clang 14 gives a cloned function another
 * name (f.ifunc) to those who call it from outside its file.
 */
#ifndef KAGE_EXPR_STAGES_H
#define KAGE_EXPR_STAGES_H

#include "expr/program.h"
#include "expr/rules.h"
#include "base/real.h"

STAGE static void stage_fill(int n, double *z, double k)
{
    for (int i = 0; i < n; i++)
        z[i] = k;
}

STAGE static void stage_shift(int n, double *restrict z, const double *restrict x, double k)
{
    for (int i = 0; i < n; i++)
        z[i] = x[i] + k;
}

STAGE static void stage_scale(int n, double *restrict z, const double *restrict x, double k)
{
    for (int i = 0; i < n; i++)
        z[i] = x[i] * k;
}

STAGE static void stage_add(int n, double *restrict z, const double *x, const double *y)
{
    for (int i = 0; i < n; i++)
        z[i] = x[i] + y[i];
}

STAGE static void stage_subtract(int n, double *restrict z, const double *x, const double *y)
{
    for (int i = 0; i < n; i++)
        z[i] = x[i] - y[i];
}

STAGE static void stage_multiply(int n, double *restrict z, const double *x, const double *y)
{
    for (int i = 0; i < n; i++)
        z[i] = x[i] * y[i];
}

/* A term of a partial: 0 times infinity is 0. */
KM_INLINE double product(double x, double y)
{
    double p = x * y;
    p = x == 0 ? 0 : p;
    return y == 0 ? 0 : p;
}

STAGE static void stage_set_product(int n, double *restrict z, const double *x, const double *y)
{
    for (int i = 0; i < n; i++)
        z[i] = product(x[i], y[i]);
}

STAGE static void stage_add_product(int n, double *restrict z, const double *x, const double *y)
{
    for (int i = 0; i < n; i++)
        z[i] += product(x[i], y[i]);
}

STAGE static void stage_set_product3(int n, double *restrict z, const double *x, const double *y, const double *t)
{
    for (int i = 0; i < n; i++)
        z[i] = product(x[i], product(y[i], t[i]));
}

STAGE static void stage_add_product3(int n, double *restrict z, const double *x, const double *y, const double *t)
{
    for (int i = 0; i < n; i++)
        z[i] += product(x[i], product(y[i], t[i]));
}

/* z = x where d < 0, y where d >= 0, NaN where d is NaN. */
STAGE static void stage_choose(int n, double *restrict z, const double *restrict d, const double *x, const double *y)
{
    for (int i = 0; i < n; i++) {
        double left = x[i], right = y[i];
        right = d[i] >= 0 ? right : KM_NAN;
        z[i] = d[i] < 0 ? left : right;
    }
}

/* For choose: -1 where x < y, 1 where x >= y, NaN where either is NaN. */
STAGE static void stage_compare(int n, double *restrict d, const double *x, const double *y)
{
    for (int i = 0; i < n; i++) {
        double right = x[i] >= y[i] ? 1 : KM_NAN;
        d[i] = x[i] < y[i] ? -1 : right;
    }
}

/* For choose: -1 where x = 0, 1 elsewhere, NaN where x is. */
STAGE static void stage_compare_zero(int n, double *restrict d, const double *restrict x)
{
    for (int i = 0; i < n; i++) {
        double right = x[i] == x[i] ? 1 : x[i];
        d[i] = x[i] == 0 ? -1 : right;
    }
}

/* f(a), with order 1 also f' in d, with order 2 also f'' in dd. */
typedef void stage1(int n, int order, const double *restrict a, double *restrict f, double *restrict d,
                    double *restrict dd);

#define STAGE1(name, rule)                                                                                             \
    STAGE static void name(int n, int order, const double *restrict a, double *restrict f, double *restrict d,         \
                           double *restrict dd)                                                                        \
    {                                                                                                                  \
        if (order == 0)                                                                                                \
            for (int i = 0; i < n; i++)                                                                                \
                f[i] = rule(a[i]).f;                                                                                   \
        else if (order == 1)                                                                                           \
            for (int i = 0; i < n; i++) {                                                                              \
                rule1 r = rule(a[i]);                                                                                  \
                f[i] = r.f, d[i] = r.d;                                                                                \
            }                                                                                                          \
        else                                                                                                           \
            for (int i = 0; i < n; i++) {                                                                              \
                rule1 r = rule(a[i]);                                                                                  \
                f[i] = r.f, d[i] = r.d, dd[i] = r.dd;                                                                  \
            }                                                                                                          \
    }

STAGE1(stage_sin, rule_sin)
STAGE1(stage_cos, rule_cos)
STAGE1(stage_tan, rule_tan)
STAGE1(stage_asin, rule_asin)
STAGE1(stage_acos, rule_acos)
STAGE1(stage_atan, rule_atan)
STAGE1(stage_sinh, rule_sinh)
STAGE1(stage_cosh, rule_cosh)
STAGE1(stage_tanh, rule_tanh)
STAGE1(stage_exp, rule_exp)
STAGE1(stage_log, rule_log)
STAGE1(stage_sqrt, rule_sqrt)
STAGE1(stage_abs, rule_abs)
STAGE1(stage_floor, rule_floor)

/* p = a^(k-2) by squaring, then a^k = p a a, k p a and k (k-1) p, which holds at any a. */
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

/* By enum expr_op. */
static stage1 *const stages1[] = {
    [OP_SIN] = stage_sin,   [OP_COS] = stage_cos,     [OP_TAN] = stage_tan,   [OP_ASIN] = stage_asin,
    [OP_ACOS] = stage_acos, [OP_ATAN] = stage_atan,   [OP_SINH] = stage_sinh, [OP_COSH] = stage_cosh,
    [OP_TANH] = stage_tanh, [OP_EXP] = stage_exp,     [OP_LOG] = stage_log,   [OP_SQRT] = stage_sqrt,
    [OP_ABS] = stage_abs,   [OP_FLOOR] = stage_floor,
};

/* The partials of an operation f(a,b). */
typedef struct partials2 {
    double a[EXPR_BATCH], b[EXPR_BATCH], aa[EXPR_BATCH], ab[EXPR_BATCH], bb[EXPR_BATCH];
} partials2;

/* f(a,b), with order 1 also the first partials, with order 2 also the second. */
typedef void stage2(int n, int order, const double *restrict a, const double *restrict b, double *restrict f,
                    partials2 *restrict d);

#define STAGE2(name, rule)                                                                                             \
    STAGE static void name(int n, int order, const double *restrict a, const double *restrict b, double *restrict f,   \
                           partials2 *restrict d)                                                                      \
    {                                                                                                                  \
        if (order == 0)                                                                                                \
            for (int i = 0; i < n; i++)                                                                                \
                f[i] = rule(a[i], b[i]).f;                                                                             \
        else if (order == 1)                                                                                           \
            for (int i = 0; i < n; i++) {                                                                              \
                rule2 r = rule(a[i], b[i]);                                                                            \
                f[i] = r.f, d->a[i] = r.a, d->b[i] = r.b;                                                              \
            }                                                                                                          \
        else                                                                                                           \
            for (int i = 0; i < n; i++) {                                                                              \
                rule2 r = rule(a[i], b[i]);                                                                            \
                f[i] = r.f, d->a[i] = r.a, d->b[i] = r.b;                                                              \
                d->aa[i] = r.aa, d->ab[i] = r.ab, d->bb[i] = r.bb;                                                     \
            }                                                                                                          \
    }

STAGE2(stage_div, rule_div)
STAGE2(stage_mod, rule_mod)
STAGE2(stage_atan2, rule_atan2)
STAGE2(stage_pow, rule_pow)
STAGE2(stage_noise, rule_noise)

static stage2 *const stages2[] = {[OP_DIV] = stage_div,
                                  [OP_MOD] = stage_mod,
                                  [OP_ATAN2] = stage_atan2,
                                  [OP_POW] = stage_pow,
                                  [OP_NOISE] = stage_noise};

#endif
