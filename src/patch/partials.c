/* Q and its partials on a patch surface, rounded to `real`. Where Qu and Qw are parallel or 0, substitutes give n its
 * limit. */
#include "patch/surface.h"

#include "base/real.h"

#include <math.h>

STAGE static void round_to_real(int n, const double *restrict from, real *restrict to)
{
    for (int i = 0; i < n; i++)
        to[i] = (real)from[i];
}

static void store3(int n, const double *x, const double *y, const double *z, vec3s *to, int at)
{
    round_to_real(n, x, to->x + at);
    round_to_real(n, y, to->y + at);
    round_to_real(n, z, to->z + at);
}

/* The square of the sine of the angle between Qu and Qw, times their ratio, below which n has few digits of double. */
#define DEGENERATE2 1e-18

static bool has_two_directions(vec3 U, vec3 W)
{
    const vec3 n = vec3_cross(U, W);
    const double e = vec3_dot(U, U) + vec3_dot(W, W);
    return vec3_dot(n, n) > DEGENERATE2 * e * e;
}

/* Where Qu x Qw = 0, as where a side of a patch shrinks to a point, n is its limit from within the range: that of a
 * point NEAR by. The shorter partial is made SHORT, as a share of the longer one, so that bs_regular still sees that
 * there is no second direction. Only directions count there. Where both are short, as at a cusp, the longer one gets
 * the length LONG, so that float holds the square of their product. */
static void take_limit(const patch *q, int32_t part, double u, double w, int lane, vec3s *Qu, vec3s *Qw)
{
    const double NEAR = 1e-6 /* of the way to the middle */, SHORT = 1e-9, LONG = 1e-4;
    patch_jets j;
    u += NEAR * (0.5 * (q->u[0] + q->u[1]) - u);
    w += NEAR * (0.5 * (q->w[0] + q->w[1]) - w);
    q->ops->eval(q, 1, &part, &u, &w, 1, &j);
    vec3 U = patch_jets_u(&j, 0), W = patch_jets_w(&j, 0);
    const double lu = vec3_length(U), lw = vec3_length(W), l = fmax(fmax(lu, lw), LONG);
    U = vec3_scale(U, (lu < lw ? SHORT : 1) * l / lu);
    W = vec3_scale(W, (lu < lw ? 1 : SHORT) * l / lw);
    store3(1, &U.x, &U.y, &U.z, Qu, lane);
    store3(1, &W.x, &W.y, &W.z, Qw, lane);
}

static double clamp(double x, const double range[2]) { return x < range[0] ? range[0] : x > range[1] ? range[1] : x; }

void patch_surface_eval(const surface *base, int n, const int32_t *part, const real *u, const real *w, int order,
                        partials *q)
{
    const patch_surface *f = (const patch_surface *)base;
    for (int at = 0; at < n; at += PATCH_BATCH) {
        const int m = n - at < PATCH_BATCH ? n - at : PATCH_BATCH;
        double U[PATCH_BATCH], W[PATCH_BATCH];
        patch_jets j;
        const expr_jets *x = &j.axis[0], *y = &j.axis[1], *z = &j.axis[2];
        for (int i = 0; i < m; i++) { /* float's pi is larger than pi, and beyond pi a sphere is inside out */
            U[i] = clamp((double)u[at + i], f->q->u);
            W[i] = clamp((double)w[at + i], f->q->w);
        }
        f->q->ops->eval(f->q, m, part + at, U, W, order > 1 ? 2 : 1, &j);
        store3(m, x->v, y->v, z->v, &q->Q, at);
        store3(m, x->u, y->u, z->u, &q->Qu, at);
        store3(m, x->w, y->w, z->w, &q->Qw, at);
        if (order > 1) {
            store3(m, x->uu, y->uu, z->uu, &q->Quu, at);
            store3(m, x->uw, y->uw, z->uw, &q->Quw, at);
            store3(m, x->ww, y->ww, z->ww, &q->Qww, at);
        }
        for (int i = 0; i < m; i++)
            if (!has_two_directions(patch_jets_u(&j, i), patch_jets_w(&j, i)))
                take_limit(f->q, part[at + i], U[i], W[i], at + i, &q->Qu, &q->Qw);
    }
}
