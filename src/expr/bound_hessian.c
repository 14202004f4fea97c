/* Bounds of the second partials, by interval arithmetic in forward mode, beside those of value and gradient
 * (expr_gradient.c). Where a slope may jump in the box they are infinite.
 */
#include "expr/bound_slopes.h"

#include "expr/rules.h"

enum { UU, UW, WW, BENDS };

/* Of each of these, its directions. */
static const int first_of[BENDS] = {ALONG_U, ALONG_U, ALONG_W}, second_of[BENDS] = {ALONG_U, ALONG_W, ALONG_W};

typedef struct bend {
    interval d[BENDS];
} bend;

/* f_aa, f_ab and f_bb of an operation f(a,b) */
typedef struct triple {
    interval aa, ab, bb;
} triple;

/* Most factors are 0: what is linear, or along what an operand does not depend on. */
static interval product(interval x, interval y) { return is_point(x, 0) || is_point(y, 0) ? zero : term(x, y); }

static interval times(double k, interval a) { return multiply((interval){k, k}, a); }
static interval power_range(interval a, double k) { return expr_value_range(&(expr_code){.op = OP_POWI, .k = k}, &a); }

/* a (1 - a^2)^(-3/2), which grows with a. */
static interval arc_bend(interval a)
{
    const interval z = clip(a, -1, 1);
    return widen((interval){rule_asin(z.lo).dd, rule_asin(z.hi).dd}, 2 * SOME_ROUNDINGS);
}

/* Of the angle of (b,a), by x = b/r^2 and y = a/r^2: -2xy, y^2 - x^2 and 2xy. */
static triple angle_bend(interval a, interval b)
{
    if (b.lo <= 0 && contains(a, 0))
        return (triple){everything, everything, everything};
    const interval r = reciprocal(add(square(a), square(b))), x = multiply(b, r), y = multiply(a, r),
                   xy = times(2, multiply(x, y));
    return (triple){negative(xy), add(square(y), negative(square(x))), xy};
}

/* Over all the values of the operands a and b; f is the range of the operation's own. */
static triple bends_of(const expr_code *p, interval a, interval b, interval f)
{
    interval d;
    switch ((enum expr_op)p->op) {
    case OP_CONST:
    case OP_ADDK:
    case OP_ADD:
    case OP_SUB:
    case OP_MULK:
        return (triple){zero, zero, zero};
    case OP_MUL:
        return (triple){zero, one, zero};
    case OP_DIV:
        d = reciprocal(b);
        return (triple){zero, negative(square(d)), times(2, multiply(f, square(d)))};
    case OP_MOD: /* where it does not jump it is a - b k */
        d = expr_partials_range(p, a, b, f).b;
        return is_point(d, d.lo) ? (triple){zero, zero, zero} : (triple){everything, everything, everything};
    case OP_POWI:
        return (triple){times(p->k * (p->k - 1), p->k == 2   ? one
                                                 : p->k == 3 ? a
                                                             : power_range(a, p->k - 2)),
                        zero, zero};
    case OP_POW:
        if (b.lo < b.hi || a.lo <= 0)
            break;
        return (triple){times(b.lo * (b.lo - 1), range(OP_POW, a, (interval){b.lo - 2, b.lo - 2})), everything,
                        everything};
    case OP_SIN:
    case OP_COS:
        return (triple){negative(f), zero, zero};
    case OP_TAN:
        return (triple){times(2, multiply(f, add(one, square(f)))), zero, zero};
    case OP_ASIN:
        return (triple){arc_bend(a), zero, zero};
    case OP_ACOS:
        return (triple){negative(arc_bend(a)), zero, zero};
    case OP_ATAN:
        d = expr_partials_range(p, a, b, f).a;
        return (triple){times(-2, multiply(a, square(d))), zero, zero};
    case OP_TANH:
        d = expr_partials_range(p, a, b, f).a;
        return (triple){times(-2, multiply(f, d)), zero, zero};
    case OP_SINH:
    case OP_COSH:
    case OP_EXP:
        return (triple){f, zero, zero};
    case OP_LOG:
        return (triple){negative(square(reciprocal(clip(a, 0, KM_INF)))), zero, zero};
    case OP_SQRT: /* -1 / (4 a sqrt a) */
        d = clip(a, 0, KM_INF);
        return (triple){times(-0.25, reciprocal(multiply(d, range(OP_SQRT, d, d)))), zero, zero};
    case OP_ABS:
        return (triple){a.lo >= 0 || a.hi <= 0 ? zero : everything, zero, zero};
    case OP_FLOOR:
        return (triple){floor(a.lo) == floor(a.hi) ? zero : everything, zero, zero};
    case OP_ATAN2:
        return angle_bend(a, b);
    case OP_NOISE:
        return (triple){expr_noise_range(a, b).xx, expr_noise_range(a, b).xy, expr_noise_range(a, b).yy};
    case OP_MIN:
    case OP_MAX:
    case OP_SELECT:
    case OP_SELECT4: /* see choice() */
        break;
    }
    return (triple){everything, everything, everything};
}

/* f_ij = f_a a_ij + f_b b_ij + f_aa a_i a_j + f_ab (a_i b_j + a_j b_i) + f_bb b_i b_j */
static bend chain(const expr_code *p, const interval *value, const slope *s, const bend *h, interval f)
{
    const int A = p->arg[0], B = p->arg[1];
    const pair d = expr_partials_range(p, value[A], value[B], f);
    const triple k = bends_of(p, value[A], value[B], f);
    bend z;
    for (int m = 0; m < BENDS; m++) {
        const interval ai = s[A].along[first_of[m]], aj = s[A].along[second_of[m]];
        const interval bi = s[B].along[first_of[m]], bj = s[B].along[second_of[m]];
        interval x = plus(product(d.a, h[A].d[m]), product(d.b, h[B].d[m]));
        if (!is_point(k.aa, 0))
            x = plus(x, product(k.aa, m == UW ? product(ai, aj) : square(ai)));
        if (!is_point(k.ab, 0))
            x = plus(x, product(k.ab, plus(product(ai, bj), product(aj, bi))));
        if (!is_point(k.bb, 0))
            x = plus(x, product(k.bb, m == UW ? product(bi, bj) : square(bi)));
        z.d[m] = x;
    }
    return z;
}

/* Of the one operand that is reached; between several the slope jumps, but along what none of them depends on. */
static bend choice(const expr_code *p, const interval *value, const slope *s, const bend *h)
{
    const int set = expr_reached(p, value);
    bool rests[DIRECTIONS] = {true, true};
    bend z;
    for (int k = 0; k < 4; k++)
        if (set == 1 << k)
            return h[p->arg[k]];
    for (int i = 0; i < DIRECTIONS; i++) {
        if (p->op == OP_SELECT || p->op == OP_SELECT4)
            rests[i] = is_point(s[p->arg[0]].along[i], 0);
        for (int k = 0; k < 4; k++)
            rests[i] = rests[i] && (!(set >> k & 1) || is_point(s[p->arg[k]].along[i], 0));
    }
    for (int m = 0; m < BENDS; m++)
        z.d[m] = rests[first_of[m]] || rests[second_of[m]] ? zero : everything;
    return z;
}

void expr_bound_hessian(const expr *e, double u0, double u1, double w0, double w1, expr_bounds *out,
                        expr_hessians *second)
{
    interval value[EXPR_SLOTS] = {{u0, u1}, {w0, w1}};
    slope s[EXPR_SLOTS] = {{{one, zero}}, {{zero, one}}};
    bend h[EXPR_SLOTS] = {{{zero, zero, zero}}};
    for (int i = 0; i < e->count; i++) {
        const expr_code *p = &e->code[i];
        const interval f = expr_value_range(p, value);
        /* all three from the operands, before the result takes its slot */
        const bend z = expr_chooses(p) ? choice(p, value, s, h) : chain(p, value, s, h, f);
        s[p->z] = expr_slope_range(p, value, s, f);
        h[p->z] = z;
        value[p->z] = f;
    }
    const bend z = h[e->result];
    expr_put_bounds(value[e->result], s[e->result], out);
    *second = (expr_hessians){{z.d[UU].lo, z.d[UU].hi}, {z.d[UW].lo, z.d[UW].hi}, {z.d[WW].lo, z.d[WW].hi}};
}
