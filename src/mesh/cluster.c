/* Clusters of triangles and blocks of clusters: triangles are sorted along Morton's curve, then cut so that the boxes
 * of the pieces are small. */
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

STAGE static void near_triangles(const mesh_cluster *restrict c, const cluster_rays *restrict k, uint32_t which,
                                 uint32_t *restrict met)
{
    for (; which; which &= which - 1) {
        const int r = lowest_bit(which), X = (k->z[r] + 1) % 3, Y = (k->z[r] + 2) % 3, Z = k->z[r];
        const float sx = k->sx[r], sy = k->sy[r], cx = k->cx[r], cy = k->cy[r];
        const uint32_t one = which & -which;
        const int32_t own = k->own[r];
        for (int i = 0; i < CLUSTER; i++) {
            const float za = c->at[0][Z][i], zb = c->at[1][Z][i], zc = c->at[2][Z][i];
            const float xa = c->at[0][X][i] - sx * za - cx, ya = c->at[0][Y][i] - sy * za - cy;
            const float xb = c->at[1][X][i] - sx * zb - cx, yb = c->at[1][Y][i] - sy * zb - cy;
            const float xc = c->at[2][X][i] - sx * zc - cx, yc = c->at[2][Y][i] - sy * zc - cy;
            const float U = xc * yb - yc * xb, V = xa * yc - ya * xc, W = xb * ya - yb * xa, e = c->error[i];
            const float least = lesser_float(lesser_float(U, V), W), most = greater_float(greater_float(U, V), W);
            met[i] |= one & -(uint32_t)(((least >= -e) | (most <= e)) & (c->index[i] != own));
        }
    }
}

bool cluster_near(const mesh_cluster *c, const cluster_rays *k, uint32_t which, uint32_t met[CLUSTER])
{
    uint32_t all = 0;
    memset(met, 0, sizeof *met * CLUSTER);
    near_triangles(c, k, which, met);
    for (int i = 0; i < CLUSTER; i++)
        all |= met[i];
    return all;
}

/* A ray passes a box from t0 to t1, as wrong as Embree's own test: three roundings of each t, for which the boxes have
 * room. There its across . p runs from a to b, and it misses a slab if both are below it or both above. a and b are
 * wrong by 1.2e-6: by 2.4e-7 for across . at, of length 1 (its rounding and that of three operations, 6e-8 each), by
 * the same times t, at most 2, for across . way, and by 3e-7 for their sum. Corners and the slab's sides are wrong
 * by 1.7e-7. */
#define SLAB_MARGIN 4e-6

STAGE static void near_boxes(const mesh_block *restrict c, const cluster_rays *restrict k, const float *restrict end,
                             uint32_t which, uint32_t *restrict met)
{
    for (; which; which &= which - 1) {
        const int r = lowest_bit(which);
        const float ox = k->at[0][r], oy = k->at[1][r], oz = k->at[2][r], last = end[r];
        const float wx = k->way[0][r], wy = k->way[1][r], wz = k->way[2][r];
        const float ix = k->over[0][r], iy = k->over[1][r], iz = k->over[2][r];
        const uint32_t one = which & -which;
        for (int i = 0; i < CLUSTER; i++) {
            const float xa = (c->lo[0][i] - ox) * ix, xb = (c->hi[0][i] - ox) * ix;
            const float ya = (c->lo[1][i] - oy) * iy, yb = (c->hi[1][i] - oy) * iy;
            const float za = (c->lo[2][i] - oz) * iz, zb = (c->hi[2][i] - oz) * iz;
            const float t0 = greater_float(greater_float(lesser_float(xa, xb), lesser_float(ya, yb)),
                                           greater_float(lesser_float(za, zb), 0)),
                        t1 = lesser_float(lesser_float(greater_float(xa, xb), greater_float(ya, yb)),
                                          lesser_float(greater_float(za, zb), last));
            const float nx = c->across[0][i], ny = c->across[1][i], nz = c->across[2][i];
            const float o = nx * ox + ny * oy + nz * oz, w = nx * wx + ny * wy + nz * wz, a = o + t0 * w,
                        b = o + t1 * w;
            const float high = greater_float(a, b), low = lesser_float(a, b);
            met[i] |= one & -(uint32_t)((t0 <= t1) & (high >= c->least[i]) & (low <= c->most[i]));
        }
    }
}

void block_near(const mesh_block *b, const cluster_rays *k, const float end[BVH_PACKET], uint32_t which,
                uint32_t met[CLUSTER])
{
    memset(met, 0, sizeof *met * CLUSTER);
    near_boxes(b, k, end, which, met);
}

enum { SOME = 8 };
static const uint32_t bit[SOME] = {1u << 0, 1u << 1, 1u << 2, 1u << 3, 1u << 4, 1u << 5, 1u << 6, 1u << 7};

/* Of the rays first .. first + SOME - 1. */
STAGE static uint32_t pass_block(const mesh_slab *restrict c, const cluster_rays *restrict k, const float *restrict end,
                                 int first)
{
    const float lx = c->lo[0], ly = c->lo[1], lz = c->lo[2], hx = c->hi[0], hy = c->hi[1], hz = c->hi[2];
    const float nx = c->across[0], ny = c->across[1], nz = c->across[2], least = c->least, most = c->most;
    uint32_t which = 0;
    for (int i = 0; i < SOME; i++) {
        const int r = first + i;
        const float ox = k->at[0][r], oy = k->at[1][r], oz = k->at[2][r];
        const float xa = (lx - ox) * k->over[0][r], xb = (hx - ox) * k->over[0][r];
        const float ya = (ly - oy) * k->over[1][r], yb = (hy - oy) * k->over[1][r];
        const float za = (lz - oz) * k->over[2][r], zb = (hz - oz) * k->over[2][r];
        const float t0 = greater_float(greater_float(lesser_float(xa, xb), lesser_float(ya, yb)),
                                       greater_float(lesser_float(za, zb), 0)),
                    t1 = lesser_float(lesser_float(greater_float(xa, xb), greater_float(ya, yb)),
                                      lesser_float(greater_float(za, zb), end[r]));
        const float o = nx * ox + ny * oy + nz * oz, w = nx * k->way[0][r] + ny * k->way[1][r] + nz * k->way[2][r];
        const float a = o + t0 * w, b = o + t1 * w;
        const float high = greater_float(a, b), low = lesser_float(a, b);
        which |= bit[i] & -(uint32_t)((t0 <= t1) & (high >= least) & (low <= most));
    }
    return which << first;
}

uint32_t block_pass(const mesh_block *b, const cluster_rays *k, const float end[BVH_PACKET], uint32_t which)
{
    uint32_t pass = 0;
    for (int i = 0; i < BVH_PACKET; i += SOME)
        if (which >> i & ((1u << SOME) - 1))
            pass |= pass_block(&b->all, k, end, i);
    return pass & which;
}

/* ---- sorting ---- */

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

enum { CHUNK = 1 << 13 }; /* boxes that are cut by themselves, each chunk by one thread */

/* Cut the n boxes into groups of up to CLUSTER so that the sum of the groups' areas is least: the number of rays that
 * reach a box is as its area, and a group takes the same time whether it is full or not. A group's box is tested as
 * often as that of what is around it is reached; that costs a quarter of the area of CLUSTER boxes. size: of the group
 * that ends behind each box, by the best cut of what is before it. start: 1 where a group starts. */
static void cut(int n, const bvh_box *box, unsigned char *size, unsigned char *start)
{
    float sum[CHUNK + 1]; /* of the best cut of what is before */
    sum[0] = 0;
    for (int i = 0; i < n; i++) {
        bvh_box all = box[i];
        float area[CLUSTER], best = HUGE_VALF; /* of the last 1, 2 .. boxes */
        int most = 0;
        for (; most < CLUSTER && most <= i; most++) {
            add_box(&all, &box[i - most]);
            area[most] = area_of(&all);
        }
        for (int k = 0; k < most; k++)
            if (sum[i - k] + area[k] <= best) {
                best = sum[i - k] + area[k];
                size[i] = (unsigned char)(k + 1);
            }
        sum[i + 1] = best + 0.25f * area[most - 1];
    }
    for (int i = n - 1; i >= 0; i -= size[i])
        start[i - size[i] + 1] = 1;
}

/* Groups of boxes: group g is box[first[g]] to box[first[g + 1] - 1]. `first`: memory_free. NULL: out of memory. */
static int32_t *cut_all(int n, const bvh_box *box, int threads, memory *m, int *groups)
{
    unsigned char *size = memory_new(m, (size_t)n), *start = memory_zeroed(m, (size_t)n);
    int32_t *first = NULL;
    (void)threads; /* without OpenMP */
    *groups = 0;
    if (size && start) {
#pragma omp parallel for num_threads(threads) schedule(static)
        for (int a = 0; a < n; a += CHUNK)
            cut(n - a < CHUNK ? n - a : CHUNK, box + a, size + a, start + a);
        for (int i = 0; i < n; i++)
            *groups += start[i];
        first = memory_new(m, sizeof *first * ((size_t)*groups + 1));
    }
    for (int i = 0, g = 0; first && i <= n; i++)
        if (i == n || start[i])
            first[g++] = i;
    memory_free(size);
    memory_free(start);
    return first;
}

static bvh_box box_of_all(int n, const bvh_box *box)
{
    bvh_box all = box[0];
    for (int i = 1; i < n; i++)
        add_box(&all, &box[i]);
    return all;
}

/* ---- filling ---- */

static float widest(const bvh_box *b)
{
    const float x = b->hi[0] - b->lo[0], y = b->hi[1] - b->lo[1], z = b->hi[2] - b->lo[2];
    return x + y + z - lesser_float(x, lesser_float(y, z)); /* the two that are widest */
}

static mesh_cluster cluster_of(const mesh_data *d, const bvh_space *space, int n, const key *sorted, const bvh_box *box)
{
    mesh_cluster to;
    memset(&to, 0, sizeof to);
    for (int i = 0; i < CLUSTER; i++) {
        const int32_t index = (int32_t)sorted[i < n ? i : 0].index;
        to.index[i] = index;
        to.error[i] = i < n ? error_of(widest(&box[i])) : -1;
        for (int c = 0; c < 3 && i < n; c++) {
            const vec3 p = vec3_scale(vec3_sub(mesh_get(d->at[index][c]), space->centre), 1 / space->radius);
            to.at[c][0][i] = (float)p.x;
            to.at[c][1][i] = (float)p.y;
            to.at[c][2][i] = (float)p.z;
        }
    }
    return to;
}

static vec3 corner_of(const mesh_cluster *c, int i, int k)
{
    return (vec3){(double)c->at[k][0][i], (double)c->at[k][1][i], (double)c->at[k][2][i]};
}

/* A slab about some clusters, across the mean of their triangles' normals. */
static void set_slab(int n, const mesh_cluster *c, mesh_slab *to)
{
    vec3 sum = {0, 0, 0};
    for (int g = 0; g < n; g++)
        for (int i = 0; i < CLUSTER && c[g].error[i] >= 0; i++) {
            const vec3 a = corner_of(&c[g], i, 0);
            sum = vec3_add(sum, vec3_cross(vec3_sub(corner_of(&c[g], i, 1), a), vec3_sub(corner_of(&c[g], i, 2), a)));
        }
    const double l = vec3_length(sum), over = l > 1e-30 ? 1 / l : 0;
    to->across[0] = (float)(sum.x * over), to->across[1] = (float)(sum.y * over), to->across[2] = (float)(sum.z * over);
    const vec3 m = mesh_get(to->across);
    double least = HUGE_VAL, most = -HUGE_VAL;
    for (int g = 0; g < n; g++)
        for (int i = 0; i < CLUSTER && c[g].error[i] >= 0; i++)
            for (int k = 0; k < 3; k++) {
                const double d = vec3_dot(m, corner_of(&c[g], i, k));
                least = lesser(least, d);
                most = greater(most, d);
            }
    to->least = (float)(least - SLAB_MARGIN);
    to->most = (float)(most + SLAB_MARGIN);
}

static mesh_block block_of(int n, const bvh_box *box, const mesh_cluster *c, int32_t first)
{
    mesh_block to = {.first = first};
    const bvh_box all = box_of_all(n, box);
    memcpy(to.all.lo, all.lo, sizeof all.lo);
    memcpy(to.all.hi, all.hi, sizeof all.hi);
    set_slab(n, c, &to.all);
    for (int i = 0; i < CLUSTER; i++) {
        mesh_slab one = {.lo = {2, 2, 2}, .hi = {2, 2, 2}}; /* beyond all rays */
        if (i < n) {
            memcpy(one.lo, box[i].lo, sizeof one.lo);
            memcpy(one.hi, box[i].hi, sizeof one.hi);
            set_slab(1, &c[i], &one);
        }
        for (int a = 0; a < 3; a++) {
            to.lo[a][i] = one.lo[a];
            to.hi[a][i] = one.hi[a];
            to.across[a][i] = one.across[a];
        }
        to.least[i] = one.least;
        to.most[i] = one.most;
    }
    return to;
}

/* The triangles' boxes, sorted. */
static bool sort_triangles(const mesh_data *d, const bvh_space *space, int threads, memory *m, key *sorted,
                           bvh_box *box)
{
    key *keys = memory_new(m, sizeof *keys * (size_t)d->n);
    if (!keys)
        return false;
    (void)threads; /* without OpenMP */
#pragma omp parallel for num_threads(threads) schedule(static)
    for (int i = 0; i < d->n; i++) {
        const bvh_box b = box_of(d, space, i);
        keys[i] = key_of(&b, i);
    }
    sort_keys(d->n, keys, sorted);
#pragma omp parallel for num_threads(threads) schedule(static)
    for (int i = 0; i < d->n; i++)
        box[i] = box_of(d, space, (int32_t)sorted[i].index);
    memory_free(keys);
    return true;
}

/* From sorted triangles. box: of each; becomes those of the clusters, and then of the blocks. */
static bool make(const mesh_data *d, const bvh_space *space, int threads, memory *m, const key *sorted, bvh_box *box,
                 mesh_clusters *out)
{
    int clusters, blocks;
    int32_t *first = cut_all(d->n, box, threads, m, &clusters);
    out->cluster = first ? memory_new(m, sizeof *out->cluster * (size_t)clusters) : NULL;
    if (out->cluster) {
#pragma omp parallel for num_threads(threads) schedule(static)
        for (int g = 0; g < clusters; g++)
            out->cluster[g] = cluster_of(d, space, first[g + 1] - first[g], sorted + first[g], box + first[g]);
        for (int g = 0; g < clusters; g++) /* first[g] >= g */
            box[g] = box_of_all(first[g + 1] - first[g], box + first[g]);
        memory_free(first);
        first = cut_all(clusters, box, threads, m, &blocks);
        out->block = first ? memory_new(m, sizeof *out->block * (size_t)blocks) : NULL;
    }
    if (out->block) {
        out->n = blocks;
#pragma omp parallel for num_threads(threads) schedule(static)
        for (int g = 0; g < blocks; g++)
            out->block[g] = block_of(first[g + 1] - first[g], box + first[g], &out->cluster[first[g]], first[g]);
        for (int g = 0; g < blocks; g++) /* first[g] >= g */
            box[g] = box_of_all(first[g + 1] - first[g], box + first[g]);
    }
    memory_free(first);
    return out->block;
}

bool mesh_clusters_new(const mesh_data *d, const bvh_space *space, int threads, const progress *w, mesh_clusters *out,
                       bvh_box **box)
{
    memory *m = progress_memory(w);
    key *sorted = memory_new(m, sizeof *sorted * (size_t)d->n);
    *out = (mesh_clusters){0};
    *box = memory_new(m, sizeof **box * (size_t)d->n);
    threads = threads_of(threads);
    const bool good = sorted && *box && sort_triangles(d, space, threads, m, sorted, *box) &&
                      make(d, space, threads, m, sorted, *box, out);
    memory_free(sorted);
    if (good)
        return true;
    mesh_clusters_free(out);
    memory_free(*box);
    *box = NULL;
    return false;
}

void mesh_clusters_free(mesh_clusters *c)
{
    memory_free(c->cluster);
    memory_free(c->block);
    *c = (mesh_clusters){0};
}
