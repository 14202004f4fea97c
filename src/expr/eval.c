/* Evaluates a program: each operation in turn, over the whole batch. */
#include <assert.h>
#include <string.h>

#include "expr/operation.h"

static void run_rule(const expr_op *op, int n, int order, expr_view z, const expr_view *x)
{
    double *f = expr_part(z, PART_V);
    const double *a = expr_part(x[0], PART_V);
    expr_partials p;
    if (op->rule1)
        op->rule1(n, order, a, f, p.d[0], p.dd[0]);
    else if (op->rule2)
        op->rule2(n, order, a, expr_part(x[1], PART_V), f, &p);
    else
        op->rule3(n, order, a, expr_part(x[1], PART_V), expr_part(x[2], PART_V), f, &p);
    jets_chain(n, z, op->operands, x, &p, op->curved);
}

static void run(const expr_code *c, int n, int order, expr_jets *const *slot, int wanted)
{
    const expr_view z = {slot[c->z], c->has_z & wanted};
    expr_view x[EXPR_OPERANDS];
    for (int i = 0; i < EXPR_OPERANDS; i++)
        x[i] = (expr_view){slot[c->arg[i]], c->has[i] & wanted};
    if (c->op->run)
        c->op->run(n, z, x, c->k);
    else
        run_rule(c->op, n, order, z, x);
}

void expr_eval(const expr *e, int n, const double *u, const double *w, int order, expr_jets *out)
{
    static const int parts[] = {HAS_V, HAS_V | HAS_FIRST, HAS_V | HAS_FIRST | HAS_SECOND};
    assert(n >= 0 && n <= EXPR_BATCH && order >= 0 && order <= 2);
    const int wanted = parts[order];
    expr_jets work[EXPR_SLOTS], *slot[EXPR_SLOTS];
    for (int s = 0; s < EXPR_SLOTS; s++)
        slot[s] = s == e->result ? out : &work[s];

    memcpy(slot[0]->v, u, (size_t)n * sizeof *u);
    memcpy(slot[1]->v, w, (size_t)n * sizeof *w);
    jets_fill(n, (expr_view){slot[0], HAS_U & wanted}, NULL, 1);
    jets_fill(n, (expr_view){slot[1], HAS_W & wanted}, NULL, 1);
    for (int i = 0; i < e->count; i++)
        run(&e->code[i], n, order, slot, wanted);
    jets_fill(n, (expr_view){out, wanted & ~e->has}, NULL, 0);
}
