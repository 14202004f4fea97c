/* Draws brackets together: bounds, steps, secants. */
#include "method/bracket.h"

#include <string.h>

#include "method/method.h"
#include "wave/lane.h"

enum { SECANTS_MAX = 8 }; /* after the steps */
#define LEAST_GAP 0.02    /* of an end, of what the ray sinks in its bracket */

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
 * the ray has met it before. Order 0's tau is kept within, as it may be far off where the ray grazes a curved surface.
 */
static inline void set_ends(hit_group *restrict g, int i, real sn, real x, real y, brackets *restrict k)
{
    real tau = g->tau[i], start = -g->t[i], P = g->bump.P[i], front = real_max(real_min(x, y), start);
    real back = real_max(x, y), above = sn < 0 ? -P : P;
    back = ((above <= 0) & (back > 0)) ? 0 : back;
    int good = (g->order[i] >= 0) & (real_abs(y - x) < REAL_FAR);
    back = real_max(back, front);
    k->front[i] = good ? front : tau;
    k->back[i] = good ? back : tau;
    g->tau[i] = good ? real_min(real_max(tau, front), back) : tau;
}

STAGE static void begin_flat(hit_group *restrict g, real Pmin, real Pmax, brackets *restrict k)
{
    for (int i = 0; i < g->n; i++) {
        bs_vec3 n = lane_get(&g->n_smooth, i), Qu = lane_get(&g->q.Qu, i), Qw = lane_get(&g->q.Qw, i);
        bs_view v = bs_view_of(lane_get(&g->x->s, i), n, Qu, Qw);
        first_try(g, i, n, Qu, Qw, v.sn);
        k->sn[i] = v.sn;
        k->a[i] = v.a;
        k->b[i] = v.b;
        k->curvature[i] = 0;
        set_ends(g, i, v.sn, Pmin / v.sn, Pmax / v.sn, k);
    }
}

STAGE static void begin_curved(hit_group *restrict g, real Pmin, real Pmax, brackets *restrict k)
{
    for (int i = 0; i < g->n; i++) {
        bs_vec3 n = lane_get(&g->n_smooth, i), Qu = lane_get(&g->q.Qu, i), Qw = lane_get(&g->q.Qw, i);
        bs_view v = bs_view_of(lane_get(&g->x->s, i), n, Qu, Qw);
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
    (flat ? begin_flat : begin_curved)(g, P->Pmin, P->Pmax, k);
}

/* Some lanes, or all. */
static void pick(const hit_group *g, int n, const int32_t *lane, const real *from, real *to)
{
    if (n == g->n)
        memcpy(to, from, (size_t)n * sizeof *to);
    else
        for (int i = 0; i < n; i++)
            to[i] = from[lane[i]];
}

static void pick3(const hit_group *g, int n, const int32_t *lane, const vec3s *from, vec3s *to)
{
    pick(g, n, lane, from->x, to->x);
    pick(g, n, lane, from->y, to->y);
    pick(g, n, lane, from->z, to->z);
}

void places_pick(const hit_group *g, const brackets *k, int n, const int32_t *lane, places *p)
{
    p->k.n = n;
    pick(g, n, lane, k->sn, p->k.sn);
    pick(g, n, lane, k->a, p->k.a);
    pick(g, n, lane, k->b, p->k.b);
    pick(g, n, lane, k->curvature, p->k.curvature);
    pick(g, n, lane, k->front, p->k.front);
    pick(g, n, lane, k->back, p->k.back);
    pick3(g, n, lane, &g->x->r, &p->x.r);
    pick3(g, n, lane, &g->x->s, &p->x.s);
    pick(g, n, lane, g->t, p->t);
    pick(g, n, lane, g->u, p->u);
    pick(g, n, lane, g->w, p->w);
    pick(g, n, lane, g->bump.P, p->P);
    pick(g, n, lane, g->bump.Pu, p->Pu);
    pick(g, n, lane, g->bump.Pw, p->Pw);
    pick(g, n, lane, g->tau, p->tau);
    for (int i = 0; i < n; i++) {
        p->lane[i] = lane[i];
        p->order[i] = g->order[lane[i]];
        p->pixels[i] = 0;
    }
}

void places_put(const places *p, hit_group *g)
{
    for (int i = 0; i < p->k.n; i++) {
        g->tau[p->lane[i]] = p->tau[i];
        g->order[p->lane[i]] = p->order[i];
    }
}

/* ---- the search ---- */

/* Lanes whose places are searched, side by side. The ends of their brackets move, with the gaps there, positive above
 * the rough surface. */
typedef struct search {
    int n;
    int32_t place[LANES]; /* index in `places` */
    real sn[LANES], a[LANES], b[LANES], curvature[LANES], u[LANES], w[LANES], pixels[LANES];
    real start[LANES], length[LANES], steps[LANES]; /* so many, of length `length` from `start` */
    real front[LANES], back[LANES], above[LANES], below[LANES];
    real tau[LANES];                                   /* the best place so far */
    int32_t stepping[LANES], side[LANES], open[LANES]; /* side: the end that moved last, 1 the back, -1 the front */

    real at[LANES], at_u[LANES], at_w[LANES]; /* the place that is looked up */
    bump_values h;
} search;

static void copy_lane(search *s, int to, int from)
{
    s->place[to] = s->place[from];
    s->sn[to] = s->sn[from];
    s->a[to] = s->a[from];
    s->b[to] = s->b[from];
    s->curvature[to] = s->curvature[from];
    s->u[to] = s->u[from];
    s->w[to] = s->w[from];
    s->pixels[to] = s->pixels[from];
    s->start[to] = s->start[from];
    s->length[to] = s->length[from];
    s->steps[to] = s->steps[from];
    s->front[to] = s->front[from];
    s->back[to] = s->back[from];
    s->above[to] = s->above[from];
    s->below[to] = s->below[from];
    s->tau[to] = s->tau[from];
    s->stepping[to] = s->stepping[from];
    s->side[to] = s->side[from];
    s->open[to] = 1;
}

static inline real above_at(bs_view v, real curvature, real tau, real P)
{
    real gap = bs_gap(v, curvature, tau, P);
    return v.sn < 0 ? gap : -gap;
}

/* All places. The gaps at the ends are those of P's tangent at the smooth hit, with the sign that they must have. */
STAGE static void search_begin(const places *restrict p, search_steps asked, search *restrict s)
{
    const brackets *k = &p->k;
    for (int i = 0; i < k->n; i++) {
        bs_view v = view(k, i);
        real front = k->front[i], back = k->back[i], width = back - front, curvature = k->curvature[i], u = p->u[i],
             w = p->w[i], pixels = p->pixels[i], tau = p->tau[i];
        real least = real_abs(v.sn) * width * R(LEAST_GAP), rise = p->Pu[i] * v.a + p->Pw[i] * v.b;
        real steps = real_floor(width * pixels / asked.pixels) + 1;
        steps = real_min(real_max(steps, asked.least), asked.most);
        s->sn[i] = v.sn;
        s->a[i] = v.a;
        s->b[i] = v.b;
        s->curvature[i] = curvature;
        s->u[i] = u;
        s->w[i] = w;
        s->pixels[i] = pixels;
        s->start[i] = front;
        s->length[i] = width / steps;
        s->steps[i] = steps;
        s->front[i] = front;
        s->back[i] = back;
        s->above[i] = real_max(above_at(v, curvature, front, p->P[i] + rise * front), least);
        s->below[i] = real_min(above_at(v, curvature, back, p->P[i] + rise * back), -least);
        s->tau[i] = tau;
        s->place[i] = i;
        s->stepping[i] = steps > 1;
        s->side[i] = 0;
        s->open[i] = width > 0;
    }
}

/* The next step, or else the secant's place. */
STAGE static void search_place(real step, search *restrict s)
{
    for (int i = 0; i < s->n; i++) {
        real front = s->front[i], back = s->back[i], high = s->above[i], low = s->below[i];
        real next = s->start[i] + s->length[i] * step, secant = front + (back - front) * (high / (high - low));
        real at = s->stepping[i] ? next : secant;
        s->at[i] = at;
        s->at_u[i] = s->u[i] + s->a[i] * at;
        s->at_w[i] = s->w[i] + s->b[i] * at;
    }
}

/* Take it in. Steps end at the first that is below the rough surface, and with the last but one, as the bracket's back
 * is below. Secants end where the error left is small; tau is the next place. An end that stays twice in a row
 * counts half, so that both ends move (Illinois). */
STAGE static void search_take(real step, real error, search *restrict s)
{
    for (int i = 0; i < s->n; i++) {
        bs_view v = {s->sn[i], s->a[i], s->b[i]};
        real at = s->at[i], above = above_at(v, s->curvature[i], at, s->h.P[i]), tau = s->tau[i];
        real front = s->front[i], back = s->back[i], high = s->above[i], low = s->below[i];
        int stepping = s->stepping[i], side = s->side[i], hit = above <= 0, again = hit ? side == 1 : side == -1;
        front = hit ? front : at;
        back = hit ? at : back;
        high = hit ? high : above;
        low = hit ? above : low;
        real width = back - front, next = front + width * (high / (high - low));
        real slope = real_min(high - low, real_abs(v.sn) * width); /* times width; an end's gap may be a guess */
        real left = real_abs(above) * width * s->pixels[i];
        s->tau[i] = s->open[i] ? next : tau;
        s->front[i] = front;
        s->back[i] = back;
        s->above[i] = (hit & again) ? high * R(0.5) : high;
        s->below[i] = ((hit == 0) & again) ? low * R(0.5) : low;
        s->stepping[i] = stepping & (hit == 0) & (step + 1 < s->steps[i]);
        s->side[i] = stepping ? 0 : hit ? 1 : -1;
        s->open[i] &= (stepping != 0) | (left > error * slope);
    }
}

STAGE static int open_lanes(int n, const int32_t *x)
{
    int m = 0;
    for (int i = 0; i < n; i++)
        m += x[i];
    return m;
}

/* Put the places of lanes that have ended, and drop these. */
static void search_put(search *s, places *p)
{
    int n = 0;
    for (int i = 0; i < s->n; i++)
        if (s->open[i])
            copy_lane(s, n++, i);
        else
            p->tau[s->place[i]] = s->tau[i];
    s->n = n;
}

long places_search(places *p, const bump *P, real error, search_steps steps)
{
    search s;
    long looks = 0;
    s.n = p->k.n;
    search_begin(p, steps, &s);
    const int32_t code = method_code((method){METHOD_MARCH, 1});
    for (int i = 0; i < s.n; i++)
        p->order[i] = s.open[i] ? code : p->order[i];
    for (int step = 1; step <= (int)steps.most + SECANTS_MAX && s.n > 0; step++) {
        search_place((real)step, &s);
        P->ops->eval(P, s.n, s.at_u, s.at_w, 0, &s.h);
        search_take((real)step, error, &s);
        looks += s.n;
        if (2 * open_lanes(s.n, s.open) <= s.n)
            search_put(&s, p);
    }
    for (int i = 0; i < s.n; i++)
        p->tau[s.place[i]] = s.tau[i];
    return looks;
}
