/* Bounds of the value, the gradient and the Hessian over a box: runs the program once on intervals, in forward mode.
 * Points where an operand is NaN or has a pole are outside the expression's domain.
 *
 * Bounds of partials are Lipschitz bounds, too. So a kink has the derivatives of both its sides and all between, and a
 * jump has an infinite derivative along each direction in which its condition changes. 0 times infinity is 0: an
 * operand that is constant along a direction adds nothing.
 */
#include "expr/operation.h"

enum { ALONG_U, ALONG_W, DIRECTIONS };
enum { UU, UW, WW, SECONDS };

typedef struct slope {
    interval along[DIRECTIONS];
} slope;

typedef struct second {
    interval d[SECONDS];
} second;

/* The two directions of each second partial. */
static const int first_of[SECONDS] = {ALONG_U, ALONG_U, ALONG_W}, second_of[SECONDS] = {ALONG_U, ALONG_W, ALONG_W};

static expr_ranges ranges_of(const expr_code *c, const interval *value)
{
    expr_ranges r = {.k = c->k, .same = c->arg[0] == c->arg[1]};
    for (int i = 0; i < c->op->operands; i++)
        r.x[i] = value[c->arg[i]];
    r.f = interval_known(c->op->value(&r));
    return r;
}

/* ---- terms of the chain rule ---- */

/* Exact where a factor is 0, as along what an operand does not depend on, or 1 or -1, as in sums. */
static inline interval product(interval x, interval y)
{
    if (interval_is(x, 0) || interval_is(y, 0))
        return interval_zero;
    if (interval_is(x, 1) || interval_is(x, -1))
        return x.lo > 0 ? y : interval_negate(y);
    if (interval_is(y, 1) || interval_is(y, -1))
        return y.lo > 0 ? x : interval_negate(x);
    return interval_multiply(x, y);
}

static inline interval sum(interval x, interval y)
{
    if (interval_is(x, 0) || interval_is(y, 0))
        return interval_is(x, 0) ? y : x;
    return interval_add(x, y);
}

/* ---- first partials ---- */

/* f_i = f_a a_i + f_b b_i + f_c c_i; terms that are 0 are passed over, which is most of them. */
static slope chain(const expr_code *c, const slope *s, const expr_gradient *g)
{
    slope z = {{{0, 0}}};
    for (int k = 0; k < c->op->operands; k++)
        if (!interval_is(g->d[k], 0))
            for (int i = 0; i < DIRECTIONS; i++)
                z.along[i] = sum(z.along[i], product(g->d[k], s[c->arg[k]].along[i]));
    return z;
}

/* For an operation that chooses: the hull of the slopes of the operands reached. Where these have the same value, as
 * those of min do at the change, there is no jump. */
static slope choice(const expr_code *c, const expr_ranges *r, const slope *s)
{
    const int set = c->op->reached(r);
    int first = 0;
    while (!(set >> first & 1))
        first++;
    const interval v = r->x[first];
    slope z = s[c->arg[first]];
    bool meet = true;
    for (int k = first + 1; k < c->op->operands; k++)
        if (set >> k & 1) {
            const interval x = r->x[k];
            meet = meet && (c->arg[k] == c->arg[first] || (interval_is(x, v.lo) && interval_is(x, v.hi)));
            for (int i = 0; i < DIRECTIONS; i++)
                z.along[i] = interval_hull(z.along[i], s[c->arg[k]].along[i]);
        }
    for (int i = 0; i < DIRECTIONS; i++)
        if (c->op->deciding && !meet && !interval_is(s[c->arg[0]].along[i], 0))
            z.along[i] = interval_all;
    return z;
}

/* ---- second partials ---- */

/* The terms of f_ij in the first partials of operands: f_aa a_i a_j, f_ab (a_i b_j + a_j b_i). */
static inline interval pair_term(interval dd, bool same, const slope *a, const slope *b, int m)
{
    const interval ai = a->along[first_of[m]], aj = a->along[second_of[m]];
    const interval bi = b->along[first_of[m]], bj = b->along[second_of[m]];
    if (!same)
        return product(dd, sum(product(ai, bj), product(aj, bi)));
    return product(dd, m == UW ? product(ai, aj) : interval_square(ai));
}

/* f_ij = sum of f_a a_ij over operands, and of pair_term over pairs. f NULL: the operation is linear. */
static second chain2(const expr_code *c, const slope *s, const second *h, const expr_gradient *g, const expr_hessian *f)
{
    second z = {{{0, 0}}};
    for (int k = 0; k < c->op->operands; k++)
        if (!interval_is(g->d[k], 0))
            for (int m = 0; m < SECONDS; m++)
                z.d[m] = sum(z.d[m], product(g->d[k], h[c->arg[k]].d[m]));
    for (int p = 0; f && p < EXPR_PAIRS; p++) {
        const int i = expr_pairs[p].i, j = expr_pairs[p].j;
        if (!interval_is(f->dd[p], 0))
            for (int m = 0; m < SECONDS; m++)
                z.d[m] = sum(z.d[m], pair_term(f->dd[p], i == j, &s[c->arg[i]], &s[c->arg[j]], m));
    }
    return z;
}

/* Those of the operand reached, if it is the only one. Else the slope jumps, except along directions in which no
 * operand reached, and no deciding one, changes. */
static second choice2(const expr_code *c, const expr_ranges *r, const slope *s, const second *h)
{
    const int set = c->op->reached(r);
    bool rests[DIRECTIONS] = {true, true};
    second z;
    for (int k = 0; k < c->op->operands; k++)
        if (set == 1 << k)
            return h[c->arg[k]];
    for (int i = 0; i < DIRECTIONS; i++)
        for (int k = 0; k < c->op->operands; k++)
            if (set >> k & 1 || k < c->op->deciding)
                rests[i] = rests[i] && interval_is(s[c->arg[k]].along[i], 0);
    for (int m = 0; m < SECONDS; m++)
        z.d[m] = rests[first_of[m]] || rests[second_of[m]] ? interval_zero : interval_all;
    return z;
}

/* The second partials of an operation's result. */
static second second_of_code(const expr_code *c, const expr_ranges *r, const slope *s, const second *h,
                             const expr_gradient *g)
{
    if (c->op->reached)
        return choice2(c, r, s, h);
    if (!c->op->hessian)
        return chain2(c, s, h, g, NULL);
    const expr_hessian f = c->op->hessian(r);
    return chain2(c, s, h, g, &f);
}

/* Runs the program over the box u x w. h NULL: without second partials. */
static void bound(const expr *e, interval u, interval w, expr_bounds *out, second *h)
{
    static const expr_gradient level;
    interval value[EXPR_SLOTS] = {u, w};
    slope s[EXPR_SLOTS] = {{{{1, 1}, {0, 0}}}, {{{0, 0}, {1, 1}}}};
    for (int i = 0; i < e->count; i++) {
        const expr_code *c = &e->code[i];
        const expr_op *op = c->op;
        const expr_ranges r = ranges_of(c, value);
        const expr_gradient g = op->gradient ? op->gradient(&r) : level;
        if (h)
            h[c->z] = second_of_code(c, &r, s, h, &g);
        s[c->z] = op->reached ? choice(c, &r, s) : chain(c, s, &g);
        value[c->z] = r.f;
    }
    const interval v = value[e->result], su = s[e->result].along[ALONG_U], sw = s[e->result].along[ALONG_W];
    *out = (expr_bounds){{v.lo, v.hi}, {su.lo, su.hi}, {sw.lo, sw.hi}};
}

void expr_bound_gradient(const expr *e, double u0, double u1, double w0, double w1, expr_bounds *out)
{
    bound(e, (interval){u0, u1}, (interval){w0, w1}, out, NULL);
}

void expr_bound_hessian(const expr *e, double u0, double u1, double w0, double w1, expr_bounds *out,
                        expr_hessians *hessian)
{
    second h[EXPR_SLOTS] = {{{{0, 0}}}};
    bound(e, (interval){u0, u1}, (interval){w0, w1}, out, h);
    const second z = h[e->result];
    *hessian = (expr_hessians){{z.d[UU].lo, z.d[UU].hi}, {z.d[UW].lo, z.d[UW].hi}, {z.d[WW].lo, z.d[WW].hi}};
}
