#include "expr/compile.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SLOT_U, SLOT_W };

void emitter_begin(emitter *e)
{
    e->count = 0;
    e->used = 1u << SLOT_U | 1u << SLOT_W;
    e->has[SLOT_U] = HAS_V | HAS_U;
    e->has[SLOT_W] = HAS_V | HAS_W;
    e->problem = NULL;
}

operand expr_emit_constant(double k) { return (operand){.constant = true, .k = k}; }
operand expr_emit_u(void) { return (operand){.slot = SLOT_U}; }
operand expr_emit_w(void) { return (operand){.slot = SLOT_W}; }

/* The second partials that the chain rule makes of first partials i of one operand and j of the other. */
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

/* The parts of a result that can differ from 0. */
static int parts_of(enum expr_op op, const uint8_t *has)
{
    int a = has[0], b = has[1], c = has[2];
    switch (op) {
    case OP_CONST:
    case OP_FLOOR:
        return HAS_V;
    case OP_ADDK:
    case OP_MULK:
    case OP_ABS:
        return a;
    case OP_ADD:
    case OP_SUB:
    case OP_MOD:
    case OP_MIN:
    case OP_MAX:
        return a | b;
    case OP_MUL:
        return a | b | cross(a, b);
    case OP_DIV:
        return a | b | cross(a, b) | cross(b, b);
    case OP_SELECT:
    case OP_SELECT4: /* has[3] is 0 where there is no fourth */
        return b | c | has[3];
    default: /* curved in every direction */
        return a | b | cross(a | b, a | b);
    }
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

static operand append(emitter *e, enum expr_op op, int n, const operand *arg, double k)
{
    if (e->count == EXPR_MAX_CODE) {
        e->problem = "expression too long, expected at most 1024 operations";
        return expr_emit_constant(0);
    }
    expr_code c = {.op = (uint8_t)op, .k = k};
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
static operand fold(enum expr_op op, int n, const operand *arg)
{
    expr_code code[5];
    for (int i = 0; i < n; i++)
        code[i] = (expr_code){.op = OP_CONST, .z = (uint8_t)(2 + i), .has_z = HAS_V, .k = arg[i].k};
    code[n] = (expr_code){
        .op = (uint8_t)op, .z = 2 + 4, .arg = {2, 3, 4, 5}, .has = {HAS_V, HAS_V, HAS_V, HAS_V}, .has_z = HAS_V};
    expr e = {.count = n + 1, .result = 2 + 4, .has = HAS_V, .code = code};
    const double none = 0;
    expr_jets out;
    expr_eval(&e, 1, &none, &none, 0, &out);
    return expr_emit_constant(out.v[0]);
}

static operand with_constant(emitter *e, enum expr_op op, operand a, double k) { return append(e, op, 1, &a, k); }

/* a^k for those k that are cheaper, and more exact, without logarithm. False: for another k. */
static bool simple_power(emitter *e, operand a, double k, operand *z)
{
    if (k == 0)
        *z = expr_emit_constant(1);
    else if (k == 0.5)
        *z = append(e, OP_SQRT, 1, &a, 0);
    else if (k == floor(k) && fabs(k) <= EXPR_MAX_POWER) {
        *z = fabs(k) == 1 ? a : with_constant(e, OP_POWI, a, fabs(k));
        if (k < 0)
            *z = expr_emit(e, OP_DIV, 2, (operand[]){expr_emit_constant(1), *z});
    } else
        return false;
    return true;
}

operand expr_emit(emitter *e, enum expr_op op, int n, const operand *arg)
{
    bool constant = true;
    for (int i = 0; i < n; i++)
        constant = constant && arg[i].constant;
    if (constant)
        return fold(op, n, arg);

    operand a = arg[0], b = n > 1 ? arg[1] : a;
    if (op == OP_ADD && a.constant)
        return with_constant(e, OP_ADDK, b, a.k);
    if (op == OP_ADD && b.constant)
        return with_constant(e, OP_ADDK, a, b.k);
    if (op == OP_SUB && a.constant)
        return with_constant(e, OP_ADDK, with_constant(e, OP_MULK, b, -1), a.k);
    if (op == OP_SUB && b.constant)
        return with_constant(e, OP_ADDK, a, -b.k);
    if (op == OP_MUL && a.constant)
        return with_constant(e, OP_MULK, b, a.k);
    if (op == OP_MUL && b.constant)
        return with_constant(e, OP_MULK, a, b.k);
    operand z, in[4];
    if (op == OP_POW && b.constant && simple_power(e, a, b.k, &z))
        return z;
    for (int i = 0; i < n; i++)
        in[i] = arg[i].constant ? append(e, OP_CONST, 0, NULL, arg[i].k) : arg[i];
    return append(e, op, n, in, 0);
}

expr *emitter_end(emitter *e, operand result)
{
    if (result.constant)
        result = append(e, OP_CONST, 0, NULL, result.k);
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
