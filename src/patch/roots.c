/* Newton's iteration for pairs of a ray and a piece. */
#include "patch/roots.h"

#include "base/real.h"

#include <math.h>

enum { STEPS = 24 /* of Newton's iteration; four are usual, and those that begin far off need more */ };

/* Shares of the width of a piece's range in u or w. */
#define CONVERGED 1e-6 /* the last step: the next one would be about its square, below double's rounding */
#define OUTSIDE 1e-5   /* a root this far outside still counts: the neighbour finds the same root, so none is lost */

/* Shares of the width of the patch's range in u or w. */
#define BEYOND_END 1e-9 /* the same at the patch's ends, and at a seam, where there is no neighbour */
#define ROUNDING 1e-14  /* of u and w: pieces can be so small that it counts */

void roots_begin(roots *p, patch_query *k)
{
    const patch *q = k->f->q;
    p->k = k;
    p->n = 0;
    p->close_u = ROUNDING * (q->u[1] - q->u[0]);
    p->close_w = ROUNDING * (q->w[1] - q->w[0]);
}

/* One step of Newton's iteration for each: Qu du + Qw dw - s dt = r + s t - Q, by Cramer's rule. */
STAGE static void newton_step(roots *restrict p, const patch_jets *restrict q)
{
    const double close_u = p->close_u, close_w = p->close_w;
    for (int i = 0; i < p->n; i++) {
        const double ux = q->axis[0].u[i], uy = q->axis[1].u[i], uz = q->axis[2].u[i];
        const double wx = q->axis[0].w[i], wy = q->axis[1].w[i], wz = q->axis[2].w[i];
        const double sx = p->sx[i], sy = p->sy[i], sz = p->sz[i];
        const double dx = p->rx[i] + sx * p->t[i] - q->axis[0].v[i];
        const double dy = p->ry[i] + sy * p->t[i] - q->axis[1].v[i];
        const double dz = p->rz[i] + sz * p->t[i] - q->axis[2].v[i];
        const double ax = wy * sz - wz * sy, ay = wz * sx - wx * sz, az = wx * sy - wy * sx; /* Qw x s */
        const double bx = sy * uz - sz * uy, by = sz * ux - sx * uz, bz = sx * uy - sy * ux; /* s x Qu */
        const double nx = uy * wz - uz * wy, ny = uz * wx - ux * wz, nz = ux * wy - uy * wx; /* Qu x Qw */
        const double k = 1 / (ux * ax + uy * ay + uz * az);
        const double du = k * (dx * ax + dy * ay + dz * az), dw = k * (dx * bx + dy * by + dz * bz);
        const double dt = -k * (dx * nx + dy * ny + dz * nz);
        const double on = p->open[i] > 0 ? 1 : 0, u = p->u[i] + du, w = p->w[i] + dw;
        const double far_u = fabs(u - p->mu[i]) / p->hu[i], far_w = fabs(w - p->mw[i]) / p->hw[i];
        const int converged =
            (fabs(du) <= CONVERGED * p->hu[i] + close_u) & (fabs(dw) <= CONVERGED * p->hw[i] + close_w);
        const int in = (far_u < 4) & (far_w < 4); /* false for NaN */
        double state = converged ? 0 : 1;
        state = in ? state : -1;
        p->u[i] = on > 0 ? u : p->u[i];
        p->w[i] = on > 0 ? w : p->w[i];
        p->t[i] = on > 0 ? p->t[i] + dt : p->t[i];
        p->open[i] = on > 0 ? state : p->open[i];
    }
}

static bool any_open(const roots *p)
{
    for (int i = 0; i < p->n; i++)
        if (p->open[i] > 0)
            return true;
    return false;
}

/* Whether a root at x, u or w, counts for a piece, which may end where the patch does. */
static bool within(double x, double middle, double half, const double patch_range[2])
{
    const double out = fabs(x - middle) - half, beyond = fmax(patch_range[0] - x, x - patch_range[1]);
    const double all = patch_range[1] - patch_range[0];
    return out <= OUTSIDE * half + ROUNDING * all && beyond <= BEYOND_END * all;
}

void roots_solve(roots *p)
{
    patch_query *k = p->k;
    const patch *q = k->f->q;
    patch_jets j;
    for (int step = 0; step < STEPS && any_open(p); step++) {
        q->ops->eval(q, p->n, p->part, p->u, p->w, 1, &j);
        newton_step(p, &j);
        k->evaluations += p->n;
    }
    for (int i = 0; i < p->n; i++) {
        const int lane = p->lane[i];
        const bool in = within(p->u[i], p->mu[i], p->hu[i], q->u) && within(p->w[i], p->mw[i], p->hw[i], q->w);
        if (p->open[i] == 0 && in && p->t[i] > k->from[lane] && p->t[i] < k->to[lane]) {
            k->to[lane] = p->t[i];
            k->found[lane] = true;
            k->unsure[lane] = p->tried[i];
            if (k->any) /* one root is enough */
                k->to[lane] = -HUGE_VAL;
        }
    }
    p->n = 0;
}

void roots_add(roots *p, int lane, const piece *f, double a, double b, bool tried)
{
    const int i = p->n++;
    const vec3 r = p->k->r[lane], s = p->k->s[lane];
    p->tried[i] = tried;
    p->lane[i] = lane;
    p->part[i] = f->part;
    p->hu[i] = 0.5 * (f->u[1] - f->u[0]);
    p->hw[i] = 0.5 * (f->w[1] - f->w[0]);
    p->mu[i] = f->u[0] + p->hu[i];
    p->mw[i] = f->w[0] + p->hw[i];
    p->u[i] = p->mu[i] + a * p->hu[i];
    p->w[i] = p->mw[i] + b * p->hw[i];
    p->t[i] = 0; /* the equation is linear in it: the first step finds it */
    p->rx[i] = r.x, p->ry[i] = r.y, p->rz[i] = r.z;
    p->sx[i] = s.x, p->sy[i] = s.y, p->sz[i] = s.z;
    p->open[i] = 1;
    if (p->n == PATCH_BATCH)
        roots_solve(p);
}
