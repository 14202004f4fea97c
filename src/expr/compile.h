/* Compiling: the parser states operations, this turns them into a program, folding constants and choosing the cheapest
 * form.
 */
#ifndef KAGE_EXPR_COMPILE_H
#define KAGE_EXPR_COMPILE_H

#include "expr/program.h"

enum { SLOT_U, SLOT_W }; /* the slots of u and w */

/* A constant, or a result in a slot. Each result is an operand once. */
typedef struct operand {
    bool constant;
    double k;
    int slot;
} operand;

typedef struct emitter {
    int count;
    expr_code code[EXPR_MAX_CODE];
    uint32_t used;           /* slots in use, a bit each */
    uint8_t has[EXPR_SLOTS]; /* the parts of each slot in use */
    const char *problem;     /* the limit that was exceeded, or NULL */
} emitter;

void emitter_begin(emitter *e);

operand expr_emit_constant(double k);

/* The result of an operation on n operands. After a problem the results have no meaning. */
operand expr_emit(emitter *e, const struct expr_op *op, int n, const operand *arg);

/* The result of an operation on one operand, not a constant, and a constant. */
operand expr_emit_with(emitter *e, const struct expr_op *op, operand a, double k);

/* The program that computes `result`; NULL: out of memory. */
expr *emitter_end(emitter *e, operand result);

#endif
