#include "shade.h"

#include "kmath.h"
#include "lane.h"

void shade_ambient(group *g, const material *m)
{
    vec3s_fill(&g->rgb, g->n, (real)(m->ambient * m->color.x), (real)(m->ambient * m->color.y),
               (real)(m->ambient * m->color.z));
}

/* The place of a light against a lane: L, the unit vector to it, and n' on the viewer's side. Returns g->lit, or 0 where
 * the smooth surface lies between the light and the viewer. */
static inline real facing(const group *g, int i, bs_vec3 at, bs_vec3 *L, bs_vec3 *n)
{
    bs_vec3 p = lane_at(&g->x, i, g->t[i]), d = {at.x - p.x, at.y - p.y, at.z - p.z};
    bs_vec3 smooth = lane_get(&g->n_smooth, i), bump = lane_get(&g->n_bump, i);
    real lit = g->lit[i]; /* read in any case: a reading that depends is a branch */
    real side = bs_dot(smooth, lane_get(&g->x.s, i)) < 0 ? R(1) : R(-1);
    *L = lane_unit(d);
    n->x = side * bump.x;
    n->y = side * bump.y;
    n->z = side * bump.z;
    return side * bs_dot(smooth, d) > 0 ? lit : 0;
}

static inline bs_vec3 position(const light *l)
{
    bs_vec3 p = {(real)l->at.x, (real)l->at.y, (real)l->at.z};
    return p;
}

STAGE static void diffuse(group *restrict g, const material *m, const light *l)
{
    const bs_vec3 at = position(l);
    const real kr = (real)(m->diffuse * m->color.x * l->color.x), kg = (real)(m->diffuse * m->color.y * l->color.y),
               kb = (real)(m->diffuse * m->color.z * l->color.z);
    for (int i = 0; i < g->n; i++) {
        bs_vec3 L, n;
        real lit = facing(g, i, at, &L, &n);
        real c = lit * real_max(bs_dot(n, L), 0);
        g->rgb.x[i] += kr * c;
        g->rgb.y[i] += kg * c;
        g->rgb.z[i] += kb * c;
    }
}

/* Phong's highlight: the mirrored view against the light. */
STAGE static void phong(const group *restrict g, const light *l, double *restrict c, real *restrict lit)
{
    const bs_vec3 at = position(l);
    for (int i = 0; i < g->n; i++) {
        bs_vec3 L, n, s = lane_unit(lane_get(&g->x.s, i));
        lit[i] = facing(g, i, at, &L, &n);
        c[i] = (double)real_max(bs_dot(s, L) - 2 * bs_dot(s, n) * bs_dot(n, L), 0);
    }
}

/* Blinn's: the half-way vector between light and viewer, L - s, against the normal. */
STAGE static void blinn(const group *restrict g, const light *l, double *restrict c, real *restrict lit)
{
    const bs_vec3 at = position(l);
    for (int i = 0; i < g->n; i++) {
        bs_vec3 L, n, s = lane_unit(lane_get(&g->x.s, i));
        lit[i] = facing(g, i, at, &L, &n);
        real length = real_sqrt(real_max(2 - 2 * bs_dot(s, L), R(1e-20)));
        c[i] = (double)real_max((bs_dot(n, L) - bs_dot(s, n)) / length, 0);
    }
}

/* c to a power, in a loop of its own: mixed with float it would not be vectorised. log 0 is -inf, and its exp 0. */
STAGE static void raise(int n, double *c, double power)
{
    for (int i = 0; i < n; i++)
        c[i] = km_exp(power * km_log(c[i]));
}

STAGE static void add_highlight(group *restrict g, const light *l, double share, const double *restrict c,
                                const real *restrict lit)
{
    const real kr = (real)(share * l->color.x), kg = (real)(share * l->color.y), kb = (real)(share * l->color.z);
    for (int i = 0; i < g->n; i++) {
        real x = lit[i] * (real)c[i];
        g->rgb.x[i] += kr * x;
        g->rgb.y[i] += kg * x;
        g->rgb.z[i] += kb * x;
    }
}

void shade_light(group *g, const material *m, const light *l)
{
    diffuse(g, m, l);
    double c[LANES];
    real lit[LANES];
    if (m->phong > 0) {
        phong(g, l, c, lit);
        raise(g->n, c, m->phong_size);
        add_highlight(g, l, m->phong, c, lit);
    }
    if (m->specular > 0) {
        blinn(g, l, c, lit);
        raise(g->n, c, 1 / m->roughness);
        add_highlight(g, l, m->specular, c, lit);
    }
}
