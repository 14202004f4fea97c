/* The search along rays for the displaced surface over a domain, many rays side by side. */
#include "displaced/march.h"

#include "displaced/crossing.h"
#include "displaced/window.h"
#include "wave/lane.h"

enum { COMPACT = 2 }; /* after so many steps the rays that have ended are dropped from the wave */

#define WIDER 4           /* the next window, where there was no hit in one */
#define FARTHER 2         /* and where one may be behind a step: over the step */
#define NARROWER R(0.125) /* and over the window at least */

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
        if (s->open[i])
            keep(s, i, n++);
    s->at.n = n;
}

/* Open the search on the rays whose stretch is not empty. */
static void begin(const domain *f, const bump *P, int n, const rays *x, const real *end, const int32_t *own, search *s)
{
    real t0[LANES], t1[LANES];
    f->bound(f, n, x, end, P->Pmin, P->Pmax, t0, t1);
    s->at.n = 0;
    s->at.evaluations = 0;
    for (int i = 0; i < n; i++) {
        if (!(t0[i] <= t1[i]))
            continue;
        const int k = s->at.n++;
        bs_vec3 r = lane_get(&x->r, i), d = lane_get(&x->s, i), far = lane_at(x, i, t1[i]);
        /* the last digits of a place on the ray: of its coordinates, and of what they were summed from */
        real size = real_sqrt(bs_dot(r, r)) + real_sqrt(bs_dot(far, far)) + real_abs(P->Pmax - P->Pmin);
        s->at.lane[k] = i;
        lane_set(&s->at.x.r, k, r);
        lane_set(&s->at.x.s, k, d);
        s->at.t[k] = t0[i];
        s->ahead.size[k] = t1[i] - t0[i];
        s->end[k] = t1[i];
        s->tolerance[k] = 8 * R(REAL_ROUNDING) * size;
        s->shortest[k] = real_max((t1[i] - t0[i]) / (real)f->steps, s->tolerance[k] / real_sqrt(bs_dot(d, d)));
        s->side[k] = 0;
        s->before[k] = real_max(t0[i] - s->shortest[k], 0);
        s->above_before[k] = s->tolerance[k];
        /* one whose stretch begins farther on comes from what the bound leaves out */
        s->own[k] = own && own[i] && t0[i] <= s->shortest[k];
        s->left[k] = !s->own[k];
        s->open[k] = 1;
    }
}

/* The side on which a ray begins. Where the gap is 0 to rounding: a ray that starts on the surface
 * is on the side that it leaves to, any other on the one that it comes from. */
static real side_of(const search *s, int i)
{
    if (real_abs(s->at.gap[i]) > s->tolerance[i] && !s->own[i])
        return s->at.gap[i] > 0 ? R(1) : R(-1);
    return (s->at.slope[i] > 0) == (s->own[i] != 0) ? R(1) : R(-1);
}

/* Where a ray starts on the surface, the gap is what rounding has made of 0: of sums, too, that are not known here, as
 * of a camera far away. */
static real tolerance_of(const search *s, int i)
{
    const real off = s->own[i] ? 2 * real_abs(s->at.gap[i]) : 0;
    return real_max(s->tolerance[i], real_min(off, 8 * s->tolerance[i]));
}

static void take_sides(search *s)
{
    for (int i = 0; i < s->at.n; i++)
        if (s->side[i] == 0) {
            s->side[i] = side_of(s, i);
            s->tolerance[i] = tolerance_of(s, i);
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

/* Whether the ray i has met the surface, or is at its end. `above` is the gap on its side. */
static bool ends(const domain *f, const bump *P, search *s, int i, crossings *c, real *t, int32_t *found)
{
    /* On its way from the surface itself a ray is on its side until it is clearly on the other. */
    const real least = s->own[i] ? s->tolerance[i] : 0, above = s->side[i] * s->at.gap[i];
    s->left[i] |= above > s->tolerance[i];
    /* At the end of the stretch, P = Pmin below it, rounding must not let the ray slip through. */
    const bool last = s->at.t[i] >= s->end[i];
    const bool touches = last && above <= s->tolerance[i] && s->side[i] * s->at.slope[i] < 0;
    if (above <= -least || (touches && s->left[i])) {
        if (!beside(f, P, s, i, t, found)) {
            if (!f->unclamped)
                add_crossing(s, i, c);
            return true;
        }
        s->side[i] = -s->side[i]; /* through what extends the surface, to its other side */
    }
    return last;
}

/* A map's partials are not the slopes of its bilinear surface, so a ray can leave its start to the other side than they
 * say: it is there, and does not turn back. One that has come back to its start turns to it. */
static void turn(search *s, int i)
{
    const real above = s->side[i] * s->at.gap[i];
    if (!s->left[i] && above <= -s->tolerance[i] && s->side[i] * s->at.slope[i] > 0)
        s->side[i] = -s->side[i];
}

/* On to where a hit may be. From its start on the surface at first as far as the tolerance allows, then as far again.
 */
static void go_on(search *s, int i)
{
    const real size = s->ahead.size[i], step = s->ahead.step[i];
    if (!s->left[i] && s->ahead.one[i]) /* it leaves to the other side */
        s->side[i] = -s->side[i];
    const real away = real_max(s->tolerance[i] / (real_abs(s->at.slope[i]) + real_abs(s->at.dh[i])), s->at.t[i]);
    const real far = real_max(step, s->left[i] ? s->shortest[i] : real_min(away, s->shortest[i]));
    s->before[i] = s->at.t[i];
    s->above_before[i] = s->side[i] * s->at.gap[i];
    s->at.t[i] = real_min(s->at.t[i] + far, s->end[i]);
    s->ahead.size[i] =
        real_min(step >= size ? WIDER * size : real_max(FARTHER * step, NARROWER * size), s->end[i] - s->at.t[i]);
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
    c.at.n = 0;
    c.at.evaluations = 0;
    all_missed(n, found);
    begin(f, P, n, x, end, own, &s);
    for (int step = 0; step < f->steps && s.at.n; step++) {
        paths_evaluate(f, P, 1, &s.at);
        take_sides(&s);
        for (int i = 0; i < s.at.n; i++) {
            turn(&s, i);
            s.open[i] = s.open[i] && !ends(f, P, &s, i, &c, t, found);
        }
        windows_clear(f, P, &s.at, s.side, s.tolerance, &s.ahead);
        for (int i = 0; i < s.at.n; i++)
            if (s.open[i])
                go_on(&s, i);
        if (step % COMPACT == COMPACT - 1)
            compact(&s);
    }
    compact(&s);
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
