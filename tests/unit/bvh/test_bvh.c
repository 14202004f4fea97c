/* The hierarchy against brute force: each box that is met must be among the candidates, and the candidates must not be
 * much more than that. */
#include "support/check.h"

#include <stdlib.h>
#include <string.h>

#include "bvh/bvh.h"
#include "support/random_in.h"
#if KAGE_EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

enum { BOXES = 500, TRIES = 400 };

static bvh_box box[BOXES];
static bvh *tree;

static float coordinate(void) { return (float)random_in(-1, 1); }

static int set_up(void **state)
{
    (void)state;
    for (int i = 0; i < BOXES; i++)
        for (int k = 0; k < 3; k++) {
            box[i].lo[k] = coordinate();
            box[i].hi[k] = box[i].lo[k] + (float)random_in(0, 0.5);
        }
    tree = bvh_new(BOXES, box, 1, NULL);
    return tree ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    bvh_free(tree);
    return 0;
}

/* Is some r + s t, 0 <= t <= end, in the box made wider by `margin`? *at: the smallest such t. */
static bool passes(const bvh_box *b, const float r[3], const float s[3], double end, double margin, double *at)
{
    double from = 0, to = end;
    for (int k = 0; k < 3; k++) {
        const double x = ((double)b->lo[k] - margin - (double)r[k]) / (double)s[k];
        const double y = ((double)b->hi[k] + margin - (double)r[k]) / (double)s[k];
        from = fmax(from, fmin(x, y));
        to = fmin(to, fmax(x, y));
    }
    *at = from;
    return from <= to;
}

static double distance(const bvh_box *b, const float p[3])
{
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        const double d = fmax(0, fmax((double)b->lo[k] - (double)p[k], (double)p[k] - (double)b->hi[k]));
        sum += d * d;
    }
    return sqrt(sum);
}

static void count_visit(void *user, int32_t i) { ((int *)user)[i]++; }

static void random_ray(float r[3], float s[3])
{
    for (int k = 0; k < 3; k++) {
        r[k] = 1.2f * coordinate();
        s[k] = coordinate();
    }
}

static void test_along_visits_the_boxes_that_are_passed(void **state)
{
    int met = 0;
    (void)state;
    for (int i = 0; i < TRIES; i++) {
        int seen[BOXES] = {0};
        float r[3], s[3];
        double at;
        random_ray(r, s);
        const float end = (float)random_in(0.1, 3);
        bvh_along(tree, r, s, end, count_visit, seen);
        for (int k = 0; k < BOXES; k++) {
            if (passes(&box[k], r, s, (double)end, -1e-5, &at))
                CHECK(seen[k], ==, 1);
            if (!passes(&box[k], r, s, (double)end, 1e-5, &at))
                CHECK(seen[k], ==, 0);
            met += seen[k];
        }
    }
    CHECK(met, >, 2 * TRIES);
}

/* The nearest box so far. */
typedef struct search {
    const float *r, *s;
    double nearest;
    int visits;
} search;

static float note_nearest(void *user, int32_t i, float end)
{
    search *k = user;
    double at;
    k->visits++;
    if (passes(&box[i], k->r, k->s, (double)end, 0, &at) && at < k->nearest)
        k->nearest = at;
    return k->nearest < (double)end ? (float)k->nearest : end;
}

/* What each ray of a packet has met. */
typedef struct packet_seen {
    int box[BVH_PACKET][BOXES];
    int calls;
} packet_seen;

static bool count_meeting(void *user, int32_t i, uint32_t which, float end[BVH_PACKET])
{
    packet_seen *seen = user;
    (void)end;
    CHECK(which, !=, 0);
    seen->calls++;
    for (int k = 0; k < BVH_PACKET; k++)
        seen->box[k][i] += (int)(which >> k & 1);
    return false;
}

/* Rays near each other (wide: not at all), of which each third is none, if `some`. */
static void random_packet(bvh_packet *x, double wide, bool some)
{
    float r[3], s[3];
    random_ray(r, s);
    for (int i = 0; i < BVH_PACKET; i++) {
        for (int k = 0; k < 3; k++) {
            x->at[k][i] = r[k] + (float)random_in(-wide, wide);
            x->way[k][i] = s[k] + (float)random_in(-wide, wide);
        }
        x->end[i] = some && i % 3 == 1 ? -1 : (float)random_in(0.1, 3);
    }
}

/* Embree takes 4, 8 or 16 rays at a time, by processor. Where they are near each other, 0.36, 0.19 and 0.09 of the
 * calls are left of those for single rays. */
static double shared_calls(void)
{
    RTCDevice d = rtcNewDevice("threads=1");
    const bool by_8 = rtcGetDeviceProperty(d, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED),
               by_16 = rtcGetDeviceProperty(d, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED);
    rtcReleaseDevice(d);
    return by_16 ? 0.125 : by_8 ? 0.25 : 0.4;
}

/* Against brute force. At most a share `shared` of calls is left of those for single rays. */
static void check_packets(double wide, double shared)
{
    int met = 0, calls = 0;
    for (int i = 0; i < TRIES; i++) {
        packet_seen seen = {.calls = 0};
        bvh_packet x;
        random_packet(&x, wide, i % 2);
        const bvh_packet was = x;
        bvh_packet_toward(tree, &x, count_meeting, &seen);
        for (int l = 0; l < BVH_PACKET; l++) {
            const float r[3] = {x.at[0][l], x.at[1][l], x.at[2][l]}, s[3] = {x.way[0][l], x.way[1][l], x.way[2][l]};
            double at;
            CHECK(x.end[l], ==, was.end[l]);
            for (int k = 0; k < BOXES; k++) {
                if (x.end[l] >= 0 && passes(&box[k], r, s, (double)x.end[l], -1e-5, &at))
                    CHECK(seen.box[l][k], ==, 1);
                BETWEEN(0, seen.box[l][k], x.end[l] >= 0);
                met += seen.box[l][k];
            }
        }
        calls += seen.calls;
    }
    CHECK(met, >, 2 * TRIES);
    CHECK(calls, <, shared * met);
}

static void test_packets_visit_what_their_rays_do(void **state)
{
    (void)state;
    check_packets(0.01, shared_calls());
    check_packets(1, 1);
}

/* A packet's search for the nearest box of each ray. */
typedef struct packet_search {
    const bvh_packet *x;
    double nearest[BVH_PACKET];
    int visits;
} packet_search;

static bool note_nearest_each(void *user, int32_t i, uint32_t which, float end[BVH_PACKET])
{
    packet_search *k = user;
    for (int l = 0; l < BVH_PACKET; l++) {
        if (!(which >> l & 1))
            continue;
        const float r[3] = {k->x->at[0][l], k->x->at[1][l], k->x->at[2][l]},
                    s[3] = {k->x->way[0][l], k->x->way[1][l], k->x->way[2][l]};
        search one = {r, s, k->nearest[l], 0};
        end[l] = note_nearest(&one, i, end[l]);
        k->nearest[l] = one.nearest;
        k->visits++;
    }
    return true;
}

static bool count_all(void *user, int32_t i, uint32_t which, float end[BVH_PACKET])
{
    (void)i;
    (void)end;
    *(int *)user += __builtin_popcount(which);
    return false;
}

/* A ray that has met a box meets few of those behind it: 0.27 to 0.38 of the visits are left, by processor. */
static void test_packets_find_the_nearest_boxes(void **state)
{
    int visits = 0, all = 0;
    (void)state;
    for (int i = 0; i < TRIES; i++) {
        bvh_packet x;
        random_packet(&x, i % 2 ? 1 : 0.01, i % 4 > 1);
        const bvh_packet was = x;
        bvh_packet_toward(tree, &x, count_all, &all);
        packet_search k = {.x = &x};
        for (int l = 0; l < BVH_PACKET; l++)
            k.nearest[l] = (double)x.end[l];
        bvh_packet_toward(tree, &x, note_nearest_each, &k);
        for (int l = 0; l < BVH_PACKET; l++) {
            const float r[3] = {x.at[0][l], x.at[1][l], x.at[2][l]}, s[3] = {x.way[0][l], x.way[1][l], x.way[2][l]};
            double nearest = (double)was.end[l], at;
            for (int b = 0; b < BOXES && nearest >= 0; b++)
                if (passes(&box[b], r, s, (double)was.end[l], 0, &at))
                    nearest = fmin(nearest, at);
            NEAR(k.nearest[l], nearest, 1e-5);
        }
        visits += k.visits;
    }
    CHECK(visits, <, 0.43 * all);
}

static bool stop_odd(void *user, int32_t i, uint32_t which, float end[BVH_PACKET])
{
    (void)i;
    for (int l = 0; l < BVH_PACKET; l++) {
        ((int *)user)[l] += (int)(which >> l & 1);
        end[l] = l % 2 && which >> l & 1 ? -1 : end[l];
    }
    return true;
}

static void test_packets_stop_rays(void **state)
{
    int seen[BVH_PACKET] = {0};
    bvh_packet x;
    (void)state;
    for (int l = 0; l < BVH_PACKET; l++)
        for (int k = 0; k < 3; k++) {
            x.at[k][l] = k == 0 ? -3.0f : 0.001f * (float)l;
            x.way[k][l] = k == 0 ? 1.0f : 0.01f * (float)k;
            x.end[l] = 9;
        }
    bvh_packet_toward(tree, &x, stop_odd, seen);
    for (int l = 0; l < BVH_PACKET; l++) {
        CHECK(x.end[l] < 0, ==, l % 2);
        if (l % 2)
            BETWEEN(1, seen[l], seen[l - 1] - 1);
    }
}

/* Embree's threads change nothing. */
static void test_threads_build_the_same(void **state)
{
    enum { MANY = 20000, RAYS = 100 };
    (void)state;
    bvh_box *many = malloc(sizeof *many * MANY);
    int *seen[2] = {calloc(MANY, sizeof(int)), calloc(MANY, sizeof(int))};
    for (int i = 0; i < MANY; i++)
        for (int k = 0; k < 3; k++) {
            many[i].lo[k] = coordinate();
            many[i].hi[k] = many[i].lo[k] + 0.02f;
        }
    for (int t = 0; t < 2; t++) {
        bvh *b = bvh_new(MANY, many, 1 + 2 * t, NULL);
        assert_non_null(b);
        for (int i = 0; i < RAYS; i++) {
            const float x = 0.019f * (float)i - 0.95f;
            bvh_along(b, (float[]){x, -3, 0.1f}, (float[]){0.01f, 1, 0.02f}, 9, count_visit, seen[t]);
        }
        bvh_free(b);
    }
    int sum = 0;
    for (int i = 0; i < MANY; i++) {
        CHECK(seen[0][i], ==, seen[1][i]);
        sum += seen[0][i];
    }
    CHECK(sum, >, RAYS);
    free(many);
    free(seen[0]);
    free(seen[1]);
}

static void test_around_visits_the_boxes_within_the_radius(void **state)
{
    int met = 0;
    (void)state;
    for (int i = 0; i < TRIES; i++) {
        int seen[BOXES] = {0};
        const float p[3] = {coordinate(), coordinate(), coordinate()};
        const double radius = random_in(0.05, 0.5);
        bvh_around(tree, p, (float)radius, count_visit, seen);
        for (int k = 0; k < BOXES; k++) {
            if (distance(&box[k], p) < radius - 1e-5)
                CHECK(seen[k], ==, 1);
            met += seen[k];
        }
    }
    CHECK(met, >, 5 * TRIES);
}

static void test_no_boxes(void **state)
{
    (void)state;
    int seen = 0;
    bvh *none = bvh_new(0, NULL, 1, NULL);
    assert_non_null(none);
    bvh_along(none, (float[]){0, 0, 0}, (float[]){1, 0, 0}, 1, count_visit, &seen);
    bvh_around(none, (float[]){0, 0, 0}, 1, count_visit, &seen);
    CHECK(seen, ==, 0);
    bvh_free(none);
}

/* ---- the space ---- */

static const double low[3] = {999, -5, 20}, high[3] = {1003, 3, 26};

static void test_space_has_the_centre_and_the_half_diagonal(void **state)
{
    (void)state;
    const bvh_space p = bvh_space_about(low, high);
    NEAR(p.centre.x, 1001, 1e-12);
    NEAR(p.centre.y, -1, 1e-12);
    NEAR(p.centre.z, 23, 1e-12);
    NEAR(p.radius, sqrt(4 + 16 + 9), 1e-12);
}

static void test_space_makes_boxes_wider(void **state)
{
    (void)state;
    const bvh_space p = bvh_space_about(low, high);
    const bvh_box b = bvh_box_in(&p, low, high);
    CHECK((double)b.lo[0], <, -2 / p.radius);
    CHECK((double)b.hi[1], >, 4 / p.radius);
    NEAR(b.hi[2], 3 / p.radius, 1e-5);
}

static void test_enter_cuts_a_ray_to_the_sphere(void **state)
{
    (void)state;
    const bvh_space p = bvh_space_about(low, high);
    double from = 0, to = 1e9;
    float at[3], way[3], end;
    assert_true(bvh_enter(&p, p.radius, (vec3){1001, -1, -1e6}, (vec3){0, 0, 2}, &from, &to, at, way, &end));
    NEAR(from, 0.5 * (1e6 + 23 - p.radius), 1e-3);
    NEAR(to, 0.5 * (1e6 + 23 + p.radius), 1e-3);
    NEAR(at[2], -1, 2e-5);
    NEAR(way[2], 1, 1e-7);
    NEAR(end, 2, 4e-5);
}

static void test_enter_keeps_the_callers_ends(void **state)
{
    (void)state;
    const bvh_space p = bvh_space_about(low, high);
    double from = 1, to = 1.5;
    float at[3], way[3], end;
    assert_true(bvh_enter(&p, p.radius, (vec3){1001, -1, 22}, (vec3){0, 0, 1}, &from, &to, at, way, &end));
    CHECK(from, ==, 1);
    CHECK(to, ==, 1.5);
    NEAR(at[2], 0, 1e-7);
    NEAR(end, 0.5 / p.radius, 1e-5);
}

static void test_enter_refuses_what_misses(void **state)
{
    (void)state;
    const bvh_space p = bvh_space_about(low, high);
    static const vec3 r[] = {{1001, 5, -9}, {1001, -1, 40}, {1001, -1, -9}, {1001, (double)NAN, -9}};
    static const vec3 s[] = {{0, 0, 1}, {0, 0, 1}, {0, 0, 0}, {0, 0, 1}};
    for (int i = 0; i < 4; i++) { /* beside it, behind it, without direction, NaN */
        double from = 0, to = 1e9;
        float at[3], way[3], end;
        CHECK(bvh_enter(&p, p.radius, r[i], s[i], &from, &to, at, way, &end), ==, 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_along_visits_the_boxes_that_are_passed),
        cmocka_unit_test(test_packets_visit_what_their_rays_do),
        cmocka_unit_test(test_packets_find_the_nearest_boxes),
        cmocka_unit_test(test_packets_stop_rays),
        cmocka_unit_test(test_threads_build_the_same),
        cmocka_unit_test(test_around_visits_the_boxes_within_the_radius),
        cmocka_unit_test(test_no_boxes),
        cmocka_unit_test(test_space_has_the_centre_and_the_half_diagonal),
        cmocka_unit_test(test_space_makes_boxes_wider),
        cmocka_unit_test(test_enter_cuts_a_ray_to_the_sphere),
        cmocka_unit_test(test_enter_keeps_the_callers_ends),
        cmocka_unit_test(test_enter_refuses_what_misses),
    };
    return cmocka_run_group_tests_name("bvh", tests, set_up, tear_down);
}
