/* Boxes and rays in the scaled space of a hierarchy. */
#include "bvh/bvh.h"

#include <math.h>

/* Boxes are enlarged, and rays lengthened, by this many radii. Coordinates are at most 1, so rounding one to float is
 * an error of at most 6e-8. A box, a ray's origin and its end add up to some ten of these, and Embree's arithmetic adds
 * as many. */
#define MARGIN 4e-6

bvh_space bvh_space_about(const double lo[3], const double hi[3])
{
    double half[3];
    for (int k = 0; k < 3; k++)
        half[k] = 0.5 * (hi[k] - lo[k]);
    return (bvh_space){{lo[0] + half[0], lo[1] + half[1], lo[2] + half[2]},
                       vec3_length((vec3){half[0], half[1], half[2]})};
}

bvh_box bvh_box_in(const bvh_space *p, const double lo[3], const double hi[3])
{
    const double C[3] = {p->centre.x, p->centre.y, p->centre.z};
    bvh_box b;
    for (int k = 0; k < 3; k++) {
        b.lo[k] = (float)((lo[k] - C[k]) / p->radius - MARGIN);
        b.hi[k] = (float)((hi[k] - C[k]) / p->radius + MARGIN);
    }
    return b;
}

/* False also for a ray without direction or with NaN. The sphere is enlarged by more than the rounding. */
bool bvh_enter(const bvh_space *p, double reach, vec3 r, vec3 s, double *from, double *to, float at[3], float way[3],
               float *end)
{
    const double length = vec3_length(s), R = (1 + 1e-5) * reach, unit = 1 / p->radius;
    const vec3 o = vec3_sub(r, p->centre);
    const double start = -vec3_dot(o, s) / (length * length);
    const vec3 near = vec3_add(o, vec3_scale(s, start));
    const double half = sqrt(R * R - vec3_dot(near, near)) / length; /* NaN where the ray misses */
    *from = fmax(*from, start - half);
    *to = fmin(*to, start + half);
    if (!(half >= 0 && half < HUGE_VAL) || !(*from <= *to))
        return false;
    const vec3 q = vec3_scale(vec3_add(near, vec3_scale(s, *from - start)), unit), d = vec3_scale(s, 1 / length);
    at[0] = (float)q.x, at[1] = (float)q.y, at[2] = (float)q.z;
    way[0] = (float)d.x, way[1] = (float)d.y, way[2] = (float)d.z;
    *end = (float)((*to - *from) * length * unit) + (float)MARGIN;
    return true;
}

STAGE static void enter_sphere(vec3 centre, double unit, double R, const double (*restrict r)[BVH_PACKET],
                               const double (*restrict s)[BVH_PACKET], double *restrict from, double *restrict to,
                               bvh_packet *restrict x)
{
    for (int i = 0; i < BVH_PACKET; i++) {
        const vec3 o = vec3_sub((vec3){r[0][i], r[1][i], r[2][i]}, centre), S = {s[0][i], s[1][i], s[2][i]};
        const double length = vec3_length(S), start = -vec3_dot(o, S) / (length * length);
        const vec3 near = vec3_add(o, vec3_scale(S, start));
        const double half = sqrt(R * R - vec3_dot(near, near)) / length; /* NaN where the ray misses */
        const double t0 = greater(from[i], start - half), t1 = lesser(to[i], start + half);
        const vec3 q = vec3_scale(vec3_add(near, vec3_scale(S, t0 - start)), unit), d = vec3_scale(S, 1 / length);
        double way = (t1 - t0) * length * unit;
        way = half < HUGE_VAL ? way : -1;
        way = way >= 0 ? way + MARGIN : -1;
        x->at[0][i] = (float)q.x, x->at[1][i] = (float)q.y, x->at[2][i] = (float)q.z;
        x->way[0][i] = (float)d.x, x->way[1][i] = (float)d.y, x->way[2][i] = (float)d.z;
        x->end[i] = (float)way;
        from[i] = t0;
        to[i] = t1;
    }
}

void bvh_enter_packet(const bvh_space *p, double reach, const double r[3][BVH_PACKET], const double s[3][BVH_PACKET],
                      double from[BVH_PACKET], double to[BVH_PACKET], bvh_packet *x)
{
    enter_sphere(p->centre, 1 / p->radius, (1 + 1e-5) * reach, r, s, from, to, x);
}
