/* Sums and products of jets, and the chain rule. The loops are stages over n points; z is never also an operand. */
#include "expr/jets.h"

#include "base/real.h"
#include "math/kmath.h"

const struct expr_pair expr_pairs[EXPR_PAIRS] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};

/* ---- loops ---- */

STAGE static void stage_fill(int n, double *z, double k)
{
    for (int i = 0; i < n; i++)
        z[i] = k;
}

STAGE static void stage_shift(int n, double *restrict z, const double *restrict x, double k)
{
    for (int i = 0; i < n; i++)
        z[i] = x[i] + k;
}

STAGE static void stage_scale(int n, double *restrict z, const double *restrict x, double k)
{
    for (int i = 0; i < n; i++)
        z[i] = x[i] * k;
}

STAGE static void stage_add(int n, double *restrict z, const double *x, const double *y)
{
    for (int i = 0; i < n; i++)
        z[i] = x[i] + y[i];
}

STAGE static void stage_subtract(int n, double *restrict z, const double *x, const double *y)
{
    for (int i = 0; i < n; i++)
        z[i] = x[i] - y[i];
}

STAGE static void stage_multiply(int n, double *restrict z, const double *x, const double *y)
{
    for (int i = 0; i < n; i++)
        z[i] = x[i] * y[i];
}

/* A term of a partial: 0 times infinity is 0. */
KM_INLINE double product(double x, double y)
{
    double p = x * y;
    p = x == 0 ? 0 : p;
    return y == 0 ? 0 : p;
}

STAGE static void stage_set_product(int n, double *restrict z, const double *x, const double *y)
{
    for (int i = 0; i < n; i++)
        z[i] = product(x[i], y[i]);
}

STAGE static void stage_add_product(int n, double *restrict z, const double *x, const double *y)
{
    for (int i = 0; i < n; i++)
        z[i] += product(x[i], y[i]);
}

STAGE static void stage_set_product3(int n, double *restrict z, const double *x, const double *y, const double *t)
{
    for (int i = 0; i < n; i++)
        z[i] = product(x[i], product(y[i], t[i]));
}

STAGE static void stage_add_product3(int n, double *restrict z, const double *x, const double *y, const double *t)
{
    for (int i = 0; i < n; i++)
        z[i] += product(x[i], product(y[i], t[i]));
}

/* ---- arithmetic ---- */

void jets_fill(int n, expr_view z, const expr_view *x, double k)
{
    (void)x;
    for (int p = 0; p < PARTS; p++)
        if (expr_part(z, p))
            stage_fill(n, expr_part(z, p), k);
}

void jets_scale(int n, expr_view z, const expr_view *x, double k)
{
    for (int p = 0; p < PARTS; p++)
        if (expr_part(z, p))
            stage_scale(n, expr_part(z, p), expr_part(*x, p), k);
}

void jets_shift(int n, expr_view z, const expr_view *x, double k)
{
    stage_shift(n, expr_part(z, PART_V), expr_part(*x, PART_V), k);
    jets_scale(n, (expr_view){z.jet, z.has & ~HAS_V}, x, 1);
}

void jets_add(int n, expr_view z, const expr_view *x, double k)
{
    (void)k;
    for (int p = 0; p < PARTS; p++)
        if (expr_part(z, p))
            stage_add(n, expr_part(z, p), expr_part_or_zeros(x[0], p), expr_part_or_zeros(x[1], p));
}

void jets_subtract(int n, expr_view z, const expr_view *x, double k)
{
    (void)k;
    for (int p = 0; p < PARTS; p++)
        if (expr_part(z, p))
            stage_subtract(n, expr_part(z, p), expr_part_or_zeros(x[0], p), expr_part_or_zeros(x[1], p));
}

/* ---- products and the chain rule ---- */

/* A second partial and its two first partials. */
static const struct {
    int ij, i, j;
} seconds[] = {{PART_UU, PART_U, PART_U}, {PART_UW, PART_U, PART_W}, {PART_WW, PART_W, PART_W}};

/* z is the sum of the terms so far; NULL: not asked for. A term with a factor NULL is 0 and left out. */
typedef struct sum {
    int n;
    double *z;
    bool begun;
} sum;

static void term(sum *s, const double *x, const double *y)
{
    if (!s->z || !x || !y)
        return;
    (s->begun ? stage_add_product : stage_set_product)(s->n, s->z, x, y);
    s->begun = true;
}

static void term3(sum *s, const double *x, const double *y, const double *t)
{
    if (!s->z || !y || !t)
        return;
    (s->begun ? stage_add_product3 : stage_set_product3)(s->n, s->z, x, y, t);
    s->begun = true;
}

/* (ab)_i = a_i b + a b_i, (ab)_ij = a_ij b + a b_ij + a_i b_j + a_j b_i */
void jets_multiply(int n, expr_view z, const expr_view *x, double k)
{
    const expr_view a = x[0], b = x[1];
    (void)k;
    const double *av = expr_part(a, PART_V), *bv = expr_part(b, PART_V);
    stage_multiply(n, expr_part(z, PART_V), av, bv);
    for (int i = PART_U; i <= PART_W; i++) {
        sum s = {n, expr_part(z, i), false};
        term(&s, expr_part(a, i), bv);
        term(&s, expr_part(b, i), av);
    }
    for (int m = 0; m < 3; m++) {
        int i = seconds[m].i, j = seconds[m].j;
        sum s = {n, expr_part(z, seconds[m].ij), false};
        term(&s, expr_part(a, seconds[m].ij), bv);
        term(&s, expr_part(b, seconds[m].ij), av);
        term(&s, expr_part(a, i), expr_part(b, j));
        term(&s, expr_part(a, j), expr_part(b, i));
    }
}

/* f_i = sum over operands a of f_a a_i, and
 * f_ij = sum over operands of f_a a_ij + sum over pairs of f_aa a_i a_j or f_ab (a_i b_j + a_j b_i). */
void jets_chain(int n, expr_view z, int operands, const expr_view *x, const expr_partials *f, int curved)
{
    for (int i = PART_U; i <= PART_W; i++) {
        sum s = {n, expr_part(z, i), false};
        for (int a = 0; a < operands; a++)
            term(&s, f->d[a], expr_part(x[a], i));
    }
    for (int k = 0; k < 3; k++) {
        int i = seconds[k].i, j = seconds[k].j;
        sum s = {n, expr_part(z, seconds[k].ij), false};
        for (int a = 0; s.z && a < operands; a++)
            term(&s, f->d[a], expr_part(x[a], seconds[k].ij));
        for (int m = 0; s.z && m < EXPR_PAIRS; m++) {
            if (!(curved >> m & 1))
                continue;
            const expr_view a = x[expr_pairs[m].i], b = x[expr_pairs[m].j];
            term3(&s, f->dd[m], expr_part(a, i), expr_part(b, j));
            if (expr_pairs[m].i != expr_pairs[m].j)
                term3(&s, f->dd[m], expr_part(a, j), expr_part(b, i));
        }
    }
}
