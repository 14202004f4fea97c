/* Draws brackets together: bounds, steps, secants. */
#include "method/bracket.h"

#include "method/method.h"
#include "wave/gather.h"
#include "wave/lane.h"

enum {
    STEPS_MAX = 16,
    SECANTS_MAX = 8, /* after them */
    COMPACT = 3,     /* after so many steps the lanes that have ended are dropped */
};
#define STEP_ERRORS 32 /* the length of a step in errors */
#define LEAST_GAP 0.1  /* of an end, of what the ray sinks in its bracket */

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

/* Both ends, not before the ray's start; tau where there is no bracket. Where the smooth hit is below the rough surface
 * the ray has met it before. */
static inline void set_ends(const hit_group *restrict g, int i, real sn, real x, real y, brackets *restrict k)
{
    real tau = g->tau[i], start = -g->t[i], P = g->bump.P[i], front = real_max(real_min(x, y), start);
    real back = real_max(x, y), above = sn < 0 ? -P : P;
    back = (above <= 0) & (back > 0) ? 0 : back;
    int good = (g->order[i] >= 0) & (back - front < REAL_FAR);
    back = real_max(back, front);
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
        set_ends(g, i, v.sn, Pmin / v.sn, Pmax / v.sn, k);
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
        set_ends(g, i, v.sn, reaches(v, curvature, Pmin), reaches(v, curvature, Pmax), k);
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
        p->P[i] = g->bump.P[j];
        p->Pu[i] = g->bump.Pu[j];
        p->Pw[i] = g->bump.Pw[j];
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

/* The ends that the search has reached, and the gaps there, positive above the rough surface. At first they are those
 * of P's tangent at the smooth hit, of the sign that they must have. */
typedef struct search {
    real front[LANES], back[LANES], above[LANES], below[LANES];
    real steps[LANES];
    int32_t done[LANES];
    real at[LANES], u[LANES], w[LANES]; /* the place that is looked up */
    bump_values h;
} search;

static inline real above_at(bs_view v, real curvature, real tau, real P)
{
    real gap = bs_gap(v, curvature, tau, P);
    return v.sn < 0 ? gap : -gap;
}

STAGE static void search_begin(const places *restrict p, real per_step, search *restrict s)
{
    const brackets *k = &p->k;
    for (int i = 0; i < k->n; i++) {
        bs_view v = view(k, i);
        real front = k->front[i], back = k->back[i], width = back - front;
        real least = real_abs(v.sn) * width * R(LEAST_GAP), rise = p->Pu[i] * v.a + p->Pw[i] * v.b;
        real steps = real_floor(width * p->pixels[i] / per_step) + 1;
        s->steps[i] = real_min(steps, STEPS_MAX);
        s->front[i] = front;
        s->back[i] = back;
        s->above[i] = real_max(above_at(v, k->curvature[i], front, p->P[i] + rise * front), least);
        s->below[i] = real_min(above_at(v, k->curvature[i], back, p->P[i] + rise * back), -least);
        s->done[i] = width <= 0;
    }
}

/* Lanes that still take steps, side by side. */
typedef struct walk {
    int n;
    int32_t place[LANES];
    real sn[LANES], a[LANES], b[LANES], curvature[LANES], u[LANES], w[LANES];
    real from[LANES], length[LANES], steps[LANES];
    real front[LANES], back[LANES], above[LANES], below[LANES];
    int32_t found[LANES];
    real at[LANES], pu[LANES], pw[LANES];
    bump_values h;
} walk;

static void walk_begin(const places *p, const search *s, walk *x)
{
    const brackets *k = &p->k;
    int n = 0;
    for (int i = 0; i < k->n; i++) {
        if (!(s->steps[i] > 1))
            continue;
        x->place[n] = i;
        x->sn[n] = k->sn[i];
        x->a[n] = k->a[i];
        x->b[n] = k->b[i];
        x->curvature[n] = k->curvature[i];
        x->u[n] = p->u[i];
        x->w[n] = p->w[i];
        x->from[n] = k->front[i];
        x->length[n] = (k->back[i] - k->front[i]) / s->steps[i];
        x->steps[n] = s->steps[i];
        x->front[n] = s->front[i];
        x->back[n] = s->back[i];
        x->above[n] = s->above[i];
        x->below[n] = s->below[i];
        x->found[n] = 0;
        n++;
    }
    x->n = n;
}

/* Let those end that have found a crossing or have but the last step left, to the bracket's back. */
static void walk_compact(walk *x, real step, search *s)
{
    int n = 0;
    for (int i = 0; i < x->n; i++) {
        if (x->found[i] || step + 1 >= x->steps[i]) {
            const int j = x->place[i];
            s->front[j] = x->front[i];
            s->back[j] = x->back[i];
            s->above[j] = x->above[i];
            s->below[j] = x->below[i];
            continue;
        }
        x->place[n] = x->place[i];
        x->sn[n] = x->sn[i];
        x->a[n] = x->a[i];
        x->b[n] = x->b[i];
        x->curvature[n] = x->curvature[i];
        x->u[n] = x->u[i];
        x->w[n] = x->w[i];
        x->from[n] = x->from[i];
        x->length[n] = x->length[i];
        x->steps[n] = x->steps[i];
        x->front[n] = x->front[i];
        x->back[n] = x->back[i];
        x->above[n] = x->above[i];
        x->below[n] = x->below[i];
        x->found[n] = 0;
        n++;
    }
    x->n = n;
}

STAGE static void walk_place(walk *restrict x, real step)
{
    for (int i = 0; i < x->n; i++) {
        real at = x->from[i] + x->length[i] * step;
        x->at[i] = at;
        x->pu[i] = x->u[i] + x->a[i] * at;
        x->pw[i] = x->w[i] + x->b[i] * at;
    }
}

STAGE static void walk_step(walk *restrict x, real step)
{
    for (int i = 0; i < x->n; i++) {
        bs_view v = {x->sn[i], x->a[i], x->b[i]};
        real at = x->at[i], above = above_at(v, x->curvature[i], at, x->h.P[i]);
        real front = x->front[i], back = x->back[i], high = x->above[i], low = x->below[i];
        int looking = (x->found[i] == 0) & (step < x->steps[i]), hit = looking & (above <= 0),
            pass = looking & (above > 0);
        x->front[i] = pass ? at : front;
        x->above[i] = pass ? above : high;
        x->back[i] = hit ? at : back;
        x->below[i] = hit ? above : low;
        x->found[i] |= hit;
    }
}

static long take_steps(const places *p, const bump *P, search *s)
{
    walk x;
    long looks = 0;
    walk_begin(p, s, &x);
    for (int step = 1; x.n > 0; step++) {
        walk_place(&x, (real)step);
        P->ops->eval(P, x.n, x.pu, x.pw, 0, &x.h);
        walk_step(&x, (real)step);
        looks += x.n;
        if (step % COMPACT == 0)
            walk_compact(&x, (real)step, s);
    }
    return looks;
}

STAGE static void secant_place(const places *restrict p, search *restrict s)
{
    for (int i = 0; i < p->k.n; i++) {
        real rise = s->above[i] - s->below[i], part = rise > 0 ? s->above[i] / rise : 0;
        real at = s->front[i] + (s->back[i] - s->front[i]) * part;
        s->at[i] = at;
        s->u[i] = p->u[i] + p->k.a[i] * at;
        s->w[i] = p->w[i] + p->k.b[i] * at;
    }
}

/* Take the place in, unless the lane is done, and as tau the next. The end that stays counts half, so that both ends
 * move (Illinois). */
STAGE static void secant_step(places *restrict p, real error, search *restrict s)
{
    const brackets *k = &p->k;
    for (int i = 0; i < k->n; i++) {
        bs_view v = view(k, i);
        real above = above_at(v, k->curvature[i], s->at[i], s->h.P[i]), at = s->at[i];
        real front = s->front[i], back = s->back[i], high = s->above[i], low = s->below[i];
        real rise = high - low, left = real_abs(above) * (back - front), tau = p->tau[i];
        int open = s->done[i] == 0, hit = above <= 0;
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
    search_begin(p, STEP_ERRORS * error, &s);
    for (int i = 0; i < n; i++)
        p->order[i] = s.done[i] ? p->order[i] : method_code((method){METHOD_MARCH, 1});
    long looks = take_steps(p, P, &s);
    for (int secant = 0; secant < SECANTS_MAX && !all(n, s.done); secant++) {
        secant_place(p, &s);
        P->ops->eval(P, n, s.u, s.w, 0, &s.h);
        secant_step(p, error, &s);
        looks += n;
    }
    return looks;
}
