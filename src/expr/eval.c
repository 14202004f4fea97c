/* Evaluation: forward-mode differentiation over a batch, one operation after the other, each made of the
 * loops of expr_stages.h. Parts of a jet that are 0 for all points are not touched.
 *
 * Partials are sums of products. In them 0 times infinity is 0: where an operand does not change in a
 * direction, a steep function of it does not either. So sqrt(u^2 + w^2) has first partials 0 at its apex.
 */
#include <assert.h>
#include <stdbool.h>

#include "expr/program.h"
#include "expr/stages.h"

/* An operand or a result: a jet and those of its parts that are not 0 and are asked for. */
typedef struct view {
    expr_jets *jet;
    int has;
} view;

/* A part, NULL where the view has none. The parts of a jet are arrays of one size, in the order of enum
 * expr_part. */
static double *part(view v, int p)
{
    return v.has >> p & 1 ? (double *)((char *)v.jet + (size_t)p * sizeof v.jet->v) : NULL;
}

static const double zeros[EXPR_BATCH];

static const double *part_or_zeros(view v, int p) { return v.has >> p & 1 ? part(v, p) : zeros; }

/* The variables by which a second partial differentiates. */
static const struct {
    int ij, i, j;
} seconds[] = {{PART_UU, PART_U, PART_U}, {PART_UW, PART_U, PART_W}, {PART_WW, PART_W, PART_W}};

/* z is the sum of the terms so far. A term with a factor NULL is 0 and left out. */
typedef struct sum {
    int n;
    double *z;
    bool begun;
} sum;

static void term(sum *s, const double *x, const double *y)
{
    if (!x || !y)
        return;
    (s->begun ? stage_add_product : stage_set_product)(s->n, s->z, x, y);
    s->begun = true;
}

static void term3(sum *s, const double *x, const double *y, const double *t)
{
    if (!y || !t)
        return;
    (s->begun ? stage_add_product3 : stage_set_product3)(s->n, s->z, x, y, t);
    s->begun = true;
}

/* f(a): f_i = f' a_i, f_ij = f' a_ij + f'' a_i a_j */
static void chain1(int n, view z, view a, const double *d, const double *dd, bool curved)
{
    for (int i = PART_U; i <= PART_W; i++)
        if (part(z, i))
            term(&(sum){n, part(z, i), false}, d, part(a, i));
    for (int k = 0; k < 3; k++) {
        sum s = {n, part(z, seconds[k].ij), false};
        if (!s.z)
            continue;
        term(&s, d, part(a, seconds[k].ij));
        if (curved)
            term3(&s, dd, part(a, seconds[k].i), part(a, seconds[k].j));
    }
}

/* f(a,b): f_i = f_a a_i + f_b b_i, and
 * f_ij = f_a a_ij + f_b b_ij + f_aa a_i a_j + f_ab (a_i b_j + a_j b_i) + f_bb b_i b_j,
 * of which / has no f_aa and mod no second partials at all. */
static void chain2(int n, view z, view a, view b, const partials2 *d, enum expr_op op)
{
    for (int i = PART_U; i <= PART_W; i++) {
        sum s = {n, part(z, i), false};
        if (!s.z)
            continue;
        term(&s, d->a, part(a, i));
        term(&s, d->b, part(b, i));
    }
    for (int k = 0; k < 3; k++) {
        int i = seconds[k].i, j = seconds[k].j;
        sum s = {n, part(z, seconds[k].ij), false};
        if (!s.z)
            continue;
        term(&s, d->a, part(a, seconds[k].ij));
        term(&s, d->b, part(b, seconds[k].ij));
        if (op == OP_MOD)
            continue;
        if (op != OP_DIV)
            term3(&s, d->aa, part(a, i), part(a, j));
        term3(&s, d->ab, part(a, i), part(b, j));
        term3(&s, d->ab, part(a, j), part(b, i));
        term3(&s, d->bb, part(b, i), part(b, j));
    }
}

/* (ab)_i = a_i b + a b_i, (ab)_ij = a_ij b + a b_ij + a_i b_j + a_j b_i */
static void product_rule(int n, view z, view a, view b)
{
    const double *av = part(a, PART_V), *bv = part(b, PART_V);
    stage_multiply(n, part(z, PART_V), av, bv);
    for (int i = PART_U; i <= PART_W; i++) {
        sum s = {n, part(z, i), false};
        if (!s.z)
            continue;
        term(&s, part(a, i), bv);
        term(&s, part(b, i), av);
    }
    for (int k = 0; k < 3; k++) {
        int i = seconds[k].i, j = seconds[k].j;
        sum s = {n, part(z, seconds[k].ij), false};
        if (!s.z)
            continue;
        term(&s, part(a, seconds[k].ij), bv);
        term(&s, part(b, seconds[k].ij), av);
        term(&s, part(a, i), part(b, j));
        term(&s, part(a, j), part(b, i));
    }
}

static void run(const expr_code *c, int n, int order, expr_jets *const *slot, int wanted)
{
    const view z = {slot[c->z], c->has_z & wanted};
    const view a = {slot[c->arg[0]], c->has[0] & wanted};
    const view b = {slot[c->arg[1]], c->has[1] & wanted};
    const view e = {slot[c->arg[2]], c->has[2] & wanted};
    const view g = {slot[c->arg[3]], c->has[3] & wanted};
    double d[EXPR_BATCH], dd[EXPR_BATCH];
    partials2 d2;

    switch (c->op) {
    case OP_CONST:
        stage_fill(n, part(z, PART_V), c->k);
        break;
    case OP_ADDK:
        stage_shift(n, part(z, PART_V), part(a, PART_V), c->k);
        for (int p = PART_U; p < PARTS; p++)
            if (part(z, p))
                stage_scale(n, part(z, p), part(a, p), 1);
        break;
    case OP_MULK:
        for (int p = 0; p < PARTS; p++)
            if (part(z, p))
                stage_scale(n, part(z, p), part(a, p), c->k);
        break;
    case OP_ADD:
    case OP_SUB:
        for (int p = 0; p < PARTS; p++)
            if (part(z, p))
                (c->op == OP_ADD ? stage_add : stage_subtract)(n, part(z, p), part_or_zeros(a, p), part_or_zeros(b, p));
        break;
    case OP_MUL:
        product_rule(n, z, a, b);
        break;
    case OP_DIV:
    case OP_MOD:
    case OP_ATAN2:
    case OP_POW:
    case OP_NOISE:
        stages2[c->op](n, order, part(a, PART_V), part(b, PART_V), part(z, PART_V), &d2);
        chain2(n, z, a, b, &d2, (enum expr_op)c->op);
        break;
    case OP_MIN:
    case OP_MAX: {
        const view first = c->op == OP_MIN ? a : b, second = c->op == OP_MIN ? b : a;
        stage_compare(n, d, part(a, PART_V), part(b, PART_V));
        for (int p = 0; p < PARTS; p++)
            if (part(z, p))
                stage_choose(n, part(z, p), d, part_or_zeros(first, p), part_or_zeros(second, p));
        break;
    }
    case OP_SELECT:
        for (int p = 0; p < PARTS; p++)
            if (part(z, p))
                stage_choose(n, part(z, p), part(a, PART_V), part_or_zeros(b, p), part_or_zeros(e, p));
        break;
    case OP_SELECT4:
        stage_compare_zero(n, d, part(a, PART_V));
        for (int p = 0; p < PARTS; p++)
            if (part(z, p)) {
                stage_choose(n, dd, d, part_or_zeros(e, p), part_or_zeros(g, p));
                stage_choose(n, part(z, p), part(a, PART_V), part_or_zeros(b, p), dd);
            }
        break;
    case OP_POWI:
        stage_powi(n, order, part(a, PART_V), c->k, part(z, PART_V), d, dd);
        chain1(n, z, a, d, dd, true);
        break;
    default:
        stages1[c->op](n, order, part(a, PART_V), part(z, PART_V), d, dd);
        chain1(n, z, a, d, dd, c->op != OP_ABS);
    }
}

void expr_eval(const expr *e, int n, const double *u, const double *w, int order, expr_jets *out)
{
    static const int parts[] = {HAS_V, HAS_V | HAS_FIRST, HAS_V | HAS_FIRST | HAS_UU | HAS_UW | HAS_WW};
    assert(n >= 0 && n <= EXPR_BATCH && order >= 0 && order <= 2);
    const int wanted = parts[order];
    expr_jets work[EXPR_SLOTS], *slot[EXPR_SLOTS];
    for (int s = 0; s < EXPR_SLOTS; s++)
        slot[s] = s == e->result ? out : &work[s];

    stage_scale(n, slot[0]->v, u, 1);
    stage_scale(n, slot[1]->v, w, 1);
    if (order > 0) {
        stage_fill(n, slot[0]->u, 1);
        stage_fill(n, slot[1]->w, 1);
    }
    for (int i = 0; i < e->count; i++)
        run(&e->code[i], n, order, slot, wanted);

    const view absent = {out, wanted & ~e->has};
    for (int p = 0; p < PARTS; p++)
        if (part(absent, p))
            stage_fill(n, part(absent, p), 0);
}
