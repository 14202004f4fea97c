/* Tori as values, and rays in their frame. Private to torus.c and torus_roots.c. */
#ifndef KAGE_GEOMETRY_TORUS_H
#define KAGE_GEOMETRY_TORUS_H

#include "geometry/surface.h"
#include "math/kmath.h"

typedef struct torus {
    surface base;
    double C[3], X[3], Y[3], Z[3];
    double M, m;
} torus;

/* A ray in the frame, from the place nearest to C on; its direction is a unit vector. r + s t is `way` = t speed -
 * start there. */
typedef struct torus_ray {
    double ox, oy, oz, dx, dy, dz, speed, start;
} torus_ray;

KM_INLINE torus_ray torus_ray_of(const torus *f, const rays *x, int i)
{
    double rx = (double)x->r.x[i] - f->C[0], ry = (double)x->r.y[i] - f->C[1], rz = (double)x->r.z[i] - f->C[2];
    double sx = (double)x->s.x[i], sy = (double)x->s.y[i], sz = (double)x->s.z[i];
    double speed = sqrt(sx * sx + sy * sy + sz * sz), k = 1 / speed;
    double px = rx * f->X[0] + ry * f->X[1] + rz * f->X[2], py = rx * f->Y[0] + ry * f->Y[1] + rz * f->Y[2];
    double pz = rx * f->Z[0] + ry * f->Z[1] + rz * f->Z[2];
    double dx = k * (sx * f->X[0] + sy * f->X[1] + sz * f->X[2]), dy = k * (sx * f->Y[0] + sy * f->Y[1] + sz * f->Y[2]);
    double dz = k * (sx * f->Z[0] + sy * f->Z[1] + sz * f->Z[2]);
    double start = -(px * dx + py * dy + pz * dz);
    torus_ray l = {px + start * dx, py + start * dy, pz + start * dz, dx, dy, dz, speed, start};
    return l;
}

/* A place r + s t in the frame. */
typedef struct torus_place {
    double x, y, z, d; /* d: from the axis */
} torus_place;

KM_INLINE torus_place torus_place_of(const torus *f, const rays *v, int i, real t)
{
    double rx = (double)v->r.x[i] + (double)v->s.x[i] * (double)t - f->C[0];
    double ry = (double)v->r.y[i] + (double)v->s.y[i] * (double)t - f->C[1];
    double rz = (double)v->r.z[i] + (double)v->s.z[i] * (double)t - f->C[2];
    torus_place p = {rx * f->X[0] + ry * f->X[1] + rz * f->X[2], rx * f->Y[0] + ry * f->Y[1] + rz * f->Y[2],
                     rx * f->Z[0] + ry * f->Z[1] + rz * f->Z[2], 0};
    p.d = sqrt(p.x * p.x + p.z * p.z);
    return p;
}

/* A vector of the frame: x and z along the radius and across it, y along the axis. */
static inline void torus_vector(const torus *f, vec3s *v, int i, double x, double y, double z)
{
    v->x[i] = (real)(x * f->X[0] + y * f->Y[0] + z * f->Z[0]);
    v->y[i] = (real)(x * f->X[1] + y * f->Y[1] + z * f->Z[1]);
    v->z[i] = (real)(x * f->X[2] + y * f->Y[2] + z * f->Z[2]);
}

/* First roots that are searched, side by side; `way` as in `local`. */
typedef struct torus_roots {
    double speed[LANES], start[LANES];
    double a[LANES], b[LANES]; /* the bracket; a > b: there is no root */
    double side[LANES];        /* the function's sign at a */
    double way[LANES];
    double open[LANES]; /* 1: not found yet */
} torus_roots;

/* Rays that are searched, side by side. */
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
