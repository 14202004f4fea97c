/* Mirrored textures: u beyond an end is looked up at its reflection, and the partials by u change their sign there. */
#include "texture/mirrored_uv.h"

#include "support/check.h"

static const double LO = -0.5, HI = 2, U[2] = {-3, 5}, W[2] = {-1, 1};

static bump *original(void)
{
    expr_error wrong;
    return bump_function_new(expr_parse("sin(u) + 0.3*u*u*w + w*w", &wrong), 0.7, U, W);
}

typedef struct looked_up {
    double P, Pu, Pw, Puu, Puw, Pww;
} looked_up;

static looked_up at(const bump *p, double u, double w)
{
    static bump_values h;
    const real x = (real)u, y = (real)w;
    p->ops->eval(p, 1, &x, &y, 3, &h);
    return (looked_up){(double)h.P[0],   (double)h.Pu[0],  (double)h.Pw[0],
                       (double)h.Puu[0], (double)h.Puw[0], (double)h.Pww[0]};
}

/* The mirrored one at u against the original at `there`, where its u runs by `sign`. */
static void check_at(double u, double there, double sign)
{
    bump *p = original(), *m = bump_mirrored_uv(original(), LO, HI);
    const looked_up got = at(m, u, 0.3), want = at(p, there, 0.3);
    const double within = 20 * EPS;
    NEAR(got.P, want.P, within);
    NEAR(got.Pu, sign * want.Pu, within);
    NEAR(got.Pw, want.Pw, within);
    NEAR(got.Puu, want.Puu, within);
    NEAR(got.Puw, sign * want.Puw, within);
    NEAR(got.Pww, want.Pww, within);
    bump_free(p);
    bump_free(m);
}

static void unchanged_within(void **state)
{
    (void)state;
    check_at(-0.25, -0.25, 1);
    check_at(LO, LO, 1);
    check_at(HI, HI, 1);
}

static void reflected_above(void **state)
{
    (void)state;
    check_at(2.75, 1.25, -1);
}

static void reflected_below(void **state)
{
    (void)state;
    check_at(-1.25, 0.25, -1);
}

static void order_1_leaves_second_partials_alone(void **state)
{
    (void)state;
    bump *m = bump_mirrored_uv(original(), LO, HI);
    static bump_values h;
    const real x = R(2.75), y = 0;
    h.Puw[0] = 42;
    m->ops->eval(m, 1, &x, &y, 1, &h);
    CHECK(h.Puw[0], ==, 42);
    bump_free(m);
}

static void bounds_are_the_originals(void **state)
{
    (void)state;
    bump *p = original(), *m = bump_mirrored_uv(original(), LO, HI);
    CHECK(m->Pmin, ==, p->Pmin);
    CHECK(m->Pmax, ==, p->Pmax);
    CHECK(m->Pu_max, ==, p->Pu_max);
    CHECK(m->Pw_max, ==, p->Pw_max);
    assert_string_equal(m->ops->kind, "function");
    bump_free(p);
    bump_free(m);
}

static void colours_are_reflected(void **state)
{
    (void)state;
    const vec3 colors[2] = {{1, 0, 0}, {0, 0.25, 1}};
    const double size[2] = {1, 1}, offset[2] = {0, 0};
    color_texture *p = color_checker_new(colors, size, offset),
                  *m = color_mirrored_uv(color_checker_new(colors, size, offset), LO, HI);
    const real u[4] = {R(0.5), R(2.75), R(3.25), R(-1.25)}, there[4] = {R(0.5), R(1.25), R(0.75), R(0.25)},
               w[4] = {R(0.5), R(0.5), R(0.5), R(0.5)};
    static vec3s got, want;
    m->ops->eval(m, 4, u, w, &got);
    p->ops->eval(p, 4, there, w, &want);
    for (int i = 0; i < 4; i++) {
        CHECK(got.x[i], ==, want.x[i]);
        CHECK(got.y[i], ==, want.y[i]);
        CHECK(got.z[i], ==, want.z[i]);
    }
    color_texture_free(p);
    color_texture_free(m);
}

static void of_nothing_there_is_none(void **state)
{
    (void)state;
    assert_null(bump_mirrored_uv(NULL, LO, HI));
    assert_null(color_mirrored_uv(NULL, LO, HI));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(unchanged_within),         cmocka_unit_test(reflected_above),
        cmocka_unit_test(reflected_below),          cmocka_unit_test(order_1_leaves_second_partials_alone),
        cmocka_unit_test(bounds_are_the_originals), cmocka_unit_test(colours_are_reflected),
        cmocka_unit_test(of_nothing_there_is_none),
    };
    return cmocka_run_group_tests_name("mirrored textures", tests, NULL, NULL);
}
