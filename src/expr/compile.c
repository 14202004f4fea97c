/* Makes a program of operations: assigns slots, finds which parts of results can be nonzero, folds constants. */
#include "expr/operation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void emitter_begin(emitter *e)
{
    e->count = 0;
    e->used = 1u << SLOT_U | 1u << SLOT_W;
    e->has[SLOT_U] = HAS_V | HAS_U;
    e->has[SLOT_W] = HAS_V | HAS_W;
    e->problem = NULL;
}

operand expr_emit_constant(double k) { return (operand){.constant = true, .k = k}; }

/* The second partials that are products of first partials i of one operand and j of another. */
static int cross(int i, int j)
{
    int has = 0;
    if (i & j & HAS_U)
        has |= HAS_UU;
    if (i & j & HAS_W)
        has |= HAS_WW;
    if ((i & HAS_U && j & HAS_W) || (i & HAS_W && j & HAS_U))
        has |= HAS_UW;
    return has;
}

/* The parts of a result that can be nonzero: those of the operands, and for operands with a nonzero f_ij the products
 * of their first partials. */
static int parts_of(const expr_op *op, const uint8_t *has)
{
    int z = HAS_V;
    if (op->steps)
        return z;
    for (int k = op->deciding; k < op->operands; k++)
        z |= has[k];
    for (int m = 0; m < EXPR_PAIRS; m++)
        if (op->curved >> m & 1)
            z |= cross(has[expr_pairs[m].i], has[expr_pairs[m].j]);
    return z;
}

static int new_slot(emitter *e)
{
    for (int s = 0; s < EXPR_SLOTS; s++)
        if (!(e->used >> s & 1)) {
            e->used |= 1u << s;
            return s;
        }
    e->problem = "too many intermediate results at a time, expected at most 30: nest the other way round";
    return EXPR_SLOTS - 1;
}

static operand append(emitter *e, const expr_op *op, int n, const operand *arg, double k)
{
    if (e->count == EXPR_MAX_CODE) {
        e->problem = "expression too long, expected at most 1024 operations";
        return expr_emit_constant(0);
    }
    expr_code c = {.op = op, .k = k};
    for (int i = 0; i < n; i++) {
        c.arg[i] = (uint8_t)arg[i].slot;
        c.has[i] = e->has[arg[i].slot];
    }
    operand z = {.slot = new_slot(e)};
    c.z = (uint8_t)z.slot;
    c.has_z = e->has[z.slot] = (uint8_t)parts_of(op, c.has);
    for (int i = 0; i < n; i++)
        if (arg[i].slot > SLOT_W)
            e->used &= ~(1u << arg[i].slot);
    e->code[e->count++] = c;
    return z;
}

/* Constants are folded by the evaluator itself, so that folding changes no byte of a result. */
static operand fold(const expr_op *op, int n, const operand *arg)
{
    enum { FIRST = 2, RESULT = FIRST + EXPR_OPERANDS }; /* slots */
    expr_code code[EXPR_OPERANDS + 1];
    code[n] = (expr_code){.op = op, .z = RESULT, .has_z = HAS_V};
    for (int i = 0; i < n; i++) {
        code[i] = (expr_code){.op = &expr_constant, .z = (uint8_t)(FIRST + i), .has_z = HAS_V, .k = arg[i].k};
        code[n].arg[i] = code[i].z;
        code[n].has[i] = HAS_V;
    }
    expr e = {.count = n + 1, .result = RESULT, .has = HAS_V, .code = code};
    const double none = 0;
    expr_jets out;
    expr_eval(&e, 1, &none, &none, 0, &out);
    return expr_emit_constant(out.v[0]);
}

operand expr_emit_with(emitter *e, const expr_op *op, operand a, double k) { return append(e, op, 1, &a, k); }

operand expr_emit(emitter *e, const expr_op *op, int n, const operand *arg)
{
    bool constant = true;
    for (int i = 0; i < n; i++)
        constant = constant && arg[i].constant;
    if (constant)
        return fold(op, n, arg);

    operand a = arg[0], b = n > 1 ? arg[1] : a;
    if (op == &expr_add && a.constant)
        return expr_emit_with(e, &expr_add_k, b, a.k);
    if (op == &expr_add && b.constant)
        return expr_emit_with(e, &expr_add_k, a, b.k);
    if (op == &expr_subtract && a.constant)
        return expr_emit_with(e, &expr_add_k, expr_emit_with(e, &expr_multiply_k, b, -1), a.k);
    if (op == &expr_subtract && b.constant)
        return expr_emit_with(e, &expr_add_k, a, -b.k);
    if (op == &expr_multiply && a.constant)
        return expr_emit_with(e, &expr_multiply_k, b, a.k);
    if (op == &expr_multiply && b.constant)
        return expr_emit_with(e, &expr_multiply_k, a, b.k);
    operand in[EXPR_OPERANDS];
    for (int i = 0; i < n; i++)
        in[i] = arg[i].constant ? append(e, &expr_constant, 0, NULL, arg[i].k) : arg[i];
    return append(e, op, n, in, 0);
}

expr *emitter_end(emitter *e, operand result)
{
    if (result.constant)
        result = append(e, &expr_constant, 0, NULL, result.k);
    size_t bytes = (size_t)e->count * sizeof *e->code;
    expr *x = malloc(sizeof *x);
    expr_code *code = malloc(bytes ? bytes : 1); /* none: the expression is u or w */
    if (!x || !code) {
        free(x);
        free(code);
        return NULL;
    }
    memcpy(code, e->code, bytes);
    *x = (expr){.count = e->count, .result = result.slot, .has = e->has[result.slot], .code = code};
    return x;
}

void expr_free(expr *e)
{
    if (e)
        free(e->code);
    free(e);
}
