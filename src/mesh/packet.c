/* A packet of rays against a mesh. A ray against a triangle is Woop, Benthin and Wald's test of 2013, in double: the
 * ray becomes an axis, and the sign of a sum says on which side of it each edge is. Two triangles that share an edge
 * compute the same sum with opposite signs, so that no ray passes between them. Embree's hierarchy (bvh.h) reports the
 * clusters of triangles to test, in any order: of hits at one t the triangle with the lowest index counts.
 */
#include "mesh/packet.h"

#include <string.h>

#define MARGIN 4e-6f      /* more than float's rounding of where a ray ends, in radii; the boxes have the same */
#define WIDER (1 + 1e-6f) /* float's rounding of t, as a share */
#define OWN_ERROR 1e-12   /* 1e-16, of double, over a sine of 1e-4; of the size and place of the mesh */

/* ---- rays as axes ---- */

/* Of three coordinates that with the index z. */
static inline double along(double z, double first, double second, double third)
{
    const double later = z == 1 ? second : third;
    return z == 0 ? first : later;
}

STAGE static void shear_rays(const bvh_space *restrict space, mesh_packet *restrict k)
{
    const vec3 C = space->centre;
    const double over = 1 / space->radius;
    for (int i = 0; i < BVH_PACKET; i++) {
        const double a = k->s[0][i], b = k->s[1][i], c = k->s[2][i];
        const double o = k->r[0][i] - C.x, p = k->r[1][i] - C.y, q = k->r[2][i] - C.z;
        const double A = fabs(a), B = fabs(b), D = fabs(c);
        const double z = A > B ? (A > D ? 0 : 2) : (B > D ? 1 : 2);
        const double Sz = along(z, a, b, c), Sx = along(z, b, c, a), Sy = along(z, c, a, b);
        const double Rz = along(z, o, p, q), Rx = along(z, p, q, o), Ry = along(z, q, o, p);
        const double sz = 1 / Sz, sx = Sx * sz, sy = Sy * sz;
        k->sx[i] = sx;
        k->sy[i] = sy;
        k->sz[i] = sz;
        k->unit[i] = sqrt(a * a + b * b + c * c) * over;
        k->axis.z[i] = (int32_t)z;
        k->axis.sx[i] = (float)sx;
        k->axis.sy[i] = (float)sy;
        k->axis.cx[i] = (float)((Rx - sx * Rz) * over);
        k->axis.cy[i] = (float)((Ry - sy * Rz) * over);
    }
}

/* 1 / way, where a way of 0 is next to it, so that no t is NaN. */
STAGE static void over_way(const bvh_packet *restrict x, cluster_rays *restrict k)
{
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < BVH_PACKET; i++) {
            const float way = x->way[a][i];
            k->at[a][i] = x->at[a][i];
            k->way[a][i] = way;
            k->over[a][i] = 1 / (fabsf(way) > 1e-18f ? way : 1e-18f);
        }
}

/* ---- triangles ---- */

/* Whether ray i meets a triangle, and t there, also below 0. */
static bool meets(const float at[3][3], const mesh_packet *k, int i, double *t)
{
    const int Z = k->axis.z[i], X = (Z + 1) % 3, Y = (Z + 2) % 3;
    double x[3], y[3], z[3];
    for (int c = 0; c < 3; c++) {
        z[c] = (double)at[c][Z] - k->r[Z][i];
        x[c] = (double)at[c][X] - k->r[X][i] - k->sx[i] * z[c];
        y[c] = (double)at[c][Y] - k->r[Y][i] - k->sy[i] * z[c];
    }
    const double U = x[2] * y[1] - y[2] * x[1], V = x[0] * y[2] - y[0] * x[2], W = x[1] * y[0] - y[1] * x[0],
                 all = U + V + W;
    if (((U < 0) | (V < 0) | (W < 0)) & ((U > 0) | (V > 0) | (W > 0)))
        return false;
    *t = (U * z[0] + V * z[1] + W * z[2]) * k->sz[i] / all;
    return all != 0;
}

/* Test one triangle. Whether it counts; then *end is the new end of the ray in the hierarchy; below 0: nothing else
 * counts. */
static bool test(mesh_packet *k, int i, int32_t index, float *end)
{
    double t;
    if (!meets((const float(*)[3])k->f->d.at[index], k, i, &t) || !(t > k->from[i]))
        return false;
    if (!(t < k->to[i] || (t == k->to[i] && k->index[i] >= 0 && index < k->index[i])))
        return false;
    k->to[i] = t;
    k->index[i] = index;
    const float now = k->any ? -1 : (float)((t - k->enter[i]) * k->unit[i]) * WIDER + MARGIN;
    *end = now < *end ? now : *end;
    return true;
}

/* ---- the hierarchy ---- */

/* Whether an end has changed. */
static bool visit_cluster(mesh_packet *k, const mesh_cluster *c, uint32_t which, float end[BVH_PACKET])
{
    uint32_t met[CLUSTER];
    bool changed = false;
    if (!cluster_near(c, &k->axis, which, met))
        return false;
    for (int j = 0; j < CLUSTER; j++)
        for (; met[j]; met[j] &= met[j] - 1) {
            const int i = lowest_bit(met[j]);
            changed |= end[i] >= 0 && test(k, i, c->index[j], &end[i]);
        }
    return changed;
}

static bool visit(void *user, int32_t index, uint32_t which, float end[BVH_PACKET])
{
    mesh_packet *k = user;
    const mesh_block *b = &k->f->clusters.block[index];
    uint32_t met[CLUSTER];
    bool changed = false;
    which = block_pass(b, &k->axis, end, which);
    if (!which)
        return false;
    block_near(b, &k->axis, end, which, met);
    for (int j = 0; j < CLUSTER; j++)
        if (met[j])
            changed |= visit_cluster(k, &k->f->clusters.cluster[b->first + j], met[j], end);
    return changed;
}

void mesh_packet_intersect(mesh_packet *k)
{
    double leave[BVH_PACKET];
    for (int i = k->n; i < BVH_PACKET; i++) {
        for (int a = 0; a < 3; a++)
            k->r[a][i] = k->s[a][i] = 0;
        k->from[i] = 0;
        k->to[i] = -1;
    }
    for (int i = 0; i < BVH_PACKET; i++) {
        k->index[i] = -1;
        k->axis.own[i] = i < k->n ? k->own[i] : -1;
        k->enter[i] = greater(k->from[i], 0);
        leave[i] = k->to[i];
    }
    bvh_enter_packet(&k->f->space, k->f->space.radius, (const double(*)[BVH_PACKET])k->r,
                     (const double(*)[BVH_PACKET])k->s, k->enter, leave, &k->x);
    shear_rays(&k->f->space, k);
    over_way(&k->x, &k->axis);
    bvh_packet_toward(k->f->tree, &k->x, visit, k);
}

/* ---- rays from the mesh itself ---- */

/* Where on its triangle a ray starts, in double. The triangle itself is left out by its index. A neighbour whose edge
 * the start is on is left out by `from`, where other hits begin: the rounding of double, over a sine of the ray's angle
 * to the neighbour of at least 1e-4. */
STAGE static void own_starts(const double (*restrict t)[BVH_PACKET], double radius, mesh_packet *restrict k,
                             double (*restrict rest)[BVH_PACKET])
{
    for (int i = 0; i < BVH_PACKET; i++) {
        const vec3 A = {t[0][i], t[1][i], t[2][i]}, r = {k->r[0][i], k->r[1][i], k->r[2][i]},
                   s = {k->s[0][i], k->s[1][i], k->s[2][i]};
        const vec3 B = vec3_sub((vec3){t[3][i], t[4][i], t[5][i]}, A),
                   C = vec3_sub((vec3){t[6][i], t[7][i], t[8][i]}, A);
        double b, c;
        mesh_foot_in(B, C, vec3_sub(r, A), &b, &c);
        mesh_keep_inside(&b, &c);
        const vec3 from = vec3_add(A, vec3_add(vec3_scale(B, b), vec3_scale(C, c))),
                   way = vec3_sub(vec3_add(r, s), from);
        k->r[0][i] = from.x, k->r[1][i] = from.y, k->r[2][i] = from.z;
        rest[0][i] = way.x, rest[1][i] = way.y, rest[2][i] = way.z;
        k->from[i] = OWN_ERROR * (vec3_length(from) + radius) / vec3_length(s);
    }
}

void mesh_packet_start(mesh_packet *k, bool segments)
{
    double t[9][BVH_PACKET], rest[3][BVH_PACKET]; /* of corners by axis; from there to the end of the ray */
    for (int i = 0; i < BVH_PACKET; i++) {
        const int32_t own = k->own[i < k->n ? i : 0];
        for (int c = 0; c < 3; c++)
            for (int a = 0; a < 3; a++)
                t[3 * c + a][i] = (double)k->f->d.at[own][c][a];
        for (int a = 0; i >= k->n && a < 3; a++)
            k->r[a][i] = k->s[a][i] = 0;
    }
    own_starts((const double(*)[BVH_PACKET])t, k->f->space.radius, k, rest);
    if (segments)
        memcpy(k->s, rest, sizeof rest);
}
