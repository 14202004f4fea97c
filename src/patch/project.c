/* Projection: the point of a patch that is closest to a point in space. The Gauss-Newton iteration runs on each piece
 * that is near, and the closest result counts. The points lie on the patch up to a rounding, so that the iteration
 * converges as fast as Newton's.
 */
#include "patch/query.h"

#include "base/real.h"

#include <math.h>

enum { STEPS = 16 }; /* of the iteration; three or four are usual */

#define CONVERGED 1e-9 /* a step, as a share of the piece's range: the next one is of double's rounding */
#define DAMPING 1e-14  /* keeps u or w in place where Qu or Qw is 0, as at a pole; else below rounding */
#define MARGIN 1e-6f   /* of the search in the hierarchy, in radii: twice float's rounding there and more */
#define NEAR 5e-7      /* of that, what counts: of boxes farther off only some hierarchies report some */
#define FARTHEST2 4    /* the square of the largest distance from the centre, in radii, that is looked up */

/* Pairs of a point and a piece that wait to be solved, side by side. */
typedef struct pairs {
    int n;
    int32_t lane[PATCH_BATCH], part[PATCH_BATCH];
    double u[PATCH_BATCH], w[PATCH_BATCH];
    double step[PATCH_BATCH]; /* the last one, as a share of the piece's range */
    double u0[PATCH_BATCH], u1[PATCH_BATCH], w0[PATCH_BATCH], w1[PATCH_BATCH]; /* the range */
    double x[PATCH_BATCH], y[PATCH_BATCH], z[PATCH_BATCH];
    double off[PATCH_BATCH]; /* the squared distance of (x, y, z) to Q(u,w) */
} pairs;

/* The state of a projection that runs. */
typedef struct search {
    const patch_surface *f;
    const int32_t *only; /* the part of each lane; NULL: any */
    projections *s;
    double best[LANES]; /* the least squared distance so far */
    int lane;           /* whose point is in the hierarchy */
    pairs p;
} search;

/* One step for each pair that has not converged, kept within its range, and the squared distance before it. */
STAGE static void gauss_newton_step(pairs *restrict p, const patch_jets *restrict q)
{
    for (int i = 0; i < p->n; i++) {
        const double ux = q->axis[0].u[i], uy = q->axis[1].u[i], uz = q->axis[2].u[i];
        const double wx = q->axis[0].w[i], wy = q->axis[1].w[i], wz = q->axis[2].w[i];
        const double dx = p->x[i] - q->axis[0].v[i], dy = p->y[i] - q->axis[1].v[i], dz = p->z[i] - q->axis[2].v[i];
        double uu = ux * ux + uy * uy + uz * uz, ww = wx * wx + wy * wy + wz * wz;
        const double uw = ux * wx + uy * wy + uz * wz, more = DAMPING * (uu + ww) + 1e-300;
        const double du = dx * ux + dy * uy + dz * uz, dw = dx * wx + dy * wy + dz * wz;
        uu += more;
        ww += more;
        const double k = 1 / (uu * ww - uw * uw);
        double u = p->u[i] + k * (ww * du - uw * dw), w = p->w[i] + k * (uu * dw - uw * du);
        u = u > p->u0[i] ? u : p->u0[i];
        u = u < p->u1[i] ? u : p->u1[i];
        w = w > p->w0[i] ? w : p->w0[i];
        w = w < p->w1[i] ? w : p->w1[i];
        const double a = fabs(u - p->u[i]) / (p->u1[i] - p->u0[i]), b = fabs(w - p->w[i]) / (p->w1[i] - p->w0[i]);
        const int on = p->step[i] > CONVERGED; /* else the pairs that it waits with would matter */
        const double off = dx * dx + dy * dy + dz * dz, step = a > b ? a : b;
        p->off[i] = on ? off : p->off[i];
        p->u[i] = on ? u : p->u[i];
        p->w[i] = on ? w : p->w[i];
        p->step[i] = on ? step : p->step[i];
    }
}

static bool any_open(const pairs *p)
{
    for (int i = 0; i < p->n; i++)
        if (p->step[i] > CONVERGED)
            return true;
    return false;
}

/* Of two results at one distance the lower part, then u, then w counts, so that the hierarchy's order does not matter.
 */
static bool better(const search *e, int i, int lane)
{
    const pairs *p = &e->p;
    const projections *s = e->s;
    if (p->off[i] != e->best[lane])
        return p->off[i] < e->best[lane];
    if (p->part[i] != s->part[lane])
        return p->part[i] < s->part[lane];
    return p->u[i] != s->u[lane] ? p->u[i] < s->u[lane] : p->w[i] < s->w[lane];
}

static void solve(search *e)
{
    const patch *q = e->f->q;
    pairs *p = &e->p;
    patch_jets j;
    for (int step = 0; step < STEPS && any_open(p); step++) {
        q->ops->eval(q, p->n, p->part, p->u, p->w, 1, &j);
        gauss_newton_step(p, &j);
    }
    for (int i = 0; i < p->n; i++) {
        const int lane = p->lane[i];
        if (better(e, i, lane)) {
            e->best[lane] = p->off[i];
            e->s->part[lane] = p->part[i];
            e->s->u[lane] = p->u[i];
            e->s->w[lane] = p->w[i];
        }
    }
    p->n = 0;
}

/* Whether all of a piece's box is farther from a point than `far`. */
static bool is_far(const piece *f, vec3 at, double far)
{
    const double p[3] = {at.x, at.y, at.z};
    double off2 = 0;
    for (int k = 0; k < 3; k++) {
        const double off = greater(greater(f->box[0][k] - p[k], p[k] - f->box[1][k]), 0);
        off2 += off * off;
    }
    return off2 > far * far;
}

static void visit(void *user, int32_t index)
{
    search *e = user;
    const piece *f = &e->f->l.piece[index];
    const int lane = e->lane;
    const vec3 at = e->s->place[lane], d = vec3_sub(at, f->c);
    const double off = e->s->off[lane];
    if ((e->only && e->only[lane] != f->part) || vec3_length(d) > piece_radius(f) + off ||
        is_far(f, at, off + NEAR * e->f->l.space.radius))
        return;
    pairs *p = &e->p;
    const int i = p->n++;
    p->lane[i] = lane;
    p->part[i] = f->part;
    p->u0[i] = f->u[0];
    p->u1[i] = f->u[1];
    p->w0[i] = f->w[0];
    p->w1[i] = f->w[1];
    p->u[i] = f->u[0] + 0.5 * (f->u[1] - f->u[0]);
    p->w[i] = f->w[0] + 0.5 * (f->w[1] - f->w[0]);
    p->x[i] = at.x;
    p->y[i] = at.y;
    p->z[i] = at.z;
    p->step[i] = 1;
    if (p->n == PATCH_BATCH)
        solve(e);
}

void patch_project(const patch_surface *f, int n, const int32_t *only, projections *s)
{
    search e;
    e.f = f;
    e.only = only;
    e.s = s;
    e.p.n = 0;
    for (int i = 0; i < n; i++) {
        e.best[i] = HUGE_VAL;
        s->part[i] = only ? only[i] : 0;
        s->u[i] = 0.5 * (f->q->u[0] + f->q->u[1]);
        s->w[i] = 0.5 * (f->q->w[0] + f->q->w[1]);
        const vec3 at = vec3_scale(vec3_sub(s->place[i], f->l.space.centre), 1 / f->l.space.radius);
        const float p[3] = {(float)at.x, (float)at.y, (float)at.z};
        e.lane = i;
        if (vec3_dot(at, at) < FARTHEST2) /* false for NaN, too */
            bvh_around(f->tree, p, (float)(s->off[i] / f->l.space.radius) + MARGIN, visit, &e);
    }
    solve(&e);
}
