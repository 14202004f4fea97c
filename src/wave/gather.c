/* Copies lanes: as a block where a group is the whole wave, else one by one. */
#include "wave/gather.h"

#include <string.h>

#include "wave/fill.h"

STAGE static void begin(int n, hits *h)
{
    for (int i = 0; i < n; i++) {
        h->t[i] = REAL_FAR;
        h->id[i] = -1;
        h->part[i] = 0;
    }
}

void gather_begin(int n, hits *h) { begin(n, h); }

STAGE static void start_own(int n, const ray_origins *restrict from, const int32_t *restrict owns, vec3s *restrict r)
{
    for (int i = 0; i < n; i++) {
        int own = owns[i];
        real x = from->at.x[i], y = from->at.y[i], z = from->at.z[i];
        r->x[i] = own ? x : r->x[i];
        r->y[i] = own ? y : r->y[i];
        r->z[i] = own ? z : r->z[i];
    }
}

void gather_move_origins(int n, const ray_origins *from, const int32_t *own, rays *x)
{
    start_own(n, from, own, &x->r);
}

STAGE static void pick(const hit_group *restrict g, const real *restrict from, real *restrict to)
{
#pragma omp simd
    for (int i = 0; i < g->n; i++)
        to[i] = from[g->lane[i]];
}

static void pick3(const hit_group *g, const vec3s *from, vec3s *to)
{
    pick(g, from->x, to->x);
    pick(g, from->y, to->y);
    pick(g, from->z, to->z);
}

static void pick_some(int n, const int32_t *lane, const vec3s *from, vec3s *to)
{
    for (int i = 0; i < n; i++) {
        to->x[i] = from->x[lane[i]];
        to->y[i] = from->y[lane[i]];
        to->z[i] = from->z[lane[i]];
    }
}

void gather_rays(int n, const int32_t *lane, const rays *x, rays *to)
{
    pick_some(n, lane, &x->r, &to->r);
    pick_some(n, lane, &x->s, &to->s);
}

void gather_ray_origins(int n, const int32_t *lane, const ray_origins *from, ray_origins *to)
{
    for (int i = 0; i < n; i++) {
        to->id[i] = from->id[lane[i]];
        to->part[i] = from->part[lane[i]];
    }
    pick_some(n, lane, &from->at, &to->at);
}

STAGE static int count_hits(int n, const int32_t *id)
{
    int m = 0;
    for (int i = 0; i < n; i++)
        m += id[i] >= 0;
    return m;
}

int gather_hits(int n, const hits *h) { return count_hits(n, h->id); }

STAGE static int count(int n, const int32_t *id, int32_t wanted)
{
    int m = 0;
    for (int i = 0; i < n; i++)
        m += id[i] == wanted;
    return m;
}

/* The lanes of object `id`, from the first on. */
static void list_lanes(int32_t id, int first, hits *h, hit_group *g)
{
    for (int i = first, m = 0; m < g->n; i++) { /* no branch, as it would be unpredictable at a silhouette */
        g->lane[m] = i;
        m += h->id[i] == id;
    }
    for (int i = 0; i < g->n; i++)
        h->id[g->lane[i]] = -1;
}

int32_t gather_next_group(int n, const rays *x, hits *h, hit_group *g)
{
    int first = 0;
    while (first < n && h->id[first] < 0)
        first++;
    if (first == n)
        return -1;
    const int32_t id = h->id[first];
    g->n = count(n, h->id, id);
    g->whole = g->n == n;
    g->x = x;
    g->t = h->t;
    if (g->whole) {
        fill_ids(n, -1, h->id);
        memcpy(g->part, h->part, (size_t)n * sizeof *h->part);
        return id;
    }
    list_lanes(id, first, h, g);
    pick3(g, &x->r, &g->picked.x.r);
    pick3(g, &x->s, &g->picked.x.s);
    pick(g, h->t, g->picked.t);
    for (int i = 0; i < g->n; i++)
        g->part[i] = h->part[g->lane[i]];
    hit_group_picked(g);
    return id;
}

void scatter(const hit_group *restrict g, const real *restrict from, real *restrict to)
{
    if (g->whole) {
        memcpy(to, from, (size_t)g->n * sizeof *to);
        return;
    }
    for (int i = 0; i < g->n; i++)
        to[g->lane[i]] = from[i];
}

void scatter_vec3s(const hit_group *g, const vec3s *from, vec3s *to)
{
    scatter(g, from->x, to->x);
    scatter(g, from->y, to->y);
    scatter(g, from->z, to->z);
}
