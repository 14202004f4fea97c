/* Compiling: the parser states operations, this turns them into a program, folding constants and choosing
 * the cheapest form. Private to expr.c and expr_emit.c.
 */
#ifndef KAGE_EXPR_COMPILE_H
#define KAGE_EXPR_COMPILE_H

#include "expr/program.h"

/* A constant, or a result in a slot. Each operand is used once. */
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
operand expr_emit_u(void);
operand expr_emit_w(void);

/* The result of op on n operands: one of enum expr_op that takes no constant. After a problem the results
 * have no meaning. */
operand expr_emit(emitter *e, enum expr_op op, int n, const operand *arg);

/* The program that computes `result`; NULL: out of memory. */
expr *emitter_end(emitter *e, operand result);

#endif
