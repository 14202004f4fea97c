/* The search along rays for the displaced surface over a domain, many rays side by side. */
#include "displaced/march.h"

#include "wave/lane.h"

enum {
    REFINE = 64, /* halvings at most: more than a real has digits */
    COMPACT = 4, /* after so many steps the rays that have ended are dropped from the wave */
};

/* What is known of the rays that are still searched, side by side. */
typedef struct search {
    int n;
    int32_t lane[LANES]; /* whose ray it is */
    rays x;
    real t[LANES], gap[LANES], end[LANES], shortest[LANES], tolerance[LANES];
    real side[LANES]; /* 1: the ray comes from above the displaced surface; -1: from below; 0: not known yet */
    int32_t own[LANES], left[LANES], open[LANES]; /* starts on this piece; has clearly left it; is still searched */
    closest_points p;
    bump_values h;
    real rate[LANES], reach[LANES];
    long evaluations; /* at P */
} search;

/* The gap at t, and its derivative along the ray. */
STAGE static void gaps(search *restrict s, real *restrict slope)
{
    for (int i = 0; i < s->n; i++) {
        bs_vec3 d = lane_get(&s->x.s, i);
        s->gap[i] = s->p.h[i] - s->h.P[i];
        slope[i] = bs_dot(d, lane_get(&s->p.gh, i)) - s->h.Pu[i] * bs_dot(d, lane_get(&s->p.gu, i)) -
                   s->h.Pw[i] * bs_dot(d, lane_get(&s->p.gw, i));
    }
}

static void evaluate(const domain *f, const bump *P, search *s, real *slope)
{
    real u[LANES], w[LANES];
    f->closest(f, s->n, s->lane, &s->x, s->t, &s->p);
    if (f->unclamped)
        f->within(f, s->n, s->lane, &s->p, u, w);
    P->ops->eval(P, s->n, f->unclamped ? u : s->p.u, f->unclamped ? w : s->p.w, 1, &s->h);
    s->evaluations += s->n;
    gaps(s, slope);
}

static void keep(search *s, int from, int to)
{
    s->lane[to] = s->lane[from];
    lane_set(&s->x.r, to, lane_get(&s->x.r, from));
    lane_set(&s->x.s, to, lane_get(&s->x.s, from));
    s->t[to] = s->t[from];
    s->end[to] = s->end[from];
    s->shortest[to] = s->shortest[from];
    s->tolerance[to] = s->tolerance[from];
    s->side[to] = s->side[from];
    s->own[to] = s->own[from];
    s->left[to] = s->left[from];
    s->open[to] = s->open[from];
}

static void compact(search *s)
{
    int n = 0;
    for (int i = 0; i < s->n; i++)
        if (s->open[i])
            keep(s, i, n++);
    s->n = n;
}

/* A crossing between a and b, the gap's sign changing: Newton's steps from b, or halvings where they leave the bracket
 * or do not pay. Returns the confirmed t in *t. */
static displaced_result refine(const domain *f, const bump *P, search *s, int i, real a, real b, real *t)
{
    search one; /* its first lane alone is used */
    real slope[LANES], best = b, least = REAL_FAR, before = REAL_FAR;
    one.n = 1;
    one.evaluations = 0;
    one.lane[0] = s->lane[i];
    lane_set(&one.x.r, 0, lane_get(&s->x.r, i));
    lane_set(&one.x.s, 0, lane_get(&s->x.s, i));
    one.t[0] = b;
    for (int k = 0; k < REFINE; k++) {
        evaluate(f, P, &one, slope);
        real gap = s->side[i] * one.gap[0], size = real_abs(gap);
        if (size < least) {
            least = size;
            best = one.t[0];
        }
        if (gap > 0)
            a = one.t[0];
        else
            b = one.t[0];
        real next = one.t[0] - one.gap[0] / slope[0];
        if (!(next > a && next < b) || size > R(0.5) * before)
            next = a + (b - a) * R(0.5);
        before = size;
        if (gap == 0 || next == one.t[0] || !(next > a && next < b))
            break;
        one.t[0] = next;
    }
    s->evaluations += one.evaluations;
    *t = best;
    /* a ray from the surface itself was let go on until it was clearly below, so that its bracket can begin there */
    return least <= (s->own[i] ? 2 : 1) * s->tolerance[i] ? DISPLACED_HIT : DISPLACED_UNCERTAIN;
}

/* Whether the closest point to a hit is on the piece, and not on what extends it. */
static bool on_piece(const domain *f, const search *s, int i, real t)
{
    rays x;
    closest_points p;
    real u, w;
    if (!f->unclamped)
        return true;
    lane_set(&x.r, 0, lane_get(&s->x.r, i));
    lane_set(&x.s, 0, lane_get(&s->x.s, i));
    f->closest(f, 1, &s->lane[i], &x, &t, &p);
    f->within(f, 1, &s->lane[i], &p, &u, &w);
    return u == p.u[0] && w == p.w[0];
}

/* Open the search on the rays whose stretch is not empty. */
static void begin(const domain *f, const bump *P, int n, const rays *x, const real *end, const int32_t *own, search *s)
{
    real t0[LANES], t1[LANES];
    f->bound(f, n, x, end, P->Pmin, P->Pmax, t0, t1);
    s->n = 0;
    s->evaluations = 0;
    for (int i = 0; i < n; i++) {
        if (!(t0[i] <= t1[i]))
            continue;
        const int k = s->n++;
        bs_vec3 r = lane_get(&x->r, i), d = lane_get(&x->s, i), far = lane_at(x, i, t1[i]);
        /* the last digits of a place on the ray: of its coordinates, and of what they were summed from */
        real size = real_sqrt(bs_dot(r, r)) + real_sqrt(bs_dot(far, far)) + real_abs(P->Pmax - P->Pmin);
        s->lane[k] = i;
        lane_set(&s->x.r, k, r);
        lane_set(&s->x.s, k, d);
        s->t[k] = t0[i];
        s->end[k] = t1[i];
        s->tolerance[k] = 8 * R(REAL_ROUNDING) * size;
        s->shortest[k] = real_max((t1[i] - t0[i]) / (real)f->steps, s->tolerance[k] / real_sqrt(bs_dot(d, d)));
        s->side[k] = 0;
        /* one whose stretch begins farther on comes from what the bound leaves out */
        s->own[k] = own && own[i] && t0[i] <= s->shortest[k];
        s->left[k] = !s->own[k];
        s->open[k] = 1;
    }
}

/* The side on which a ray begins. Where the gap is 0 to rounding: a ray that starts on the surface
 * is on the side that it leaves to, any other on the one that it comes from. */
static real side_of(const search *s, int i, real slope)
{
    if (real_abs(s->gap[i]) > s->tolerance[i] && !s->own[i])
        return s->gap[i] > 0 ? R(1) : R(-1);
    return (slope > 0) == (s->own[i] != 0) ? R(1) : R(-1);
}

/* Where a ray starts on the surface, the gap is what rounding has made of 0: of sums, too, that are not known here, as
 * of a camera far away. */
static real tolerance_of(const search *s, int i)
{
    const real off = s->own[i] ? 2 * real_abs(s->gap[i]) : 0;
    return real_max(s->tolerance[i], real_min(off, 8 * s->tolerance[i]));
}

long displaced_search(const domain *f, const bump *P, int n, const rays *x, const real *end, const int32_t *own,
                      real *t, int32_t *found)
{
    search s;
    real slope[LANES];
    for (int i = 0; i < n; i++)
        found[i] = DISPLACED_MISSED;
    begin(f, P, n, x, end, own, &s);
    for (int step = 0; step < f->steps && s.n; step++) {
        evaluate(f, P, &s, slope);
        f->lipschitz(f, s.n, s.lane, &s.x, &s.p, P->Pu_max, P->Pw_max, s.rate, s.reach);
        for (int i = 0; i < s.n; i++) {
            if (!s.open[i])
                continue;
            if (s.side[i] == 0) {
                s.side[i] = side_of(&s, i, slope[i]);
                s.tolerance[i] = tolerance_of(&s, i);
            }
            /* On its way from the surface itself a ray is on its side until it is clearly on the other. */
            real least = s.own[i] ? s.tolerance[i] : 0;
            real above = s.side[i] * s.gap[i];
            /* A map's partials are not the slopes of its bilinear surface, so a ray can leave to the other side than
             * they say: it is there, and does not turn back. One that has come back to its start turns to it. */
            if (!s.left[i] && above <= -least && s.side[i] * slope[i] > 0) {
                s.side[i] = -s.side[i];
                above = -above;
            }
            s.left[i] |= above > s.tolerance[i];
            /* At the end of the stretch, P = Pmin below it, rounding must not let the ray slip through. */
            bool last = s.t[i] >= s.end[i], touches = last && above <= s.tolerance[i] && s.side[i] * slope[i] < 0;
            if (above <= -least || (touches && s.left[i])) {
                /* no step goes past a crossing by more than the shortest does */
                real from = real_max(s.t[i] - s.shortest[i], 0), at;
                displaced_result end_of = refine(f, P, &s, i, from, s.t[i], &at);
                if (on_piece(f, &s, i, at)) {
                    t[s.lane[i]] = at;
                    found[s.lane[i]] = (int32_t)end_of;
                    s.open[i] = 0;
                    continue;
                }
                s.side[i] = -s.side[i]; /* through what extends the surface, to its other side */
                above = -above;
            }
            if (last) {
                s.open[i] = 0;
                continue;
            }
            /* from its start on the surface at first as far as the tolerance allows, then as far again */
            real safe = real_min(above / s.rate[i], s.reach[i]), away = real_max(s.tolerance[i] / s.rate[i], s.t[i]);
            safe = real_max(safe, s.left[i] ? s.shortest[i] : real_min(away, s.shortest[i]));
            s.t[i] = real_min(s.t[i] + safe, s.end[i]);
        }
        if (step % COMPACT == COMPACT - 1)
            compact(&s);
    }
    compact(&s);
    for (int i = 0; i < s.n; i++)
        if (on_piece(f, &s, i, s.t[i])) {
            t[s.lane[i]] = s.t[i];
            found[s.lane[i]] = DISPLACED_UNCERTAIN;
        }
    return s.evaluations;
}
