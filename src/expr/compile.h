/* The emitter: the parser calls it for each operation, and it builds a program, folds constants and chooses cheaper
 * operations where an operand is constant.
 */
#ifndef KAGE_EXPR_COMPILE_H
#define KAGE_EXPR_COMPILE_H

#include "expr/program.h"

enum { SLOT_U, SLOT_W }; /* the slots of u and w */

/* A constant, or a result in a slot, which is used as an operand once. */
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

/* Emit an operation on n operands. After a problem the results have no meaning. */
operand expr_emit(emitter *e, const struct expr_op *op, int n, const operand *arg);

/* Emit an operation on one operand, which is not constant, and the constant k. */
operand expr_emit_with(emitter *e, const struct expr_op *op, operand a, double k);

/* The program that computes `result`; expr_free. NULL: out of memory. */
expr *emitter_end(emitter *e, operand result);

#endif
