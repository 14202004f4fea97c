/* Displaced surfaces: their methods, by the form that fits the smooth surface (form.h), and the method `exact`. */
#include "displaced/displaced.h"

#include <stdlib.h>
#include <string.h>

#include "bvh/bvh.h"
#include "displaced/form.h"
#include "method/method.h"
#include "wave/lane.h"

static const displaced *of(const surface *f) { return (const displaced *)f; }

static void displaced_hit(const surface *f, int n, const rays *x, int32_t id, hits *h)
{
    of(f)->form->hit(of(f), n, x, NULL, id, h);
}

static void displaced_hit_own(const surface *f, int n, const rays *x, const ray_origins *from, int32_t id, hits *h)
{
    of(f)->form->hit(of(f), n, x, from, id, h);
}

static void displaced_occlude(const surface *f, int n, const rays *x, real *lit)
{
    of(f)->form->occlude(of(f), n, x, NULL, lit);
}

static void displaced_occlude_own(const surface *f, int n, const rays *x, const int32_t *part, real *lit)
{
    of(f)->form->occlude(of(f), n, x, part, lit);
}

static void displaced_locate(const surface *f, int n, const rays *x, const real *t, int32_t *part, real *u, real *w)
{
    closest_points p;
    of(f)->form->closest(of(f), n, x, t, part, &p);
    memcpy(u, p.u, (size_t)n * sizeof *u);
    memcpy(w, p.w, (size_t)n * sizeof *w);
}

static void displaced_extent(const surface *f, int part, double u[2], double w[2])
{
    of(f)->smooth->ops->extent(of(f)->smooth, part, u, w);
}

static void displaced_box(const surface *f, double lo[3], double hi[3])
{
    const displaced *d = of(f);
    const double high = fmax(fabs((double)d->P->Pmin), fabs((double)d->P->Pmax));
    d->smooth->ops->box(d->smooth, lo, hi);
    for (int k = 0; k < 3; k++) {
        lo[k] -= high;
        hi[k] += high;
    }
}

static const surface_ops displaced_ops = {
    .kind = "displaced",
    .hit = displaced_hit,
    .hit_own = displaced_hit_own,
    .locate = displaced_locate,
    .occlude = displaced_occlude,
    .occlude_own = displaced_occlude_own,
    .extent = displaced_extent,
    .box = displaced_box,
};

bool displaced_is(const surface *f) { return f->ops == &displaced_ops; }

static const displaced_form *form_of(const surface *f)
{
    static const displaced_form *const all[] = {&displaced_over_patch, &displaced_over_mesh, &displaced_over_closed};
    for (int k = 0; k < 3; k++)
        if (all[k]->fits(f))
            return all[k];
    return NULL;
}

bool displaced_has_form(const surface *f) { return form_of(f) != NULL; }

bool displaced_has_bounds(const bump *P)
{
    return P->Pmax - P->Pmin < REAL_FAR && P->Pu_max < REAL_FAR && P->Pw_max < REAL_FAR;
}

static void displaced_free(surface *f)
{
    displaced *d = (displaced *)f;
    surface_free(d->offset);
    bvh_free(d->prisms);
    free(d);
}

surface *displaced_new(const surface *f, bump *P, const progress *w, bool *bounded)
{
    *bounded = true;
    displaced *d = bump_prepare(P, w) ? calloc(1, sizeof *d) : NULL;
    if (!d)
        return NULL;
    d->base = (surface){.ops = &displaced_ops, .free = displaced_free};
    d->form = form_of(f);
    d->smooth = f;
    d->P = P;
    if (!d->form->prepare || d->form->prepare(d, w))
        return &d->base;
    *bounded = !d->unbounded;
    displaced_free(&d->base);
    return NULL;
}

displaced displaced_counting(const surface *f, displaced_counts *c)
{
    displaced d = *of(f);
    d.counts = c;
    return d;
}

/* n as a unit vector; where it has no length, that of the smooth surface, else one that faces the viewer. */
static bs_vec3 normal_of(bs_vec3 n, bs_vec3 smooth, bs_vec3 s)
{
    const real n2 = bs_dot(n, n), smooth2 = bs_dot(smooth, smooth);
    if (n2 >= REAL_LEAST && n2 < (real)HUGE_VAL)
        return lane_unit(n);
    if (smooth2 >= REAL_LEAST && smooth2 < (real)HUGE_VAL)
        return lane_unit(smooth);
    return lane_unit((bs_vec3){-s.x, -s.y, -s.z});
}

/* The surface is where height - P = 0: its normal is the gradient of that. */
void displaced_shape(const surface *f, hit_group *g)
{
    const displaced *d = of(f);
    closest_points p;
    d->form->closest(d, g->n, g->x, g->t, g->part, &p);
    memcpy(g->u, p.u, sizeof g->u);
    memcpy(g->w, p.w, sizeof g->w);
    d->P->ops->eval(d->P, g->n, g->u, g->w, 1, &g->bump);
    for (int i = 0; i < g->n; i++) {
        bs_vec3 h = lane_get(&p.gh, i), u = lane_get(&p.gu, i), w = lane_get(&p.gw, i);
        bs_vec3 n = {h.x - g->bump.Pu[i] * u.x - g->bump.Pw[i] * w.x, h.y - g->bump.Pu[i] * u.y - g->bump.Pw[i] * w.y,
                     h.z - g->bump.Pu[i] * u.z - g->bump.Pw[i] * w.z};
        n = normal_of(n, h, lane_get(&g->x->s, i));
        lane_set(&g->n_smooth, i, n);
        lane_set(&g->n_bump, i, n);
        lane_set(&g->q.Q, i, lane_at(g->x, i, g->t[i]));
        g->tau[i] = 0;
        g->order[i] = ORDER_EXACT;
    }
}

/* Order 0 where there is no hit. */
STAGE static void take_shifts(const hits *restrict h, hit_group *restrict g)
{
    const int n = g->n;
    for (int i = 0; i < n; i++) {
        const bs_vec3 m = lane_get(&g->n_smooth, i), s = lane_get(&g->x->s, i);
        const bs_view v = {bs_dot(s, m) / real_sqrt(bs_dot(m, m)), 0, 0};
        const real along = h->t[i] - g->t[i];
        const int regular = bs_regular(m, lane_get(&g->q.Qu, i), lane_get(&g->q.Qw, i)), hit = h->id[i] == 0;
        const real tau0 = bs_tau0(v, g->bump.P[i]), order_0 = regular ? tau0 : 0;
        g->tau[i] = hit ? along : order_0;
        g->order[i] = hit ? ORDER_EXACT : 0;
    }
}

void displaced_shift(const surface *f, hit_group *g)
{
    hits h;
    for (int i = 0; i < g->n; i++) {
        h.t[i] = REAL_FAR;
        h.id[i] = -1;
    }
    f->ops->hit(f, g->n, g->x, 0, &h);
    take_shifts(&h, g);
}
