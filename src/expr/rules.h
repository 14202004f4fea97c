/* The value and the first and second derivatives of each operation at one point. The loops of
 * expr_stages.h call these; what a loop does not use, the compiler leaves out.
 */
#ifndef KAGE_EXPR_RULES_H
#define KAGE_EXPR_RULES_H

#include "math/kmath.h"
#include "math/noise.h"

/* f(a), df/da, d2f/da2 */
typedef struct rule1 {
    double f, d, dd;
} rule1;

KM_INLINE rule1 rule_sin(double a)
{
    double s = km_sin(a), c = km_cos(a);
    return (rule1){s, c, -s};
}

KM_INLINE rule1 rule_cos(double a)
{
    double s = km_sin(a), c = km_cos(a);
    return (rule1){c, -s, -c};
}

KM_INLINE rule1 rule_tan(double a)
{
    double t = km_tan(a), d = 1 + t * t;
    return (rule1){t, d, 2 * t * d};
}

KM_INLINE rule1 rule_asin(double a)
{
    double d = 1 / sqrt((1 - a) * (1 + a));
    return (rule1){km_asin(a), d, a * d * d * d};
}

KM_INLINE rule1 rule_acos(double a)
{
    double d = 1 / sqrt((1 - a) * (1 + a));
    return (rule1){km_acos(a), -d, -a * d * d * d};
}

KM_INLINE rule1 rule_atan(double a)
{
    double d = 1 / (1 + a * a);
    return (rule1){km_atan(a), d, -2 * a * d * d};
}

KM_INLINE rule1 rule_sinh(double a)
{
    double s = km_sinh(a);
    return (rule1){s, km_cosh(a), s};
}

KM_INLINE rule1 rule_cosh(double a)
{
    double c = km_cosh(a);
    return (rule1){c, km_sinh(a), c};
}

/* 1 - tanh^2 = 4 (e + 1) / (e + 2)^2 with e = exp(2|a|) - 1, which does not cancel. */
KM_INLINE rule1 rule_tanh(double a)
{
    double t = km_tanh(a), e = km_expm1_twice(a), d = 4 / (e + 2) * ((e + 1) / (e + 2));
    return (rule1){t, d, -2 * t * d};
}

KM_INLINE rule1 rule_exp(double a)
{
    double e = km_exp(a);
    return (rule1){e, e, e};
}

KM_INLINE rule1 rule_log(double a)
{
    double d = 1 / a;
    return (rule1){km_log(a), d, -d * d};
}

/* At 0: value 0, derivative +infinite. */
KM_INLINE rule1 rule_sqrt(double a)
{
    double s = sqrt(a), d = 0.5 / s;
    return (rule1){s, d, -0.5 * d / a};
}

/* The derivative at the edge is that of neither side, but 0. */
KM_INLINE rule1 rule_abs(double a)
{
    double right = a > 0 ? 1 : 0, left = a < 0 ? 1 : 0;
    return (rule1){fabs(a), right - left, 0};
}

KM_INLINE rule1 rule_floor(double a) { return (rule1){km_floor(a), 0, 0}; }

/* f(a,b) and its partials */
typedef struct rule2 {
    double f, a, b, aa, ab, bb;
} rule2;

KM_INLINE rule2 rule_div(double a, double b)
{
    double f = a / b, r = 1 / b;
    return (rule2){f, r, -f * r, 0, -r * r, 2 * f * r * r};
}

/* a - b trunc(a/b), where trunc is constant. */
KM_INLINE rule2 rule_mod(double a, double b)
{
    double f = km_mod(a, b), q = km_round((a - f) / b);
    return (rule2){f, 1, -q, 0, 0, 0};
}

/* The angle of the point (b,a). */
KM_INLINE rule2 rule_atan2(double a, double b)
{
    double r = 1 / (a * a + b * b), x = b * r, y = a * r;
    return (rule2){km_atan2(a, b), x, -y, -2 * x * y, y * y - x * x, 2 * x * y};
}

/* a^b. At a = 0 < b, where f/a is 0/0, the limits along a stand, and 0 for what depends on b. */
KM_INLINE rule2 rule_pow(double a, double b)
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

KM_INLINE rule2 rule_noise(double a, double b)
{
    noise_jet n = noise_at(a, b);
    return (rule2){n.f, n.x, n.y, n.xx, n.xy, n.yy};
}

#endif
