/* The prism over a mesh's triangle: all Q + h N for its Q and a range of heights h. */
#ifndef KAGE_DISPLACED_PRISM_H
#define KAGE_DISPLACED_PRISM_H

#include "mesh/mesh.h"

/* A triangle's displaced surface extends beyond it by this share, so that no ray passes between two triangles. */
#define PRISM_OVERLAP 1e-4

/* The offset point Q + h N at b and c of a triangle, N there, and the point's partials by b and by c. */
typedef struct prism_point {
    vec3 place, N, Xb, Xc;
} prism_point;

prism_point prism_at(const mesh_triangle *x, double b, double c, double h);

/* The gradients of u and w in space there. det: Xb x Xc . N, or a substitute where that is 0 as normals meet. */
void prism_gradients(const mesh_triangle *x, const prism_point *p, double det, vec3 *gu, vec3 *gw);

/* The box of the prism for heights from lo to hi. */
void prism_box(const mesh_triangle *x, double lo, double hi, double box[2][3]);

/* Narrow from..to to where r + s t may be in the prism, or within `air` of it. False: nowhere. */
bool prism_stretch(const mesh_triangle *x, double air, vec3 r, vec3 s, double lo, double hi, double *from, double *to);

/* The place of the triangle from which N leads to `at`, by Newton's iteration; it may lie beyond the triangle. */
void prism_closest(const mesh_triangle *x, vec3 at, closest_points *out, int lane);

#endif
