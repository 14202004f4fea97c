/* The struct of cones and cylinders, and rays in its frame. Private to cone.c and cone_shape.c. */
#ifndef KAGE_GEOMETRY_CONE_H
#define KAGE_GEOMETRY_CONE_H

#include "geometry/plane.h"
#include "math/kmath.h"

typedef struct cone {
    surface base;
    real F[3], X[3], Y[3], Z[3]; /* the middle of the lower end, and the frame; Y is the axis */
    real from, to;               /* radii of the lower and of the upper end */
    real length;                 /* of the axis */
    real rise;                   /* how the radius changes along it */
    real side;                   /* length of the side */
    real sin, cos;               /* of the angle a between side and axis */
    int capped;                  /* 0: open, 1: with caps */
    plane cap[2];                /* on top, at the bottom; a radius of 0 is no cap */
} cone;

/* A ray in the frame: the origin o and the direction s along X, Y and Z. */
typedef struct cone_ray {
    real ox, oy, oz, sx, sy, sz;
} cone_ray;

KM_INLINE cone_ray cone_local_from(const cone *f, const vec3s *r, const vec3s *s, int i)
{
    real rx = r->x[i] - f->F[0], ry = r->y[i] - f->F[1], rz = r->z[i] - f->F[2];
    real sx = s->x[i], sy = s->y[i], sz = s->z[i];
    cone_ray l = {rx * f->X[0] + ry * f->X[1] + rz * f->X[2], rx * f->Y[0] + ry * f->Y[1] + rz * f->Y[2],
                  rx * f->Z[0] + ry * f->Z[1] + rz * f->Z[2], sx * f->X[0] + sy * f->X[1] + sz * f->X[2],
                  sx * f->Y[0] + sy * f->Y[1] + sz * f->Y[2], sx * f->Z[0] + sy * f->Z[1] + sz * f->Z[2]};
    return l;
}

KM_INLINE cone_ray cone_local_of(const cone *f, const rays *x, int i) { return cone_local_from(f, &x->r, &x->s, i); }

/* Set lane i to the vector x X + y Y + z Z. */
static inline void cone_vector(const cone *f, vec3s *v, int i, real x, real y, real z)
{
    v->x[i] = x * f->X[0] + y * f->Y[0] + z * f->Z[0];
    v->y[i] = x * f->X[1] + y * f->Y[1] + z * f->Z[1];
    v->z[i] = x * f->X[2] + y * f->Y[2] + z * f->Z[2];
}

/* The disc of part 1 or 2. */
static inline const surface *cone_cap(const surface *base, int part)
{
    return &((const cone *)base)->cap[part - 1].base;
}

/* In cone_shape.c; as the members of surface_ops of the same names. */
void cone_locate(const surface *base, int n, const rays *x, const real *t, int32_t *part, real *u, real *w);
void cone_foot(const surface *base, int n, const rays *x, const real *t, int32_t *part, real *u, real *w);
void cone_eval(const surface *base, int n, const int32_t *part, const real *u, const real *w, int order, partials *q);
void cone_extent(const surface *base, int part, double u[2], double w[2]);
void cone_box(const surface *base, double lo[3], double hi[3]);

#endif
