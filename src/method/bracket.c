/* Draws brackets together: bounds, steps, secants. */
#include "method/bracket.h"

#include "method/method.h"
#include "wave/gather.h"
#include "wave/lane.h"

enum {
    STEPS_MAX = 16,  /* through a bracket */
    SECANTS_MAX = 8, /* after them */
};
#define STEP_ERRORS 32 /* the length of a step in errors */

static inline bs_view view(const brackets *k, int i) { return (bs_view){k->sn[i], k->a[i], k->b[i]}; }

/* Order 0, or none where the surface is not regular. */
static inline void first_try(hit_group *restrict g, int i, bs_vec3 n, bs_vec3 Qu, bs_vec3 Qw, real sn)
{
    bs_view v = {sn, 0, 0};
    int regular = bs_regular(n, Qu, Qw);
    real tau = bs_tau0(v, g->bump.P[i]);
    g->tau[i] = regular ? tau : 0;
    g->order[i] = regular ? 0 : -1;
}

/* Where the ray is at height P over the smooth surface: the root of 1/2 curvature tau^2 - sn tau + P near P/sn. Where
 * there is none, the place where the height is nearest to P. Without curvature it is P/sn to the last bit. */
static inline real reaches(bs_view v, real curvature, real P)
{
    const real A = R(0.5) * curvature, B = -v.sn, d = bs_discriminant(A, B, P);
    real root = bs_tau2(v, B, d > 0 ? d : 0, P), turn = v.sn / curvature;
    return d >= 0 ? root : turn;
}

/* Both ends, not before the ray's start; tau where there is no bracket. */
static inline void set_ends(const hit_group *restrict g, int i, real x, real y, brackets *restrict k)
{
    real tau = g->tau[i], start = -g->t[i], front = real_max(real_min(x, y), start), back = real_max(x, y);
    int good = (g->order[i] >= 0) & (back - front < REAL_FAR);
    back = real_max(back, start);
    k->front[i] = good ? front : tau;
    k->back[i] = good ? back : tau;
}

STAGE static void begin_flat(hit_group *restrict g, real Pmin, real Pmax, brackets *restrict k)
{
    for (int i = 0; i < g->n; i++) {
        bs_vec3 n = lane_get(&g->n_smooth, i), Qu = lane_get(&g->q.Qu, i), Qw = lane_get(&g->q.Qw, i);
        bs_view v = bs_view_of(lane_get(&g->x.s, i), n, Qu, Qw);
        first_try(g, i, n, Qu, Qw, v.sn);
        k->sn[i] = v.sn;
        set_ends(g, i, Pmin / v.sn, Pmax / v.sn, k);
    }
}

STAGE static void begin_curved(hit_group *restrict g, real Pmin, real Pmax, brackets *restrict k)
{
    for (int i = 0; i < g->n; i++) {
        bs_vec3 n = lane_get(&g->n_smooth, i), Qu = lane_get(&g->q.Qu, i), Qw = lane_get(&g->q.Qw, i);
        bs_view v = bs_view_of(lane_get(&g->x.s, i), n, Qu, Qw);
        real curvature = bs_curvature(v, n, lane_get(&g->q.Quu, i), lane_get(&g->q.Quw, i), lane_get(&g->q.Qww, i));
        first_try(g, i, n, Qu, Qw, v.sn);
        k->sn[i] = v.sn;
        k->a[i] = v.a;
        k->b[i] = v.b;
        k->curvature[i] = curvature;
        set_ends(g, i, reaches(v, curvature, Pmin), reaches(v, curvature, Pmax), k);
    }
}

void bracket_begin(hit_group *g, const bump *P, bool flat, brackets *k)
{
    k->n = g->n;
    k->flat = flat;
    (flat ? begin_flat : begin_curved)(g, P->Pmin, P->Pmax, k);
}

/* What a flat surface leaves out. */
static void pick_flat(const hit_group *g, int n, const int32_t *lane, brackets *k)
{
    for (int i = 0; i < n; i++) {
        const int j = lane[i];
        bs_view v =
            bs_view_of(lane_get(&g->x.s, j), lane_get(&g->n_smooth, j), lane_get(&g->q.Qu, j), lane_get(&g->q.Qw, j));
        k->a[i] = v.a;
        k->b[i] = v.b;
        k->curvature[i] = 0;
    }
}

static void pick_curved(const brackets *from, int n, const int32_t *lane, brackets *k)
{
    for (int i = 0; i < n; i++) {
        k->a[i] = from->a[lane[i]];
        k->b[i] = from->b[lane[i]];
        k->curvature[i] = from->curvature[lane[i]];
    }
}

void places_pick(const hit_group *g, const brackets *k, int n, const int32_t *lane, places *p)
{
    p->k.n = n;
    p->k.flat = k->flat;
    for (int i = 0; i < n; i++) {
        const int j = lane[i];
        p->lane[i] = j;
        p->k.sn[i] = k->sn[j];
        p->k.front[i] = k->front[j];
        p->k.back[i] = k->back[j];
        p->t[i] = g->t[j];
        p->u[i] = g->u[j];
        p->w[i] = g->w[j];
        p->tau[i] = g->tau[j];
        p->pixels[i] = 0;
        p->order[i] = g->order[j];
    }
    if (k->flat)
        pick_flat(g, n, lane, &p->k);
    else
        pick_curved(k, n, lane, &p->k);
    gather_rays(n, lane, &g->x, &p->x);
}

void places_put(const places *p, hit_group *g)
{
    for (int i = 0; i < p->k.n; i++) {
        g->tau[p->lane[i]] = p->tau[i];
        g->order[p->lane[i]] = p->order[i];
    }
}

/* ---- the search ---- */

/* The ends of the brackets that the search has reached, and the gaps there, positive above the rough surface. */
typedef struct search {
    real front[LANES], back[LANES], above[LANES], below[LANES];
    real steps[LANES];
    int32_t found[LANES]; /* `back` is below the rough surface */
    int32_t done[LANES];
    real at[LANES], u[LANES], w[LANES]; /* the place that is looked up */
    bump_values h;
} search;

STAGE static void search_begin(const places *restrict p, real per_step, search *restrict s)
{
    const brackets *k = &p->k;
    for (int i = 0; i < k->n; i++) {
        real steps = real_floor((k->back[i] - k->front[i]) * p->pixels[i] / per_step) + 1;
        s->steps[i] = real_min(steps, STEPS_MAX);
        s->front[i] = k->front[i];
        s->back[i] = k->back[i];
        s->above[i] = 0;
        s->below[i] = 0;
        s->found[i] = 0;
        s->done[i] = 0;
    }
}

STAGE static void search_place(const brackets *restrict k, real step, search *restrict s)
{
    for (int i = 0; i < k->n; i++) {
        real front = k->front[i], back = k->back[i], along = step / s->steps[i];
        s->at[i] = along < 1 ? front + (back - front) * along : back;
    }
}

STAGE static void search_step(const brackets *restrict k, real step, search *restrict s)
{
    for (int i = 0; i < k->n; i++) {
        bs_view v = view(k, i);
        real gap = bs_gap(v, k->curvature[i], s->at[i], s->h.P[i]), above = v.sn < 0 ? gap : -gap, at = s->at[i];
        real front = s->front[i], back = s->back[i], high = s->above[i], low = s->below[i];
        int looking = (s->found[i] == 0) & (step <= s->steps[i]), hit = looking & (above <= 0),
            pass = looking & (above > 0);
        s->front[i] = pass ? at : front;
        s->above[i] = pass ? above : high;
        s->back[i] = hit ? at : back;
        s->below[i] = hit ? above : low;
        s->found[i] |= hit;
    }
}

STAGE static void secant_place(int n, search *restrict s)
{
    for (int i = 0; i < n; i++) {
        real rise = s->above[i] - s->below[i];
        real part = rise > 0 ? s->above[i] / rise : 0;
        s->at[i] = s->front[i] + (s->back[i] - s->front[i]) * part;
    }
}

/* Take the place in, unless the lane is done; the end that stays counts half, so that both ends move (Illinois). */
STAGE static void secant_step(places *restrict p, real error, search *restrict s)
{
    const brackets *k = &p->k;
    for (int i = 0; i < k->n; i++) {
        bs_view v = view(k, i);
        real gap = bs_gap(v, k->curvature[i], s->at[i], s->h.P[i]), above = v.sn < 0 ? gap : -gap, at = s->at[i];
        real front = s->front[i], back = s->back[i], high = s->above[i], low = s->below[i];
        real rise = high - low, left = real_abs(above) * (back - front), tau = p->tau[i];
        int open = (s->found[i] != 0) & (s->done[i] == 0), hit = above <= 0;
        front = hit ? front : at;
        back = hit ? at : back;
        high = hit ? high : above;
        low = hit ? above : low;
        p->tau[i] = open ? front + (back - front) * (high > low ? high / (high - low) : 0) : tau;
        s->front[i] = front;
        s->above[i] = hit ? high * R(0.5) : high;
        s->back[i] = back;
        s->below[i] = hit ? low : low * R(0.5);
        s->done[i] |= left * p->pixels[i] <= error * rise;
    }
}

STAGE static void search_places(const places *restrict p, search *restrict s)
{
    for (int i = 0; i < p->k.n; i++) {
        s->u[i] = p->u[i] + p->k.a[i] * s->at[i];
        s->w[i] = p->w[i] + p->k.b[i] * s->at[i];
    }
}

static void look_up(const places *p, const bump *P, search *s)
{
    search_places(p, s);
    P->ops->eval(P, p->k.n, s->u, s->w, 0, &s->h);
}

static bool all(int n, const int32_t *x)
{
    int m = 0;
    for (int i = 0; i < n; i++)
        m += x[i] != 0;
    return m == n;
}

long places_search(places *p, const bump *P, real error)
{
    const int n = p->k.n;
    search s;
    long looks = 0;
    search_begin(p, STEP_ERRORS * error, &s);
    for (int step = 0; step <= STEPS_MAX && !all(n, s.found); step++) {
        search_place(&p->k, (real)step, &s);
        look_up(p, P, &s);
        search_step(&p->k, (real)step, &s);
        looks += n;
    }
    for (int i = 0; i < n; i++)
        s.done[i] = !s.found[i];
    for (int secant = 0; secant < SECANTS_MAX && !all(n, s.done); secant++) {
        secant_place(n, &s);
        look_up(p, P, &s);
        secant_step(p, error, &s);
        looks += n;
    }
    for (int i = 0; i < n; i++)
        p->order[i] = s.found[i] ? method_code((method){METHOD_MARCH, 1}) : 0;
    return looks;
}
