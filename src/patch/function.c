/* Q(u,w) from three expressions, with exact partials by forward-mode differentiation (expr.h). */
#include "patch/patch.h"

#include <stdlib.h>

typedef struct function {
    patch base;
    expr *axis[3]; /* x, y, z */
} function;

static void function_eval(const patch *base, int n, const int32_t *part, const double *u, const double *w, int order,
                          patch_jets *out)
{
    const function *q = (const function *)base;
    (void)part;
    for (int k = 0; k < 3; k++)
        expr_eval(q->axis[k], n, u, w, order, &out->axis[k]);
}

static void function_bound(const patch *base, int part, const double u[2], const double w[2], patch_bounds *out,
                           patch_hessians *second)
{
    const function *q = (const function *)base;
    (void)part;
    for (int k = 0; k < 3; k++)
        if (second)
            expr_bound_hessian(q->axis[k], u[0], u[1], w[0], w[1], &out->axis[k], &second->axis[k]);
        else
            expr_bound_gradient(q->axis[k], u[0], u[1], w[0], w[1], &out->axis[k]);
}

static void function_free(patch *base)
{
    function *q = (function *)base;
    for (int k = 0; k < 3; k++)
        expr_free(q->axis[k]);
    free(q);
}

static const patch_ops function_methods = {.eval = function_eval, .bound = function_bound, .free = function_free};

patch *patch_function_new(const char *kind, expr *const xyz[3], const double u[2], const double w[2])
{
    function *q = xyz[0] && xyz[1] && xyz[2] ? calloc(1, sizeof *q) : NULL;
    for (int k = 0; k < 3; k++)
        if (q)
            q->axis[k] = xyz[k];
        else
            expr_free(xyz[k]);
    if (!q)
        return NULL;
    q->base = (patch){&function_methods, kind, 1, {u[0], u[1]}, {w[0], w[1]}, 0};
    return &q->base;
}
