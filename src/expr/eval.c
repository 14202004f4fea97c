/* Evaluation: one operation after the other, each over the whole batch. */
#include <assert.h>
#include <string.h>

#include "expr/operation.h"

static void run(const expr_code *c, int n, int order, expr_jets *const *slot, int wanted)
{
    const expr_view z = {slot[c->z], c->has_z & wanted};
    expr_view x[EXPR_OPERANDS];
    for (int i = 0; i < EXPR_OPERANDS; i++)
        x[i] = (expr_view){slot[c->arg[i]], c->has[i] & wanted};
    c->op->run(c, n, order, z, x);
}

void expr_eval(const expr *e, int n, const double *u, const double *w, int order, expr_jets *out)
{
    static const int parts[] = {HAS_V, HAS_V | HAS_FIRST, HAS_V | HAS_FIRST | HAS_UU | HAS_UW | HAS_WW};
    assert(n >= 0 && n <= EXPR_BATCH && order >= 0 && order <= 2);
    const int wanted = parts[order];
    expr_jets work[EXPR_SLOTS], *slot[EXPR_SLOTS];
    for (int s = 0; s < EXPR_SLOTS; s++)
        slot[s] = s == e->result ? out : &work[s];

    memcpy(slot[0]->v, u, (size_t)n * sizeof *u);
    memcpy(slot[1]->v, w, (size_t)n * sizeof *w);
    jets_fill(n, (expr_view){slot[0], HAS_U & wanted}, 1);
    jets_fill(n, (expr_view){slot[1], HAS_W & wanted}, 1);
    for (int i = 0; i < e->count; i++)
        run(&e->code[i], n, order, slot, wanted);
    jets_fill(n, (expr_view){out, wanted & ~e->has}, 0);
}
