/* Rays against a mesh: hits and shadows. A ray against a triangle is Woop, Benthin and Wald's test of 2013, in double:
 * the ray becomes an axis, and the sign of a sum says on which side of it each edge is. Two triangles that share an
 * edge compute the same sum with opposite signs, so that no ray passes between them. Embree's hierarchy (bvh.h) reports
 * the triangles to test, in any order: of hits at one t the triangle with the lowest index counts.
 */
#include "mesh/mesh.h"

#define MARGIN 4e-6f      /* more than float's rounding of where a ray ends, in radii; the boxes have the same */
#define WIDER (1 + 1e-6f) /* float's rounding of t, as a share */
#define OWN_ERROR 1e-12   /* 1e-16, of double, over a sine of 1e-4; of the size and place of the mesh */

/* A ray as an axis: z is the coordinate in which its direction is largest. x and y are sheared so that the ray runs
 * along z. */
typedef struct shear {
    int x, y, z;       /* indices of coordinates */
    double r[3];       /* the origin */
    double sx, sy, sz; /* the shear of x and y per z, and t per z */
} shear;

static shear shear_of(vec3 r, vec3 s)
{
    const double S[3] = {s.x, s.y, s.z};
    shear k = {.r = {r.x, r.y, r.z}};
    k.z = fabs(s.x) > fabs(s.y) ? (fabs(s.x) > fabs(s.z) ? 0 : 2) : (fabs(s.y) > fabs(s.z) ? 1 : 2);
    k.x = (k.z + 1) % 3;
    k.y = (k.z + 2) % 3;
    k.sz = 1 / S[k.z];
    k.sx = S[k.x] * k.sz;
    k.sy = S[k.y] * k.sz;
    return k;
}

/* Whether the ray meets a triangle, and t there, also below 0. */
static bool meets(const float at[3][3], const shear *k, double *t)
{
    double x[3], y[3], z[3];
    for (int i = 0; i < 3; i++) {
        z[i] = (double)at[i][k->z] - k->r[k->z];
        x[i] = (double)at[i][k->x] - k->r[k->x] - k->sx * z[i];
        y[i] = (double)at[i][k->y] - k->r[k->y] - k->sy * z[i];
    }
    const double U = x[2] * y[1] - y[2] * x[1], V = x[0] * y[2] - y[0] * x[2], W = x[1] * y[0] - y[1] * x[0],
                 all = U + V + W;
    if (((U < 0) | (V < 0) | (W < 0)) & ((U > 0) | (V > 0) | (W > 0)))
        return false;
    *t = (U * z[0] + V * z[1] + W * z[2]) * k->sz / all;
    return all != 0;
}

/* A ray on its way through the hierarchy. Hits with from < t < to count; `to` becomes t of the first one. */
typedef struct mesh_query {
    const mesh *f;
    shear k;
    int32_t own, index; /* a triangle that does not count, -1: none; the triangle that is met, -1: none so far */
    double from, to;
    double enter, unit; /* t where the ray enters the hierarchy's sphere, and its length in radii for each t */
    bool any;           /* any hit will do, as for shadows */
} mesh_query;

static float visit(void *user, int32_t index, float end)
{
    mesh_query *q = user;
    double t;
    if (index == q->own || !meets((const float(*)[3])q->f->d.at[index], &q->k, &t) || !(t > q->from))
        return end;
    if (!(t < q->to || (t == q->to && q->index >= 0 && index < q->index)))
        return end;
    q->to = t;
    q->index = index;
    if (q->any)
        return -1;
    const float now = (float)((t - q->enter) * q->unit) * WIDER + MARGIN;
    return now < end ? now : end;
}

/* The first hit of r + s t with from < t < to, on any triangle other than `own`: into q->to and q->index. */
static void intersect(mesh_query *q, vec3 r, vec3 s, double from, double to, int32_t own)
{
    float at[3], way[3], end;
    double enter = from > 0 ? from : 0, leave = to;
    q->own = own;
    q->index = -1;
    q->from = from;
    q->to = to;
    if (!(from < to) || !bvh_enter(&q->f->space, q->f->space.radius, r, s, &enter, &leave, at, way, &end))
        return;
    q->k = shear_of(r, s);
    q->enter = enter;
    q->unit = vec3_length(s) / q->f->space.radius;
    bvh_toward(q->f->tree, at, way, end, visit, q);
}

static void store_hit(const mesh_query *q, int i, int32_t id, hits *h)
{
    const real t = (real)q->to;
    if (q->index >= 0 && t > 0 && t < h->t[i]) {
        h->t[i] = t;
        h->id[i] = id;
        h->part[i] = q->index;
    }
}

void mesh_hit(const surface *base, int n, const rays *x, int32_t id, hits *h)
{
    mesh_query q = {.f = (const mesh *)base};
    for (int i = 0; i < n; i++) {
        intersect(&q, vec3s_get(&x->r, i), vec3s_get(&x->s, i), 0, (double)h->t[i], -1);
        store_hit(&q, i, id, h);
    }
}

void mesh_occlude(const surface *base, int n, const rays *x, real *lit)
{
    mesh_query q = {.f = (const mesh *)base, .any = true};
    for (int i = 0; i < n; i++) {
        intersect(&q, vec3s_get(&x->r, i), vec3s_get(&x->s, i), 0, lit[i] > 0 ? 1 : -1, -1);
        lit[i] = q.index >= 0 ? 0 : lit[i];
    }
}

bool mesh_near(const mesh *f, vec3 p, vec3 N, int32_t *part)
{
    mesh_query out = {.f = f}, in = {.f = f};
    const vec3 down = vec3_scale(N, -1);
    intersect(&out, p, N, 0, 1, -1);
    intersect(&in, p, down, 0, out.index >= 0 ? out.to : 1, -1);
    const mesh_query *q = in.index >= 0 ? &in : &out;
    if (q->index < 0)
        return false;
    *part = q->index;
    return true;
}

/* ---- rays from the mesh itself ---- */

/* Where on its triangle a ray starts, in double. The triangle itself is left out by its index. A neighbour whose edge
 * the start is on is left out by *beyond, where other hits begin: the rounding of double, over a sine of the ray's
 * angle to the neighbour of at least 1e-4. */
static vec3 own_start(const mesh *f, int32_t index, vec3 at, vec3 s, double *beyond)
{
    const mesh_triangle x = mesh_triangle_of(f, index);
    double b, c;
    mesh_foot_shares(&x, at, &b, &c);
    mesh_keep_inside(&b, &c);
    const vec3 from = mesh_mix(x.at, b, c);
    *beyond = OWN_ERROR * (vec3_length(from) + f->space.radius) / vec3_length(s);
    return from;
}

void mesh_hit_own(const surface *base, int n, const rays *x, const ray_origins *from, int32_t id, hits *h)
{
    mesh_query q = {.f = (const mesh *)base};
    for (int i = 0; i < n; i++) {
        const bool own = from->id[i] == id;
        vec3 r = vec3s_get(&x->r, i);
        const vec3 s = vec3s_get(&x->s, i);
        double beyond = 0;
        if (own)
            r = own_start(q.f, from->part[i], vec3s_get(&from->at, i), s, &beyond);
        intersect(&q, r, s, beyond, (double)h->t[i], own ? from->part[i] : -1);
        store_hit(&q, i, id, h);
    }
}

void mesh_occlude_own(const surface *base, int n, const rays *x, const int32_t *part, real *lit)
{
    mesh_query q = {.f = (const mesh *)base, .any = true};
    for (int i = 0; i < n; i++) {
        if (!(lit[i] > 0))
            continue;
        double beyond;
        const vec3 r = vec3s_get(&x->r, i), to = vec3_add(r, vec3s_get(&x->s, i)),
                   from = own_start(q.f, part[i], r, vec3s_get(&x->s, i), &beyond);
        intersect(&q, from, vec3_sub(to, from), beyond, 1, part[i]);
        lit[i] = q.index >= 0 ? 0 : lit[i];
    }
}
