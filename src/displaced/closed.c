/* Displaced surfaces over those whose closest points have closed forms: the members bound, closest and bend of
 * surface_ops. Each part of the surface is searched alone, by march.h. */
#include "displaced/form.h"
#include "displaced/march.h"
#include "wave/lane.h"

/* Of a search along one ray: its shortest step is the stretch over this, far below a pixel. */
enum { STEPS = 4096 };

/* A part of a surface, the same for every lane. */
typedef struct part_domain {
    domain base;
    const surface *f;
    int part;
} part_domain;

static const part_domain *part_of(const domain *g) { return (const part_domain *)g; }

static void part_bound(const domain *g, int n, const rays *x, const real *end, real Pmin, real Pmax, real *t0, real *t1)
{
    const part_domain *k = part_of(g);
    k->f->ops->bound(k->f, k->part, n, x, end, Pmin, Pmax, t0, t1);
}

static void part_closest(const domain *g, int n, const int32_t *lane, const rays *x, const real *t, closest_points *p)
{
    const part_domain *k = part_of(g);
    (void)lane;
    k->f->ops->closest(k->f, k->part, n, x, t, p);
}

static void part_bend(const domain *g, int n, const int32_t *lane, const rays *x, const closest_points *p,
                      path_bends *out)
{
    const part_domain *k = part_of(g);
    (void)lane;
    k->f->ops->bend(k->f, k->part, n, x, p, out);
}

/* What of a range is within a part; where that goes around, a range beyond an end is all of it. */
STAGE static void cut_range(int n, real lo, real hi, int around, real *restrict from, real *restrict to)
{
    for (int i = 0; i < n; i++) {
        const int beyond = around & ((from[i] < lo) | (to[i] > hi));
        const real a = real_min(real_max(from[i], lo), hi), b = real_min(real_max(to[i], lo), hi);
        from[i] = beyond ? lo : a;
        to[i] = beyond ? hi : b;
    }
}

static void part_places(const domain *g, int n, const int32_t *lane, rectangles *r)
{
    const part_domain *k = part_of(g);
    const int around = k->part == 0 ? k->f->ops->around : 0;
    double U[2], W[2];
    (void)lane;
    k->f->ops->extent(k->f, k->part, U, W);
    cut_range(n, (real)U[0], (real)U[1], (around & AROUND_U) != 0, r->u0, r->u1);
    cut_range(n, (real)W[0], (real)W[1], (around & AROUND_W) != 0, r->w0, r->w1);
}

static void part_within(const domain *g, int n, const int32_t *lane, const closest_points *p, real *u, real *w)
{
    const part_domain *k = part_of(g);
    double U[2], W[2];
    (void)lane;
    k->f->ops->extent(k->f, k->part, U, W);
    for (int i = 0; i < n; i++) {
        u[i] = real_min(real_max(p->u[i], (real)U[0]), (real)U[1]);
        w[i] = real_min(real_max(p->w[i], (real)W[0]), (real)W[1]);
    }
}

/* own[i]: the ray starts on this part's displaced surface. Returns how often P was evaluated. */
static long search_part(const displaced *d, int part, int n, const rays *x, const real *end, const int32_t *own,
                        bool any, real *t, int32_t *found)
{
    const surface *f = d->smooth;
    const part_domain k = {{.bound = part_bound,
                            .closest = part_closest,
                            .bend = part_bend,
                            .places = part_places,
                            .within = part_within,
                            .unclamped = f->ops->unclamped,
                            .steps = STEPS},
                           f,
                           part};
    return displaced_search(&k.base, d->P, n, x, end, own, any, t, found);
}

static bool closed_fits(const surface *f) { return f->ops->closest != NULL; }

/* The nearest hit over all parts. */
static void closed_hit(const displaced *d, int n, const rays *x, const ray_origins *from, int32_t id, hits *h)
{
    real t[LANES];
    int32_t found[LANES], own[LANES];
    for (int part = 0; part < d->smooth->ops->parts; part++) {
        int32_t any_own = 0;
        long uncertain = 0;
        for (int i = 0; i < n; i++)
            any_own |= own[i] = from && from->id[i] == id && from->part[i] == part;
        const long evaluations = search_part(d, part, n, x, h->t, any_own ? own : NULL, false, t, found);
        for (int i = 0; i < n; i++)
            if (found[i] != DISPLACED_MISSED && t[i] > 0 && t[i] < h->t[i]) {
                h->t[i] = t[i];
                h->id[i] = id;
                h->part[i] = part;
                uncertain += found[i] == DISPLACED_UNCERTAIN;
            }
        displaced_count(d, evaluations, uncertain);
    }
}

static void closed_occlude(const displaced *d, int n, const rays *x, const int32_t *on, real *lit)
{
    real t[LANES], end[LANES];
    int32_t found[LANES], own[LANES];
    for (int i = 0; i < n; i++)
        end[i] = lit[i] > 0 ? R(1) : R(-1); /* in shadow already: nothing to search */
    for (int part = 0; part < d->smooth->ops->parts; part++) {
        long uncertain = 0;
        for (int i = 0; i < n; i++)
            own[i] = on && on[i] == part;
        const long evaluations = search_part(d, part, n, x, end, own, true, t, found);
        for (int i = 0; i < n; i++)
            if (found[i] != DISPLACED_MISSED) {
                lit[i] = 0;
                uncertain += found[i] == DISPLACED_UNCERTAIN;
            }
        displaced_count(d, evaluations, uncertain);
    }
}

/* Each hit on its own part. */
static void closed_closest(const displaced *d, int n, const rays *x, const real *t, int32_t *part, closest_points *all)
{
    const surface *f = d->smooth;
    f->ops->closest(f, 0, n, x, t, all);
    for (int k = 1; k < f->ops->parts; k++) {
        closest_points p;
        f->ops->closest(f, k, n, x, t, &p);
        for (int i = 0; i < n; i++)
            if (part[i] == k) {
                all->u[i] = p.u[i];
                all->w[i] = p.w[i];
                lane_set(&all->gu, i, lane_get(&p.gu, i));
                lane_set(&all->gw, i, lane_get(&p.gw, i));
                lane_set(&all->gh, i, lane_get(&p.gh, i));
            }
    }
}

const displaced_form displaced_over_closed = {closed_fits, NULL, closed_hit, closed_occlude, closed_closest};
