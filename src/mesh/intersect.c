/* Rays against a mesh: hits and shadows, in packets (packet.h). */
#include "mesh/packet.h"

#include <stddef.h>

static void put(mesh_packet *k, int i, const vec3s *r, const vec3s *s, int lane)
{
    k->r[0][i] = (double)r->x[lane], k->r[1][i] = (double)r->y[lane], k->r[2][i] = (double)r->z[lane];
    k->s[0][i] = (double)s->x[lane], k->s[1][i] = (double)s->y[lane], k->s[2][i] = (double)s->z[lane];
}

static void store_hits(const mesh_packet *k, const int *lane, int32_t id, hits *h)
{
    for (int i = 0; i < k->n; i++) {
        const real t = (real)k->to[i];
        if (k->index[i] >= 0 && t > 0 && t < h->t[lane[i]]) {
            h->t[lane[i]] = t;
            h->id[lane[i]] = id;
            h->part[lane[i]] = k->index[i];
        }
    }
}

/* The rays from the mesh itself, if `own`, or the others. from: NULL: all are others. */
static void hit_some(const mesh *f, int n, const rays *x, const ray_origins *from, bool own, int32_t id, hits *h)
{
    mesh_packet k = {.f = f};
    int lane[BVH_PACKET];
    for (int first = 0; first < n; first += BVH_PACKET) {
        k.n = 0;
        for (int j = 0; j < BVH_PACKET && first + j < n; j++) {
            const int l = wave_lane(n, first + j), i = k.n;
            if (from && own != (from->id[l] == id))
                continue;
            lane[k.n++] = l;
            put(&k, i, own ? &from->at : &x->r, &x->s, l);
            k.from[i] = 0;
            k.to[i] = (double)h->t[l];
            k.own[i] = own ? from->part[l] : -1;
        }
        if (k.n == 0)
            continue;
        if (own)
            mesh_packet_start(&k, false);
        mesh_packet_intersect(&k);
        store_hits(&k, lane, id, h);
    }
}

void mesh_hit(const surface *base, int n, const rays *x, int32_t id, hits *h)
{
    hit_some((const mesh *)base, n, x, NULL, false, id, h);
}

void mesh_hit_own(const surface *base, int n, const rays *x, const ray_origins *from, int32_t id, hits *h)
{
    hit_some((const mesh *)base, n, x, from, false, id, h);
    hit_some((const mesh *)base, n, x, from, true, id, h);
}

/* part: of segments from the mesh itself; NULL: they start elsewhere. */
static void occlude_some(const mesh *f, int n, const rays *x, const int32_t *part, real *lit)
{
    mesh_packet k = {.f = f, .any = true};
    int lane[BVH_PACKET];
    for (int first = 0; first < n; first += BVH_PACKET) {
        k.n = 0;
        for (int j = 0; j < BVH_PACKET && first + j < n; j++) {
            const int l = wave_lane(n, first + j), i = k.n;
            if (!(lit[l] > 0))
                continue;
            lane[k.n++] = l;
            put(&k, i, &x->r, &x->s, l);
            k.from[i] = 0;
            k.to[i] = 1;
            k.own[i] = part ? part[l] : -1;
        }
        if (k.n == 0)
            continue;
        if (part)
            mesh_packet_start(&k, true);
        mesh_packet_intersect(&k);
        for (int i = 0; i < k.n; i++)
            lit[lane[i]] = k.index[i] >= 0 ? 0 : lit[lane[i]];
    }
}

void mesh_occlude(const surface *base, int n, const rays *x, real *lit)
{
    occlude_some((const mesh *)base, n, x, NULL, lit);
}

void mesh_occlude_own(const surface *base, int n, const rays *x, const int32_t *part, real *lit)
{
    occlude_some((const mesh *)base, n, x, part, lit);
}

static void put_one(mesh_packet *k, int i, vec3 r, vec3 s, double to)
{
    k->r[0][i] = r.x, k->r[1][i] = r.y, k->r[2][i] = r.z;
    k->s[0][i] = s.x, k->s[1][i] = s.y, k->s[2][i] = s.z;
    k->from[i] = 0;
    k->to[i] = to;
    k->own[i] = -1;
}

bool mesh_near(const mesh *f, vec3 p, vec3 N, int32_t *part)
{
    mesh_packet k = {.f = f, .n = 2};
    put_one(&k, 0, p, N, 1);
    put_one(&k, 1, p, vec3_scale(N, -1), 1);
    mesh_packet_intersect(&k);
    const int i = k.index[1] >= 0 && !(k.index[0] >= 0 && k.to[0] <= k.to[1]);
    *part = k.index[i] >= 0 ? k.index[i] : *part;
    return k.index[i] >= 0;
}
