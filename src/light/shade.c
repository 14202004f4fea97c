/* POV-Ray's diffuse light and highlights with n'. One loop for each kind of light and highlight, so that each is
 * vectorised. */
#include "light/shade.h"

#include "math/kmath.h"
#include "wave/fill.h"
#include "wave/lane.h"

STAGE static void ambient_pattern(hit_group *restrict g, real share)
{
    for (int i = 0; i < g->n; i++) {
        g->rgb.x[i] = share * g->color.x[i];
        g->rgb.y[i] = share * g->color.y[i];
        g->rgb.z[i] = share * g->color.z[i];
    }
}

void shade_ambient(hit_group *g, const material *m)
{
    const double share = m->ambient * material_opacity(m);
    if (m->pattern) {
        ambient_pattern(g, (real)share);
        return;
    }
    fill_vec3s(g->n, (real)(share * m->color.x), (real)(share * m->color.y), (real)(share * m->color.z), &g->rgb);
}

/* The direction from p to a light: at - near p. near is 0 for a parallel light. The light is seen where its direction
 * times the smooth normal is above `least`. Constant in each stage, so it is free. */
typedef struct way {
    bs_vec3 at;
    real near, least;
} way;

static inline real least_of(bool front) { return front ? 0 : -REAL_FAR; }

static inline way way_to(const light *l, bool front)
{
    way x = {{(real)l->at.x, (real)l->at.y, (real)l->at.z}, 1, least_of(front)};
    return x;
}

static inline way way_against(const light *l, bool front)
{
    way x = {{-(real)l->axis.x, -(real)l->axis.y, -(real)l->axis.z}, 0, least_of(front)};
    return x;
}

/* L, the unit vector to the light, and n' on the viewer's side. Returns g->lit, or 0 where the light is behind the
 * smooth surface, if that counts. */
static inline real facing(const hit_group *g, int i, way to, bs_vec3 *L, bs_vec3 *n)
{
    bs_vec3 p = lane_at(g->x, i, g->t_shade[i]);
    bs_vec3 d = {to.at.x - to.near * p.x, to.at.y - to.near * p.y, to.at.z - to.near * p.z};
    bs_vec3 smooth = lane_get(&g->n_smooth, i), bumped = lane_get(&g->n_bump, i);
    real lit = g->lit[i]; /* always read: a conditional read would be a branch */
    real side = bs_dot(smooth, lane_get(&g->x->s, i)) < 0 ? R(1) : R(-1);
    *L = lane_unit(d);
    n->x = side * bumped.x;
    n->y = side * bumped.y;
    n->z = side * bumped.z;
    return side * bs_dot(smooth, d) > to.least ? lit : 0;
}

/* Call it with constants, as a choice in the loop would stop vectorisation. own: times the colour of each lane (with a
 * pattern the material's colour is 1). */
static inline void diffuse(hit_group *restrict g, const material *m, const light *l, const way to, bool own,
                           const vec3s *color)
{
    const double share = m->diffuse * material_opacity(m);
    const real kr = (real)(share * m->color.x * l->color.x), kg = (real)(share * m->color.y * l->color.y),
               kb = (real)(share * m->color.z * l->color.z);
    for (int i = 0; i < g->n; i++) {
        bs_vec3 L, n;
        real lit = facing(g, i, to, &L, &n);
        real c = lit * real_max(bs_dot(n, L), 0);
        g->rgb.x[i] += kr * c * (own ? color->x[i] : 1);
        g->rgb.y[i] += kg * c * (own ? color->y[i] : 1);
        g->rgb.z[i] += kb * c * (own ? color->z[i] : 1);
    }
}

STAGE static void diffuse_to(hit_group *g, const material *m, const light *l, bool front)
{
    diffuse(g, m, l, way_to(l, front), false, NULL);
}
STAGE static void diffuse_against(hit_group *g, const material *m, const light *l, bool front)
{
    diffuse(g, m, l, way_against(l, front), false, NULL);
}
STAGE static void diffuse_color_to(hit_group *g, const material *m, const light *l, bool front, const vec3s *c)
{
    diffuse(g, m, l, way_to(l, front), true, c);
}
STAGE static void diffuse_color_against(hit_group *g, const material *m, const light *l, bool front, const vec3s *c)
{
    diffuse(g, m, l, way_against(l, front), true, c);
}

STAGE static void product(int n, const vec3s *restrict a, const vec3s *restrict b, vec3s *restrict c)
{
    for (int i = 0; i < n; i++) {
        c->x[i] = a->x[i] * b->x[i];
        c->y[i] = a->y[i] * b->y[i];
        c->z[i] = a->z[i] * b->z[i];
    }
}

static void shade_diffuse(hit_group *g, const material *m, const light *l, bool tinted, bool front)
{
    const bool along = l->kind == LIGHT_PARALLEL;
    const vec3s *color = m->pattern ? &g->color : &g->tint;
    vec3s both;
    if (tinted && m->pattern) {
        product(g->n, &g->color, &g->tint, &both);
        color = &both;
    }
    if (tinted || m->pattern)
        (along ? diffuse_color_against : diffuse_color_to)(g, m, l, front, color);
    else
        (along ? diffuse_against : diffuse_to)(g, m, l, front);
}

/* Phong's highlight: the cosine between the mirrored view and L. */
static inline void phong(const hit_group *restrict g, const way to, double *restrict c, real *restrict lit)
{
    for (int i = 0; i < g->n; i++) {
        bs_vec3 L, n, s = lane_unit(lane_get(&g->x->s, i));
        lit[i] = facing(g, i, to, &L, &n);
        c[i] = (double)real_max(bs_dot(s, L) - 2 * bs_dot(s, n) * bs_dot(n, L), 0);
    }
}

STAGE static void phong_to(const hit_group *g, const light *l, bool front, double *c, real *lit)
{
    phong(g, way_to(l, front), c, lit);
}
STAGE static void phong_against(const hit_group *g, const light *l, bool front, double *c, real *lit)
{
    phong(g, way_against(l, front), c, lit);
}

/* Blinn's highlight: the cosine between n' and the half-way vector h = L - s. Where L is near s (light behind the
 * surface), |h|^2 = 2 - 2 s.L and n.h = n.L - n.s cancel; there they are computed from h, so that c is at most 1 and
 * its power is finite. */
static inline void blinn(const hit_group *restrict g, const way to, double *restrict c, real *restrict lit)
{
    for (int i = 0; i < g->n; i++) {
        bs_vec3 L, n, s = lane_unit(lane_get(&g->x->s, i));
        lit[i] = facing(g, i, to, &L, &n);
        bs_vec3 h = {L.x - s.x, L.y - s.y, L.z - s.z};
        real square = 2 - 2 * bs_dot(s, L), along = bs_dot(n, L) - bs_dot(s, n);
        real short_square = bs_dot(h, h), short_along = bs_dot(n, h);
        int behind = square < R(0.01);
        square = behind ? short_square : square;
        along = behind ? short_along : along;
        c[i] = (double)real_max(along / real_sqrt(real_max(square, R(1e-20))), 0);
    }
}

STAGE static void blinn_to(const hit_group *g, const light *l, bool front, double *c, real *lit)
{
    blinn(g, way_to(l, front), c, lit);
}
STAGE static void blinn_against(const hit_group *g, const light *l, bool front, double *c, real *lit)
{
    blinn(g, way_against(l, front), c, lit);
}

/* c^power, in a loop of its own: mixed with float it would not be vectorised. log 0 is -inf, whose exp is 0. */
STAGE static void raise(int n, double *c, double power)
{
    for (int i = 0; i < n; i++)
        c[i] = km_exp(power * km_log(c[i]));
}

STAGE static void highlight_plain(hit_group *restrict g, real kr, real kg, real kb, const double *restrict c,
                                  const real *restrict lit)
{
    for (int i = 0; i < g->n; i++) {
        real x = lit[i] * (real)c[i];
        g->rgb.x[i] += kr * x;
        g->rgb.y[i] += kg * x;
        g->rgb.z[i] += kb * x;
    }
}

STAGE static void highlight_tinted(hit_group *restrict g, real kr, real kg, real kb, const double *restrict c,
                                   const real *restrict lit)
{
    for (int i = 0; i < g->n; i++) {
        real x = lit[i] * (real)c[i];
        g->rgb.x[i] += kr * x * g->tint.x[i];
        g->rgb.y[i] += kg * x * g->tint.y[i];
        g->rgb.z[i] += kb * x * g->tint.z[i];
    }
}

STAGE static int shines(int n, const double *restrict c, const real *restrict lit)
{
    int some = 0;
    for (int i = 0; i < n; i++)
        some |= (c[i] > 0) & (lit[i] > 0);
    return some;
}

/* share * c^power, where some lane has a highlight: most waves have none. */
static void add_highlight(hit_group *g, const light *l, bool tinted, double share, double power, double *c,
                          const real *lit)
{
    if (!shines(g->n, c, lit))
        return;
    raise(g->n, c, power);
    (tinted ? highlight_tinted : highlight_plain)(g, (real)(share * l->color.x), (real)(share * l->color.y),
                                                  (real)(share * l->color.z), c, lit);
}

void shade_light(hit_group *g, const material *m, const light *l, bool tinted, bool front)
{
    const bool along = l->kind == LIGHT_PARALLEL;
    double c[LANES];
    real lit[LANES];
    shade_diffuse(g, m, l, tinted, front);
    if (m->phong > 0) {
        (along ? phong_against : phong_to)(g, l, front, c, lit);
        add_highlight(g, l, tinted, m->phong, m->phong_size, c, lit);
    }
    if (m->specular > 0) {
        (along ? blinn_against : blinn_to)(g, l, front, c, lit);
        add_highlight(g, l, tinted, m->specular, 1 / m->roughness, c, lit);
    }
}
