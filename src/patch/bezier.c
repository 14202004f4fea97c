/* Q(u,w) from bicubic Bezier patches: Q = sum over i and j of B_i(u) B_j(w) p_ij, B Bernstein's polynomials of
 * degree 3. */
#include "patch/patch.h"

#include "base/real.h"

#include <stdlib.h>
#include <string.h>

#define ROUNDING 1e-14 /* more than some thirty roundings come to, as a share of the largest coordinate */

typedef double net[16]; /* one coordinate of the control points of a patch; 4 j + i */

typedef struct bezier {
    patch base;
    net *axis[3]; /* by part */
} bezier;

/* Bernstein's polynomials and their first and second derivatives, for each lane. */
typedef struct weights {
    double b[3][4][PATCH_BATCH];
} weights;

STAGE static void bezier_weights(int n, const double *restrict x, weights *restrict k)
{
    for (int i = 0; i < n; i++) {
        double t = x[i], s = 1 - t;
        k->b[0][0][i] = s * s * s;
        k->b[0][1][i] = 3 * s * s * t;
        k->b[0][2][i] = 3 * s * t * t;
        k->b[0][3][i] = t * t * t;
        k->b[1][0][i] = -3 * s * s;
        k->b[1][1][i] = 3 * s * (s - 2 * t);
        k->b[1][2][i] = 3 * t * (2 * s - t);
        k->b[1][3][i] = 3 * t * t;
        k->b[2][0][i] = 6 * s;
        k->b[2][1][i] = 6 * (t - 2 * s);
        k->b[2][2][i] = 6 * (s - 2 * t);
        k->b[2][3][i] = 6 * t;
    }
}

/* The control points for each lane. Not a stage: no two lanes share a load, so memory sets the pace and SIMD would not
 * help (SSE2 has no gathers at all). */
static void bezier_gather(int n, const int32_t *part, const net *axis, double p[16][PATCH_BATCH])
{
    for (int i = 0; i < n; i++)
        for (int k = 0; k < 16; k++)
            p[k][i] = axis[part[i]][k];
}

/* z = sum of a_i b_j p_ij, the rows first. */
STAGE static void bezier_sum(int n, double (*restrict a)[PATCH_BATCH], double (*restrict b)[PATCH_BATCH],
                             double (*restrict p)[PATCH_BATCH], double *restrict z)
{
    for (int i = 0; i < n; i++) {
        double r0 = a[0][i] * p[0][i] + a[1][i] * p[1][i] + a[2][i] * p[2][i] + a[3][i] * p[3][i];
        double r1 = a[0][i] * p[4][i] + a[1][i] * p[5][i] + a[2][i] * p[6][i] + a[3][i] * p[7][i];
        double r2 = a[0][i] * p[8][i] + a[1][i] * p[9][i] + a[2][i] * p[10][i] + a[3][i] * p[11][i];
        double r3 = a[0][i] * p[12][i] + a[1][i] * p[13][i] + a[2][i] * p[14][i] + a[3][i] * p[15][i];
        z[i] = b[0][i] * r0 + b[1][i] * r1 + b[2][i] * r2 + b[3][i] * r3;
    }
}

static void bezier_eval(const patch *base, int n, const int32_t *part, const double *u, const double *w, int order,
                        patch_jets *out)
{
    const bezier *q = (const bezier *)base;
    weights a, b;
    double p[16][PATCH_BATCH];
    bezier_weights(n, u, &a);
    bezier_weights(n, w, &b);
    for (int k = 0; k < 3; k++) {
        expr_jets *z = &out->axis[k];
        bezier_gather(n, part, (const net *)q->axis[k], p);
        bezier_sum(n, a.b[0], b.b[0], p, z->v);
        if (order >= 1) {
            bezier_sum(n, a.b[1], b.b[0], p, z->u);
            bezier_sum(n, a.b[0], b.b[1], p, z->w);
        }
        if (order >= 2) {
            bezier_sum(n, a.b[2], b.b[0], p, z->uu);
            bezier_sum(n, a.b[1], b.b[1], p, z->uw);
            bezier_sum(n, a.b[0], b.b[2], p, z->ww);
        }
    }
}

/* Weights for the control points of a cubic's restriction to x0..x1: m[k] holds the share of each original point in the
 * k-th new one, the blossom with k arguments x1 and 3 - k arguments x0. */
static void restriction(double x0, double x1, double m[4][4])
{
    const double x[2] = {x0, x1};
    for (int k = 0; k < 4; k++) {
        double b[4] = {1, 0, 0, 0};
        for (int level = 0; level < 3; level++) {
            const double t = x[level < k], s = 1 - t;
            for (int i = level + 1; i > 0; i--)
                b[i] = s * b[i] + t * b[i - 1];
            b[0] *= s;
        }
        memcpy(m[k], b, sizeof b);
    }
}

/* One coordinate of the control points over a smaller range, from the weights along u and along w. */
static void restrict_net(const double *restrict p, double (*restrict a)[4], double (*restrict b)[4], double *restrict z)
{
    double rows[16];
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 4; i++)
            rows[4 * j + i] =
                a[i][0] * p[4 * j] + a[i][1] * p[4 * j + 1] + a[i][2] * p[4 * j + 2] + a[i][3] * p[4 * j + 3];
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 4; i++)
            z[4 * j + i] = b[j][0] * rows[i] + b[j][1] * rows[4 + i] + b[j][2] * rows[8 + i] + b[j][3] * rows[12 + i];
}

static void extend(double range[2], double x)
{
    range[0] = lesser(x, range[0]);
    range[1] = greater(x, range[1]);
}

/* Widen by `air` and scale. */
static void widen_and_scale(double range[2], double k, double air)
{
    range[0] = k * (range[0] - air);
    range[1] = k * (range[1] + air);
}

/* Quu, Quw and Qww are in the hulls of the second differences of the control points p. */
static void bezier_hessians(const double p[16], double air, double du, double dw, expr_hessians *z)
{
    *z = (expr_hessians){{HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, -HUGE_VAL}};
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 4; i++) {
            const double *q = p + 4 * j + i;
            if (i < 2)
                extend(z->uu, q[2] - 2 * q[1] + q[0]);
            if (i < 3 && j < 3)
                extend(z->uw, q[5] - q[4] - q[1] + q[0]);
            if (j < 2)
                extend(z->ww, q[8] - 2 * q[4] + q[0]);
        }
    widen_and_scale(z->uu, 6 / (du * du), 4 * air);
    widen_and_scale(z->uw, 9 / (du * dw), 4 * air);
    widen_and_scale(z->ww, 6 / (dw * dw), 4 * air);
}

/* Q is in the hull of the control points over the box, Qu and Qw in those of their differences. */
static void bezier_bound(const patch *base, int part, const double u[2], const double w[2], patch_bounds *out,
                         patch_hessians *second)
{
    const bezier *q = (const bezier *)base;
    double a[4][4], b[4][4];
    restriction(u[0], u[1], a);
    restriction(w[0], w[1], b);
    for (int k = 0; k < 3; k++) {
        expr_bounds *z = &out->axis[k];
        const double *all = q->axis[k][part];
        net p;
        double most = 0;
        for (int i = 0; i < 16; i++)
            most = greater(fabs(all[i]), most);
        restrict_net(all, a, b, p);
        const double air = ROUNDING * most, du = u[1] - u[0], dw = w[1] - w[0];
        *z = (expr_bounds){{HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, -HUGE_VAL}};
        for (int j = 0; j < 4; j++)
            for (int i = 0; i < 4; i++) {
                const double here = p[4 * j + i];
                extend(z->v, here);
                if (i < 3)
                    extend(z->u, p[4 * j + i + 1] - here);
                if (j < 3)
                    extend(z->w, p[4 * j + i + 4] - here);
            }
        widen_and_scale(z->v, 1, air);
        widen_and_scale(z->u, 3 / du, 2 * air);
        widen_and_scale(z->w, 3 / dw, 2 * air);
        if (second)
            bezier_hessians(p, air, du, dw, &second->axis[k]);
    }
}

static void bezier_free(patch *base)
{
    bezier *q = (bezier *)base;
    for (int k = 0; k < 3; k++)
        free(q->axis[k]);
    free(q);
}

static const patch_ops bezier_methods = {.eval = bezier_eval, .bound = bezier_bound, .free = bezier_free};

patch *patch_bezier_new(int patches, const vec3 *point)
{
    bezier *q = calloc(1, sizeof *q);
    bool good = q;
    for (int k = 0; k < 3 && good; k++)
        good = (q->axis[k] = malloc(sizeof *q->axis[k] * (size_t)(patches > 0 ? patches : 1))) != NULL;
    if (!good) {
        if (q)
            bezier_free(&q->base);
        return NULL;
    }
    for (int i = 0; i < patches; i++)
        for (int k = 0; k < 16; k++) {
            const vec3 p = point[16 * i + k];
            q->axis[0][i][k] = p.x;
            q->axis[1][i][k] = p.y;
            q->axis[2][i][k] = p.z;
        }
    q->base = (patch){&bezier_methods, "patches", patches, {0, 1}, {0, 1}, 0};
    return &q->base;
}
