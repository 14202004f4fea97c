/* Places on rays, and the gap there. */
#include "displaced/path.h"

#include "wave/lane.h"

STAGE static void gaps(int n, const real *restrict h, const real *restrict P, real *restrict gap)
{
    for (int i = 0; i < n; i++)
        gap[i] = h[i] - P[i];
}

STAGE static void rates(int n, const rays *restrict x, const closest_points *restrict p, real *restrict du,
                        real *restrict dw, real *restrict dh)
{
    for (int i = 0; i < n; i++) {
        const bs_vec3 d = lane_get(&x->s, i);
        du[i] = bs_dot(d, lane_get(&p->gu, i));
        dw[i] = bs_dot(d, lane_get(&p->gw, i));
        dh[i] = bs_dot(d, lane_get(&p->gh, i));
    }
}

STAGE static void slopes(paths *restrict k)
{
    const int n = k->n;
    for (int i = 0; i < n; i++)
        k->slope[i] = k->dh[i] - k->h.Pu[i] * k->du[i] - k->h.Pw[i] * k->dw[i];
}

void paths_evaluate(const domain *f, const bump *P, int order, paths *k)
{
    real u[LANES], w[LANES];
    f->closest(f, k->n, k->lane, &k->x, k->t, &k->p);
    if (f->unclamped)
        f->within(f, k->n, k->lane, &k->p, u, w);
    P->ops->eval(P, k->n, f->unclamped ? u : k->p.u, f->unclamped ? w : k->p.w, order, &k->h);
    k->evaluations += k->n;
    gaps(k->n, k->p.h, k->h.P, k->gap);
}

void paths_differentiate(int order, paths *k)
{
    rates(k->n, &k->x, &k->p, k->du, k->dw, k->dh);
    if (order > 0)
        slopes(k);
}

void paths_copy(const paths *k, int from, paths *other, int to)
{
    other->lane[to] = k->lane[from];
    lane_set(&other->x.r, to, lane_get(&k->x.r, from));
    lane_set(&other->x.s, to, lane_get(&k->x.s, from));
    other->t[to] = k->t[from];
}
