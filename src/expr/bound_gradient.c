/* Bounds of the value and of the first partials, by interval arithmetic in forward mode: beside each slot's bounds run
 * those of its partials along u and along w.
 *
 * They are bounds for differences too, so each operation must be Lipschitz over all the values that its operands can
 * take in the box, not only have a derivative almost everywhere: a kink has the derivatives of both its sides and all
 * between, a jump has an infinite one, unless what decides about the jump does not change in that direction. As
 * everywhere here, 0 times infinity is 0: what does not change, changes nothing.
 */
#include "expr/bound_slopes.h"

#include "expr/rules.h"

static const interval minus_one = {-1, -1};

/* A derivative that is positive, from its values at the ends, in either order. Where these underflow it is still not 0,
 * nor as large as the cut of rule_tanh leaves it. */
static interval positive(double x, double y)
{
    interval z = widen((interval){least(x, y), most(x, y)}, SOME_ROUNDINGS);
    return (interval){z.lo > 1e-300 ? z.lo : 0, most(z.hi, TINY)};
}

static interval sign(interval a) { return (interval){a.lo < 0 ? -1 : a.lo > 0, a.hi > 0 ? 1 : -(a.hi < 0)}; }

/* d a^b / da = b a^(b-1) */
static interval power_by_base(interval a, interval b)
{
    bool integer = b.lo == b.hi && km_floor(b.lo) == b.lo; /* then b - 1 is one, too: a may be negative */
    if (a.lo < 0 && !integer) {
        if (b.lo < b.hi) /* defined at isolated b */
            return everything;
        a = clip(a, 0, KM_INF);
    }
    return multiply(b, range(OP_POW, a, integer ? (interval){b.lo - 1, b.lo - 1} : add(b, minus_one)));
}

/* d a^b / db = a^b log a */
static interval power_by_exponent(interval a, interval f)
{
    return a.lo < 0 ? everything : multiply(f, range(OP_LOG, a, a));
}

/* d atan2(y,x) / dx and / dy are t / (x^2 + y^2), t = -y and x, and nowhere more than 1 / sqrt(x^2 + y^2). Across the
 * cut along x <= 0 the angle jumps; on it, too, since y may be -0. */
static interval angle_by(interval t, interval y, interval x)
{
    if (x.lo <= 0 && contains(y, 0))
        return everything;
    interval r2 = add(square(x), square(y)), z = multiply(t, reciprocal(r2));
    double steepest = reciprocal(range(OP_SQRT, r2, r2)).hi * (1 + SOME_ROUNDINGS);
    return widen((interval){most(z.lo, -steepest), least(z.hi, steepest)}, SOME_ROUNDINGS);
}

/* a - b trunc(a/b): 1 and -trunc(a/b), which jumps where the quotient crosses an integer other than 0. */
static interval quotient_of_modulo(interval a, interval b)
{
    interval q = multiply(a, reciprocal(b));
    double lo = q.lo < 0 ? ceil(q.lo) : floor(q.lo), hi = q.hi < 0 ? ceil(q.hi) : floor(q.hi);
    return lo == hi && fabs(lo) < KM_TWO52 ? (interval){lo, lo} : everything;
}

pair expr_partials_range(const expr_code *p, interval a, interval b, interval f)
{
    const interval m = magnitude(a), z = magnitude(clip(a, -1, 1));
    interval d;
    switch ((enum expr_op)p->op) {
    case OP_CONST:
        return (pair){zero, zero};
    case OP_ADDK:
        return (pair){one, zero};
    case OP_ADD:
        return (pair){one, one};
    case OP_SUB:
        return (pair){one, minus_one};
    case OP_MULK:
        return (pair){{p->k, p->k}, zero};
    case OP_MUL:
        return (pair){b, a};
    case OP_DIV:
        return (pair){reciprocal(b), negative(multiply(f, reciprocal(b)))};
    case OP_MOD:
        d = quotient_of_modulo(a, b);
        return (pair){d.lo == d.hi ? one : everything, negative(d)};
    case OP_POWI:
        return (pair){power_by_base(a, (interval){p->k, p->k}), zero};
    case OP_POW:
        return (pair){power_by_base(a, b), power_by_exponent(a, f)};
    case OP_SIN:
        return (pair){range(OP_COS, a, a), zero};
    case OP_COS:
        return (pair){negative(range(OP_SIN, a, a)), zero};
    case OP_TAN:
        return (pair){add(one, square(f)), zero};
    case OP_ASIN:
        return (pair){positive(rule_asin(z.lo).d, rule_asin(z.hi).d), zero};
    case OP_ACOS:
        return (pair){negative(positive(rule_asin(z.lo).d, rule_asin(z.hi).d)), zero};
    case OP_ATAN:
        return (pair){positive(rule_atan(m.lo).d, rule_atan(m.hi).d), zero};
    case OP_ATAN2:
        return (pair){angle_by(b, a, b), angle_by(negative(a), a, b)};
    case OP_SINH:
        return (pair){range(OP_COSH, a, a), zero};
    case OP_COSH:
        return (pair){range(OP_SINH, a, a), zero};
    case OP_TANH:
        return (pair){positive(rule_tanh(m.lo).d, rule_tanh(m.hi).d), zero};
    case OP_EXP:
        return (pair){f, zero};
    case OP_LOG:
        return (pair){reciprocal(clip(a, 0, KM_INF)), zero};
    case OP_SQRT:
        d = clip(a, 0, KM_INF);
        return (pair){positive(rule_sqrt(d.lo).d, rule_sqrt(d.hi).d), zero};
    case OP_ABS:
        return (pair){sign(a), zero};
    case OP_FLOOR:
        return (pair){floor(a.lo) == floor(a.hi) ? zero : everything, zero};
    case OP_NOISE:
        return (pair){expr_noise_range(a, b).x, expr_noise_range(a, b).y};
    case OP_MIN:
    case OP_MAX:
    case OP_SELECT:
    case OP_SELECT4: /* see choice() */
        break;
    }
    return (pair){everything, everything};
}

/* f_i = f_a a_i + f_b b_i */
static slope chain(const expr_code *p, const interval *value, const slope *s, interval f)
{
    const pair d = expr_partials_range(p, value[p->arg[0]], value[p->arg[1]], f);
    slope z;
    for (int i = 0; i < DIRECTIONS; i++)
        z.along[i] = plus(term(d.a, s[p->arg[0]].along[i]), term(d.b, s[p->arg[1]].along[i]));
    return z;
}

int expr_reached(const expr_code *p, const interval *value)
{
    const interval a = value[p->arg[0]], b = value[p->arg[1]];
    switch (p->op) {
    case OP_MIN:
        return (a.lo <= b.hi) | (b.lo <= a.hi) << 1;
    case OP_MAX:
        return (a.hi >= b.lo) | (b.hi >= a.lo) << 1;
    case OP_SELECT:
        return (a.lo < 0) << 1 | (a.hi >= 0) << 2;
    default:
        return (a.lo < 0) << 1 | contains(a, 0) << 2 | (a.hi > 0) << 3;
    }
}

/* The slope is that of one of the operands reached. Between operands that meet, as min's do, nothing jumps. */
static slope choice(const expr_code *p, const interval *value, const slope *s)
{
    const int set = expr_reached(p, value);
    const bool by_sign = p->op == OP_SELECT || p->op == OP_SELECT4;
    int first = 0;
    while (first < 3 && !(set >> first & 1))
        first++;
    const interval v = value[p->arg[first]];
    slope z = s[p->arg[first]];
    bool meet = true;
    for (int k = first + 1; k < 4; k++)
        if (set >> k & 1) {
            const interval x = value[p->arg[k]];
            meet = meet && (p->arg[k] == p->arg[first] || (is_point(x, v.lo) && is_point(x, v.hi)));
            for (int i = 0; i < DIRECTIONS; i++)
                z.along[i] = hull(z.along[i], s[p->arg[k]].along[i]);
        }
    for (int i = 0; i < DIRECTIONS; i++)
        if (by_sign && !meet && !is_point(s[p->arg[0]].along[i], 0))
            z.along[i] = everything;
    return z;
}

slope expr_slope_range(const expr_code *p, const interval *value, const slope *s, interval f)
{
    return expr_chooses(p) ? choice(p, value, s) : chain(p, value, s, f);
}

void expr_bound_gradient(const expr *e, double u0, double u1, double w0, double w1, expr_bounds *out)
{
    interval value[EXPR_SLOTS] = {{u0, u1}, {w0, w1}};
    slope s[EXPR_SLOTS] = {{{one, zero}}, {{zero, one}}};
    for (int i = 0; i < e->count; i++) {
        const expr_code *p = &e->code[i];
        const interval f = expr_value_range(p, value);
        s[p->z] = expr_slope_range(p, value, s, f);
        value[p->z] = f;
    }
    expr_put_bounds(value[e->result], s[e->result], out);
}
