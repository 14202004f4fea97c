/* POV-Ray's finish against a plain calculation in double, lane by lane. */
#include "support/check.h"
#include "base/vec3.h"
#include "light/shade.h"
#include "support/random_in.h"
#include "wave/lane.h"

static vec3 wide(bs_vec3 v) { return (vec3){(double)v.x, (double)v.y, (double)v.z}; }

static bs_vec3 random_vector(double size)
{
    return (bs_vec3){(real)random_in(-size, size), (real)random_in(-size, size), (real)random_in(-size, size)};
}

static void random_group(hit_group *g)
{
    g->n = LANES;
    hit_group_picked(g);
    for (int i = 0; i < LANES; i++) {
        const bs_vec3 n = random_vector(1), lean = random_vector(0.3);
        lane_set(&g->picked.x.r, i, random_vector(5));
        lane_set(&g->picked.x.s, i, random_vector(1));
        lane_set(&g->n_smooth, i, n);
        lane_set(&g->n_bump, i, lane_unit((bs_vec3){n.x + lean.x, n.y + lean.y, n.z + lean.z}));
        lane_set(&g->color, i, (bs_vec3){(real)random_in(0, 1), (real)random_in(0, 1), (real)random_in(0, 1)});
        lane_set(&g->tint, i, (bs_vec3){(real)random_in(0, 1), (real)random_in(0, 1), (real)random_in(0, 1)});
        g->picked.t[i] = (real)random_in(0.5, 2);
        g->lit[i] = i % 4 == 0 ? 0 : R(0.75);
    }
}

/* What lane i sends to the eye, in red. */
static double red(const hit_group *g, int i, const material *m, const light *l, bool tinted, bool front)
{
    const vec3 s = vec3_unit(wide(lane_get(&g->x->s, i))), p = wide(lane_at(g->x, i, g->t_shade[i]));
    const vec3 L = vec3_unit(l->kind == LIGHT_PARALLEL ? vec3_scale(l->axis, -1) : vec3_sub(l->at, p));
    vec3 smooth = wide(lane_get(&g->n_smooth, i)), n = wide(lane_get(&g->n_bump, i));
    const double color = m->pattern ? (double)g->color.x[i] : m->color.x, tint = tinted ? (double)g->tint.x[i] : 1;
    const double opacity = 1 - m->filter - m->transmit, lit = (double)g->lit[i] * tint * l->color.x;
    double sum = m->ambient * opacity * color;
    if (vec3_dot(s, smooth) > 0) {
        smooth = vec3_scale(smooth, -1);
        n = vec3_scale(n, -1);
    }
    if (front && vec3_dot(smooth, L) <= 0)
        return sum;
    const vec3 mirrored = vec3_sub(s, vec3_scale(n, 2 * vec3_dot(s, n))), h = vec3_unit(vec3_sub(L, s));
    sum += lit * m->diffuse * opacity * color * fmax(vec3_dot(n, L), 0);
    sum += lit * m->phong * pow(fmax(vec3_dot(mirrored, L), 0), m->phong_size);
    sum += lit * m->specular * pow(fmax(vec3_dot(n, h), 0), 1 / m->roughness);
    return sum;
}

static void as_by_hand_if(material m, light_kind kind, bool tinted, bool front)
{
    static hit_group g;
    const light l = {.kind = kind, .at = {3, 9, -4}, .axis = {0.6, -0.8, 0}, .color = {0.9, 0.5, 0.2}};
    int bright = 0;
    random_group(&g);
    shade_ambient(&g, &m);
    shade_light(&g, &m, &l, tinted, front);
    for (int i = 0; i < LANES; i++) {
        const double want = red(&g, i, &m, &l, tinted, front);
        NEAR(g.rgb.x[i], want, 400 * EPS);
        bright += want > m.ambient;
    }
    CHECK(bright, >, LANES / 16);
}

/* Whether or not light from behind the smooth surface counts. */
static void as_by_hand(material m, light_kind kind, bool tinted)
{
    as_by_hand_if(m, kind, tinted, true);
    as_by_hand_if(m, kind, tinted, false);
}

static const material matt = {.color = {0.8, 0.6, 0.4}, .ambient = 0.1, .diffuse = 0.7, .roughness = 1};

static void diffuse_point(void **state)
{
    (void)state;
    as_by_hand(matt, LIGHT_POINT, false);
}

static void diffuse_parallel(void **state)
{
    (void)state;
    as_by_hand(matt, LIGHT_PARALLEL, false);
}

static void phong(void **state)
{
    material m = matt;
    (void)state;
    m.phong = 0.8;
    m.phong_size = 20;
    as_by_hand(m, LIGHT_POINT, false);
    as_by_hand(m, LIGHT_PARALLEL, true);
}

static void specular(void **state)
{
    material m = matt;
    (void)state;
    m.specular = 0.6;
    m.roughness = 0.05;
    as_by_hand(m, LIGHT_POINT, true);
    as_by_hand(m, LIGHT_PARALLEL, false);
}

/* A pattern's colour is the lane's; its material has the colour 1. */
static void patterned(void **state)
{
    material m = matt;
    (void)state;
    m.pattern = PATTERN_CHECKER;
    m.color = (vec3){1, 1, 1};
    as_by_hand(m, LIGHT_POINT, false);
    as_by_hand(m, LIGHT_POINT, true);
}

/* Ambient and diffuse light keep their share of opacity, highlights all of theirs. */
static void transparent(void **state)
{
    material m = matt;
    (void)state;
    m.filter = 0.5;
    m.transmit = 0.2;
    m.phong = 1;
    m.phong_size = 5;
    as_by_hand(m, LIGHT_POINT, true);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(diffuse_point), cmocka_unit_test(diffuse_parallel), cmocka_unit_test(phong),
        cmocka_unit_test(specular),      cmocka_unit_test(patterned),        cmocka_unit_test(transparent),
    };
    return cmocka_run_group_tests_name("shade", tests, NULL, NULL);
}
