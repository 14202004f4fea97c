/* Clusters of triangles: sorted along Morton's curve, then cut so that the boxes of the pieces are small. */
#include "mesh/cluster.h"

#include "base/real.h"
#include "base/threads.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- the test ---- */

/* What x = X - sx Z - cx of a corner may be wrong by, in the hierarchy's space, where X, Z and sx are at most 1 and cx
 * at most 2. Rounding to float is an error of 6e-8 as a share. So X, sx Z by Z and by sx, and their product are wrong
 * by 6e-8 each, cx by 1.2e-7, the first difference, at most 2, by 1.2e-7, and the second, which is small, by next to
 * nothing: 4.8e-7 in all. The rest is for what double rounds: 1e-16 of the distance in radii that the ray comes from.
 */
#define ERROR 6e-7f

/* A ray that meets a triangle is at most as far from its corners, in the plane across z, as its box is wide, in x or y
 * and z together: M. Then U = x2 y1 - y2 x1 is wrong by 2 (2 M ERROR + ERROR^2), and by the rounding of three
 * operations, 3 6e-8 2 M^2. */
static float error_of(float wide) { return ERROR * (4 * wide + 4 * ERROR) + 4e-7f * wide * wide; }

static inline float less(float x, float y) { return x < y ? x : y; }
static inline float more(float x, float y) { return x > y ? x : y; }

static const uint32_t bit[CLUSTER] = {1, 2, 4, 8, 16, 32, 64, 128};

STAGE static void near_triangles(const mesh_cluster *restrict c, const cluster_rays *restrict k, int n,
                                 const int32_t *restrict ray, uint32_t *restrict met)
{
    for (int j = 0; j < n; j++) {
        const int r = ray[j], X = (k->z[r] + 1) % 3, Y = (k->z[r] + 2) % 3, Z = k->z[r];
        const float sx = k->sx[r], sy = k->sy[r], cx = k->cx[r], cy = k->cy[r];
        uint32_t some = 0;
        for (int i = 0; i < CLUSTER; i++) {
            const float za = c->at[0][Z][i], zb = c->at[1][Z][i], zc = c->at[2][Z][i];
            const float xa = c->at[0][X][i] - sx * za - cx, ya = c->at[0][Y][i] - sy * za - cy;
            const float xb = c->at[1][X][i] - sx * zb - cx, yb = c->at[1][Y][i] - sy * zb - cy;
            const float xc = c->at[2][X][i] - sx * zc - cx, yc = c->at[2][Y][i] - sy * zc - cy;
            const float U = xc * yb - yc * xb, V = xa * yc - ya * xc, W = xb * ya - yb * xa, e = c->error[i];
            const float least = less(less(U, V), W), most = more(more(U, V), W);
            some |= bit[i] & -(uint32_t)((least >= -e) | (most <= e));
        }
        met[j] = some;
    }
}

void cluster_near(const mesh_cluster *c, const cluster_rays *k, int n, const int32_t *ray, uint32_t *met)
{
    near_triangles(c, k, n, ray, met);
}

/* ---- making them ---- */

typedef struct key {
    uint32_t code, index; /* Morton's code of the triangle's middle; the triangle */
} key;

/* The lowest 10 bits, with two zeros between them. */
static uint32_t spread(uint32_t x)
{
    x = (x | x << 16) & 0x030000ffu;
    x = (x | x << 8) & 0x0300f00fu;
    x = (x | x << 4) & 0x030c30c3u;
    return (x | x << 2) & 0x09249249u;
}

static bvh_box box_of(const mesh_data *d, const bvh_space *space, int32_t index)
{
    double lo[3], hi[3];
    for (int a = 0; a < 3; a++) {
        const double x = (double)d->at[index][0][a], y = (double)d->at[index][1][a], z = (double)d->at[index][2][a];
        lo[a] = lesser(x, lesser(y, z));
        hi[a] = greater(x, greater(y, z));
    }
    return bvh_box_in(space, lo, hi);
}

static key key_of(const bvh_box *b, int32_t index)
{
    uint32_t code = 0;
    for (int a = 0; a < 3; a++) /* the middle is between -1 and 1 */
        code |= spread((uint32_t)(511.5f * (0.5f * (b->lo[a] + b->hi[a]) + 1))) << a;
    return (key){code, (uint32_t)index};
}

/* By code, then by index: by 10 bits at a time. */
static void sort_keys(int n, key *k, key *other)
{
    enum { BITS = 10, SIZE = 1 << BITS };
    for (int pass = 0; pass < 3; pass++) {
        int first[SIZE + 1] = {0};
        for (int i = 0; i < n; i++)
            first[(k[i].code >> (BITS * pass) & (SIZE - 1)) + 1]++;
        for (int i = 0; i < SIZE; i++)
            first[i + 1] += first[i];
        for (int i = 0; i < n; i++)
            other[first[k[i].code >> (BITS * pass) & (SIZE - 1)]++] = k[i];
        key *swap = k;
        k = other;
        other = swap;
    }
}

static void add_box(bvh_box *to, const bvh_box *b)
{
    for (int a = 0; a < 3; a++) {
        to->lo[a] = b->lo[a] < to->lo[a] ? b->lo[a] : to->lo[a];
        to->hi[a] = b->hi[a] > to->hi[a] ? b->hi[a] : to->hi[a];
    }
}

static float area_of(const bvh_box *b)
{
    const float x = b->hi[0] - b->lo[0], y = b->hi[1] - b->lo[1], z = b->hi[2] - b->lo[2];
    return x * y + y * z + z * x;
}

/* ---- cutting ---- */

enum { CHUNK = 1 << 13 }; /* triangles that are cut by themselves, each chunk by one thread */

typedef struct cutting {
    const mesh_data *d;
    const bvh_space *space;
    const bvh_box *box; /* of each triangle */
    const key *sorted;
    unsigned char *size;  /* of the cluster that ends behind each triangle, by the best cut of what is before it */
    unsigned char *start; /* 1: a cluster starts here */
} cutting;

/* Cut triangles a to b - 1 so that the sum of the boxes' areas is least: the number of rays that reach a box is as its
 * area, and a cluster takes the same time whether it is full or not. A box takes time in the hierarchy, too, which
 * counts as the area of a triangle's box. */
static int cut(const cutting *k, int a, int b)
{
    float sum[CHUNK + 1]; /* of the best cut of what is before */
    int n = 0;
    sum[0] = 0;
    for (int i = a; i < b; i++) {
        bvh_box all = k->box[k->sorted[i].index];
        const float own = area_of(&all);
        float best = HUGE_VALF;
        for (int j = i; j >= a && j > i - CLUSTER; j--) {
            add_box(&all, &k->box[k->sorted[j].index]);
            const float now = sum[j - a] + area_of(&all) + own;
            if (now <= best) {
                best = now;
                k->size[i] = (unsigned char)(i - j + 1);
            }
        }
        sum[i - a + 1] = best;
    }
    for (int i = b - 1; i >= a; i -= k->size[i], n++)
        k->start[i - k->size[i] + 1] = 1;
    return n;
}

static float widest(const bvh_box *b)
{
    const float x = b->hi[0] - b->lo[0], y = b->hi[1] - b->lo[1], z = b->hi[2] - b->lo[2];
    return (x > y ? x : y) + (x > y ? (y > z ? y : z) : (x > z ? x : z)); /* the two that are widest */
}

/* The clusters of triangles a to b - 1. */
static void fill(const cutting *k, int a, int b, mesh_cluster *to, bvh_box *box)
{
    int n = 0;
    to--, box--;
    for (int i = a; i < b; i++) {
        const int32_t index = (int32_t)k->sorted[i].index;
        if (k->start[i]) {
            to++, box++;
            n = 0;
            *box = k->box[index];
            for (int j = 0; j < CLUSTER; j++) {
                to->index[j] = index;
                to->error[j] = -1;
                memset(to->at, 0, sizeof to->at);
            }
        }
        add_box(box, &k->box[index]);
        for (int c = 0; c < 3; c++) {
            const vec3 p = vec3_scale(vec3_sub(mesh_get(k->d->at[index][c]), k->space->centre), 1 / k->space->radius);
            to->at[c][0][n] = (float)p.x;
            to->at[c][1][n] = (float)p.y;
            to->at[c][2][n] = (float)p.z;
        }
        to->index[n] = index;
        to->error[n++] = error_of(widest(&k->box[index]));
    }
}

/* Cut all chunks, into first[0..chunks]: the number of clusters before each. */
static void cut_all(const cutting *k, int chunks, int threads, int *first)
{
#pragma omp parallel for num_threads(threads) schedule(static)
    for (int c = 0; c < chunks; c++) {
        const int end = (c + 1) * CHUNK;
        first[c + 1] = cut(k, c * CHUNK, end < k->d->n ? end : k->d->n);
    }
    first[0] = 0;
    for (int c = 0; c < chunks; c++)
        first[c + 1] += first[c];
}

static bool make_all(const cutting *k, int threads, mesh_clusters *out, bvh_box **box)
{
    const int n = k->d->n, chunks = (n + CHUNK - 1) / CHUNK;
    int *first = malloc(sizeof *first * ((size_t)chunks + 1));
    if (first) {
        cut_all(k, chunks, threads, first);
        out->n = first[chunks];
        out->cluster = malloc(sizeof *out->cluster * (size_t)out->n);
        *box = malloc(sizeof **box * (size_t)out->n);
    }
    const bool good = first && out->cluster && *box;
#pragma omp parallel for num_threads(threads) schedule(static) if (good)
    for (int c = 0; c < chunks; c++)
        if (good) {
            const int end = (c + 1) * CHUNK;
            fill(k, c * CHUNK, end < n ? end : n, out->cluster + first[c], *box + first[c]);
        }
    free(first);
    return good;
}

bool mesh_clusters_new(const mesh_data *d, const bvh_space *space, int threads, mesh_clusters *out, bvh_box **box)
{
    const size_t n = (size_t)d->n;
    bvh_box *each = malloc(sizeof *each * n);
    key *keys = malloc(sizeof *keys * n), *sorted = malloc(sizeof *sorted * n);
    unsigned char *size = malloc(n), *start = calloc(n, 1);
    const cutting k = {d, space, each, sorted, size, start};
    bool good = each && keys && sorted && size && start;
    *out = (mesh_clusters){0};
    *box = NULL;
    threads = threads_of(threads);
    if (good) {
#pragma omp parallel for num_threads(threads) schedule(static)
        for (int i = 0; i < d->n; i++) {
            each[i] = box_of(d, space, i);
            keys[i] = key_of(&each[i], i);
        }
        sort_keys(d->n, keys, sorted);
        good = make_all(&k, threads, out, box);
    }
    free(each);
    free(keys);
    free(sorted);
    free(size);
    free(start);
    if (!good) {
        mesh_clusters_free(out);
        free(*box);
        *box = NULL;
    }
    return good;
}

void mesh_clusters_free(mesh_clusters *c)
{
    free(c->cluster);
    *c = (mesh_clusters){0};
}
