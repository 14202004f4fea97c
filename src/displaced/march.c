/* The search along rays for the displaced surface over a domain, many rays side by side. */
#include "displaced/march.h"

#include "displaced/crossing.h"
#include "displaced/window.h"
#include "wave/lane.h"

#define WIDER 4          /* the next window, where there was no hit in one */
#define FARTHER 2        /* and where one may be behind a step: over the step */
#define NARROWER R(0.25) /* and over the window at least */

/* What is known of the rays that are still searched, side by side. */
typedef struct search {
    paths at;
    windows ahead;
    real end[LANES], shortest[LANES], tolerance[LANES];
    real side[LANES]; /* 1: the ray comes from above the displaced surface; -1: from below; 0: not known yet */
    real before[LANES], above_before[LANES];      /* the place before t, and the gap there times side */
    int32_t own[LANES], left[LANES], open[LANES]; /* starts on this piece; has clearly left it; is still searched */
} search;

static void keep(search *s, int from, int to)
{
    paths_copy(&s->at, from, &s->at, to);
    s->at.slope[to] = s->at.slope[from];
    s->ahead.size[to] = s->ahead.size[from];
    s->end[to] = s->end[from];
    s->shortest[to] = s->shortest[from];
    s->tolerance[to] = s->tolerance[from];
    s->side[to] = s->side[from];
    s->before[to] = s->before[from];
    s->above_before[to] = s->above_before[from];
    s->own[to] = s->own[from];
    s->left[to] = s->left[from];
    s->open[to] = s->open[from];
}

static void compact(search *s)
{
    int n = 0;
    for (int i = 0; i < s->at.n; i++)
        if (s->open[i] && n++ < i)
            keep(s, i, n - 1);
    s->at.n = n;
}

/* How a ray goes on: bits of `state`. */
enum { CROSSES = 1, ENDS = 2 };

/* Take the rays with their stretches; open: that are not empty. */
STAGE static void lay_search(int n, const rays *restrict x, const real *restrict t0, const real *restrict t1,
                             int32_t steps, real high, search *restrict s)
{
    const real share = 1 / (real)steps;
    for (int i = 0; i < n; i++) {
        const bs_vec3 r = lane_get(&x->r, i), d = lane_get(&x->s, i), far = lane_at(x, i, t1[i]);
        /* the last digits of a place on the ray: of its coordinates, and of what they were summed from */
        const real size = real_sqrt(bs_dot(r, r)) + real_sqrt(bs_dot(far, far)) + high;
        const real length = t1[i] - t0[i], tolerance = 8 * R(REAL_ROUNDING) * size;
        const real shortest = real_max(length * share, tolerance / real_sqrt(bs_dot(d, d)));
        lane_set(&s->at.x.r, i, r);
        lane_set(&s->at.x.s, i, d);
        s->at.lane[i] = i;
        s->at.t[i] = t0[i];
        s->ahead.size[i] = length;
        s->end[i] = t1[i];
        s->tolerance[i] = tolerance;
        s->shortest[i] = shortest;
        s->side[i] = 0;
        s->before[i] = real_max(t0[i] - shortest, 0);
        s->above_before[i] = tolerance;
        s->open[i] = t0[i] <= t1[i];
    }
}

/* One whose stretch begins farther on comes from what the bound leaves out. */
static void lay_own(int n, const int32_t *own, search *s)
{
    for (int i = 0; i < n; i++) {
        s->own[i] = own && own[i] && s->at.t[i] <= s->shortest[i];
        s->left[i] = !s->own[i];
    }
}

static void begin(const domain *f, const bump *P, int n, const rays *x, const real *end, const int32_t *own, search *s)
{
    real t0[LANES], t1[LANES];
    f->bound(f, n, x, end, P->Pmin, P->Pmax, t0, t1);
    s->at.n = n;
    s->at.evaluations = 0;
    lay_search(n, x, t0, t1, f->steps, real_abs(P->Pmax - P->Pmin), s);
    lay_own(n, own, s);
    compact(s);
}

/* The side on which a ray begins, and its tolerance; order: of the evaluation. Where the gap is 0 to rounding, a ray
 * that starts on the surface is on the side that it leaves to, any other on the one that it comes from. There the gap
 * is what rounding has made of 0: of sums, too, that are not known here, as of a camera far away. */
STAGE static void take_sides(int order, search *restrict s)
{
    const int n = s->at.n;
    if (order == 0)
        for (int i = 0; i < n; i++)
            s->at.slope[i] = s->at.dh[i];
    for (int i = 0; i < n; i++) {
        const real gap = s->at.gap[i], off = real_abs(gap), tolerance = s->tolerance[i];
        const int own = s->own[i] != 0, clear = (off > tolerance) & !own, rises = s->at.slope[i] > 0;
        const real by_gap = gap > 0 ? R(1) : R(-1), by_slope = rises == own ? R(1) : R(-1);
        s->side[i] = clear ? by_gap : by_slope;
        s->tolerance[i] = own ? real_max(tolerance, real_min(2 * off, 8 * tolerance)) : tolerance;
    }
}

/* Where rays have got to. A map's partials are not the slopes of its bilinear surface, so a ray can leave its start to
 * the other side than they say: it is there, and does not turn back. One that has come back to its start turns to it.
 * On its way from the surface itself a ray is on its side until it is clearly on the other. At the end of the stretch,
 * P = Pmin below it, rounding must not let the ray slip through. */
STAGE static void look(search *restrict s, int32_t *restrict state)
{
    const int n = s->at.n;
    for (int i = 0; i < n; i++) {
        const real tolerance = s->tolerance[i], side = s->side[i], gap = side * s->at.gap[i];
        const real slope = side * s->at.slope[i], least = s->own[i] ? tolerance : 0;
        const int turns = (s->left[i] == 0) & (gap <= -tolerance) & (slope > 0);
        const real sign = turns ? R(-1) : R(1), above = sign * gap, falls = sign * side * s->at.dh[i];
        const int left = (s->left[i] != 0) | (above > tolerance), last = s->at.t[i] >= s->end[i];
        const int touches = last & left & (above <= tolerance) & (falls < 0);
        s->side[i] = sign * side;
        s->left[i] = left;
        state[i] = (((above <= -least) | touches) ? CROSSES : 0) | (last ? ENDS : 0);
    }
}

/* ---- crossings ---- */

/* A ray that has crossed between the place before t and t. */
static void add_crossing(const search *s, int i, crossings *c)
{
    const int k = c->at.n++;
    paths_copy(&s->at, i, &c->at, k);
    c->side[k] = s->side[i];
    c->a[k] = s->before[i];
    c->b[k] = s->at.t[i];
    c->above_a[k] = real_max(s->above_before[i], 0);
    c->above_b[k] = s->side[i] * s->at.gap[i];
    c->tolerance[k] = s->tolerance[i];
    c->own[k] = s->own[i];
}

/* Whether the closest point to a hit is on the piece, and not on what extends it. */
static bool on_piece(const domain *f, const search *s, int i, real t)
{
    rays x;
    closest_points p;
    real u, w;
    lane_set(&x.r, 0, lane_get(&s->at.x.r, i));
    lane_set(&x.s, 0, lane_get(&s->at.x.s, i));
    f->closest(f, 1, &s->at.lane[i], &x, &t, &p);
    f->within(f, 1, &s->at.lane[i], &p, &u, &w);
    return u == p.u[0] && w == p.w[0];
}

/* Whether a crossing is none as it is not on the piece: it is refined alone. */
static bool beside(const domain *f, const bump *P, search *s, int i, real *t, int32_t *found)
{
    const int32_t lane = s->at.lane[i];
    crossings one;
    if (!f->unclamped)
        return false;
    one.at.n = 0;
    one.at.evaluations = 0;
    add_crossing(s, i, &one);
    crossings_refine(f, P, &one, t, found);
    s->at.evaluations += one.at.evaluations;
    if (on_piece(f, s, i, t[lane]))
        return false;
    found[lane] = DISPLACED_MISSED;
    return true;
}

/* ---- steps ---- */

/* Take the rays that have met the surface, or are at their ends. Whether others are left. */
static bool take(const domain *f, const bump *P, search *s, const int32_t *state, crossings *c, real *t, int32_t *found)
{
    for (int i = 0; i < s->at.n; i++) {
        if (state[i] == 0 || !s->open[i])
            continue;
        const bool crosses = state[i] & CROSSES, other = crosses && beside(f, P, s, i, t, found);
        if (crosses && !f->unclamped)
            add_crossing(s, i, c);
        if (other) /* through what extends the surface, to its other side */
            s->side[i] = -s->side[i];
        s->open[i] = !(state[i] & ENDS) && (other || !crosses);
    }
    for (int i = 0; i < s->at.n; i++)
        if (s->open[i])
            return true;
    s->at.n = 0;
    return false;
}

/* On to where a hit may be. From its start on the surface at first as far as the tolerance allows, then as far again.
 */
STAGE static void go_on(search *restrict s)
{
    const int n = s->at.n;
    for (int i = 0; i < n; i++) {
        const real t = s->at.t[i], size = s->ahead.size[i], step = s->ahead.step[i], shortest = s->shortest[i];
        const real slow = s->tolerance[i] / (real_abs(s->at.slope[i]) + real_abs(s->at.dh[i]));
        const int left = s->left[i] != 0, other = !left & (s->ahead.one[i] != 0); /* it leaves to the other side */
        const real side = other ? -s->side[i] : s->side[i];
        const real least = left ? shortest : real_min(real_max(slow, t), shortest);
        const real next = real_min(t + real_max(step, least), s->end[i]);
        const real wide = step >= size ? WIDER * size : real_max(FARTHER * step, NARROWER * size);
        s->side[i] = side;
        s->before[i] = t;
        s->above_before[i] = side * s->at.gap[i];
        s->at.t[i] = next;
        s->ahead.size[i] = real_min(wide, s->end[i] - next);
    }
}

static void all_missed(int n, int32_t *found)
{
    for (int i = 0; i < n; i++)
        found[i] = DISPLACED_MISSED;
}

long displaced_search(const domain *f, const bump *P, int n, const rays *x, const real *end, const int32_t *own,
                      bool any, real *t, int32_t *found)
{
    search s;
    crossings c;
    int32_t state[LANES];
    c.at.n = 0;
    c.at.evaluations = 0;
    all_missed(n, found);
    begin(f, P, n, x, end, own, &s);
    for (int step = 0; step < f->steps && s.at.n; step++) {
        const int order = (step == 0 && own) || P->Puu_max < REAL_FAR;
        paths_evaluate(f, P, order, &s.at);
        paths_differentiate(order, &s.at);
        if (step == 0)
            take_sides(order, &s);
        look(&s, state);
        if (!take(f, P, &s, state, &c, t, found))
            break;
        windows_clear(f, P, &s.at, s.side, s.tolerance, &s.ahead);
        go_on(&s);
        compact(&s);
    }
    for (int i = 0; i < s.at.n; i++)
        if (!f->unclamped || on_piece(f, &s, i, s.at.t[i])) {
            t[s.at.lane[i]] = s.at.t[i];
            found[s.at.lane[i]] = DISPLACED_UNCERTAIN;
        }
    if (any)
        for (int i = 0; i < c.at.n; i++) {
            t[c.at.lane[i]] = c.b[i];
            found[c.at.lane[i]] = DISPLACED_HIT;
        }
    else
        crossings_refine(f, P, &c, t, found);
    return s.at.evaluations + c.at.evaluations;
}
