/* The operations of the language. An expr_op describes one: its name, evaluation, bounds, and text for POV-Ray. Other
 * files of the room know only sums, products, powers and sqrt by name.
 *
 * To add a function, write its rules and its row into elementary.c (one operand) or functions.c (two or three).
 */
#ifndef KAGE_EXPR_OPERATION_H
#define KAGE_EXPR_OPERATION_H

#include "expr/compile.h"
#include "expr/jets.h"
#include "math/interval.h"

/* The arguments of an operation's bounds. */
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

/* How tightly an operation binds its operands in POV-Ray's text. */
enum expr_binding { EXPR_CALL, EXPR_SUM, EXPR_PRODUCT };

enum { EXPR_ANY_NUMBER = 1000 }; /* of arguments; f(a,b,c) is f(f(a,b),c) */

typedef struct expr_op expr_op;
struct expr_op {
    /* The language. NULL for operators and internal operations. */
    const char *name;
    int least, most; /* arguments */
    /* Emits other operations for a call, as clamp does; NULL: this one. */
    operand (*build)(emitter *e, int n, const operand *arg);

    int operands;
    int deciding; /* how many of the first operands only choose between the others: 1 for select */
    int curved;   /* set of EXPR_AA ...: the second partials that can be nonzero */
    bool steps;   /* all partials are 0: floor */

    /* Evaluation: by `run`, or where that is NULL, by the one rule that is set, and the chain rule. */
    expr_run *run;
    expr_rule1 *rule1;
    expr_rule2 *rule2;
    expr_rule3 *rule3;

    /* Bounds; those of partials are Lipschitz bounds (bounds.c). */
    interval (*value)(const expr_ranges *r);
    expr_gradient (*gradient)(const expr_ranges *r); /* NULL: 0 */
    expr_hessian (*hessian)(const expr_ranges *r);   /* NULL: 0 */
    /* Instead of gradient and hessian, if the result is always one of the operands: the set of those that it can be,
     * bit k for operand k. */
    int (*reached)(const expr_ranges *r);

    /* POV-Ray's text. With EXPR_CALL the name of a function, or a formula of the operands $1, $2 ...; else the operator
     * between two operands. NULL: POV-Ray has none. */
    const char *pov;
    enum expr_binding binding;
};

/* Operations on constants and sums and products (arithmetic.c). Those with _k have one operand and a constant. */
extern const expr_op expr_constant, expr_add_k, expr_multiply_k, expr_add, expr_subtract, expr_multiply, expr_divide;

/* Those of the language by name, in lists that end with NULL. */
extern const expr_op *const expr_elementary[], *const expr_functions[], *const expr_choices[];

extern const expr_op expr_sqrt, expr_pow, expr_power_k;

#endif
