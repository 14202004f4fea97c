/* The displaced surface of a patch, X = Q + P n/|n|, as a patch itself, so that its hits are found as any patch's.
 *
 * With n = Qu x Qw, X_u = Qu + P_u n/|n| + P (n/|n|)_u, and (n/|n|)_u is n_u = Quu x Qw + Qu x Quw without its part
 * along n, over |n|. Vectors are bounded by balls: within r of c.
 */
#include "displaced/form.h"

#include "base/real.h"

#include <math.h>
#include <stdlib.h>

#define ROUNDING 1e-13 /* of what is summed: some hundred roundings of double */

typedef struct offset_patch {
    patch base;
    const patch *q;
    const bump *P;
} offset_patch;

/* In place: the jets of Q, of order 2, become those of X, of order 1. */
STAGE static void add_bump(int n, const expr_jets *restrict P, patch_jets *restrict j)
{
    double *restrict x = j->axis[0].v, *restrict y = j->axis[1].v, *restrict z = j->axis[2].v;
    double *restrict xu = j->axis[0].u, *restrict yu = j->axis[1].u, *restrict zu = j->axis[2].u;
    double *restrict xw = j->axis[0].w, *restrict yw = j->axis[1].w, *restrict zw = j->axis[2].w;
    const double *restrict xuu = j->axis[0].uu, *restrict yuu = j->axis[1].uu, *restrict zuu = j->axis[2].uu;
    const double *restrict xuw = j->axis[0].uw, *restrict yuw = j->axis[1].uw, *restrict zuw = j->axis[2].uw;
    const double *restrict xww = j->axis[0].ww, *restrict yww = j->axis[1].ww, *restrict zww = j->axis[2].ww;
    for (int i = 0; i < n; i++) {
        const double ux = xu[i], uy = yu[i], uz = zu[i], wx = xw[i], wy = yw[i], wz = zw[i];
        const double Nx = uy * wz - uz * wy, Ny = uz * wx - ux * wz, Nz = ux * wy - uy * wx;
        const double k = 1 / sqrt(Nx * Nx + Ny * Ny + Nz * Nz), nx = k * Nx, ny = k * Ny, nz = k * Nz;
        /* n_u and n_w, over |n| */
        const double ax = k * (yuu[i] * wz - zuu[i] * wy + uy * zuw[i] - uz * yuw[i]);
        const double ay = k * (zuu[i] * wx - xuu[i] * wz + uz * xuw[i] - ux * zuw[i]);
        const double az = k * (xuu[i] * wy - yuu[i] * wx + ux * yuw[i] - uy * xuw[i]);
        const double bx = k * (yuw[i] * wz - zuw[i] * wy + uy * zww[i] - uz * yww[i]);
        const double by = k * (zuw[i] * wx - xuw[i] * wz + uz * xww[i] - ux * zww[i]);
        const double bz = k * (xuw[i] * wy - yuw[i] * wx + ux * yww[i] - uy * xww[i]);
        const double p = P->v[i];
        const double a = P->u[i] - p * (ax * nx + ay * ny + az * nz), b = P->w[i] - p * (bx * nx + by * ny + bz * nz);
        x[i] += p * nx;
        y[i] += p * ny;
        z[i] += p * nz;
        xu[i] = ux + p * ax + a * nx;
        yu[i] = uy + p * ay + a * ny;
        zu[i] = uz + p * az + a * nz;
        xw[i] = wx + p * bx + b * nx;
        yw[i] = wy + p * by + b * ny;
        zw[i] = wz + p * bz + b * nz;
    }
}

/* The same of order 0 from order 1: X alone. */
STAGE static void add_height(int n, const double *restrict P, patch_jets *restrict j)
{
    double *restrict x = j->axis[0].v, *restrict y = j->axis[1].v, *restrict z = j->axis[2].v;
    const double *restrict xu = j->axis[0].u, *restrict yu = j->axis[1].u, *restrict zu = j->axis[2].u;
    const double *restrict xw = j->axis[0].w, *restrict yw = j->axis[1].w, *restrict zw = j->axis[2].w;
    for (int i = 0; i < n; i++) {
        const double ux = xu[i], uy = yu[i], uz = zu[i], wx = xw[i], wy = yw[i], wz = zw[i];
        const double Nx = uy * wz - uz * wy, Ny = uz * wx - ux * wz, Nz = ux * wy - uy * wx;
        const double h = P[i] / sqrt(Nx * Nx + Ny * Ny + Nz * Nz);
        x[i] += h * Nx;
        y[i] += h * Ny;
        z[i] += h * Nz;
    }
}

static void offset_eval(const patch *base, int n, const int32_t *part, const double *u, const double *w, int order,
                        patch_jets *out)
{
    const offset_patch *k = (const offset_patch *)base;
    expr_jets P;
    k->q->ops->eval(k->q, n, part, u, w, order ? 2 : 1, out);
    k->P->ops->jets(k->P, n, u, w, &P);
    if (order)
        add_bump(n, &P, out);
    else
        add_height(n, P.v, out);
}

/* ---- bounds ---- */

/* All that is within r of c. */
typedef struct ball {
    vec3 c;
    double r;
} ball;

static ball ball_of(const double x[2], const double y[2], const double z[2])
{
    const vec3 half = {0.5 * (x[1] - x[0]), 0.5 * (y[1] - y[0]), 0.5 * (z[1] - z[0])};
    return (ball){{x[0] + half.x, y[0] + half.y, z[0] + half.z}, vec3_length(half)};
}

static ball ball_cross(ball a, ball b)
{
    return (ball){vec3_cross(a.c, b.c), vec3_length(a.c) * b.r + a.r * vec3_length(b.c) + a.r * b.r};
}

static ball ball_sum(ball a, ball b) { return (ball){vec3_add(a.c, b.c), a.r + b.r}; }

static vec3 across(vec3 a, vec3 n) { return vec3_sub(a, vec3_scale(n, vec3_dot(a, n))); }

/* n/|n|: within `chord` of c, and within an angle of that sine. */
typedef struct normals {
    vec3 c;
    double length, chord, sine; /* of the ball's centre */
    double least;               /* that n can be long; not above 0: n may be anything */
} normals;

static normals normals_of(ball n)
{
    const double length = vec3_length(n.c), sine = n.r / length;
    return (normals){vec3_scale(n.c, 1 / length), length, sine * sqrt(2 / (1 + sqrt(1 - sine * sine))), sine,
                     length - n.r};
}

/* (n/|n|)_u, from n_u. The projections along two directions differ by the sine of their angle. */
static ball turn_of(ball nu, const normals *n)
{
    const vec3 c = across(nu.c, n->c);
    const double size = vec3_length(nu.c);
    return (ball){vec3_scale(c, 1 / n->length), (nu.r + n->sine * (size + vec3_length(c))) / n->least};
}

static double most(const double range[2]) { return greater(fabs(range[0]), fabs(range[1])); }

/* range becomes range + p n + h v, n a number and v within r of it; air. */
static void add_to(double range[2], const double p[2], double n, double n_air, const double h[2], double v,
                   double v_air)
{
    const double off = most(p) * n_air + most(h) * v_air;
    const double air = off + ROUNDING * (most(range) + most(p) * (fabs(n) + n_air) + most(h) * (fabs(v) + v_air));
    range[0] += lesser(p[0] * n, p[1] * n) + lesser(h[0] * v, h[1] * v) - air;
    range[1] += greater(p[0] * n, p[1] * n) + greater(h[0] * v, h[1] * v) + air;
}

static void unknown(double range[2])
{
    range[0] = -HUGE_VAL;
    range[1] = HUGE_VAL;
}

static void offset_bound(const patch *base, int part, const double u[2], const double w[2], patch_bounds *out,
                         patch_hessians *second)
{
    const offset_patch *k = (const offset_patch *)base;
    const double none[2] = {0, 0};
    patch_hessians z;
    expr_bounds P;
    (void)second;
    k->q->ops->bound(k->q, part, u, w, out, &z);
    k->P->ops->bound(k->P, u, w, &P);
    const expr_bounds *X = &out->axis[0], *Y = &out->axis[1], *Z = &out->axis[2];
    const expr_hessians *x = &z.axis[0], *y = &z.axis[1], *t = &z.axis[2];
    const ball Qu = ball_of(X->u, Y->u, Z->u), Qw = ball_of(X->w, Y->w, Z->w), Quw = ball_of(x->uw, y->uw, t->uw);
    const normals n = normals_of(ball_cross(Qu, Qw));
    const ball nu = turn_of(ball_sum(ball_cross(ball_of(x->uu, y->uu, t->uu), Qw), ball_cross(Qu, Quw)), &n);
    const ball nw = turn_of(ball_sum(ball_cross(Quw, Qw), ball_cross(Qu, ball_of(x->ww, y->ww, t->ww))), &n);
    const bool some = n.least > 0;
    const double N[3] = {n.c.x, n.c.y, n.c.z}, U[3] = {nu.c.x, nu.c.y, nu.c.z}, W[3] = {nw.c.x, nw.c.y, nw.c.z};
    for (int a = 0; a < 3; a++) {
        expr_bounds *b = &out->axis[a];
        if (some)
            add_to(b->v, P.v, N[a], n.chord, none, 0, 0);
        else
            add_to(b->v, P.v, 0, 1, none, 0, 0);
        if (some && nu.r + nw.r < HUGE_VAL) {
            add_to(b->u, P.u, N[a], n.chord, P.v, U[a], nu.r);
            add_to(b->w, P.w, N[a], n.chord, P.v, W[a], nw.r);
        } else {
            unknown(b->u);
            unknown(b->w);
        }
    }
}

static void offset_free(patch *q) { free(q); }

static const patch_ops offset_methods = {offset_eval, offset_bound, offset_free};

patch *patch_offset_new(const patch *q, const bump *P)
{
    offset_patch *k = calloc(1, sizeof *k);
    if (!k)
        return NULL;
    k->base = *q;
    k->base.ops = &offset_methods;
    k->q = q;
    k->P = P;
    return &k->base;
}
