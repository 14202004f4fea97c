/* Arithmetic of jets (values with first and second partials) for batches of points: forward-mode differentiation. Parts
 * of a jet that are 0 for all points are neither stored nor read.
 *
 * In the products of the chain rule 0 times infinity is 0: a function of a constant operand is constant, however steep.
 * So sqrt(u^2 + w^2) has first partials 0 at its apex.
 */
#ifndef KAGE_EXPR_JETS_H
#define KAGE_EXPR_JETS_H

#include "expr/program.h"

/* An operand or a result: a jet, and the set of its parts that are nonzero and wanted. */
typedef struct expr_view {
    expr_jets *jet;
    int has;
} expr_view;

/* A part; NULL if the view does not have it. */
static inline double *expr_part(expr_view v, int p)
{
    /* the parts of a jet are arrays of one size, in the order of enum expr_part */
    return v.has >> p & 1 ? (double *)((char *)v.jet + (size_t)p * sizeof v.jet->v) : NULL;
}

/* The same, but zeros if the view does not have it. */
static inline const double *expr_part_or_zeros(expr_view v, int p)
{
    static const double zeros[EXPR_BATCH];
    return v.has >> p & 1 ? expr_part(v, p) : zeros;
}

/* A function with partials has at most 3 operands a, b, c, so 6 pairs of them; EXPR_AA ...: sets of pairs. */
enum { EXPR_CURVED = 3, EXPR_PAIRS = 6 };
enum { EXPR_AA = 1, EXPR_AB = 2, EXPR_AC = 4, EXPR_BB = 8, EXPR_BC = 16, EXPR_CC = 32, EXPR_ALL = 63 };
extern const struct expr_pair {
    int i, j;
} expr_pairs[EXPR_PAIRS];

/* The partials of a function by its operands. */
typedef struct expr_partials {
    double d[EXPR_CURVED][EXPR_BATCH], dd[EXPR_PAIRS][EXPR_BATCH];
} expr_partials;

/* A function f(a), f(a,b) or f(a,b,c) at n points, with order 1 also its first partials, with order 2 also its second.
 * RULE1, RULE2 and RULE3 in rule.h make them. */
typedef void expr_rule1(int n, int order, const double *restrict a, double *restrict f, double *restrict d,
                        double *restrict dd);
typedef void expr_rule2(int n, int order, const double *restrict a, const double *restrict b, double *restrict f,
                        expr_partials *restrict p);
typedef void expr_rule3(int n, int order, const double *restrict a, const double *restrict b, const double *restrict c,
                        double *restrict f, expr_partials *restrict p);

/* Computes all parts that z has, at n points, from operands x and a constant k, which not all operations use. */
typedef void expr_run(int n, expr_view z, const expr_view *x, double k);

/* z = k, x[0] + k, k x[0], x[0] + x[1], x[0] - x[1], x[0] x[1] */
expr_run jets_fill, jets_shift, jets_scale, jets_add, jets_subtract, jets_multiply;

/* The chain rule: the partials of z = f(x[0], x[1], ...). curved: which f_ij can differ from 0. */
void jets_chain(int n, expr_view z, int operands, const expr_view *x, const expr_partials *f, int curved);

#endif
