/* P from an expression in u and w, with exact partials by forward-mode differentiation (expr.h). */
#include "perturb.h"

#include <stdlib.h>

typedef struct function {
    perturb base;
    expr *f;
    double scale;
} function;

static void function_copy(int n, double scale, const double *restrict from, real *restrict to)
{
    for (int i = 0; i < n; i++)
        to[i] = (real)(scale * from[i]);
}

static void function_eval(const perturb *base, int n, const real *u, const real *w, int order, heights *h)
{
    const function *p = (const function *)base;
    for (int at = 0; at < n; at += EXPR_BATCH) {
        int m = n - at < EXPR_BATCH ? n - at : EXPR_BATCH;
        double x[EXPR_BATCH], y[EXPR_BATCH];
        expr_jets j;
        for (int i = 0; i < m; i++) {
            x[i] = (double)u[at + i];
            y[i] = (double)w[at + i];
        }
        expr_eval(p->f, m, x, y, order, &j);
        function_copy(m, p->scale, j.v, h->P + at);
        if (order >= 1) {
            function_copy(m, p->scale, j.u, h->Pu + at);
            function_copy(m, p->scale, j.w, h->Pw + at);
        }
        if (order >= 2) {
            function_copy(m, p->scale, j.uu, h->Puu + at);
            function_copy(m, p->scale, j.uw, h->Puw + at);
            function_copy(m, p->scale, j.ww, h->Pww + at);
        }
    }
}

static void function_free(perturb *base)
{
    expr_free(((function *)base)->f);
    free(base);
}

static const perturb_methods function_methods = {"function", function_eval, function_free};

/* Interval arithmetic takes each mention of u for another variable, so its bounds are wide over a wide extent. Over
 * CELLS x CELLS parts of it they are close. */
static void function_bounds(const expr *f, const double u[2], const double w[2], double *lo, double *hi)
{
    enum { CELLS = 64 };
    int nu = u[1] - u[0] < HUGE_VAL ? CELLS : 1, nw = w[1] - w[0] < HUGE_VAL ? CELLS : 1;
    *lo = HUGE_VAL;
    *hi = -HUGE_VAL;
    for (int j = 0; j < nw; j++)
        for (int i = 0; i < nu; i++) {
            double a, b;
            double u0 = nu > 1 ? u[0] + (u[1] - u[0]) * i / nu : u[0], w0 = nw > 1 ? w[0] + (w[1] - w[0]) * j / nw : w[0];
            double u1 = nu > 1 ? u[0] + (u[1] - u[0]) * (i + 1) / nu : u[1];
            double w1 = nw > 1 ? w[0] + (w[1] - w[0]) * (j + 1) / nw : w[1];
            expr_range(f, u0, u1, w0, w1, &a, &b);
            *lo = a < *lo ? a : *lo;
            *hi = b > *hi ? b : *hi;
        }
}

perturb *perturb_function(expr *f, double scale, const double u[2], const double w[2])
{
    function *p = calloc(1, sizeof *p);
    if (!p) {
        expr_free(f);
        return NULL;
    }
    double lo, hi;
    function_bounds(f, u, w, &lo, &hi);
    p->base.is = &function_methods;
    if (scale != 0) { /* 0 times an infinite bound is no bound */
        p->base.Pmin = (real)(scale < 0 ? scale * hi : scale * lo);
        p->base.Pmax = (real)(scale < 0 ? scale * lo : scale * hi);
    }
    p->f = f;
    p->scale = scale;
    return &p->base;
}
