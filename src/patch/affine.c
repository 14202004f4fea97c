/* The image of a patch by an affine map: Q = o + x X + y Y + z Z, where (x, y, z) is on the original patch and X, Y, Z
 * and o are the map's columns. */
#include "patch/patch.h"

#include "base/real.h"

#include <math.h>
#include <stdlib.h>

#define ROUNDING 1e-15 /* more than the roundings of a sum of four products, as a share of its terms */

typedef struct affine_patch {
    patch base;
    const patch *from;
    double M[3][3], o[3];      /* M[k]: row k of the map's matrix */
    double mirror, u_ends_sum; /* the original's u is u_ends_sum + mirror u; mirror: -1 where the map mirrors, else 1 */
} affine_patch;

/* One coordinate of Q or of a partial, from the original's three; sign: what mirroring does to the partial. */
STAGE static void combine(int n, const double *restrict m, double o, const double *restrict x, const double *restrict y,
                          const double *restrict z, double sign, double *restrict to)
{
    const double a = m[0] * sign, b = m[1] * sign, c = m[2] * sign;
    for (int i = 0; i < n; i++)
        to[i] = o + (a * x[i] + b * y[i] + c * z[i]);
}

static void affine_patch_eval(const patch *base, int n, const int32_t *part, const double *u, const double *w,
                              int order, patch_jets *out)
{
    const affine_patch *q = (const affine_patch *)base;
    double there[PATCH_BATCH];
    patch_jets j;
    const expr_jets *x = &j.axis[0], *y = &j.axis[1], *z = &j.axis[2];
    for (int i = 0; i < n; i++)
        there[i] = q->u_ends_sum + q->mirror * u[i];
    q->from->ops->eval(q->from, n, part, there, w, order, &j);
    for (int k = 0; k < 3; k++) {
        expr_jets *to = &out->axis[k];
        const double *m = q->M[k];
        combine(n, m, q->o[k], x->v, y->v, z->v, 1, to->v);
        if (order >= 1) {
            combine(n, m, 0, x->u, y->u, z->u, q->mirror, to->u);
            combine(n, m, 0, x->w, y->w, z->w, 1, to->w);
        }
        if (order >= 2) {
            combine(n, m, 0, x->uu, y->uu, z->uu, 1, to->uu);
            combine(n, m, 0, x->uw, y->uw, z->uw, q->mirror, to->uw);
            combine(n, m, 0, x->ww, y->ww, z->ww, 1, to->ww);
        }
    }
}

/* The range of o + sign m.v, v in three ranges; infinite where one of them is. */
static void mix(const double m[3], double o, double *const v[3], double sign, double to[2])
{
    double lo = o, hi = o, size = fabs(o);
    for (int k = 0; k < 3; k++) {
        const double a = m[k] * sign * v[k][0], b = m[k] * sign * v[k][1];
        if (m[k] == 0)
            continue;
        lo += lesser(a, b);
        hi += greater(a, b);
        size += greater(fabs(a), fabs(b));
    }
    const bool known = size < HUGE_VAL;
    to[0] = known ? lo - ROUNDING * size : -HUGE_VAL;
    to[1] = known ? hi + ROUNDING * size : HUGE_VAL;
}

static void affine_patch_bound(const patch *base, int part, const double u[2], const double w[2], patch_bounds *out,
                               patch_hessians *second)
{
    const affine_patch *q = (const affine_patch *)base;
    const double a = q->u_ends_sum + q->mirror * u[0], b = q->u_ends_sum + q->mirror * u[1],
                 there[2] = {lesser(a, b), greater(a, b)};
    patch_bounds f;
    patch_hessians g;
    q->from->ops->bound(q->from, part, there, w, &f, second ? &g : NULL);
    expr_bounds *x = &f.axis[0], *y = &f.axis[1], *z = &f.axis[2];
    expr_hessians *a2 = &g.axis[0], *b2 = &g.axis[1], *c2 = &g.axis[2];
    for (int k = 0; k < 3; k++) {
        mix(q->M[k], q->o[k], (double *const[]){x->v, y->v, z->v}, 1, out->axis[k].v);
        mix(q->M[k], 0, (double *const[]){x->u, y->u, z->u}, q->mirror, out->axis[k].u);
        mix(q->M[k], 0, (double *const[]){x->w, y->w, z->w}, 1, out->axis[k].w);
        if (second) {
            mix(q->M[k], 0, (double *const[]){a2->uu, b2->uu, c2->uu}, 1, second->axis[k].uu);
            mix(q->M[k], 0, (double *const[]){a2->uw, b2->uw, c2->uw}, q->mirror, second->axis[k].uw);
            mix(q->M[k], 0, (double *const[]){a2->ww, b2->ww, c2->ww}, 1, second->axis[k].ww);
        }
    }
}

static void affine_patch_free(patch *q) { free(q); }

static const patch_ops affine_patch_methods = {
    .eval = affine_patch_eval, .bound = affine_patch_bound, .free = affine_patch_free};

patch *patch_affine_new(const patch *from, const affine *m)
{
    affine_patch *q = calloc(1, sizeof *q);
    const bool mirrors = affine_volume(m) < 0;
    if (!q)
        return NULL;
    *q = (affine_patch){.base = *from,
                        .from = from,
                        .M = {{m->x.x, m->y.x, m->z.x}, {m->x.y, m->y.y, m->z.y}, {m->x.z, m->y.z, m->z.z}},
                        .o = {m->o.x, m->o.y, m->o.z},
                        .mirror = mirrors ? -1 : 1,
                        .u_ends_sum = mirrors ? from->u[0] + from->u[1] : 0};
    q->base.ops = &affine_patch_methods;
    return &q->base;
}
