/* Each lane's true place is in a bracket on its viewing ray (method/bracket.h). Where a light sees the whole bracket
 * alike, the place within does not matter, and order 0's is kept. For the others the bracket is drawn together until
 * the light sees it alike, or it is no longer than the error on the screen.
 *
 * What a light sees: the shadow rays from a bracket sweep a triangle with the light as its apex. A caster whose box the
 * triangle does not meet cannot matter. A convex caster that hides both ends hides all. Anything else counts as not
 * alike.
 */
#include "render/auto.h"

#include "light/lighting.h"
#include "method/bracket.h"
#include "render/shadow.h"
#include "wave/gather.h"
#include "wave/lane.h"

/* ---- what a light sees of the brackets ---- */

/* The lanes' viewing rays and smooth hits. */
typedef struct lanes {
    rays x;
    real t[LANES];
} lanes;

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

/* The rays to a light from both ends and the middle of each bracket. */
typedef struct sweep {
    rays middle, front, back;
    real half[LANES];
    bool ends; /* front and back are set */
} sweep;

static void sweep_ends(const light *l, const brackets *k, const rays *x, const real *t, sweep *w)
{
    real at[LANES];
    if (w->ends)
        return;
    sums(k->n, t, k->front, at);
    lighting_rays(l, k->n, x, at, &w->front);
    sums(k->n, t, k->back, at);
    lighting_rays(l, k->n, x, at, &w->back);
    w->ends = true;
}

static int any(int n, const int32_t *x)
{
    int some = 0;
    for (int i = 0; i < n; i++)
        some |= x[i];
    return some;
}

/* differs |= the caster is near, and does not hide both ends; dark |= it hides both. */
static void join(int n, const int32_t *near, const real *front, const real *back, int32_t *differs, int32_t *dark)
{
    for (int i = 0; i < n; i++) {
        dark[i] |= front[i] + back[i] == 0;
        differs[i] |= near[i];
    }
}

/* The box of a caster, grown by the light's area. False: it has no end, as a plane. */
static bool box_of(const surface *f, const light *l, real lo[3], real hi[3])
{
    double a[3], b[3];
    const double grown[3] = {(fabs(l->u.x) + fabs(l->w.x)) / 2, (fabs(l->u.y) + fabs(l->w.y)) / 2,
                             (fabs(l->u.z) + fabs(l->w.z)) / 2};
    bool ends = true;
    f->ops->box(f, a, b);
    for (int k = 0; k < 3; k++) {
        ends &= b[k] - a[k] < (double)REAL_FAR;
        lo[k] = (real)(a[k] - grown[k]);
        hi[k] = (real)(b[k] + grown[k]);
    }
    return ends;
}

/* One caster. */
static void compare(const surface *f, const light *l, const brackets *k, const rays *x, const real *t, sweep *w,
                    int32_t *differs, int32_t *dark)
{
    int32_t near[LANES];
    real lo[3], hi[3], front[LANES], back[LANES];
    const bool boxed = box_of(f, l, lo, hi), area = l->samples[0] * l->samples[1] > 1;
    if (boxed) {
        near_box(k->n, &w->middle, &x->s, w->half, lo, hi, near);
        if (!any(k->n, near))
            return;
    }
    sweep_ends(l, k, x, t, w);
    for (int i = 0; i < k->n; i++)
        front[i] = back[i] = 1;
    f->ops->occlude(f, k->n, &w->front, front);
    f->ops->occlude(f, k->n, &w->back, back);
    for (int i = 0; !boxed && i < k->n; i++)
        near[i] = front[i] != back[i];
    for (int i = 0; area && i < k->n; i++) /* hidden from the light's middle says nothing of the others */
        front[i] = 1;
    join(k->n, near, front, back, differs, dark);
}

/* The lanes whose bracket the light does not see alike: into differs[]. */
static void see(const tracer *tr, int32_t id, const light *l, const workspace *v, const brackets *k, const rays *x,
                const real *t, int32_t *differs)
{
    sweep w;
    real middle[LANES];
    int32_t dark[LANES] = {0};
    w.ends = false;
    middles(k, t, middle, w.half);
    lighting_rays(l, k->n, x, middle, &w.middle);
    for (int i = 0; i < k->n; i++)
        differs[i] = 0;
    for (int32_t j = 0; j < tr->scene->objects; j++)
        if (j != id && shadow_casts(tr, j))
            compare(v->surface[j], l, k, x, t, &w, differs, dark);
    for (int i = 0; i < k->n; i++)
        differs[i] &= !dark[i];
}

/* ---- the cascade ---- */

/* pixels = the larger of itself and what an error of 1 in tau moves a shadow of this light on the screen: |s| times the
 * sine between view and light, over the size of a pixel there. */
STAGE static void measure(int n, const rays *restrict x, const real *restrict t, const rays *restrict to_light,
                          real fixed, real spread, real *restrict pixels)
{
    for (int i = 0; i < n; i++) {
        bs_vec3 s = lane_get(&x->s, i), d = lane_get(&to_light->s, i), c = bs_cross(s, d);
        real across = real_sqrt(bs_dot(c, c) / bs_dot(d, d)), pixel = fixed + spread * t[i];
        pixels[i] = real_max(pixels[i], across / pixel);
    }
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

/* The lanes of k that some light does not see alike. */
static int see_all(const tracer *tr, int32_t id, const workspace *v, const brackets *k, const rays *x, const real *t,
                   int32_t *lane)
{
    int32_t differs[LANES], some[LANES] = {0};
    for (int l = 0; l < tr->scene->lights; l++) {
        see(tr, id, &tr->scene->light[l], v, k, x, t, differs);
        for (int i = 0; i < k->n; i++)
            some[i] |= differs[i];
    }
    return listed(k->n, some, lane);
}

static void take(const int32_t *lane, int n, const lanes *from, lanes *to)
{
    gather_rays(n, lane, &from->x, &to->x);
    for (int i = 0; i < n; i++)
        to->t[i] = from->t[lane[i]];
}

void auto_shift(const tracer *tr, int32_t id, workspace *v)
{
    const scene *s = tr->scene;
    const bump *P = s->object[id].bump;
    const real error = (real)tr->shadow.n / METHOD_PIXEL, pixel = (real)(2 * vec3_length(s->camera.right) / s->width);
    hit_group *g = &v->g;
    brackets all, some;
    int32_t lane[LANES];
    lanes few;
    v->stats->fell_back += bracket_begin(g, P, &all);
    const int n = see_all(tr, id, v, &all, &g->x, g->t, lane);
    if (n == 0)
        return;
    for (int i = 0; i < g->n; i++)
        all.lane[i] = i, all.pixels[i] = 0;
    bracket_pick(n, lane, &all, &some);
    gather_rays(n, lane, &g->x, &few.x);
    for (int i = 0; i < n; i++)
        few.t[i] = g->t[lane[i]];
    for (int l = 0; l < s->lights; l++) {
        rays to_light;
        lighting_rays(&s->light[l], n, &few.x, few.t, &to_light);
        measure(n, &few.x, few.t, &to_light, s->camera.orthographic ? pixel : 0, s->camera.orthographic ? 0 : pixel, some.pixels);
    }
    v->stats->evaluations += bracket_search(&some, P, error);
    for (int i = 0; i < n; i++) {
        g->tau[some.lane[i]] = some.tau[i];
        g->order[some.lane[i]] = some.order[i];
    }
    (void)take;
}
