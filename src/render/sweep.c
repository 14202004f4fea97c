/* For each caster and light there are three cases. A caster whose box the triangle does not meet cannot matter. One
 * that hides both ends hides all between: that is so for convex casters, and assumed of others. Anything else counts as
 * not alike.
 */
#include "render/sweep.h"

#include <string.h>

#include "light/lighting.h"
#include "render/intersect.h"
#include "render/shadow.h"
#include "render/transparent.h"
#include "wave/lane.h"

STAGE static int any(int n, const int32_t *x)
{
    int some = 0;
    for (int i = 0; i < n; i++)
        some |= x[i];
    return some;
}

static int listed(int n, const int32_t *is, int32_t *lane)
{
    int m = 0;
    for (int i = 0; i < n; i++) { /* without a branch */
        lane[m] = i;
        m += is[i] != 0;
    }
    return m;
}

/* The rays to a light from both ends and from the middle of each lane's bracket. */
typedef struct sweep {
    const light *l;
    const brackets *k;
    const rays *x; /* the viewing rays, and their smooth hits */
    const real *t;
    rays middle, front, back;
    real half[LANES]; /* half the bracket, in t */
    bool ends;        /* front and back are set */

    /* over all casters so far: one may matter; an opaque one hides both ends. Set with the first that is near. */
    bool met;
    int32_t some[LANES], dark[LANES];
} sweep;

STAGE static void middles(const brackets *restrict k, const real *restrict t, real *restrict middle,
                          real *restrict half)
{
    for (int i = 0; i < k->n; i++) {
        real front = k->front[i], back = k->back[i];
        middle[i] = t[i] + R(0.5) * (front + back);
        half[i] = R(0.5) * (back - front);
    }
}

STAGE static void sums(int n, const real *restrict x, const real *restrict y, real *restrict sum)
{
    for (int i = 0; i < n; i++)
        sum[i] = x[i] + y[i];
}

/* Whether the segment from the middle to the light meets the box, grown by half the bracket along each axis: it does
 * where the triangle meets the box. */
STAGE static void near_box(int n, const rays *restrict to_light, const vec3s *restrict s, const real *restrict half,
                           const real *restrict lo, const real *restrict hi, int32_t *restrict near)
{
    const real lx = lo[0], ly = lo[1], lz = lo[2], hx = hi[0], hy = hi[1], hz = hi[2];
    for (int i = 0; i < n; i++) {
        real gx = real_abs(s->x[i]) * half[i], gy = real_abs(s->y[i]) * half[i], gz = real_abs(s->z[i]) * half[i];
        real ix = 1 / to_light->s.x[i], iy = 1 / to_light->s.y[i], iz = 1 / to_light->s.z[i];
        real x = to_light->r.x[i], y = to_light->r.y[i], z = to_light->r.z[i];
        real ax = (lx - gx - x) * ix, bx = (hx + gx - x) * ix;
        real ay = (ly - gy - y) * iy, by = (hy + gy - y) * iy;
        real az = (lz - gz - z) * iz, bz = (hz + gz - z) * iz;
        real in = real_max(real_max(real_min(ax, bx), real_min(ay, by)), real_min(az, bz));
        real out = real_min(real_min(real_max(ax, bx), real_max(ay, by)), real_max(az, bz));
        near[i] = (in <= out) & (in < 1) & (out > 0);
    }
}

/* Whether a plane along the axis across (y,z) and along the triangle's side v parts triangle and box. The box has half
 * size h and its middle at c from a corner on that side; e is from there to the other end of the bracket. */
static inline int parts(real vy, real vz, real cy, real cz, real ey, real ez, real hy, real hz)
{
    real c = vy * cz - vz * cy, e = vy * ez - vz * ey, reach = real_abs(vz) * hy + real_abs(vy) * hz;
    int above = c - reach > real_max(e, 0), below = c + reach < real_min(e, 0);
    return above | below;
}

static inline int any_parts(bs_vec3 v, bs_vec3 c, bs_vec3 e, bs_vec3 h)
{
    return parts(v.y, v.z, c.y, c.z, e.y, e.z, h.y, h.z) | parts(v.z, v.x, c.z, c.x, e.z, e.x, h.z, h.x) |
           parts(v.x, v.y, c.x, c.y, e.x, e.y, h.x, h.y);
}

/* Whether the triangle meets the box, where it may and both ends are lit: planes that may part them are tried, the
 * triangle's own, and those along its two sides and an axis. With D half the bracket, M its middle and d from there to
 * the light, the sides run along D + d and D - d; those of a parallel light along d (apex 0). */
STAGE static void near_triangle(int n, const rays *restrict to_light, const vec3s *restrict s,
                                const real *restrict half, real apex, const real *restrict lo, const real *restrict hi,
                                const real *restrict lit_front, const real *restrict lit_back, int32_t *restrict near)
{
    const bs_vec3 middle = {R(0.5) * (lo[0] + hi[0]), R(0.5) * (lo[1] + hi[1]), R(0.5) * (lo[2] + hi[2])};
    const bs_vec3 h = {R(0.5) * (hi[0] - lo[0]), R(0.5) * (hi[1] - lo[1]), R(0.5) * (hi[2] - lo[2])};
    for (int i = 0; i < n; i++) {
        bs_vec3 D = {s->x[i] * half[i], s->y[i] * half[i], s->z[i] * half[i]}, d = lane_get(&to_light->s, i);
        bs_vec3 c = {middle.x - to_light->r.x[i], middle.y - to_light->r.y[i], middle.z - to_light->r.z[i]};
        bs_vec3 from_front = {c.x + D.x, c.y + D.y, c.z + D.z}, from_back = {c.x - D.x, c.y - D.y, c.z - D.z};
        bs_vec3 front = {apex * D.x + d.x, apex * D.y + d.y, apex * D.z + d.z};
        bs_vec3 back = {apex * D.x - d.x, apex * D.y - d.y, apex * D.z - d.z};
        bs_vec3 whole = {2 * D.x, 2 * D.y, 2 * D.z}, back_to_front = {-whole.x, -whole.y, -whole.z};
        bs_vec3 across = bs_cross(D, d);
        real reach = real_abs(across.x) * h.x + real_abs(across.y) * h.y + real_abs(across.z) * h.z;
        int parted = (real_abs(bs_dot(across, c)) > reach) | any_parts(front, from_front, whole, h) |
                     any_parts(back, from_back, back_to_front, h);
        near[i] &= (parted == 0) | (lit_front[i] + lit_back[i] <= 1);
    }
}

static void sweep_begin(const light *l, const brackets *k, const rays *x, const real *t, sweep *w)
{
    real middle[LANES];
    w->l = l;
    w->k = k;
    w->x = x;
    w->t = t;
    w->ends = w->met = false;
    middles(k, t, middle, w->half);
    lighting_rays(l, k->n, x, middle, &w->middle);
}

static void sweep_ends(sweep *w)
{
    const int n = w->k->n;
    real at[LANES];
    if (w->ends)
        return;
    sums(n, w->t, w->k->front, at);
    lighting_rays(w->l, n, w->x, at, &w->front);
    sums(n, w->t, w->k->back, at);
    lighting_rays(w->l, n, w->x, at, &w->back);
    w->ends = true;
}

/* The box of a caster, grown by the light's area. False: it has no end, as a plane. */
static bool box_of(const surface *f, const light *l, real lo[3], real hi[3])
{
    const double grown[3] = {(fabs(l->u.x) + fabs(l->w.x)) / 2, (fabs(l->u.y) + fabs(l->w.y)) / 2,
                             (fabs(l->u.z) + fabs(l->w.z)) / 2};
    double a[3], b[3];
    bool ends = true;
    f->ops->box(f, a, b);
    for (int k = 0; k < 3; k++) {
        ends &= b[k] - a[k] < (double)REAL_FAR;
        lo[k] = (real)(a[k] - grown[k]);
        hi[k] = (real)(b[k] + grown[k]);
    }
    return ends;
}

STAGE static void differ(int n, const real *restrict front, const real *restrict back, int32_t *restrict near)
{
    for (int i = 0; i < n; i++)
        near[i] = front[i] != back[i];
}

/* Lanes that may be hidden between their ends alone. */
STAGE static int both_lit(int n, const real *restrict front, const real *restrict back, const int32_t *restrict near)
{
    int some = 0;
    for (int i = 0; i < n; i++)
        some |= near[i] & (front[i] + back[i] > 1);
    return some;
}

/* boxed: it is dark by a caster that is near alone. So a lane's result does not depend on the other lanes, for which
 * the caster is tested, not even by rounding. */
STAGE static void join(int n, int32_t boxed, const int32_t *restrict near, const real *restrict front,
                       const real *restrict back, int32_t *restrict some, int32_t *restrict dark)
{
    for (int i = 0; i < n; i++) {
        int32_t hidden = front[i] + back[i] == 0;
        some[i] |= near[i];
        dark[i] |= hidden & (near[i] | (boxed == 0));
    }
}

/* Whether both ends of each lane are lit. A clear caster's colour may differ between them, so it hides none; nor does
 * any where the light has an area, as only its middle is tested. */
static void look_from_ends(const surface *f, bool hides, bool boxed, sweep *w, real *front, real *back)
{
    const int n = w->k->n;
    for (int i = 0; i < n; i++)
        front[i] = back[i] = 1;
    if (!hides && boxed)
        return;
    sweep_ends(w);
    f->ops->occlude(f, n, &w->front, front);
    f->ops->occlude(f, n, &w->back, back);
}

/* One caster, for the lanes in only[]; NULL: for all. One without an end, as a plane, matters where the ends differ. */
static void sweep_caster(sweep *w, const surface *f, bool clear, const int32_t *only)
{
    const int n = w->k->n;
    const bool hides = !clear && w->l->samples[0] * w->l->samples[1] == 1;
    real lo[3], hi[3], front[LANES], back[LANES];
    int32_t near[LANES];
    const bool boxed = box_of(f, w->l, lo, hi);
    if (boxed) {
        near_box(n, &w->middle, &w->x->s, w->half, lo, hi, near);
        for (int i = 0; only && i < n; i++)
            near[i] &= only[i];
        if (!any(n, near))
            return;
    }
    look_from_ends(f, hides, boxed, w, front, back);
    if (!boxed)
        differ(n, front, back, near);
    else if (both_lit(n, front, back, near))
        near_triangle(n, &w->middle, &w->x->s, w->half, w->l->kind == LIGHT_PARALLEL ? 0 : 1, lo, hi, front, back,
                      near);
    if (!hides)
        for (int i = 0; i < n; i++)
            front[i] = 1;
    if (!w->met) {
        memset(w->some, 0, sizeof w->some);
        memset(w->dark, 0, sizeof w->dark);
        w->met = true;
    }
    join(n, boxed, near, front, back, w->some, w->dark);
}

/* Whether object j may cast a shadow on object `id`. Copies cast shadows on each other; these are taken for
 * transparent, as the copy itself is among them. */
static bool casts_there(const tracer *tr, int32_t id, int32_t j)
{
    return (j != id || tr->scene->object[id].crowd) && shadow_casts(tr, j);
}

/* Many objects: each lane has those that the hierarchy finds on one of three rays, from both ends and from tau. */
static void sweep_candidates(const tracer *tr, int32_t id, workspace *v, const real *tau, sweep *w)
{
    const scene *s = tr->scene;
    const int n = w->k->n;
    rays place;
    real at[LANES], end[LANES];
    int32_t lane[LANES];
    sweep_ends(w);
    sums(n, w->t, tau, at);
    lighting_rays(w->l, n, w->x, at, &place);
    const rays *const from[] = {&w->front, &place, &w->back};
    for (int i = 0; i < n; i++)
        end[i] = 1;
    for (int k = 0; k < 3; k++) {
        object_bvh_find(s->object_bvh, n, from[k], end, NULL, v->candidates);
        for (int32_t j = candidates_next(v->candidates, -1); j >= 0; j = candidates_next(v->candidates, j)) {
            int32_t only[LANES] = {0};
            const int some = candidates_rays(v->candidates, j, lane);
            if (!casts_there(tr, id, j))
                continue;
            for (int i = 0; i < some; i++)
                only[lane[i]] = 1;
            sweep_caster(w, v->surface[j], j == s->object[id].first || transparent_is(s, j), only);
        }
    }
}

STAGE static void add_open(int n, const int32_t *restrict some, const int32_t *restrict dark, int32_t *restrict differs)
{
    for (int i = 0; i < n; i++)
        differs[i] |= some[i] & (dark[i] == 0);
}

/* differs[i] |= the light may not see lane i's bracket alike. False: no caster is near any lane. */
static bool sweep_casters(const tracer *tr, int32_t id, workspace *v, const real *tau, sweep *w, int32_t *differs)
{
    const scene *s = tr->scene;
    if (v->candidates)
        sweep_candidates(tr, id, v, tau, w);
    else
        for (int32_t j = intersect_next(s, NULL, -1); j >= 0; j = intersect_next(s, NULL, j))
            if (casts_there(tr, id, j))
                sweep_caster(w, v->surface[j], j == s->object[id].first || transparent_is(s, j), NULL);
    if (w->met)
        add_open(w->k->n, w->some, w->dark, differs);
    return w->met || v->candidates; /* others than the candidates may be near */
}

int sweep_lights(const tracer *tr, int32_t id, workspace *v, const brackets *k, int32_t *lane)
{
    const hit_group *g = &v->g;
    int32_t differs[LANES] = {0};
    sweep w;
    bool met = false;
    for (int l = 0; l < tr->scene->lights; l++) {
        sweep_begin(&tr->scene->light[l], k, g->x, g->t, &w);
        met |= sweep_casters(tr, id, v, g->tau, &w, differs);
    }
    v->alone = !met;
    return met ? listed(g->n, differs, lane) : 0;
}
