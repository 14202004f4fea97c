/* Triangle meshes as surfaces.
 *
 * On a triangle Q(u,w) is linear, and (u,w) are its texture coordinates. n is along the normal N that is interpolated
 * between the corners: Qu and Qw are the triangle's own without their parts along N. Then a and b of the method say
 * exactly how (u,w) change along a ray near the points Q + h N. Quu, Quw and Qww are along N, with the curvature of a
 * surface whose normal is N.
 *
 * A triangle whose texture is mirrored would have n inward. So its u is reflected to beyond the end of the range:
 * u -> 2 axis - u, the axis one range beyond the end. Textures reflect it back (texture/mirrored_uv.h). Where the
 * texture has no area on a triangle, its texture coordinates are moved apart by 1/4096 of the range.
 */
#ifndef KAGE_MESH_MESH_H
#define KAGE_MESH_MESH_H

#include "bvh/bvh.h"
#include "mesh/cluster.h"
#include "mesh/mesh_data.h"
#include "geometry/surface.h"

typedef struct mesh {
    surface base;
    mesh_data d;         /* owned; mesh_new counts notes.folded and notes.spread */
    bool textured;       /* the file has texture coordinates on every triangle */
    double u[2], w[2];   /* the range of the texture coordinates; 0..1 where there are none */
    double lo[3], hi[3]; /* the box of all vertices */
    bvh_space space;     /* the sphere about all vertices */
    mesh_clusters clusters;
    bvh *tree; /* over the blocks of clusters, in `space` */
} mesh;

/* Owns *d, also on failure. *d has been through mesh_clean. threads: those that build the hierarchy, 0: one for each
 * processor; w: the progress of that, may be NULL.
 * NULL: out of memory, or all vertices are in one place. */
surface *mesh_new(mesh_data *d, int threads, const progress *w);

/* The image of a mesh by an affine map, with arrays of its own; unlike one by surface_transformed it can be displaced.
 * Where the map mirrors, u runs the other way in its range. NULL: out of memory. */
surface *mesh_moved(const surface *base, const affine *m, int threads, const progress *w);

/* Whether a surface is one. */
bool mesh_is(const surface *f);

/* A triangle in double: its corners, their unit normals, and their (u,w). */
typedef struct mesh_triangle {
    vec3 at[3], normal[3];
    double u[3], w[3];
} mesh_triangle;

static inline mesh_triangle mesh_triangle_of(const mesh *f, int32_t index)
{
    mesh_triangle x;
    for (int k = 0; k < 3; k++) {
        x.at[k] = mesh_get(f->d.at[index][k]);
        x.normal[k] = mesh_get(f->d.skin[index].normal[k]);
        x.u[k] = (double)f->d.skin[index].uv[k][0];
        x.w[k] = (double)f->d.skin[index].uv[k][1];
    }
    return x;
}

/* A vector between those of the three corners, at barycentric coordinates b and c. */
static inline vec3 mesh_mix(const vec3 v[3], double b, double c)
{
    return vec3_add(v[0], vec3_add(vec3_scale(vec3_sub(v[1], v[0]), b), vec3_scale(vec3_sub(v[2], v[0]), c)));
}

/* The barycentric coordinates b and c of (u,w), those of the second and the third corner. Outside the triangle they are
 * below 0, or above 1 in sum. */
void mesh_shares(const mesh_triangle *x, double u, double w, double *b, double *c);

/* The same of the point of the triangle's plane that is closest to its first corner + d. B and C: the sides from that
 * corner. */
static inline void mesh_foot_in(vec3 B, vec3 C, vec3 d, double *b, double *c)
{
    const vec3 n = vec3_cross(B, C);
    const double k = 1 / vec3_dot(n, n);
    *b = k * vec3_dot(n, vec3_cross(d, C));
    *c = k * vec3_dot(n, vec3_cross(B, d));
}

static inline void mesh_foot_shares(const mesh_triangle *x, vec3 p, double *b, double *c)
{
    mesh_foot_in(vec3_sub(x->at[1], x->at[0]), vec3_sub(x->at[2], x->at[0]), vec3_sub(p, x->at[0]), b, c);
}

/* Move b and c to inside the triangle. */
static inline void mesh_keep_inside(double *b, double *c)
{
    *b = *b > 0 ? *b : 0;
    *c = *c > 0 ? *c : 0;
    const double sum = *b + *c, k = sum > 1 ? 1 / sum : 1;
    *b *= k;
    *c *= k;
}

/* In intersect.c; as the members of surface_ops of the same names. */
void mesh_hit(const surface *base, int n, const rays *x, int32_t id, hits *h);
void mesh_hit_own(const surface *base, int n, const rays *x, const ray_origins *from, int32_t id, hits *h);
void mesh_occlude(const surface *base, int n, const rays *x, real *lit);
void mesh_occlude_own(const surface *base, int n, const rays *x, const int32_t *part, real *lit);

/* In intersect.c: the triangle that the line through p along N meets nearest to p, at most as far away as N is long.
 * False: none. */
bool mesh_near(const mesh *f, vec3 p, vec3 N, int32_t *part);

/* In texture.c: lay out the texture coordinates and set the range, of a mesh that has none in its file, and of one
 * that has them on every triangle. */
void mesh_lay_bare(mesh *f);
void mesh_lay_texture(mesh *f);

#endif
