/* Draws brackets together: bounds, steps, secants. */
#include "method/bracket.h"

#include <string.h>

#include "method/method.h"
#include "wave/lane.h"

enum {
    STEPS_MAX = 16,  /* through a bracket */
    SECANTS_MAX = 8, /* after them */
};
#define STEP_ERRORS 16 /* the length of a step in errors */

static inline bs_view view(const brackets *k, int i) { return (bs_view){k->sn[i], k->a[i], k->b[i]}; }

/* Where the ray is at height P over the smooth surface: the root of 1/2 curvature tau^2 - sn tau + P near P/sn. Where
 * there is none, the place where the height is nearest to P. */
static inline real reaches(bs_view v, real curvature, real P)
{
    const real A = R(0.5) * curvature, B = -v.sn, d = B * B - 4 * A * P;
    real root = bs_tau2(v, B, d > 0 ? d : 0, P), turn = v.sn / curvature;
    return d >= 0 ? root : turn;
}

STAGE static void begin(const hit_group *restrict g, real Pmin, real Pmax, brackets *restrict k)
{
    for (int i = 0; i < g->n; i++) {
        bs_vec3 n = lane_get(&g->n_smooth, i), Qu = lane_get(&g->q.Qu, i), Qw = lane_get(&g->q.Qw, i);
        bs_view v = bs_view_of(lane_get(&g->x.s, i), n, Qu, Qw);
        real curvature =
            bs_curvature(v, n, lane_get(&g->q.Quu, i), lane_get(&g->q.Quw, i), lane_get(&g->q.Qww, i));
        real x = reaches(v, curvature, Pmin), y = reaches(v, curvature, Pmax);
        k->sn[i] = v.sn;
        k->a[i] = v.a;
        k->b[i] = v.b;
        k->curvature[i] = curvature;
        k->front[i] = real_max(real_min(x, y), -g->t[i]); /* not before the ray's start */
        k->back[i] = real_max(real_max(x, y), -g->t[i]);
    }
}

/* No bracket where there is no order 0, and where its ends are not finite. */
STAGE static void close_open_ends(const hit_group *restrict g, brackets *restrict k)
{
    for (int i = 0; i < g->n; i++) {
        real tau = g->tau[i], front = k->front[i], back = k->back[i];
        int good = (g->order[i] >= 0) & (back - front < REAL_FAR);
        k->front[i] = good ? front : tau;
        k->back[i] = good ? back : tau;
    }
}

int bracket_begin(const hit_group *g, const bump *P, brackets *k)
{
    const bool bounded = P->Pmax - P->Pmin < REAL_FAR;
    k->n = g->n;
    memcpy(k->u, g->u, sizeof k->u);
    memcpy(k->w, g->w, sizeof k->w);
    memcpy(k->tau, g->tau, sizeof k->tau);
    memcpy(k->order, g->order, sizeof k->order);
    begin(g, P->Pmin, P->Pmax, k);
    close_open_ends(g, k);
    return bounded ? 0 : g->n;
}

void bracket_pick(int n, const int32_t *lane, const brackets *from, brackets *to)
{
    to->n = n;
    for (int i = 0; i < n; i++) {
        const int j = lane[i];
        to->lane[i] = from->lane[j];
        to->sn[i] = from->sn[j];
        to->a[i] = from->a[j];
        to->b[i] = from->b[j];
        to->curvature[i] = from->curvature[j];
        to->u[i] = from->u[j];
        to->w[i] = from->w[j];
        to->front[i] = from->front[j];
        to->back[i] = from->back[j];
        to->tau[i] = from->tau[j];
        to->pixels[i] = from->pixels[j];
        to->order[i] = from->order[j];
    }
}

int bracket_wide(const brackets *k, real error, int32_t *lane)
{
    int n = 0;
    for (int i = 0; i < k->n; i++) { /* without a branch */
        lane[n] = i;
        n += (k->back[i] - k->front[i]) * k->pixels[i] > error;
    }
    return n;
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

STAGE static void search_begin(const brackets *restrict k, real per_step, search *restrict s)
{
    for (int i = 0; i < k->n; i++) {
        real steps = real_floor((k->back[i] - k->front[i]) * k->pixels[i] / per_step) + 1;
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
        int looking = (s->found[i] == 0) & (step <= s->steps[i]), hit = looking & (above <= 0), pass = looking & (above > 0);
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
STAGE static void secant_step(brackets *restrict k, real error, search *restrict s)
{
    for (int i = 0; i < k->n; i++) {
        bs_view v = view(k, i);
        real gap = bs_gap(v, k->curvature[i], s->at[i], s->h.P[i]), above = v.sn < 0 ? gap : -gap, at = s->at[i];
        real front = s->front[i], back = s->back[i], high = s->above[i], low = s->below[i];
        real rise = high - low, left = real_abs(above) * (back - front), tau = k->tau[i];
        int open = (s->found[i] != 0) & (s->done[i] == 0), hit = above <= 0;
        k->tau[i] = open ? at : tau;
        s->front[i] = hit ? front : at;
        s->above[i] = hit ? high * R(0.5) : above;
        s->back[i] = hit ? at : back;
        s->below[i] = hit ? above : low * R(0.5);
        s->done[i] |= left * k->pixels[i] <= error * rise;
    }
}

STAGE static void places(const brackets *restrict k, search *restrict s)
{
    for (int i = 0; i < k->n; i++) {
        s->u[i] = k->u[i] + k->a[i] * s->at[i];
        s->w[i] = k->w[i] + k->b[i] * s->at[i];
    }
}

static void look_up(const brackets *k, const bump *P, search *s)
{
    places(k, s);
    P->ops->eval(P, k->n, s->u, s->w, 0, &s->h);
}

static bool all(int n, const int32_t *x)
{
    int m = 0;
    for (int i = 0; i < n; i++)
        m += x[i] != 0;
    return m == n;
}

long bracket_search(brackets *k, const bump *P, real error)
{
    search s;
    long looks = 0;
    search_begin(k, STEP_ERRORS * error, &s);
    for (int step = 0; step <= STEPS_MAX && !all(k->n, s.found); step++) {
        search_place(k, (real)step, &s);
        look_up(k, P, &s);
        search_step(k, (real)step, &s);
        looks += k->n;
    }
    for (int i = 0; i < k->n; i++)
        s.done[i] = !s.found[i];
    for (int secant = 0; secant < SECANTS_MAX && !all(k->n, s.done); secant++) {
        secant_place(k->n, &s);
        look_up(k, P, &s);
        secant_step(k, error, &s);
        looks += k->n;
    }
    for (int i = 0; i < k->n; i++)
        k->order[i] = s.found[i] ? method_code((method){METHOD_MARCH, 1}) : 0;
    return looks;
}
