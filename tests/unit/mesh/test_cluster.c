/* Clusters of triangles and blocks of clusters: each triangle is in one, within its boxes, for any number of threads.
 * The test in float leaves out no triangle that is met, by rays that are aimed at edges and corners, and few others
 * stay; the same of blocks and clusters, of which few stay in a plane. */
#include "support/check.h"

#include <stdlib.h>
#include <string.h>

#include "mesh/cluster.h"
#include "support/random_in.h"

enum { TRIANGLES = 30000 };

/* Small triangles in a ball of radius 7 far from the origin. */
static mesh_data soup(double size)
{
    mesh_data d = {.n = TRIANGLES, .at = memory_new(NULL, sizeof *d.at * TRIANGLES)};
    assert_non_null(d.at);
    for (int k = 0; k < TRIANGLES; k++) {
        const double at[3] = {random_in(-4, 4), random_in(-4, 4), random_in(-4, 4)};
        for (int i = 0; i < 9; i++)
            d.at[k][i / 3][i % 3] = (float)(100 + at[i % 3] + random_in(-size, size));
    }
    return d;
}

static const bvh_space space = {{100, 100, 100}, 7.5};

static void make(const mesh_data *d, int threads, mesh_clusters *c, bvh_box **box)
{
    assert_true(mesh_clusters_new(d, &space, threads, NULL, c, box));
    CHECK(c->n, >, TRIANGLES / 64);
    CHECK(c->n, <, TRIANGLES / 4);
}

/* Where the triangles of cluster k lie within lo and hi of a box, and a block's in its own. */
static void check_inside(const mesh_data *d, int32_t index, const float lo[3], const float hi[3])
{
    const double C[3] = {space.centre.x, space.centre.y, space.centre.z};
    for (int i = 0; i < 3; i++)
        for (int a = 0; a < 3; a++) {
            const double x = ((double)d->at[index][i][a] - C[a]) / space.radius;
            BETWEEN((double)lo[a] + 3e-6, x, (double)hi[a] - 3e-6); /* the boxes have room for rounding */
        }
}

static void test_each_triangle_is_in_one(void **state)
{
    (void)state;
    mesh_data d = soup(0.05);
    mesh_clusters c;
    bvh_box *box;
    unsigned char *seen = calloc(TRIANGLES, 1);
    make(&d, 2, &c, &box);
    int sum = 0, clusters = 0;
    for (int b = 0; b < c.n; b++)
        for (int k = 0; k < CLUSTER && c.block[b].lo[0][k] < 2; k++, clusters++) {
            const mesh_cluster *e = &c.cluster[c.block[b].first + k];
            CHECK(c.block[b].first + k, ==, clusters);
            for (int i = 0; i < CLUSTER && e->error[i] >= 0; i++) {
                const mesh_block *o = &c.block[b];
                CHECK(seen[e->index[i]]++, ==, 0);
                check_inside(&d, e->index[i], (float[]){o->lo[0][k], o->lo[1][k], o->lo[2][k]},
                             (float[]){o->hi[0][k], o->hi[1][k], o->hi[2][k]});
                check_inside(&d, e->index[i], box[b].lo, box[b].hi);
                sum++;
            }
        }
    CHECK(sum, ==, TRIANGLES);
    mesh_clusters_free(&c);
    memory_free(box);
    free(seen);
    memory_free(d.at);
}

static void test_threads_make_the_same(void **state)
{
    (void)state;
    mesh_data d = soup(0.05);
    mesh_clusters one, three;
    bvh_box *box[2];
    make(&d, 1, &one, &box[0]);
    make(&d, 3, &three, &box[1]);
    CHECK(one.n, ==, three.n);
    assert_memory_equal(box[0], box[1], sizeof **box * (size_t)one.n);
    assert_memory_equal(one.block, three.block, sizeof *one.block * (size_t)one.n);
    assert_memory_equal(one.cluster, three.cluster, sizeof *one.cluster * (size_t)one.block[one.n - 1].first);
    mesh_clusters_free(&one);
    mesh_clusters_free(&three);
    memory_free(box[0]);
    memory_free(box[1]);
    memory_free(d.at);
}

/* Ray 0 of k through p and q, in scene units, as packet.c has it. */
static void set_ray(cluster_rays *k, const double p[3], const double q[3])
{
    const double C[3] = {space.centre.x, space.centre.y, space.centre.z};
    double s[3];
    int z = 0;
    for (int a = 0; a < 3; a++) {
        s[a] = q[a] - p[a];
        z = fabs(s[a]) > fabs(s[z]) ? a : z;
    }
    const int x = (z + 1) % 3, y = (z + 2) % 3;
    const double sx = s[x] / s[z], sy = s[y] / s[z];
    k->z[0] = z;
    k->own[0] = -1; /* it starts on no triangle */
    k->sx[0] = (float)sx;
    k->sy[0] = (float)sy;
    k->cx[0] = (float)((p[x] - C[x] - sx * (p[z] - C[z])) / space.radius);
    k->cy[0] = (float)((p[y] - C[y] - sy * (p[z] - C[z])) / space.radius);
}

/* The same as in the hierarchy, from p on. Returns its end there. */
static float set_way(cluster_rays *k, const double p[3], const double q[3])
{
    double from = 0, to = HUGE_VAL;
    float at[3], way[3], end;
    assert_true(bvh_enter(&space, space.radius, (vec3){p[0], p[1], p[2]}, (vec3){q[0] - p[0], q[1] - p[1], q[2] - p[2]},
                          &from, &to, at, way, &end));
    for (int a = 0; a < 3; a++) {
        k->at[a][0] = at[a];
        k->way[a][0] = way[a];
        k->over[a][0] = 1 / (fabsf(way[a]) > 1e-18f ? way[a] : 1e-18f);
    }
    return end;
}

/* A point at barycentric coordinates b and c. */
static void point_in(const float at[3][3], double b, double c, double p[3])
{
    for (int a = 0; a < 3; a++)
        p[a] = (1 - b - c) * (double)at[0][a] + b * (double)at[1][a] + c * (double)at[2][a];
}

/* Through the edges and corners of triangles of one size, from 10 units away. Counts how many of the other triangles of
 * the cluster stay. */
static void aim(double size, double most)
{
    mesh_data d = soup(size);
    mesh_clusters c;
    bvh_box *box;
    cluster_rays k;
    int kept = 0, others = 0;
    make(&d, 1, &c, &box);
    for (int n = 0; n < c.block[c.n - 1].first; n++)
        for (int i = 0; i < CLUSTER && c.cluster[n].error[i] >= 0; i++) {
            const double b = i % 4 == 0 ? 0 : random_in(0, 1), e = i % 4 == 1 ? 0 : 1 - b,
                         from[3] = {100 + random_in(-10, 10), 100 + random_in(-10, 10), 110};
            double p[3];
            uint32_t met[CLUSTER];
            point_in((const float(*)[3])d.at[c.cluster[n].index[i]], b, e, p);
            set_ray(&k, from, p);
            cluster_near(&c.cluster[n], &k, 1, met);
            CHECK(met[i], ==, 1);
            for (int j = 0; j < CLUSTER; j++) {
                kept += j != i && met[j];
                others += j != i && c.cluster[n].error[j] >= 0;
                CHECK(c.cluster[n].error[j] < 0 && met[j], ==, 0);
            }
        }
    CHECK(kept, <, most * others);
    mesh_clusters_free(&c);
    memory_free(box);
    memory_free(d.at);
}

static void test_no_triangle_is_left_out(void **state)
{
    (void)state;
    aim(0.5, 0.5); /* larger than their distances */
    aim(0.05, 0.1);
    aim(0.002, 0.01);
    aim(1e-5, 0.1); /* a unit of float's last place at 100 is 7.6e-6 */
}

/* Through and from the edges and corners of large and small triangles. */
static void test_no_cluster_is_left_out(void **state)
{
    (void)state;
    for (int size = 0; size < 3; size++) {
        mesh_data d = soup(pow(0.02, size));
        mesh_clusters c;
        bvh_box *box;
        cluster_rays k;
        memset(&k, 0, sizeof k);
        make(&d, 1, &c, &box);
        for (int n = 0; n < c.n; n++)
            for (int g = 0; g < CLUSTER && c.block[n].lo[0][g] < 2; g++) {
                const double e = random_in(0, 1), to[3] = {100 + random_in(-9, 9), 100 + random_in(-9, 9), 109};
                float end[BVH_PACKET] = {0};
                uint32_t met[CLUSTER];
                double p[3];
                point_in((const float(*)[3])d.at[c.cluster[c.block[n].first + g].index[0]], g % 3 ? e : 0,
                         g % 2 ? 1 - e : 0, p);
                for (int from = 0; from < 2; from++) {
                    end[0] = from ? set_way(&k, p, to) : set_way(&k, to, p);
                    CHECK(block_pass(&c.block[n], &k, end, 1), ==, 1);
                    block_near(&c.block[n], &k, end, 1, met);
                    CHECK(met[g], ==, 1);
                }
            }
        mesh_clusters_free(&c);
        memory_free(box);
        memory_free(d.at);
    }
}

/* All triangles in a plane across (1, 2, -3), which goes through the middles of boxes. Rays that run along the plane a
 * little above it pass boxes, but no slab; rays in it do. */
static void test_slabs_are_thin(void **state)
{
    (void)state;
    mesh_data d = soup(0.05);
    mesh_clusters c;
    bvh_box *box;
    cluster_rays k;
    memset(&k, 0, sizeof k);
    for (int n = 0; n < 3 * TRIANGLES; n++) {
        float *p = d.at[n / 3][n % 3];
        p[2] = 100 + (p[0] - 100 + 2 * (p[1] - 100)) / 3;
    }
    make(&d, 1, &c, &box);
    for (int above = 0; above < 2; above++) {
        int blocks = 0, clusters = 0;
        const double p[3] = {96, 99.7, 98.4667 + 0.001 * above}, q[3] = {104, 100.3, 101.5333 + 0.001 * above};
        float end[BVH_PACKET] = {0};
        uint32_t met[CLUSTER];
        end[0] = set_way(&k, p, q);
        for (int n = 0; n < c.n; n++) {
            blocks += (int)block_pass(&c.block[n], &k, end, 1);
            block_near(&c.block[n], &k, end, 1, met);
            for (int g = 0; g < CLUSTER; g++)
                clusters += (int)met[g];
        }
        BETWEEN(above ? 0 : 20, blocks, above ? 0 : 1000);
        BETWEEN(above ? 0 : 50, clusters, above ? 0 : 1000);
    }
    mesh_clusters_free(&c);
    memory_free(box);
    memory_free(d.at);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_each_triangle_is_in_one), cmocka_unit_test(test_threads_make_the_same),
        cmocka_unit_test(test_no_triangle_is_left_out), cmocka_unit_test(test_no_cluster_is_left_out),
        cmocka_unit_test(test_slabs_are_thin),
    };
    return cmocka_run_group_tests_name("cluster", tests, NULL, NULL);
}
