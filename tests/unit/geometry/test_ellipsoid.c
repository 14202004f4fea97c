/* The ellipsoid against the unit sphere that an affine map stretches to it: that is tested by brute force. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "geometry/closed_form.h"
#include "patch/surface.h"
#include "support/random_rays.h"
#include "wave/lane.h"

#ifdef KAGE_DOUBLE
#define EPS 2.2e-16
#else
#define EPS 1.2e-7
#endif

static const shape_values values = {.v = {{0.2, -0.1, 0.3}, {1.4, 0.6, 0.9}}};

typedef struct pair {
    surface *egg, *ball, *image;
} pair;

static pair make(void)
{
    const vec3 c = values.v[0], radii = values.v[1], origin = {0, 0, 0};
    const affine m = {{radii.x, 0, 0}, {0, radii.y, 0}, {0, 0, radii.z}, c};
    form_fault fault = {NULL, NULL};
    pair p = {form_ellipsoid.make(&values, &fault), sphere_new(origin, 1), NULL};
    p.image = surface_transformed(p.ball, &m);
    assert_non_null(p.egg);
    assert_non_null(p.image);
    return p;
}

static void end(pair p)
{
    surface_free(p.egg);
    surface_free(p.image);
    surface_free(p.ball);
}

static void assert_near(double a, double b, double within)
{
    if (!(fabs(a - b) <= within)) {
        print_error("%.9g, expected %.9g within %g\n", a, b, within);
        fail();
    }
}

static void assert_near3(bs_vec3 a, bs_vec3 b, double within)
{
    assert_near((double)a.x, (double)b.x, within);
    assert_near((double)a.y, (double)b.y, within);
    assert_near((double)a.z, (double)b.z, within);
}

static void hits_are_those_of_a_stretched_sphere(void **state)
{
    static rays x;
    static hits h, k;
    pair p = make();
    int met = 0;
    (void)state;
    for (int i = 0; i < LANES; i++)
        random_ray(&x, i, 0.9);
    no_hits(&h, LANES);
    no_hits(&k, LANES);
    p.egg->ops->hit(p.egg, LANES, &x, 3, &h);
    p.image->ops->hit(p.image, LANES, &x, 3, &k);
    for (int i = 0; i < LANES; i++) {
        if (h.id[i] == 3 && k.id[i] == 3) {
            /* beside a tangent t is worth the root of a digit */
            assert_near3(lane_at(&x, i, h.t[i]), lane_at(&x, i, k.t[i]), sqrt(EPS));
            met++;
        }
    }
    assert_true(met > LANES / 2);
    end(p);
}

static void places_and_partials_are_those_of_a_stretched_sphere(void **state)
{
    static partials q, s;
    static real u[LANES], w[LANES];
    static int32_t part[LANES];
    pair p = make();
    (void)state;
    for (int i = 0; i < LANES; i++) {
        u[i] = (real)random_in(-3.1, 3.1);
        w[i] = (real)random_in(0.01, 3.1);
    }
    p.egg->ops->eval(p.egg, LANES, part, u, w, 2, &q);
    p.image->ops->eval(p.image, LANES, part, u, w, 2, &s);
    for (int i = 0; i < LANES; i++) {
        const vec3s *const a[] = {&q.Q, &q.Qu, &q.Qw, &q.Quu, &q.Quw, &q.Qww};
        const vec3s *const b[] = {&s.Q, &s.Qu, &s.Qw, &s.Quu, &s.Quw, &s.Qww};
        for (int k = 0; k < 6; k++)
            assert_near3(lane_get(a[k], i), lane_get(b[k], i), 8 * EPS);
    }
    end(p);
}

static void hits_are_located_where_they_are(void **state)
{
    static rays x;
    static hits h;
    static partials q;
    static real u[LANES], w[LANES];
    static int32_t part[LANES];
    pair p = make();
    (void)state;
    for (int i = 0; i < LANES; i++)
        random_ray(&x, i, 0.5);
    no_hits(&h, LANES);
    p.egg->ops->hit(p.egg, LANES, &x, 0, &h);
    p.egg->ops->locate(p.egg, LANES, &x, h.t, part, u, w);
    p.egg->ops->eval(p.egg, LANES, part, u, w, 1, &q);
    for (int i = 0; i < LANES; i++)
        if (h.id[i] == 0)
            assert_near3(lane_get(&q.Q, i), lane_at(&x, i, h.t[i]), 64 * EPS);
    end(p);
}

/* From outside the far side is in shadow, and nothing else: the surface is convex. */
static void own_shadows_are_where_light_comes_from_behind(void **state)
{
    static rays x;
    static hits again;
    static ray_origins from;
    static partials q;
    static real u[LANES], w[LANES], lit[LANES];
    static int32_t part[LANES];
    pair p = make();
    (void)state;
    for (int i = 0; i < LANES; i++) {
        u[i] = (real)random_in(-3.1, 3.1);
        w[i] = (real)random_in(0.1, 3);
        lit[i] = 1;
        from.id[i] = 5;
        from.part[i] = 0;
    }
    p.egg->ops->eval(p.egg, LANES, part, u, w, 1, &q);
    for (int i = 0; i < LANES; i++) {
        const bs_vec3 Q = lane_get(&q.Q, i);
        lane_set(&x.r, i, Q);
        lane_set(&x.s, i, (bs_vec3){R(4) - Q.x, R(5) - Q.y, R(-3) - Q.z});
    }
    no_hits(&again, LANES);
    from.at = x.r;
    p.egg->ops->occlude_own(p.egg, LANES, &x, part, lit);
    p.egg->ops->hit_own(p.egg, LANES, &x, &from, 5, &again);
    for (int i = 0; i < LANES; i++) {
        const bs_vec3 n = bs_normal(lane_get(&q.Qu, i), lane_get(&q.Qw, i));
        const double slope = (double)bs_dot(n, lane_get(&x.s, i));
        if (fabs(slope) > 1e-4) {
            assert_int_equal(lit[i] == 0, slope < 0);
            assert_int_equal(again.id[i] == 5, slope < 0);
        }
    }
    end(p);
}

static void the_formula_is_the_surface(void **state)
{
    form_formula formula;
    pair p = make();
    partials q, s;
    const real u = R(0.7), w = R(1.1);
    const int32_t part = 0;
    (void)state;
    assert_true(form_ellipsoid.formula(&values, &formula));
    surface *searched = patch_surface_formula("ellipsoid", &formula, 1, NULL);
    assert_non_null(searched);
    p.egg->ops->eval(p.egg, 1, &part, &u, &w, 1, &q);
    searched->ops->eval(searched, 1, &part, &u, &w, 1, &s);
    const bs_vec3 Q = lane_get(&q.Q, 0), C = {R(0.2), R(-0.1), R(0.3)};
    assert_near3((bs_vec3){Q.x - C.x, Q.y - C.y, Q.z - C.z}, lane_get(&s.Q, 0), 8 * EPS);
    assert_near3(lane_get(&q.Qu, 0), lane_get(&s.Qu, 0), 8 * EPS);
    assert_near3(lane_get(&q.Qw, 0), lane_get(&s.Qw, 0), 8 * EPS);
    surface_free(searched);
    end(p);
}

static void no_radius_may_be_0(void **state)
{
    shape_values flat = values;
    form_fault fault = {NULL, NULL};
    (void)state;
    flat.v[1].y = 0;
    assert_null(form_ellipsoid.make(&flat, &fault));
    assert_string_equal(fault.key, "radii");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hits_are_those_of_a_stretched_sphere),
        cmocka_unit_test(places_and_partials_are_those_of_a_stretched_sphere),
        cmocka_unit_test(hits_are_located_where_they_are),
        cmocka_unit_test(own_shadows_are_where_light_comes_from_behind),
        cmocka_unit_test(the_formula_is_the_surface),
        cmocka_unit_test(no_radius_may_be_0),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
