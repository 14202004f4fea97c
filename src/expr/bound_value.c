/* Bounds of the value by interval arithmetic: the program of expr_eval.c, run once on intervals instead of on points.
 *
 * A point at which some operand is NaN or a pole counts as outside the expression's domain.
 */
#include "expr/interval.h"

#include "math/noise.h"

/* Is there an integer in lo..hi, or so near that rounding decides? */
static bool holds_integer(double lo, double hi) { return floor(hi + 1e-9) >= ceil(lo - 1e-9); }

/* cos(x - 2 pi phase) for x in a, of which lo and hi are the values at the ends. */
static interval wave(interval a, double phase, double lo, double hi)
{
    const double turn = 6.28318530717958647693, reliable = 1e5;
    if (!(a.lo > -reliable && a.hi < reliable && a.hi - a.lo < turn))
        return (interval){-1, 1};
    double t0 = a.lo / turn - phase, t1 = a.hi / turn - phase;
    interval z = widen((interval){least(lo, hi), most(lo, hi)}, SOME_ROUNDINGS);
    return (interval){holds_integer(t0 - 0.5, t1 - 0.5) ? -1 : most(z.lo, -1),
                      holds_integer(t0, t1) ? 1 : least(z.hi, 1)};
}

static interval tangent(interval a)
{
    const double half_turn = 3.14159265358979323846, reliable = 1e5;
    if (!(a.lo > -reliable && a.hi < reliable) || holds_integer(a.lo / half_turn - 0.5, a.hi / half_turn - 0.5))
        return everything;
    return widen((interval){km_tan(a.lo), km_tan(a.hi)}, SOME_ROUNDINGS);
}

/* a^b for a >= 0, which is monotonic in a and in b: the extremes are at corners. */
static interval positive_power(interval a, interval b)
{
    interval p = {km_pow(a.lo, b.lo), km_pow(a.lo, b.hi)}, q = {km_pow(a.hi, b.lo), km_pow(a.hi, b.hi)};
    interval z = {least(least(p.lo, p.hi), least(q.lo, q.hi)), most(most(p.lo, p.hi), most(q.lo, q.hi))};
    z = widen(z, SOME_ROUNDINGS);
    return (interval){most(z.lo, 0), most(z.hi, TINY)}; /* which also holds what underflows */
}

static interval power(interval a, interval b)
{
    if (a.lo >= 0)
        return positive_power(a, b);
    if (b.lo < b.hi) { /* a negative base has powers at integers b only: |a|^b with either sign */
        interval m = positive_power(magnitude(a), b);
        return (interval){-m.hi, m.hi};
    }
    if (km_floor(b.lo) != b.lo)
        return positive_power(clip(a, 0, KM_INF), b);
    if (km_floor(0.5 * b.lo) == 0.5 * b.lo)
        return positive_power(magnitude(a), b);
    interval left = negative(positive_power(clip(negative(a), 0, KM_INF), b));
    return a.hi < 0 ? left : hull(left, positive_power(clip(a, 0, KM_INF), b));
}

/* The angle of (x,y): on a rectangle apart from the cut along x <= 0, extreme at corners. */
static interval angle(interval y, interval x)
{
    const double pi = 3.14159265358979323846;
    if (x.lo <= 0 && contains(y, 0))
        return widen((interval){-pi, pi}, ONE_ROUNDING);
    double a = km_atan2(y.lo, x.lo), b = km_atan2(y.lo, x.hi), c = km_atan2(y.hi, x.lo), d = km_atan2(y.hi, x.hi);
    return widen((interval){least(least(a, b), least(c, d)), most(most(a, b), most(c, d))}, SOME_ROUNDINGS);
}

/* At most as far from 0 as a and as b, on the side of a. */
static interval modulo(interval a, interval b)
{
    interval m = magnitude(a), n = magnitude(b);
    if (m.hi < n.lo)
        return a;
    return (interval){a.lo < 0 ? most(a.lo, -n.hi) : 0, a.hi > 0 ? least(a.hi, n.hi) : 0};
}

/* A function that grows with its argument, from its values at the ends. */
static interval rising(double lo, double hi) { return widen((interval){lo, hi}, SOME_ROUNDINGS); }

/* f in the middle, as far as it can go from there: by its partials u and v there and a bound of the second ones. */
static interval about(double f, double u, double v, double x, double y, double bend, double limit)
{
    const double off = fabs(u) * x + fabs(v) * y + 0.5 * bend * (x + y) * (x + y) + 1e-12;
    return (interval){most(f - off, -limit), least(f + off, limit)};
}

/* Bounds of all partials, of order 1, 2 and 3. The first is 2.9262, at the centre of a cell whose four gradients are at
 * their worst; found on a grid of 4001 x 4001, rounded up by more than it can rise between. The others by the triangle
 * inequality, with gradients below 1.4143, fades whose derivatives are below 1.876, 5.78 and 60, and places in the unit
 * square. */
noise_bounds expr_noise_range(interval a, interval b)
{
    const double SLOPE = 2.93, BEND = 31, THIRD = 260, x = 0.5 * (a.hi - a.lo), y = 0.5 * (b.hi - b.lo);
    const interval f = {-1, 1}, d = {-SLOPE, SLOPE}, dd = {-BEND, BEND};
    if (!(x + y < 1))
        return (noise_bounds){f, d, d, dd, dd, dd};
    const noise_jet n = noise_at(a.lo + x, b.lo + y);
    return (noise_bounds){
        about(n.f, n.x, n.y, x, y, BEND, 1),        about(n.x, n.xx, n.xy, x, y, THIRD, SLOPE),
        about(n.y, n.xy, n.yy, x, y, THIRD, SLOPE), about(n.xx, THIRD, THIRD, x, y, 0, BEND),
        about(n.xy, THIRD, THIRD, x, y, 0, BEND),   about(n.yy, THIRD, THIRD, x, y, 0, BEND),
    };
}

static interval range_of(const expr_code *p, const interval *slot)
{
    const interval k = {p->k, p->k};
    const interval a = slot[p->arg[0]], b = slot[p->arg[1]], c = slot[p->arg[2]], d = slot[p->arg[3]];
    interval z;
    switch ((enum expr_op)p->op) {
    case OP_CONST:
        return k;
    case OP_ADDK:
        return add(a, k);
    case OP_ADD:
        return add(a, b);
    case OP_SUB:
        return add(a, negative(b));
    case OP_MULK:
        return multiply(a, k);
    case OP_MUL:
        return p->arg[0] == p->arg[1] ? multiply(magnitude(a), magnitude(a)) : multiply(a, b);
    case OP_DIV:
        return multiply(a, reciprocal(b));
    case OP_MOD:
        return modulo(a, b);
    case OP_POWI:
        return power(a, k);
    case OP_POW:
        return power(a, b);
    case OP_SIN:
        return wave(a, 0.25, km_sin(a.lo), km_sin(a.hi));
    case OP_COS:
        return wave(a, 0, km_cos(a.lo), km_cos(a.hi));
    case OP_TAN:
        return tangent(a);
    case OP_ASIN:
        z = clip(a, -1, 1);
        return rising(km_asin(z.lo), km_asin(z.hi));
    case OP_ACOS:
        z = clip(a, -1, 1);
        return rising(km_acos(z.hi), km_acos(z.lo));
    case OP_ATAN:
        return rising(km_atan(a.lo), km_atan(a.hi));
    case OP_ATAN2:
        return angle(a, b);
    case OP_SINH:
        return rising(km_sinh(a.lo), km_sinh(a.hi));
    case OP_COSH:
        z = magnitude(a);
        return rising(km_cosh(z.lo), km_cosh(z.hi));
    case OP_TANH:
        return rising(km_tanh(a.lo), km_tanh(a.hi));
    case OP_EXP:
        z = rising(km_exp(a.lo), km_exp(a.hi));
        return (interval){most(z.lo, 0), most(z.hi, TINY)};
    case OP_LOG:
        z = clip(a, 0, KM_INF);
        return rising(km_log(z.lo), km_log(z.hi));
    case OP_SQRT:
        z = clip(a, 0, KM_INF);
        return rising(sqrt(z.lo), sqrt(z.hi));
    case OP_ABS:
        return magnitude(a);
    case OP_FLOOR:
        return (interval){floor(a.lo), floor(a.hi)};
    case OP_NOISE:
        return expr_noise_range(a, b).f;
    case OP_MIN:
        return (interval){least(a.lo, b.lo), least(a.hi, b.hi)};
    case OP_MAX:
        return (interval){most(a.lo, b.lo), most(a.hi, b.hi)};
    case OP_SELECT:
        return a.hi < 0 ? b : a.lo >= 0 ? c : hull(b, c);
    case OP_SELECT4:
        z = contains(a, 0) ? c : a.hi < 0 ? b : d;
        z = a.lo < 0 ? hull(z, b) : z;
        return a.hi > 0 ? hull(z, d) : z;
    }
    return everything;
}

interval expr_value_range(const expr_code *p, const interval *slot) { return known(range_of(p, slot)); }

void expr_bound_value(const expr *e, double u0, double u1, double w0, double w1, double *lo, double *hi)
{
    interval slot[EXPR_SLOTS] = {{u0, u1}, {w0, w1}};
    for (int i = 0; i < e->count; i++)
        slot[e->code[i].z] = expr_value_range(&e->code[i], slot);
    *lo = slot[e->result].lo;
    *hi = slot[e->result].hi;
}
