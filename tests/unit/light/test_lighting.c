/* Where shadow rays go, and how much of a light's colour arrives. */
#include "support/check.h"
#include "light/lighting.h"
#include "wave/lane.h"

/* A lane straight below the eye at height 8, whose ray meets y = 0 at t = 2 in (x, 0, 0). */
static void lane_over(hit_group *g, int i, double x)
{
    hit_group_picked(g);
    lane_set(&g->picked.x.r, i, (bs_vec3){(real)x, 8, 0});
    lane_set(&g->picked.x.s, i, (bs_vec3){0, -4, 0});
    g->picked.t[i] = 2;
    g->t0[i] = R(1.5);
    g->lit[i] = 1;
}

static light lamp(light_kind kind)
{
    return (light){.kind = kind, .at = {0, 4, 0}, .axis = {0, -1, 0}, .samples = {1, 1}};
}

static void aim_from_either_place(void **state)
{
    static hit_group g;
    const light l = lamp(LIGHT_POINT);
    (void)state;
    g.n = 1;
    lane_over(&g, 0, 3);
    lighting_aim(&l, g.t, &g);
    CHECK(g.to_light.r.y[0], ==, 0);
    CHECK(g.to_light.s.x[0], ==, -3);
    CHECK(g.to_light.s.y[0], ==, 4);
    lighting_aim(&l, g.t0, &g);
    CHECK(g.to_light.r.y[0], ==, 2);
    CHECK(g.to_light.s.y[0], ==, 2);
}

/* A parallel light shines straight down, from its plane on. */
static void aim_against_parallel_light(void **state)
{
    static hit_group g;
    const light l = lamp(LIGHT_PARALLEL);
    (void)state;
    g.n = 1;
    lane_over(&g, 0, 3);
    lighting_aim(&l, g.t, &g);
    CHECK(g.to_light.s.x[0], ==, 0);
    CHECK(g.to_light.s.y[0], ==, 4);
}

/* 2/(1 + (d/fade_distance)^power): 1 at the fade distance, 2/5 at twice that with the power 2. */
static void fading(void **state)
{
    static hit_group g;
    light l = lamp(LIGHT_POINT);
    (void)state;
    l.fade_power = 2;
    l.fade_distance = 4;
    g.n = 1;
    lane_over(&g, 0, 0);
    lighting_fade(&l, &g);
    NEAR(g.lit[0], 1, 4 * EPS);
    l.fade_distance = 2;
    lane_over(&g, 0, 0);
    lighting_fade(&l, &g);
    NEAR(g.lit[0], 0.4, 4 * EPS);
}

/* 45 degrees off the axis: within the radius all of it, beyond the falloff none, half of it amid the two cosines. */
static void spot_edges(void **state)
{
    static hit_group g;
    light l = lamp(LIGHT_SPOT);
    const double degree = 3.14159265358979323846 / 180, at45 = cos(45 * degree);
    const double radius[] = {50, 20, acos(at45 + 0.1) / degree}, falloff[] = {60, 40, acos(at45 - 0.1) / degree};
    const double want[] = {1, 0, 0.5};
    (void)state;
    g.n = 1;
    for (int k = 0; k < 3; k++) {
        l.radius = radius[k];
        l.falloff = falloff[k];
        lane_over(&g, 0, 4);
        lighting_fade(&l, &g);
        NEAR(g.lit[0], want[k], 20 * EPS);
    }
}

/* The highlights of a spot's axis: cos^tightness. */
static void spot_tightness(void **state)
{
    static hit_group g;
    light l = lamp(LIGHT_SPOT);
    (void)state;
    l.radius = 50;
    l.falloff = 60;
    l.tightness = 4;
    g.n = 1;
    lane_over(&g, 0, 4);
    lighting_fade(&l, &g);
    NEAR(g.lit[0], 0.25, 4 * EPS);
}

static void adding_shares(void **state)
{
    static hit_group g;
    static vec3s tints;
    real sum[LANES] = {R(0.25)};
    (void)state;
    g.n = 1;
    g.lit[0] = R(0.5);
    lane_set(&g.tint, 0, (bs_vec3){1, R(0.5), 0});
    lighting_add(&g, R(0.5), sum);
    CHECK(sum[0], ==, 0.5);
    lighting_add_tint(&g, R(0.5), &tints);
    CHECK(tints.x[0], ==, 0.25);
    CHECK(tints.y[0], ==, 0.125);
    CHECK(tints.z[0], ==, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(aim_from_either_place),
        cmocka_unit_test(aim_against_parallel_light),
        cmocka_unit_test(fading),
        cmocka_unit_test(spot_edges),
        cmocka_unit_test(spot_tightness),
        cmocka_unit_test(adding_shares),
    };
    return cmocka_run_group_tests_name("lighting", tests, NULL, NULL);
}
