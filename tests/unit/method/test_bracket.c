/* The brackets of the method auto, and the search in them, against a fine march along each ray; and its name.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "wave/lane.h"
#include "support/check.h"
#include "support/function_bump.h"
#include "support/random_in.h"
#include "method/bracket.h"
#include "method/method.h"
#include "method/shift.h"
#include "geometry/surface.h"

/* A wave of rays that come down (side 1), or up from behind (-1), to a surface whose top is at y = 0, and all that
 * precedes the shift. */
static hit_group *wave(const surface *f, const bump *P, double side)
{
    static hit_group g;
    hits h;
    g.n = LANES;
    hit_group_picked(&g);
    for (int i = 0; i < LANES; i++) {
        double x = random_in(-0.3, 0.3), z = random_in(-0.3, 0.3);
        lane_set(&g.picked.x.s, i,
                 (bs_vec3){(real)random_in(-1, 1), (real)(-side * random_in(0.4, 1)), (real)random_in(-1, 1)});
        g.picked.x.r.x[i] = (real)x - 2 * g.x->s.x[i];
        g.picked.x.r.y[i] = R(-0.05) - 2 * g.x->s.y[i];
        g.picked.x.r.z[i] = (real)z - 2 * g.x->s.z[i];
        h.t[i] = REAL_FAR;
        h.id[i] = -1;
        h.part[i] = 0;
    }
    f->ops->hit(f, LANES, g.x, 0, &h);
    for (int i = 0; i < LANES; i++)
        assert_int_equal(h.id[i], 0);
    memcpy(g.picked.t, h.t, sizeof g.picked.t);
    memset(g.part, 0, sizeof g.part);
    f->ops->locate(f, LANES, g.x, g.t, g.part, g.u, g.w);
    f->ops->eval(f, LANES, g.part, g.u, g.w, 2, &g.q);
    P->ops->eval(P, LANES, g.u, g.w, 3, &g.bump);
    shift_normals(&g, P);
    return &g;
}

/* The first crossing on lane i, by 1024 steps of the method march. */
static void fine(const hit_group *from, const bump *P, real *tau, int32_t *order)
{
    static hit_group g;
    g = *from;
    shift_group(&g, P, (method){METHOD_MARCH, METHOD_STEPS_MAX}, true);
    memcpy(tau, g.tau, sizeof g.tau);
    memcpy(order, g.order, sizeof g.order);
}

static surface *plane(void) { return plane_new((vec3){0, 0, 0}, (vec3){0, 0, 1}, (vec3){1, 0, 0}, false); }

static const char *const texts[] = {"0.03*sin(9*u)*cos(8*w)", "0.02 + 0.02*sin(13*u + 5*w)", "-0.05 + 0.01*sin(20*w)"};
enum { TEXTS = sizeof texts / sizeof *texts };

/* The fine march's place is in each bracket, to its own error; and the brackets are no wider than the slab. */
static void brackets_hold_the_place(void **state)
{
    surface *const f[] = {plane(), sphere_new((vec3){0, -3, 0}, 3)};
    (void)state;
    for (int k = 0; k < 2; k++)
        for (int p = 0; p < TEXTS; p++)
            for (int behind = 0; behind < 2; behind++) {
                bump *P = function(texts[p]);
                hit_group *g = wave(f[k], P, behind ? -1 : 1);
                brackets b;
                real tau[LANES];
                int32_t order[LANES];
                int held = 0;
                fine(g, P, tau, order);
                bracket_begin(g, P, f[k]->ops->flat, &b);
                for (int i = 0; i < LANES; i++) {
                    double width = ((double)P->Pmax - (double)P->Pmin) / fabs((double)b.sn[i]);
                    if (order[i] != 5)
                        continue;
                    held++;
                    BETWEEN((double)b.front[i] - 1e-3 * width, tau[i], (double)b.back[i] + 1e-3 * width);
                    if (f[k]->ops->flat)
                        CHECK(b.back[i] - b.front[i], <=, width * 1.0001);
                }
                CHECK(held, >, LANES / 2);
                bump_free(P);
            }
    surface_free(f[0]);
    surface_free(f[1]);
}

/* The search finds the fine march's place to the error, all lanes at once or a few. */
static void search_finds_the_place(void **state)
{
    const search_steps steps = {1, 1, 16};
    surface *f = plane();
    (void)state;
    for (int p = 0; p < TEXTS; p++) {
        bump *P = function(texts[p]);
        hit_group *g = wave(f, P, 1);
        brackets b;
        places all, few;
        real tau[LANES];
        int32_t order[LANES], lane[LANES];
        fine(g, P, tau, order);
        bracket_begin(g, P, true, &b);
        for (int i = 0; i < LANES; i++)
            lane[i] = i;
        places_pick(g, &b, LANES, lane, &all);
        for (int i = 0; i < LANES; i++)
            all.pixels[i] = 1000;
        CHECK(places_search(&all, P, R(0.25), steps), >, LANES);
        for (int i = 0; i < LANES; i++) {
            NEAR(all.tau[i], tau[i], 2 * 0.25 / 1000); /* the error is known to first order */
            assert_int_equal(all.order[i], 5);
        }
        for (int i = 0; i < 10; i++)
            lane[i] = 7 * i + 3;
        places_pick(g, &b, 10, lane, &few);
        for (int i = 0; i < 10; i++)
            few.pixels[i] = 1000;
        places_search(&few, P, R(0.25), steps);
        for (int i = 0; i < 10; i++)
            CHECK(few.tau[i], ==, all.tau[lane[i]]); /* a lane does not depend on its neighbours */
        places_put(&few, g);
        CHECK(g->tau[3], ==, all.tau[3]);
        assert_int_equal(g->order[3], 5);
        assert_int_equal(g->order[4], 0);
        bump_free(P);
    }
    surface_free(f);
}

/* Without bounds of P there is no bracket: both ends are order 0. */
static void no_bracket_without_bounds(void **state)
{
    surface *f = plane();
    bump *P = function("0.1*u");
    (void)state;
    assert_false(bump_is_bounded(P));
    hit_group *g = wave(f, P, 1);
    brackets b;
    bracket_begin(g, P, true, &b);
    for (int i = 0; i < LANES; i++) {
        CHECK(b.front[i], ==, g->tau[i]);
        CHECK(b.back[i], ==, g->tau[i]);
        assert_int_equal(g->order[i], 0);
    }
    bump_free(P);
    surface_free(f);
}

static void names(void **state)
{
    static const char *const good[][2] = {{"auto", "auto"},           {"auto:0.25", "auto"},
                                          {"auto:1", "auto:1"},       {"auto:0.050", "auto:0.05"},
                                          {"auto:1000", "auto:1000"}, {"auto:0.000001", "auto:0.000001"},
                                          {"auto:12.5", "auto:12.5"}, {"auto:007", "auto:7"}};
    static const char *const bad[] = {"auto:",
                                      "auto:0",
                                      "auto:-1",
                                      "auto:1000.1",
                                      "auto:1e2",
                                      "auto: 1",
                                      "auto:.5",
                                      "auto:1.2.3",
                                      "auto:0.0000001",
                                      "autobahn",
                                      "auto:nan",
                                      "auto:x",
                                      "auto:99999999999999999999"};
    char name[METHOD_NAME_SIZE];
    method m;
    (void)state;
    for (size_t k = 0; k < sizeof good / sizeof *good; k++) {
        assert_true(method_parse(good[k][0], &m));
        method_name(m, name);
        assert_string_equal(name, good[k][1]);
    }
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
        if (method_parse(bad[k], &m)) {
            print_error("%s is taken for a method\n", bad[k]);
            fail();
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(brackets_hold_the_place),
        cmocka_unit_test(search_finds_the_place),
        cmocka_unit_test(no_bracket_without_bounds),

        cmocka_unit_test(names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
