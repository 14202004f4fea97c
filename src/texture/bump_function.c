/* P from an expression in u and w, with exact partials by forward-mode differentiation (expr.h). */
#include "texture/bump.h"

#include "base/vec3.h"

#include <stdlib.h>

typedef struct function {
    bump base;
    expr *f;
    double scale;
    double u[2], w[2]; /* the range that its bounds hold for */
} function;

static void function_copy(int n, double scale, const double *restrict from, real *restrict to)
{
    for (int i = 0; i < n; i++)
        to[i] = (real)(scale * from[i]);
}

/* The number of places where P, or from order 1 on its slope, is NaN, infinite or beyond REAL_FAR. */
STAGE static int count_undefined(int n, int order, const real *restrict P, const real *restrict Pu,
                                 const real *restrict Pw)
{
    int none = 0;
    if (order == 0)
        for (int i = 0; i < n; i++)
            none += REAL_IS_FAR(P[i]);
    else
        for (int i = 0; i < n; i++)
            none += REAL_IS_FAR(real_abs(P[i]) + real_abs(Pu[i]) + real_abs(Pw[i]));
    return none;
}

static void level_undefined(int n, int order, bump_values *h)
{
    for (int i = 0; i < n; i++) {
        h->none[i] = count_undefined(1, order, h->P + i, h->Pu + i, h->Pw + i);
        if (h->none[i])
            h->P[i] = h->Pu[i] = h->Pw[i] = h->Puu[i] = h->Puw[i] = h->Pww[i] = 0;
    }
}

static void function_eval(const bump *base, int n, const real *u, const real *w, int order, bump_values *h)
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
        expr_eval(p->f, m, x, y, order < 2 ? order : 2, &j);
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
    h->undefined = count_undefined(n, order, h->P, h->Pu, h->Pw);
    if (h->undefined)
        level_undefined(n, order, h);
}

static void function_jets(const bump *base, int n, const double *u, const double *w, expr_jets *out)
{
    const function *p = (const function *)base;
    const double scale = p->scale;
    expr_eval(p->f, n, u, w, 1, out);
    for (int i = 0; i < n; i++) {
        out->v[i] *= scale;
        out->u[i] *= scale;
        out->w[i] *= scale;
        if (!(fabs(out->v[i]) + fabs(out->u[i]) + fabs(out->w[i]) < HUGE_VAL))
            out->v[i] = out->u[i] = out->w[i] = 0;
    }
}

/* range *= scale; 0 for a scale of 0, even if the range is infinite */
static void scaled(double scale, double range[2])
{
    const double a = scale == 0 ? 0 : scale * range[0], b = scale == 0 ? 0 : scale * range[1];
    range[0] = lesser(a, b);
    range[1] = greater(a, b);
}

static void function_bound(const bump *base, const double u[2], const double w[2], expr_bounds *out)
{
    const function *p = (const function *)base;
    expr_bound_gradient(p->f, u[0], u[1], w[0], w[1], out);
    scaled(p->scale, out->v);
    scaled(p->scale, out->u);
    scaled(p->scale, out->w);
}

static void function_free(bump *base)
{
    pyramid_free(base->pyramid);
    expr_free(((function *)base)->f);
    free(base);
}

static double widest(const double range[2], double so_far)
{
    return greater(so_far, greater(fabs(range[0]), fabs(range[1])));
}

/* The start of part i of n of an extent; part i - 1 ends at the same number. */
static double part(const double extent[2], int i, int n)
{
    return i == 0 ? extent[0] : i == n ? extent[1] : extent[0] + (extent[1] - extent[0]) * i / n;
}

/* Interval arithmetic treats each u in the expression as a variable of its own, so its bounds are wide over a wide
 * extent. Over CELLS x CELLS parts they are close. The parts share their edges, so P cannot jump between them. */
enum { CELLS = 64 }; /* along u and along w */

static int parts_of(const double extent[2]) { return extent[1] - extent[0] < HUGE_VAL ? CELLS : 1; }

static void function_bounds(const expr *f, const double u[2], const double w[2], double P[2], double slope[2])
{
    const int nu = parts_of(u), nw = parts_of(w);
    P[0] = HUGE_VAL;
    P[1] = -HUGE_VAL;
    slope[0] = slope[1] = 0;
    for (int j = 0; j < nw; j++)
        for (int i = 0; i < nu; i++) {
            expr_bounds b;
            expr_bound_gradient(f, part(u, i, nu), part(u, i + 1, nu), part(w, j, nw), part(w, j + 1, nw), &b);
            P[0] = lesser(P[0], b.v[0]);
            P[1] = greater(P[1], b.v[1]);
            slope[0] = widest(b.u, slope[0]);
            slope[1] = widest(b.w, slope[1]);
        }
}

/* ---- for range ---- */

/* One axis of a grid of parts: parts per unit, and the part at 0. */
static void lay_axis(const double extent[2], int parts, real *k, real *o)
{
    const double size = extent[1] - extent[0];
    *k = parts > 1 && size > 0 ? (real)(parts / size) : 0;
    *o = parts > 1 && size > 0 ? (real)(-extent[0] * parts / size) : 0;
}

static cell_range function_part(const void *user, int row, int column)
{
    const function *p = user;
    const int nu = parts_of(p->u), nw = parts_of(p->w);
    const double u[2] = {part(p->u, column, nu), part(p->u, column + 1, nu)},
                 w[2] = {part(p->w, row, nw), part(p->w, row + 1, nw)};
    expr_bounds b;
    function_bound(&p->base, u, w, &b);
    return (cell_range){b.v[0], b.v[1], b.u[0], b.u[1], b.w[0], b.w[1]};
}

static void function_bends(function *p)
{
    const int nu = parts_of(p->u), nw = parts_of(p->w);
    double uu = 0, uw = 0, ww = 0;
    for (int j = 0; j < nw; j++)
        for (int i = 0; i < nu; i++) {
            expr_bounds b;
            expr_hessians h;
            expr_bound_hessian(p->f, part(p->u, i, nu), part(p->u, i + 1, nu), part(p->w, j, nw), part(p->w, j + 1, nw),
                               &b, &h);
            uu = widest(h.uu, uu);
            uw = widest(h.uw, uw);
            ww = widest(h.ww, ww);
        }
    p->base.Puu_max = bump_slope(uu, p->scale);
    p->base.Puw_max = bump_slope(uw, p->scale);
    p->base.Pww_max = bump_slope(ww, p->scale);
}

static bool function_prepare(bump *base, const progress *w)
{
    function *p = (function *)base;
    table_grid g = {.columns = parts_of(p->u), .rows = parts_of(p->w)};
    lay_axis(p->u, g.columns, &g.ku, &g.ou);
    lay_axis(p->w, g.rows, &g.kw, &g.ow);
    p->base.pyramid = pyramid_new(&g, function_part, p, w);
    if (p->base.pyramid)
        function_bends(p);
    return p->base.pyramid;
}

static const bump_ops function_methods = {.kind = "function",
                                          .eval = function_eval,
                                          .jets = function_jets,
                                          .bound = function_bound,
                                          .range = bump_range,
                                          .prepare = function_prepare,
                                          .free = function_free};

bump *bump_function_new(expr *f, double scale, const double u[2], const double w[2])
{
    function *p = calloc(1, sizeof *p);
    if (!p) {
        expr_free(f);
        return NULL;
    }
    double P[2], slope[2];
    function_bounds(f, u, w, P, slope);
    p->base.ops = &function_methods;
    if (scale != 0) { /* 0 times an infinite bound would be NaN */
        p->base.Pmin = (real)(scale < 0 ? scale * P[1] : scale * P[0]);
        p->base.Pmax = (real)(scale < 0 ? scale * P[0] : scale * P[1]);
    }
    p->base.Pu_max = bump_slope(slope[0], scale);
    p->base.Pw_max = bump_slope(slope[1], scale);
    bump_unknown_bends(&p->base);
    for (int k = 0; k < 2; k++) {
        p->u[k] = u[k];
        p->w[k] = w[k];
    }
    p->f = f;
    p->scale = scale;
    return &p->base;
}
