/* A compiled expression: a list of operations on slots, without jumps. Private to this room and to exports.
 *
 * A slot stores the jet of an intermediate result. Slots 0 and 1 are u and w. An operation never writes a slot of its
 * operands. The compiler finds which partials of a result can be nonzero (6*u has no w, uu, uw, ww); only those are
 * computed and read.
 */
#ifndef KAGE_EXPR_PROGRAM_H
#define KAGE_EXPR_PROGRAM_H

#include <stdint.h>

#include "expr/expr.h"

enum {
    EXPR_MAX_TEXT = 4096, /* bytes */
    EXPR_MAX_CODE = 1024, /* operations */
    EXPR_MAX_DEPTH = 64,  /* of nesting, which is that of the parser's recursion */
    EXPR_SLOTS = 32,      /* u, w, and 30 intermediate results at a time */
    EXPR_OPERANDS = 4,    /* of one operation at the most */
    EXPR_MAX_POWER = 16   /* the largest exponent that is multiplied out */
};

/* The parts of a jet, and sets of them. */
enum expr_part { PART_V, PART_U, PART_W, PART_UU, PART_UW, PART_WW, PARTS };
enum {
    HAS_V = 1 << PART_V,
    HAS_U = 1 << PART_U,
    HAS_W = 1 << PART_W,
    HAS_UU = 1 << PART_UU,
    HAS_UW = 1 << PART_UW,
    HAS_WW = 1 << PART_WW,
    HAS_FIRST = HAS_U | HAS_W,
    HAS_SECOND = HAS_UU | HAS_UW | HAS_WW
};

struct expr_op; /* operation.h */

typedef struct expr_code {
    const struct expr_op *op;
    uint8_t z;                  /* slot of the result */
    uint8_t arg[EXPR_OPERANDS]; /* slots of the operands */
    uint8_t has[EXPR_OPERANDS]; /* their parts */
    uint8_t has_z;
    double k; /* the constant of an operation that has one */
} expr_code;

struct expr {
    int count;
    int result; /* slot */
    uint8_t has;
    expr_code *code; /* owned */
};

#endif
