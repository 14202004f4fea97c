/* Evaluating an operation by its rule. */
#include "expr/operation.h"

void expr_run_rule(const expr_code *c, int n, int order, expr_view z, const expr_view *x)
{
    const expr_op *op = c->op;
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
