/* The formulas of bumpshadow.h in loops over the lanes of a group. */
#include "method/shift.h"

#include <string.h>

#include "wave/fill.h"
#include "wave/lane.h"

/* Whether a vector with this square has a length and a direction. */
static inline int has_length(real square) { return (square >= REAL_LEAST) & (square < (real)HUGE_VAL); }

/* Both return how many lanes have no normal, or no n'. */
STAGE static int normals_smooth(hit_group *restrict g)
{
    int none = 0;
    for (int i = 0; i < g->n; i++) {
        bs_vec3 n = bs_normal(lane_get(&g->q.Qu, i), lane_get(&g->q.Qw, i));
        lane_set(&g->n_smooth, i, n);
        lane_set(&g->n_bump, i, lane_unit(n));
        none += has_length(bs_dot(n, n)) == 0;
    }
    return none;
}

STAGE static int normals_bump(hit_group *restrict g)
{
    int none = 0;
    for (int i = 0; i < g->n; i++) {
        bs_vec3 Qu = lane_get(&g->q.Qu, i), Qw = lane_get(&g->q.Qw, i), n = bs_normal(Qu, Qw);
        bs_vec3 np = bs_perturbed_normal(n, Qu, Qw, g->bump.Pu[i], g->bump.Pw[i]);
        int good = bs_regular(n, Qu, Qw) & has_length(bs_dot(np, np));
        np.x = good ? np.x : n.x;
        np.y = good ? np.y : n.y;
        np.z = good ? np.z : n.z;
        lane_set(&g->n_smooth, i, n);
        lane_set(&g->n_bump, i, lane_unit(np));
        none += good == 0;
    }
    return none;
}

/* ---- without a value ---- */

void shift_undefined(hit_group *g, int i)
{
    if (g->undefined == 0)
        fill_ids(g->n, 0, g->none);
    g->undefined += g->none[i] == 0;
    g->none[i] = 1;
}

static void level_bump(hit_group *g, int i)
{
    bump_values *h = &g->bump;
    h->P[i] = h->Pu[i] = h->Pw[i] = h->Puu[i] = h->Puw[i] = h->Pww[i] = 0;
}

/* Qu x Qw, where float's range does not bear it; where there is none, a normal that faces the viewer. */
static vec3 normal_at(const hit_group *g, int i)
{
    const vec3 u = vec3s_get(&g->q.Qu, i), w = vec3s_get(&g->q.Qw, i), n = vec3_cross(u, w), s = vec3s_get(&g->x->s, i);
    const double length = vec3_length(n);
    return length > 0 && length < HUGE_VAL ? vec3_scale(n, 1 / length) : vec3_scale(vec3_unit(s), -1);
}

/* A plane without bumps in place of a surface without a normal. */
static void flatten(hit_group *g, int i)
{
    const vec3 n = normal_at(g, i);
    const vec3 axis = fabs(n.x) < 0.6 ? (vec3){1, 0, 0} : (vec3){0, 1, 0}, u = vec3_unit(vec3_cross(axis, n)),
               none = {0, 0, 0};
    vec3s_set(&g->q.Qu, i, u);
    vec3s_set(&g->q.Qw, i, vec3_cross(n, u));
    vec3s_set(&g->q.Quu, i, none);
    vec3s_set(&g->q.Quw, i, none);
    vec3s_set(&g->q.Qww, i, none);
    vec3s_set(&g->n_smooth, i, n);
    vec3s_set(&g->n_bump, i, n);
    level_bump(g, i);
}

/* The lanes that the loops above count. Where the surface is not regular, but has a normal, P is its height; where n'
 * alone is beyond float's range, there is no bump. */
static void mend_normals(hit_group *g, bool bumped)
{
    for (int i = 0; i < g->n; i++) {
        const bs_vec3 Qu = lane_get(&g->q.Qu, i), Qw = lane_get(&g->q.Qw, i), n = lane_get(&g->n_smooth, i);
        const bs_vec3 np = bumped ? bs_perturbed_normal(n, Qu, Qw, g->bump.Pu[i], g->bump.Pw[i]) : n;
        const bool smooth = has_length(bs_dot(n, n)), regular = !bumped || bs_regular(n, Qu, Qw);
        if (smooth && regular && has_length(bs_dot(np, np)))
            continue;
        if (!smooth)
            flatten(g, i);
        else if (regular)
            level_bump(g, i);
        shift_undefined(g, i);
    }
}

void shift_normals(hit_group *g, const bump *P)
{
    if ((P ? normals_bump : normals_smooth)(g) > 0)
        mend_normals(g, P);
    if (P && g->bump.undefined)
        for (int i = 0; i < g->n; i++)
            if (g->bump.none[i])
                shift_undefined(g, i);
}

/* ---- the shift ---- */

static inline bs_view view(const hit_group *g, int i)
{
    return bs_view_of(lane_get(&g->x->s, i), lane_get(&g->n_smooth, i), lane_get(&g->q.Qu, i), lane_get(&g->q.Qw, i));
}

static inline real curvature(const hit_group *g, int i, bs_view v)
{
    return bs_curvature(v, lane_get(&g->n_smooth, i), lane_get(&g->q.Quu, i), lane_get(&g->q.Quw, i),
                        lane_get(&g->q.Qww, i));
}

static void drop(hit_group *g, int i)
{
    g->tau[i] = 0;
    g->order[i] = -1;
}

STAGE static int count_far(int n, const real *restrict tau)
{
    int far = 0;
    for (int i = 0; i < n; i++)
        far += REAL_IS_FAR(tau[i]);
    return far;
}

void shift_known(hit_group *g)
{
    if (count_far(g->n, g->tau))
        for (int i = 0; i < g->n; i++)
            if (REAL_IS_FAR(g->tau[i])) {
                shift_undefined(g, i);
                drop(g, i);
            }
    for (int i = 0; g->bump.undefined && i < g->n; i++)
        if (g->bump.none[i])
            drop(g, i);
}

/* One lane. `order` is constant in each loop below, so derivatives that it does not use are not loaded. */
static inline void by_order(hit_group *g, int i, int order, int guard, real Pmin, real Pmax)
{
    bs_view v = view(g, i);
    bs_bump p = {g->bump.P[i],
                 order >= 1 ? g->bump.Pu[i] : 0,
                 order >= 1 ? g->bump.Pw[i] : 0,
                 order >= 2 ? g->bump.Puu[i] : 0,
                 order == 3 ? g->bump.Puw[i] : 0,
                 order >= 2 ? g->bump.Pww[i] : 0};
    bs_shift s = bs_shift_of(order, guard, v, order == 3 ? curvature(g, i, v) : 0, p, bs_slab_of(v, Pmin, Pmax));
    g->tau[i] = s.tau;
    g->order[i] = s.order;
}

#define BY_ORDER(name, order, guard)                                                                                   \
    STAGE static void name(hit_group *restrict g, real Pmin, real Pmax)                                                \
    {                                                                                                                  \
        for (int i = 0; i < g->n; i++)                                                                                 \
            by_order(g, i, order, guard, Pmin, Pmax);                                                                  \
    }

BY_ORDER(order_0, 0, 0)
BY_ORDER(order_1, 1, 1)
BY_ORDER(order_2, 2, 1)
BY_ORDER(order_2_plus, 3, 1)
BY_ORDER(order_1_bare, 1, 0)
BY_ORDER(order_2_bare, 2, 0) /* alone not vectorised: gcc 12 finds no vector for its choice between 1 and 2 */
BY_ORDER(order_2_plus_bare, 3, 0)

typedef void by_order_stage(hit_group *restrict g, real Pmin, real Pmax);
static by_order_stage *const by_orders[2][4] = {
    {order_0, order_1_bare, order_2_bare, order_2_plus_bare},
    {order_0, order_1, order_2, order_2_plus},
};

/* For methods that evaluate P along the ray: bs_view of each lane, the current tau, and P there. */
typedef struct ray_walk {
    real sn[LANES], a[LANES], b[LANES], curvature[LANES];
    real tau[LANES], u[LANES], w[LANES];
    bump_values h;
} ray_walk;

STAGE static void walk_start(const hit_group *restrict g, ray_walk *restrict walk)
{
    for (int i = 0; i < g->n; i++) {
        bs_view v = view(g, i);
        walk->sn[i] = v.sn;
        walk->a[i] = v.a;
        walk->b[i] = v.b;
    }
}

STAGE static void walk_curvature(const hit_group *restrict g, ray_walk *restrict walk)
{
    for (int i = 0; i < g->n; i++) {
        bs_view v = {walk->sn[i], walk->a[i], walk->b[i]};
        walk->curvature[i] = curvature(g, i, v);
    }
}

/* P at (u0 + a tau, w0 + b tau). */
STAGE static void walk_place(const hit_group *restrict g, ray_walk *restrict walk)
{
    for (int i = 0; i < g->n; i++) {
        walk->u[i] = g->u[i] + walk->a[i] * walk->tau[i];
        walk->w[i] = g->w[i] + walk->b[i] * walk->tau[i];
    }
}

STAGE static void iter_step(int n, ray_walk *restrict walk, const real *restrict P)
{
    for (int i = 0; i < n; i++) {
        bs_view v = {walk->sn[i], 0, 0};
        walk->tau[i] = bs_tau0(v, P[i]);
    }
}

static long iterate(hit_group *g, const bump *P, method m)
{
    ray_walk walk;
    walk_start(g, &walk);
    iter_step(g->n, &walk, g->bump.P); /* P at the smooth hit is known */
    for (int step = 1; step < m.n; step++) {
        walk_place(g, &walk);
        P->ops->eval(P, g->n, walk.u, walk.w, 0, &walk.h);
        iter_step(g->n, &walk, walk.h.P);
    }
    memcpy(g->tau, walk.tau, sizeof g->tau);
    fill_ids(g->n, method_code(m), g->order);
    return (long)(m.n - 1) * g->n;
}

typedef struct march_lanes {
    real front[LANES], back[LANES]; /* the slab */
    real tau[LANES], gap[LANES];
    int32_t found[LANES];
} march_lanes;

STAGE static void march_start(int n, const ray_walk *restrict walk, real Pmin, real Pmax, march_lanes *restrict m)
{
    for (int i = 0; i < n; i++) {
        bs_view v = {walk->sn[i], walk->a[i], walk->b[i]};
        bs_slab slab = bs_slab_of(v, Pmin, Pmax);
        bs_march s = bs_march_start(slab);
        m->front[i] = slab.front;
        m->back[i] = slab.back;
        m->tau[i] = s.tau;
        m->gap[i] = s.gap;
        m->found[i] = s.found;
    }
}

/* Step 0..steps through the slab, and the place of P there. */
STAGE static void march_place(const hit_group *restrict g, const march_lanes *restrict m, int step, int steps,
                              ray_walk *restrict walk)
{
    for (int i = 0; i < g->n; i++) {
        bs_slab slab = {m->front[i], m->back[i]};
        real tau = bs_march_tau(slab, step, steps);
        walk->tau[i] = tau;
        walk->u[i] = g->u[i] + walk->a[i] * tau;
        walk->w[i] = g->w[i] + walk->b[i] * tau;
    }
}

/* Returns how many lanes are still looking. */
STAGE static int march_step(int n, const ray_walk *restrict walk, march_lanes *restrict m)
{
    int looking = 0;
    for (int i = 0; i < n; i++) {
        bs_view v = {walk->sn[i], walk->a[i], walk->b[i]};
        bs_march s = {m->tau[i], m->gap[i], m->found[i]};
        s = bs_march_step(s, walk->tau[i], bs_gap(v, walk->curvature[i], walk->tau[i], walk->h.P[i]), v);
        m->tau[i] = s.tau;
        m->gap[i] = s.gap;
        m->found[i] = s.found;
        looking += s.found == 0;
    }
    return looking;
}

/* Order 0 where nothing is found. */
STAGE static void march_end(const ray_walk *restrict walk, const march_lanes *restrict m, int32_t code,
                            hit_group *restrict g)
{
    for (int i = 0; i < g->n; i++) {
        bs_view v = {walk->sn[i], 0, 0};
        int found = m->found[i];
        real tau = m->tau[i], tau0 = bs_tau0(v, g->bump.P[i]);
        g->tau[i] = found ? tau : tau0;
        g->order[i] = found ? code : 0;
    }
}

/* Look P up at a step, and take it. */
static int march_look(const hit_group *g, const bump *P, int step, int steps, march_lanes *x, ray_walk *walk)
{
    march_place(g, x, step, steps, walk);
    P->ops->eval(P, g->n, walk->u, walk->w, 0, &walk->h);
    return march_step(g->n, walk, x);
}

/* Step 0 of a peaked P, where the ray is above the surface: the gap alone. */
STAGE static void march_top(int n, const ray_walk *restrict walk, march_lanes *restrict m)
{
    for (int i = 0; i < n; i++) {
        bs_view v = {walk->sn[i], 0, 0};
        real gap = bs_gap(v, walk->curvature[i], walk->tau[i], walk->h.P[i]);
        m->gap[i] = v.sn < 0 ? gap : -gap;
    }
}

/* A peaked P is below the top of the slab, but for single points. So step 0 finds nothing, and its gap matters only to
 * lanes that step 1 finds: the waves that have some look it up then. Returns how many lanes are looking. */
static int march_below_top(const hit_group *g, const bump *P, int steps, march_lanes *x, ray_walk *walk, long *looked)
{
    int looking = march_look(g, P, 1, steps, x, walk);
    *looked += g->n;
    if (looking == g->n)
        return looking;
    march_start(g->n, walk, P->Pmin, P->Pmax, x);
    march_place(g, x, 0, steps, walk);
    P->ops->eval(P, g->n, walk->u, walk->w, 0, &walk->h);
    march_top(g->n, walk, x);
    *looked += 2L * g->n;
    return march_look(g, P, 1, steps, x, walk);
}

/* Until all lanes have found the surface: those of a wave are next to each other, and find it at nearly the same step.
 */
static long march(hit_group *g, const bump *P, method m)
{
    ray_walk walk;
    march_lanes x;
    long looked = 0;
    walk_start(g, &walk);
    if (g->flat)
        fill(g->n, 0, walk.curvature);
    else
        walk_curvature(g, &walk);
    march_start(g->n, &walk, P->Pmin, P->Pmax, &x);
    int looking = P->peaked ? march_below_top(g, P, m.n, &x, &walk, &looked) : g->n;
    for (int step = P->peaked ? 2 : 0; step <= m.n && looking > 0; step++) {
        looking = march_look(g, P, step, m.n, &x, &walk);
        looked += g->n;
    }
    march_end(&walk, &x, method_code(m), g);
    return looked;
}

long shift_group(hit_group *g, const bump *P, method m, bool guard)
{
    long evaluations = 0;
    if (!P || m.kind == METHOD_NONE) {
        fill(g->n, 0, g->tau);
        fill_ids(g->n, -1, g->order);
        return 0;
    }
    if (m.kind == METHOD_ORDER)
        by_orders[guard][m.n](g, P->Pmin, P->Pmax);
    else
        evaluations = (m.kind == METHOD_ITER ? iterate : march)(g, P, m);
    for (int i = 0; g->undefined && i < g->n; i++)
        if (g->none[i])
            drop(g, i);
    return evaluations;
}

STAGE static void within(int n, const real *restrict t, real *restrict tau)
{
    const real most = R(1) - R(1) / 1024; /* of the way back */
    for (int i = 0; i < n; i++)
        tau[i] = real_max(tau[i], -most * t[i]);
}

void shift_within(hit_group *g) { within(g->n, g->t, g->tau); }

STAGE static void origins(int n, const real *restrict t, const real *restrict tau, real *restrict t0)
{
    for (int i = 0; i < n; i++)
        t0[i] = t[i] + tau[i];
}

void shift_origins(hit_group *g) { origins(g->n, g->t, g->tau, g->t0); }
