/* Displaced surfaces as surfaces: what they own, and what they count. */
#include "support/check.h"
#include "mesh/mesh.h"
#include "support/displace.h"
#include "support/function_bump.h"
#include "wave/lane.h"

#include <stdlib.h>

static surface *ground(void) { return plane_new((vec3){0, 0, 0}, (vec3){0, 0, 1}, (vec3){1, 0, 0}, false); }

/* Rays straight down from the height 2. */
static void from_above(rays *x, hits *h)
{
    for (int i = 0; i < LANES; i++) {
        lane_set(&x->r, i, (bs_vec3){(real)(0.05 * i - 3), 2, R(0.3)});
        lane_set(&x->s, i, (bs_vec3){0, -1, 0});
        h->t[i] = REAL_FAR;
        h->id[i] = -1;
        h->part[i] = 0;
    }
}

/* Each thread's copy counts its own searches; the original counts none. */
static void copies_count_apart(void **state)
{
    static rays x;
    static hits h;
    displaced_counts one = {0, 0}, two = {0, 0};
    (void)state;
    bump *P = function("0.1*sin(5*w)");
    surface *f = ground(), *d = displaced_new(f, P, NULL, &(bool){true});
    const displaced a = displaced_counting(d, &one), b = displaced_counting(d, &two);
    from_above(&x, &h);
    a.base.ops->hit(&a.base, LANES, &x, 0, &h);
    CHECK(one.evaluations, >=, LANES);
    CHECK(two.evaluations, ==, 0);
    const long before = one.evaluations;
    from_above(&x, &h);
    d->ops->hit(d, LANES, &x, 0, &h);
    CHECK(one.evaluations, ==, before);
    from_above(&x, &h);
    b.base.ops->hit(&b.base, LANES, &x, 0, &h);
    CHECK(two.evaluations, ==, before);
    surface_free(d);
    surface_free(f);
    bump_free(P);
}

/* `locate` is the closest point of the smooth surface, `shape` its P and the hit. */
static void located_below_the_hit(void **state)
{
    static rays x;
    static hits h;
    static hit_group g;
    real u[LANES], w[LANES];
    (void)state;
    bump *P = function("0.25");
    surface *f = ground(), *d = displaced_new(f, P, NULL, &(bool){true});
    from_above(&x, &h);
    d->ops->hit(d, LANES, &x, 0, &h);
    d->ops->locate(d, LANES, &x, h.t, h.part, u, w);
    g.n = LANES;
    hit_group_picked(&g);
    g.picked.x = x;
    for (int i = 0; i < LANES; i++) {
        g.picked.t[i] = h.t[i];
        g.part[i] = h.part[i];
    }
    displaced_shape(d, &g);
    for (int i = 0; i < LANES; i += 9) {
        NEAR(h.t[i], 1.75, 8 * EPS);
        NEAR(u[i], 0.3, 8 * EPS);
        NEAR(w[i], 0.05 * i - 3, 40 * EPS);
        NEAR(g.q.Q.y[i], 0.25, 8 * EPS);
        NEAR(g.n_bump.y[i], 1, EPS);
        CHECK(g.u[i], ==, u[i]);
    }
    surface_free(d);
    surface_free(f);
    bump_free(P);
}

static void the_box_is_higher(void **state)
{
    double lo[3], hi[3];
    (void)state;
    bump *P = function("0.25*sin(u)");
    surface *f = sphere_new((vec3){1, 2, 3}, 2), *d = displaced_new(f, P, NULL, &(bool){true});
    d->ops->box(d, lo, hi);
    NEAR(lo[0], -1.25, 1e-6);
    NEAR(hi[1], 4.25, 1e-6);
    surface_free(d);
    surface_free(f);
    bump_free(P);
}

/* A mesh of two triangles, the square -4..4 at y = 0, (u,w) as its (z,x). */
static surface *square(void)
{
    static const float corner[4][3] = {{-4, 0, -4}, {-4, 0, 4}, {4, 0, 4}, {4, 0, -4}};
    static const int index[2][3] = {{0, 1, 2}, {0, 2, 3}};
    mesh_data m = {
        .n = 2, .at = memory_zeroed(NULL, 2 * sizeof *m.at), .skin = memory_zeroed(NULL, 2 * sizeof *m.skin)};
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 3; i++)
            for (int a = 0; a < 3; a++) {
                m.at[k][i][a] = corner[index[k][i]][a];
                m.skin[k].normal[i][a] = a == 1;
                if (a < 2)
                    m.skin[k].uv[i][a] = corner[index[k][i]][2 - 2 * a];
            }
    return mesh_new(&m, 1, NULL);
}

/* Two bumps over one mesh: neither knows of the other. */
static void bumps_over_one_mesh(void **state)
{
    static rays x;
    static hits alone, beside;
    displaced_counts one = {0, 0}, two = {0, 0};
    (void)state;
    bump *low = function("0.1*sin(5*w)"), *high = function("1+0.1*sin(5*w)");
    surface *f = square(), *d = displace(f, low, &one);
    from_above(&x, &alone);
    d->ops->hit(d, LANES, &x, 0, &alone);
    CHECK(alone.id[64], ==, 0);
    surface_free(d);
    surface *other = displace(f, high, NULL), *again = displace(f, low, &two);
    from_above(&x, &beside);
    again->ops->hit(again, LANES, &x, 0, &beside);
    assert_memory_equal(&alone, &beside, sizeof alone);
    CHECK(one.evaluations, ==, two.evaluations);
    surface_free(other);
    surface_free(again);
    surface_free(f);
    bump_free(low);
    bump_free(high);
}

/* A cone with caps that is stretched has no closest points in closed form. */
static void not_over_a_stretched_cone(void **state)
{
    const affine stretched = {.x = {2, 0, 0}, .y = {0, 1, 0}, .z = {0, 0, 1}};
    (void)state;
    surface *cone = cone_new((vec3){0, 0, 0}, 1, (vec3){0, 2, 0}, 0.5, false);
    surface *moved = surface_transformed(cone, &stretched);
    assert_true(displaced_has_form(cone));
    assert_false(displaced_has_form(moved));
    surface_free(moved);
    surface_free(cone);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(copies_count_apart),        cmocka_unit_test(located_below_the_hit),
        cmocka_unit_test(the_box_is_higher),         cmocka_unit_test(bumps_over_one_mesh),
        cmocka_unit_test(not_over_a_stretched_cone),
    };
    return cmocka_run_group_tests_name("displaced surfaces", tests, NULL, NULL);
}
