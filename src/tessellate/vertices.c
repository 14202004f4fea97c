/* Vertices of meshes: each evaluated once, LANES at a time, and found again by a hash table. */
#include "tessellate/vertices.h"

#include "wave/lane.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void put_list(pov_text *t, const char *kind, const float *v, int n, int each)
{
    pov_print(t, "  %s { %d", kind, n);
    for (int k = 0; k < n; k++, v += sizeof(pov_vertex) / sizeof *v) {
        pov_print(t, k % 4 ? ",<" : ",\n<");
        for (int a = 0; a < each; a++)
            pov_print(t, a ? ",%s" : "%s", pov_number((double)v[a], 7).text);
        pov_print(t, ">");
    }
    pov_print(t, " }\n");
}

void pov_mesh2(pov_text *t, const pov_vertex *v, int n, bool uv, int faces, const int32_t (*face)[3])
{
    pov_print(t, "mesh2 {\n");
    put_list(t, "vertex_vectors", v->at, n, 3);
    put_list(t, "normal_vectors", v->normal, n, 3);
    if (uv)
        put_list(t, "uv_vectors", v->uv, n, 2);
    pov_print(t, "  face_indices { %d", faces);
    for (int k = 0; k < faces; k++)
        pov_print(t, k % 8 ? ",<%d,%d,%d>" : ",\n<%d,%d,%d>", (int)face[k][0], (int)face[k][1], (int)face[k][2]);
    pov_print(t, " }\n");
}

pov_vertex pov_vertex_of(vec3 at, vec3 normal, double u, double w)
{
    return (pov_vertex){{(float)at.x, (float)at.y, (float)at.z},
                        {(float)normal.x, (float)normal.y, (float)normal.z},
                        {(float)u, (float)w}};
}

static double line(const pov_lattice *l, int axis, int64_t i)
{
    return fmin(fmax(l->start[axis] + (double)i * l->step[axis], l->lo[axis]), l->hi[axis]);
}

double pov_lattice_at(const pov_lattice *l, int axis, int64_t i, int s)
{
    double a = line(l, axis, i), b = line(l, axis, i + 1);
    return s == LATTICE ? b : a + (b - a) * s / LATTICE;
}

/* X = Q + P n/|n|, with the gradient of height - P as normal: the displaced surface is where that is 0. */
static void evaluate(pov_vertices *v, int n, const real *u, const real *w, pov_vertex *out)
{
    partials q;
    bump_values h;
    rays x;
    closest_points p;
    int32_t part[LANES] = {0};
    real t[LANES];
    for (int i = 0; i < n; i++) {
        part[i] = v->lattice.part;
        t[i] = 0;
    }
    v->f->ops->eval(v->f, n, part, u, w, 1, &q);
    v->P->ops->eval(v->P, n, u, w, 1, &h);
    for (int i = 0; i < n; i++) {
        bs_vec3 Q = lane_get(&q.Q, i), up = lane_unit(bs_normal(lane_get(&q.Qu, i), lane_get(&q.Qw, i)));
        bs_vec3 X = {Q.x + h.P[i] * up.x, Q.y + h.P[i] * up.y, Q.z + h.P[i] * up.z};
        lane_set(&x.r, i, X);
        lane_set(&x.s, i, up);
    }
    v->f->ops->closest(v->f, v->lattice.part, n, &x, t, &p);
    for (int i = 0; i < n; i++) {
        bs_vec3 Qu = lane_get(&q.Qu, i), Qw = lane_get(&q.Qw, i);
        bs_vec3 gu = lane_get(&p.gu, i), gw = lane_get(&p.gw, i), gh = lane_get(&p.gh, i);
        if (bs_regular(bs_normal(Qu, Qw), Qu, Qw)) {
            bs_vec3 g = {gh.x - h.Pu[i] * gu.x - h.Pw[i] * gw.x, gh.y - h.Pu[i] * gu.y - h.Pw[i] * gw.y,
                         gh.z - h.Pu[i] * gu.z - h.Pw[i] * gw.z};
            lane_set(&x.s, i, lane_unit(g));
        }
        out[i] = pov_vertex_of(vec3s_get(&x.r, i), vec3s_get(&x.s, i), (double)u[i], (double)w[i]);
    }
}

/* The slot of a key, or the free one for it. */
static int find(const pov_vertices *v, int64_t key)
{
    int at = (int)((uint64_t)key * 0x9e3779b97f4a7c15u >> 32 & (uint64_t)(v->slots - 1));
    while (v->slot[at] >= 0 && v->key[v->slot[at]] != key)
        at = (at + 1) & (v->slots - 1);
    return at;
}

static bool grow(pov_vertices *v)
{
    const int room = v->room ? 2 * v->room : 1 << 14, slots = 2 * room;
    pov_vertex *vertex = memory_resize(v->memory, v->vertex, sizeof *vertex * (size_t)room);
    v->vertex = vertex ? vertex : v->vertex;
    int64_t *key = memory_resize(v->memory, v->key, sizeof *key * (size_t)room);
    v->key = key ? key : v->key;
    int32_t *slot = memory_resize(v->memory, v->slot, sizeof *slot * (size_t)slots);
    v->slot = slot ? slot : v->slot;
    if (!vertex || !key || !slot)
        return false;
    v->room = room;
    v->slots = slots;
    memset(slot, 0xff, sizeof *slot * (size_t)slots);
    for (int k = 0; k < v->count; k++)
        slot[find(v, key[k])] = k;
    return true;
}

bool pov_vertices_get(pov_vertices *v, int n, const int64_t (*cell)[2], const int (*place)[2], int32_t *number,
                      bool *fresh)
{
    if (v->count + n > v->room && !grow(v))
        return false;
    real u[LANES], w[LANES];
    int waiting = 0;
    for (int i = 0; i < n; i++) {
        const int64_t a = cell[i][0] * LATTICE + place[i][0], b = cell[i][1] * LATTICE + place[i][1];
        const int64_t key = (int64_t)((uint64_t)a << 32 ^ ((uint64_t)b & 0xffffffffu));
        const int at = find(v, key);
        fresh[i] = v->slot[at] < 0;
        if (fresh[i]) {
            v->slot[at] = v->count;
            v->key[v->count++] = key;
            u[waiting] = (real)pov_lattice_at(&v->lattice, 0, cell[i][0], place[i][0]);
            w[waiting++] = (real)pov_lattice_at(&v->lattice, 1, cell[i][1], place[i][1]);
        }
        number[i] = v->slot[at];
        if (waiting == LANES || (i == n - 1 && waiting)) {
            evaluate(v, waiting, u, w, v->vertex + v->count - waiting);
            waiting = 0;
        }
    }
    return true;
}

void pov_vertices_clear(pov_vertices *v)
{
    v->count = 0;
    if (v->slot)
        memset(v->slot, 0xff, sizeof *v->slot * (size_t)v->slots);
}

void pov_vertices_free(pov_vertices *v)
{
    memory_free(v->vertex);
    memory_free(v->key);
    memory_free(v->slot);
}
