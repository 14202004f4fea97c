/* Groups are taken out of a wave and put back at their places. */
#include "support/check.h"
#include "wave/gather.h"
#include "wave/lane.h"

/* Lane i meets object i % 3 at t = i; every seventh lane meets nothing. */
static void mixed_wave(rays *x, hits *h)
{
    gather_begin(LANES, h);
    for (int i = 0; i < LANES; i++) {
        lane_set(&x->r, i, (bs_vec3){(real)i, 2, 3});
        lane_set(&x->s, i, (bs_vec3){(real)-i, 5, 6});
        if (i % 7 == 0)
            continue;
        h->id[i] = i % 3;
        h->t[i] = (real)i;
        h->part[i] = 10 * i;
    }
}

static void begins_without_hits(void **state)
{
    static hits h;
    (void)state;
    gather_begin(LANES, &h);
    CHECK(h.id[5], ==, -1);
    CHECK(h.t[5], ==, REAL_FAR);
}

static void groups_are_of_one_object(void **state)
{
    static rays x;
    static hits h;
    static hit_group g;
    int seen = 0, groups = 0;
    int32_t id;
    (void)state;
    mixed_wave(&x, &h);
    while ((id = gather_next_group(LANES, &x, &h, &g)) >= 0) {
        groups++;
        seen += g.n;
        for (int k = 0; k < g.n; k++) {
            const int i = hit_group_place(&g, k);
            CHECK(i % 3, ==, id);
            CHECK(g.t[k], ==, i);
            CHECK(g.part[k], ==, 10 * i);
            CHECK(g.x->s.x[k], ==, -i);
        }
    }
    assert_int_equal(groups, 3);
    assert_int_equal(seen, LANES - (LANES + 6) / 7);
}

static void scatter_undoes_gather(void **state)
{
    static rays x;
    static hits h;
    static hit_group g;
    static vec3s back;
    real t[LANES];
    (void)state;
    mixed_wave(&x, &h);
    const hits before = h;
    for (int i = 0; i < LANES; i++)
        t[i] = REAL_FAR;
    while (gather_next_group(LANES, &x, &h, &g) >= 0) {
        scatter(&g, g.t, t);
        scatter_vec3s(&g, &g.x->r, &back);
    }
    for (int i = 0; i < LANES; i++) {
        CHECK(t[i], ==, before.t[i]);
        CHECK(back.x[i], ==, before.id[i] < 0 ? 0 : i);
    }
}

/* A group that is the whole wave has no list of lanes. */
static void a_whole_wave(void **state)
{
    static rays x;
    static hits h;
    static hit_group g;
    real t[LANES];
    (void)state;
    mixed_wave(&x, &h);
    for (int i = 0; i < LANES; i++)
        h.id[i] = 4;
    assert_int_equal(gather_next_group(LANES, &x, &h, &g), 4);
    assert_true(g.whole);
    scatter(&g, g.t, t);
    assert_memory_equal(t, h.t, sizeof t);
    assert_int_equal(gather_next_group(LANES, &x, &h, &g), -1);
}

/* A ray that meets the object it has left begins where it left that; any other where it was sent from. */
static void own_origins(void **state)
{
    static rays x;
    static hits h;
    static ray_origins from;
    int32_t own[LANES];
    (void)state;
    mixed_wave(&x, &h);
    for (int i = 0; i < LANES; i++) {
        from.id[i] = 1;
        lane_set(&from.at, i, (bs_vec3){-1, -1, -1});
    }
    for (int i = 0; i < LANES; i++)
        own[i] = h.id[i] == 1;
    gather_move_origins(LANES, &from, own, &x);
    CHECK(x.r.x[1], ==, -1); /* met object 1 */
    CHECK(x.r.x[2], ==, 2);  /* met object 2 */
    CHECK(x.r.x[7], ==, 7);  /* met nothing */
}

static void some_rays(void **state)
{
    static rays x, y;
    static hits h;
    const int32_t lane[] = {3, 9, 40};
    (void)state;
    mixed_wave(&x, &h);
    gather_rays(3, lane, &x, &y);
    for (int k = 0; k < 3; k++) {
        CHECK(y.r.x[k], ==, lane[k]);
        CHECK(y.s.x[k], ==, -lane[k]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(begins_without_hits),   cmocka_unit_test(groups_are_of_one_object),
        cmocka_unit_test(scatter_undoes_gather), cmocka_unit_test(a_whole_wave),
        cmocka_unit_test(own_origins),           cmocka_unit_test(some_rays),
    };
    return cmocka_run_group_tests_name("gather", tests, NULL, NULL);
}
