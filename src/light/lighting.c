/* Shadow rays to each kind of light, and POV-Ray 3.7's spot falloff and fading. */
#include "light/lighting.h"

#include "math/kmath.h"
#include "wave/lane.h"

#define SHORT 1e-6 /* scene units */

/* The segment from o to the light. Called with constants, as a choice in the loop would prevent SIMD. */
static inline void aim_at(int i, bs_vec3 o, bs_vec3 to, rays *restrict y)
{
    lane_set(&y->r, i, o);
    lane_set(&y->s, i, (bs_vec3){to.x - o.x, to.y - o.y, to.z - o.z});
}

/* To the light's plane. Behind the plane there is light without shadows, as in POV-Ray: there the ray is only SHORT. */
static inline void aim_along(int i, bs_vec3 o, bs_vec3 to, bs_vec3 axis, rays *restrict y)
{
    real depth = (o.x - to.x) * axis.x + (o.y - to.y) * axis.y + (o.z - to.z) * axis.z;
    depth = real_max(depth, R(SHORT));
    lane_set(&y->r, i, o);
    lane_set(&y->s, i, (bs_vec3){-depth * axis.x, -depth * axis.y, -depth * axis.z});
}

static inline bs_vec3 rounded(vec3 x) { return (bs_vec3){(real)x.x, (real)x.y, (real)x.z}; }

STAGE static void rays_at(const light *l, int n, const rays *restrict x, const real *restrict t, rays *restrict y)
{
    const bs_vec3 at = rounded(l->at);
    for (int i = 0; i < n; i++)
        aim_at(i, lane_at(x, i, t[i]), at, y);
}

STAGE static void rays_along(const light *l, int n, const rays *restrict x, const real *restrict t, rays *restrict y)
{
    const bs_vec3 at = rounded(l->at), axis = rounded(l->axis);
    for (int i = 0; i < n; i++)
        aim_along(i, lane_at(x, i, t[i]), at, axis, y);
}

STAGE static void places_at(const light *l, int n, const vec3s *restrict from, rays *restrict y)
{
    const bs_vec3 at = rounded(l->at);
    for (int i = 0; i < n; i++)
        aim_at(i, lane_get(from, i), at, y);
}

STAGE static void places_along(const light *l, int n, const vec3s *restrict from, rays *restrict y)
{
    const bs_vec3 at = rounded(l->at), axis = rounded(l->axis);
    for (int i = 0; i < n; i++)
        aim_along(i, lane_get(from, i), at, axis, y);
}

void lighting_rays(const light *l, int n, const rays *x, const real *t, rays *to_light)
{
    (l->kind == LIGHT_PARALLEL ? rays_along : rays_at)(l, n, x, t, to_light);
}

void lighting_aim_from(const light *l, const vec3s *from, hit_group *g)
{
    (l->kind == LIGHT_PARALLEL ? places_along : places_at)(l, g->n, from, &g->to_light);
}

void lighting_aim(const light *l, const real *t, hit_group *g) { lighting_rays(l, g->n, g->x, t, &g->to_light); }

STAGE static void add(const hit_group *restrict g, real share, real *restrict sum)
{
    for (int i = 0; i < g->n; i++)
        sum[i] += share * g->lit[i];
}

void lighting_add(const hit_group *g, real share, real *sum) { add(g, share, sum); }

STAGE static void add_tint(const hit_group *restrict g, real share, vec3s *restrict sum)
{
    for (int i = 0; i < g->n; i++) {
        real x = share * g->lit[i];
        sum->x[i] += x * g->tint.x[i];
        sum->y[i] += x * g->tint.y[i];
        sum->z[i] += x * g->tint.z[i];
    }
}

void lighting_add_tint(const hit_group *g, real share, vec3s *sum) { add_tint(g, share, sum); }

/* The distance of the shaded place from the light, or from its plane, and the cosine of the angle to its axis. */
STAGE static void place(const hit_group *restrict g, const light *l, double *restrict distance, double *restrict cosine)
{
    const real lx = (real)l->at.x, ly = (real)l->at.y, lz = (real)l->at.z;
    const real ax = (real)l->axis.x, ay = (real)l->axis.y, az = (real)l->axis.z, flat = l->kind == LIGHT_PARALLEL;
    for (int i = 0; i < g->n; i++) {
        bs_vec3 p = lane_at(g->x, i, g->t_shade[i]);
        real x = p.x - lx, y = p.y - ly, z = p.z - lz;
        real far = real_sqrt(x * x + y * y + z * z), deep = x * ax + y * ay + z * az;
        distance[i] = (double)(far + flat * (real_abs(deep) - far));
        cosine[i] = (double)(deep / real_max(far, R(1e-30)));
    }
}

/* cos^tightness, times a cubic that rises from 0 at `falloff` to 1 at `radius`. */
STAGE static void spot(int n, double outer, double inner, double tightness, const double *restrict cosine,
                       double *restrict share)
{
    const double width = inner > outer ? inner - outer : 1e-300;
    for (int i = 0; i < n; i++) {
        double c = cosine[i], x = (c - outer) / width;
        x = x < 1 ? x : 1;
        x = x > 0 ? x : 0;
        c = c < 1 ? c : 1;
        c = c > 1e-300 ? c : 1e-300;
        share[i] *= x * x * (3 - 2 * x) * km_exp(tightness * km_log(c));
    }
}

/* 2/(1 + (d/fade_distance)^power) */
STAGE static void fade(int n, double reach, double power, const double *restrict distance, double *restrict share)
{
    for (int i = 0; i < n; i++) {
        double d = distance[i] / reach;
        share[i] *= 2 / (1 + km_exp(power * km_log(d > 1e-300 ? d : 1e-300)));
    }
}

STAGE static void dim(hit_group *restrict g, const double *restrict share)
{
    for (int i = 0; i < g->n; i++)
        g->lit[i] = (real)((double)g->lit[i] * share[i]);
}

void lighting_fade(const light *l, hit_group *g)
{
    double distance[LANES], cosine[LANES], share[LANES];
    const double degree = KM_PI / 180;
    if (l->kind != LIGHT_SPOT && l->fade_distance == 0)
        return;
    for (int i = 0; i < g->n; i++)
        share[i] = 1;
    place(g, l, distance, cosine);
    if (l->kind == LIGHT_SPOT)
        spot(g->n, km_cos(l->falloff * degree), km_cos(l->radius * degree), l->tightness, cosine, share);
    if (l->fade_distance > 0)
        fade(g->n, l->fade_distance, l->fade_power, distance, share);
    dim(g, share);
}
