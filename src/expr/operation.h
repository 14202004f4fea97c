/* The operations of the language. One is described by an expr_op: its name, how it is evaluated, its bounds, its text
 * for POV-Ray. The rest of the room knows no operation but sums and products.
 *
 * To add a function, write its rules and its row into elementary.c (one operand) or functions.c (two or three).
 */
#ifndef KAGE_EXPR_OPERATION_H
#define KAGE_EXPR_OPERATION_H

#include "expr/compile.h"
#include "expr/jets.h"
#include "math/interval.h"

/* What an operation's bounds are computed from. */
typedef struct expr_ranges {
    interval x[EXPR_OPERANDS]; /* of the operands */
    interval f;                /* of the result, for bounds of its partials */
    double k;                  /* the constant of an operation that has one */
    bool same;                 /* the first two operands are one result */
} expr_ranges;

/* Bounds of the partials f_i by the operands, and of f_ij in the order of expr_pairs. */
typedef struct expr_gradient {
    interval d[EXPR_CURVED];
} expr_gradient;

typedef struct expr_hessian {
    interval dd[EXPR_PAIRS];
} expr_hessian;

/* How an operation is written in a language of formulas such as POV-Ray's. */
enum expr_binding { EXPR_CALL, EXPR_SUM, EXPR_PRODUCT };

enum { EXPR_ANY_NUMBER = 1000 }; /* of arguments: a chain, folded from the left */

typedef struct expr_op expr_op;
struct expr_op {
    /* The language. A row may have no name (+, and what only the compiler uses) or no more than `build` (clamp). */
    const char *name;
    int least, most; /* arguments */
    /* From the arguments to operations; NULL: to this one. */
    operand (*build)(emitter *e, int n, const operand *arg);

    int operands;
    int deciding; /* of these, the first so many only decide between the others: select */
    int curved;   /* set of EXPR_AA ...: the second partials that can differ from 0 */
    bool steps;   /* all partials are 0: floor */

    /* Evaluation: by `run`, or where that is NULL, by the one rule that is set, and the chain rule. */
    expr_run *run;
    expr_rule1 *rule1;
    expr_rule2 *rule2;
    expr_rule3 *rule3;

    /* Bounds. The partials are bounds of differences too, so a kink has the derivatives of both its sides and all
     * between, and a jump an infinite one. */
    interval (*value)(const expr_ranges *r);
    expr_gradient (*gradient)(const expr_ranges *r); /* NULL: 0 */
    expr_hessian (*hessian)(const expr_ranges *r);   /* NULL: 0 */
    /* Instead of gradient and hessian, for an operation whose result is always equal to one of its operands: which of
     * them it is equal to somewhere, bit k for operand k. */
    int (*reached)(const expr_ranges *r);

    /* POV-Ray's text: the name of a function; or a formula in which $1, $2 ... are the operands, put in parentheses
     * where needed; or what stands between two operands, when `binding` is not EXPR_CALL. NULL: it has no such
     * function. */
    const char *pov;
    enum expr_binding binding;
};

/* Operations on constants and sums and products (arithmetic.c). Those with _k have one operand and a constant. */
extern const expr_op expr_constant, expr_add_k, expr_multiply_k, expr_add, expr_subtract, expr_multiply, expr_divide;

/* Those of the language by name, in lists that end with NULL. */
extern const expr_op *const expr_elementary[], *const expr_functions[], *const expr_choices[];

extern const expr_op expr_sqrt, expr_pow, expr_power_k;

#endif
