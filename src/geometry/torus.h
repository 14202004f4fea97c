/* The struct of tori, and rays in its frame. Private to torus.c and torus_roots.c. */
#ifndef KAGE_GEOMETRY_TORUS_H
#define KAGE_GEOMETRY_TORUS_H

#include "geometry/surface.h"
#include "math/kmath.h"

typedef struct torus {
    surface base;
    double C[3], X[3], Y[3], Z[3]; /* the middle, and the frame; Y is the axis */
    double M, m;                   /* the radii of the circle and of the tube about it */
} torus;

/* A vector along X, Y and Z. */
KM_INLINE vec3 torus_frame(const torus *f, double x, double y, double z)
{
    return (vec3){x * f->X[0] + y * f->X[1] + z * f->X[2], x * f->Y[0] + y * f->Y[1] + z * f->Y[2],
                  x * f->Z[0] + y * f->Z[1] + z * f->Z[2]};
}

/* A ray in the frame. Its origin o is the point closest to C, its direction d a unit vector. At t it is at
 * o + d (t speed - start). */
typedef struct torus_ray {
    double ox, oy, oz, dx, dy, dz, speed, start;
} torus_ray;

KM_INLINE torus_ray torus_ray_of(const torus *f, const rays *x, int i)
{
    double rx = (double)x->r.x[i] - f->C[0], ry = (double)x->r.y[i] - f->C[1], rz = (double)x->r.z[i] - f->C[2];
    double sx = (double)x->s.x[i], sy = (double)x->s.y[i], sz = (double)x->s.z[i];
    double speed = sqrt(sx * sx + sy * sy + sz * sz), k = 1 / speed;
    vec3 p = torus_frame(f, rx, ry, rz), s = torus_frame(f, sx, sy, sz);
    double dx = k * s.x, dy = k * s.y, dz = k * s.z;
    double start = -(p.x * dx + p.y * dy + p.z * dz);
    torus_ray l = {p.x + start * dx, p.y + start * dy, p.z + start * dz, dx, dy, dz, speed, start};
    return l;
}

/* A point r + s t in the frame. */
typedef struct torus_place {
    double x, y, z, d; /* d: the distance from the axis */
} torus_place;

KM_INLINE torus_place torus_place_of(const torus *f, const rays *x, int i, real t)
{
    double rx = (double)x->r.x[i] + (double)x->s.x[i] * (double)t - f->C[0];
    double ry = (double)x->r.y[i] + (double)x->s.y[i] * (double)t - f->C[1];
    double rz = (double)x->r.z[i] + (double)x->s.z[i] * (double)t - f->C[2];
    vec3 v = torus_frame(f, rx, ry, rz);
    torus_place p = {v.x, v.y, v.z, 0};
    p.d = sqrt(p.x * p.x + p.z * p.z);
    return p;
}

/* Set lane i to the vector x X + y Y + z Z. */
static inline void torus_vector(const torus *f, vec3s *v, int i, double x, double y, double z)
{
    v->x[i] = (real)(x * f->X[0] + y * f->Y[0] + z * f->Z[0]);
    v->y[i] = (real)(x * f->X[1] + y * f->Y[1] + z * f->Z[1]);
    v->z[i] = (real)(x * f->X[2] + y * f->Y[2] + z * f->Z[2]);
}

/* The first roots of many rays, side by side, as way = t speed - start. */
typedef struct torus_roots {
    double speed[LANES], start[LANES];
    double a[LANES], b[LANES]; /* the bracket; a > b: there is no root */
    double side[LANES];        /* the function's sign at a, 1 or -1 */
    double way[LANES];
    double open[LANES]; /* 1: not found yet */
} torus_roots;

/* Rays, side by side, and their roots. */
typedef struct torus_rays {
    double ox[LANES], oy[LANES], oz[LANES], dx[LANES], dy[LANES], dz[LANES];
    torus_roots root;
} torus_rays;

/* In torus_roots.c: the first root with 0 < t < end[i] of each ray, of a torus with a tube of radius m. */
void torus_search(const torus *f, double m, int n, const rays *x, const real *end, torus_rays *k);

/* Also there; as the members of surface_ops of the same names. */
void torus_hit(const surface *base, int n, const rays *x, int32_t id, hits *h);
void torus_hit_own(const surface *base, int n, const rays *x, const ray_origins *from, int32_t id, hits *h);
void torus_occlude(const surface *base, int n, const rays *x, real *lit);
void torus_occlude_own(const surface *base, int n, const rays *x, const int32_t *part, real *lit);

#endif
