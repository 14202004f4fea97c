/* The stages of the bumps' own shadows, on a plane and on a cylinder: against brute force, from the front and from
 * behind, and where no bump can shadow.
 */
#include <string.h>

#include "geometry/surface.h"
#include "method/own_shadow.h"
#include "method/shift.h"
#include "support/check.h"
#include "support/function_bump.h"
#include "support/random_in.h"
#include "wave/lane.h"

static const double endless[2] = {-HUGE_VAL, HUGE_VAL};

/* Places of y = 0, u to z and w to x, seen from above or from below, and a light above or below at random heights. */
static void places_on_plane(const bump *P, double side, hit_group *g)
{
    surface *f = plane_new((vec3){0, 0, 0}, (vec3){0, 0, 1}, (vec3){1, 0, 0}, false);
    assert_non_null(f);
    g->n = LANES;
    hit_group_picked(g);
    for (int i = 0; i < LANES; i++) {
        g->u[i] = (real)random_in(-3, 3);
        g->w[i] = (real)random_in(-3, 3);
        lane_set(&g->picked.x.s, i, (bs_vec3){R(0.3), (real)-side, R(0.1)});
        g->lit[i] = 1;
    }
    f->ops->eval(f, LANES, g->part, g->u, g->w, 2, &g->q);
    P->ops->eval(P, LANES, g->u, g->w, 1, &g->bump);
    shift_normals(g, P);
    own_places(g, &g->rough);
    for (int i = 0; i < LANES; i++) {
        bs_vec3 X = lane_get(&g->rough, i);
        lane_set(&g->to_light.r, i, X);
        lane_set(&g->to_light.s, i,
                 (bs_vec3){(real)random_in(-9, 9), (real)(side * random_in(0.2, 4)), (real)random_in(-9, 9)});
    }
    surface_free(f);
}

/* Whether 20 000 places on the way are above the bumps, and by how much the nearest is. */
static double clearance(const bump *P, const hit_group *g, int i, double side)
{
    const vec3 X = vec3s_get(&g->rough, i), d = vec3s_get(&g->to_light.s, i);
    const double end = fmin(1, (side > 0 ? (double)P->Pmax - X.y : (double)P->Pmin - X.y) / d.y);
    double least = HUGE_VAL;
    for (int k = 1; k <= 20000; k += LANES) {
        real u[LANES], w[LANES];
        bump_values h;
        for (int j = 0; j < LANES; j++) {
            const double t = end * (k + j) / 20000;
            u[j] = (real)(X.z + d.z * t);
            w[j] = (real)(X.x + d.x * t);
        }
        P->ops->eval(P, LANES, u, w, 0, &h);
        for (int j = 0; j < LANES; j++)
            least = fmin(least, side * (X.y + d.y * end * (k + j) / 20000 - (double)h.P[j]));
    }
    return least;
}

static void as_by_brute_force(double side, bool flat)
{
    static hit_group g;
    bump *P = function("0.2*sin(3*u)*cos(2*w) + 0.1*sin(5*u + 4*w)");
    own_ways y;
    int dark = 0;
    places_on_plane(P, side, &g);
    own_begin(&g, P, flat, endless, endless, &y);
    own_turned_away(&g, &y);
    BETWEEN(1, own_march(&g, P, &y, 1000, 0), 1000 * LANES);
    for (int i = 0; i < LANES; i++) {
        const double clear = clearance(P, &g, i, side);
        dark += g.lit[i] == 0;
        if (fabs(clear) > 1e-4) /* a way that touches may be either */
            CHECK(g.lit[i], ==, clear > 0);
        else if (clear < -1e-5)
            CHECK(g.lit[i], ==, 0);
    }
    BETWEEN(LANES / 8, dark, LANES - LANES / 8);
    bump_free(P);
}

static void a_fine_march_is_brute_force(void **state)
{
    (void)state;
    for (int flat = 0; flat < 2; flat++) {
        as_by_brute_force(1, flat);
        as_by_brute_force(-1, flat);
    }
}

/* A light above the slope of all bumps sees everything, by any number of steps. */
static void steep_light_sees_all(void **state)
{
    static hit_group g;
    bump *P = function("0.05*sin(3*u)*cos(2*w)");
    own_ways y;
    (void)state;
    for (int steps = 1; steps < 40; steps += 7) {
        places_on_plane(P, 1, &g);
        for (int i = 0; i < LANES; i++)
            lane_set(&g.to_light.s, i, (bs_vec3){R(1), R(0.3), R(0.2)}); /* slopes are below 0.15 + 0.1 */
        own_begin(&g, P, true, endless, endless, &y);
        own_turned_away(&g, &y);
        own_march(&g, P, &y, steps, 0);
        for (int i = 0; i < LANES; i++)
            CHECK(g.lit[i], ==, 1);
    }
    bump_free(P);
}

/* Lanes on the other side stay as they are. */
static void only_the_side_that_is_asked_for(void **state)
{
    static hit_group g;
    bump *P = function("0.2*sin(3*u)*cos(2*w) + 0.1*sin(5*u + 4*w)");
    own_ways y;
    (void)state;
    places_on_plane(P, 1, &g);
    own_begin(&g, P, true, endless, endless, &y);
    own_march(&g, P, &y, 50, -1);
    for (int i = 0; i < LANES; i++)
        CHECK(g.lit[i], ==, 1);
    bump_free(P);
}

/* A ridge at u = 1 shadows places before it, unless the surface ends before the ridge. */
static void edges_end_the_bumps(void **state)
{
    static hit_group g;
    bump *P = function("max(0, 0.5 - 5*abs(u - 1))");
    const double before[2] = {-3, 0.8};
    own_ways y;
    (void)state;
    for (int edge = 0; edge < 2; edge++) {
        places_on_plane(P, 1, &g);
        for (int i = 0; i < LANES; i++) {
            g.u[i] = R(0.5);
            lane_set(&g.to_light.s, i, (bs_vec3){0, R(0.5), 5});
            g.bump.P[i] = g.bump.Pu[i] = g.bump.Pw[i] = 0;
        }
        own_begin(&g, P, true, edge ? before : endless, endless, &y);
        own_march(&g, P, &y, 16, 0);
        for (int i = 0; i < LANES; i++)
            CHECK(g.lit[i], ==, edge);
    }
    bump_free(P);
}

/* On a ball the way to a light below the horizon leaves the slab above the ball, beyond the bend. */
static void ways_leave_a_ball(void **state)
{
    static hit_group g;
    const double r = 2;
    surface *f = sphere_new((vec3){0, 0, 0}, r);
    bump *P = function("0.1*sin(3*u)*sin(5*w)");
    own_ways y;
    (void)state;
    g.n = LANES;
    hit_group_picked(&g);
    for (int i = 0; i < LANES; i++) {
        g.u[i] = (real)random_in(-3, 3);
        g.w[i] = (real)random_in(0.6, 2.5);
    }
    f->ops->eval(f, LANES, g.part, g.u, g.w, 2, &g.q);
    P->ops->eval(P, LANES, g.u, g.w, 1, &g.bump);
    shift_normals(&g, P);
    own_places(&g, &g.rough);
    for (int i = 0; i < LANES; i++) {
        bs_vec3 X = lane_get(&g.rough, i), n = lane_unit(lane_get(&g.n_smooth, i));
        bs_vec3 along = lane_unit(bs_cross(n, (bs_vec3){R(0.3), R(0.9), R(-0.2)}));
        const real sink = (real)random_in(-0.25, 0.1); /* the sine of the light's elevation */
        lane_set(&g.picked.x.s, i, (bs_vec3){-n.x, -n.y, -n.z});
        lane_set(&g.to_light.r, i, X);
        lane_set(&g.to_light.s, i,
                 (bs_vec3){9 * (along.x + sink * n.x), 9 * (along.y + sink * n.y), 9 * (along.z + sink * n.z)});
    }
    own_begin(&g, P, false, endless, endless, &y);
    own_leave(&g, &y);
    for (int i = 0; i < LANES; i++) {
        const vec3 at = vec3s_get(&g.to_light.r, i);
        const double high = vec3_length(at) - r, range = (double)(P->Pmax - P->Pmin);
        BETWEEN(0.6 * (range + (double)P->Pmax), high, 1.6 * (range + (double)P->Pmax));
    }
    bump_free(P);
    surface_free(f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_fine_march_is_brute_force),
        cmocka_unit_test(steep_light_sees_all),
        cmocka_unit_test(only_the_side_that_is_asked_for),
        cmocka_unit_test(edges_end_the_bumps),
        cmocka_unit_test(ways_leave_a_ball),
    };
    return cmocka_run_group_tests_name("own shadows", tests, NULL, NULL);
}
