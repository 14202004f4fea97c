/* Secondary rays: how much of the light they find is added, and how far they go. */
#include "support/check.h"
#include "render/secondary.h"
#include "support/scene_text.h"

/* All that is seen is the background, by way of the materials: they have no light of their own. */
#define HEAD                                                                                                           \
    "camera: {from: [0, 6, 0], at: [0, 0, 0], up: [0, 0, 1], fov: 20}\n"                                               \
    "image: {size: [16, 8], background: [0.2, 0.4, 0.8]}\n"                                                            \
    "lights: {}\n"                                                                                                     \
    "materials:\n"                                                                                                     \
    "  mirror: {color: [0, 0, 0], reflection: 0.5, ambient: 0, diffuse: 0}\n"                                          \
    "  pane: {color: [0.5, 0.25, 1], filter: 0.8, transmit: 0.1, ambient: 0, diffuse: 0}\n"                            \
    "  glass: {color: [1, 1, 1], transmit: 1, ior: 1.5, ambient: 0, diffuse: 0}\n"

static bs_vec3 seen(const char *text)
{
    scene *s = scene_text(text);
    const tracer tr = {.scene = s, .self_shadow = true};
    workspace *v = camera_wave(&tr);
    trace(&tr, LANES, v);
    const bs_vec3 rgb = lane_get(&v->out.rgb, 64 + 8),
                  sky = {(real)s->background.x, (real)s->background.y, (real)s->background.z};
    workspace_free(v);
    scene_free(s);
    return (bs_vec3){rgb.x / sky.x, rgb.y / sky.y, rgb.z / sky.z};
}

static void a_mirror(void **state)
{
    (void)state;
    const bs_vec3 x = seen(HEAD "render: {depth: 2}\n"
                                "objects: {floor: {plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: "
                                "mirror}}\n");
    NEAR(x.x, 0.5, 4 * EPS);
    NEAR(x.z, 0.5, 4 * EPS);
}

/* Two mirrors that face each other: at depth 3 the third ray is the last one, and still meets a mirror, which is dark.
 */
static void depth_ends_it(void **state)
{
    (void)state;
    const bs_vec3 x = seen(HEAD "render: {depth: 3}\n"
                                "objects:\n"
                                "  floor: {plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: mirror}\n"
                                "  roof: {plane: {origin: [0, 9, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: mirror}\n");
    CHECK(x.x, ==, 0);
}

/* Panes do not refract: rays go straight on, without end at any depth, and weights multiply. */
static void three_panes(void **state)
{
    (void)state;
    const bs_vec3 x =
        seen(HEAD "render: {depth: 2}\n"
                  "objects:\n"
                  "  a: {rectangle: {origin: [-9, 0, -9], u: [0, 0, 18], w: [18, 0, 0]}, material: pane}\n"
                  "  b: {rectangle: {origin: [-9, 1, -9], u: [0, 0, 18], w: [18, 0, 0]}, material: pane}\n"
                  "  c: {rectangle: {origin: [-9, 2, -9], u: [0, 0, 18], w: [18, 0, 0]}, material: "
                  "pane}\n");
    NEAR(x.x, 0.5 * 0.5 * 0.5, 8 * EPS);
    NEAR(x.y, 0.3 * 0.3 * 0.3, 8 * EPS);
    NEAR(x.z, 0.9 * 0.9 * 0.9, 8 * EPS);
}

/* Clear glass that is refracted on the way in and out takes nothing. */
static void clear_glass(void **state)
{
    (void)state;
    const bs_vec3 x = seen(HEAD "render: {depth: 3}\n"
                                "objects: {ball: {sphere: {center: [0, 0, 0], radius: 2}, material: glass}}\n");
    NEAR(x.y, 1, 8 * EPS);
}

/* A queue's rays are replaced by those that go on from some of them; places and weights follow. */
static void going_on(void **state)
{
    static ray_queue q, on;
    (void)state;
    q.n = 3;
    on.n = 2;
    for (int i = 0; i < 3; i++) {
        q.lane[i] = 10 * i;
        lane_set(&q.weight, i, (bs_vec3){R(0.5), (real)i, 1});
    }
    for (int i = 0; i < 2; i++) {
        on.lane[i] = i + 1;
        lane_set(&on.weight, i, (bs_vec3){R(0.5), 2, R(0.25)});
    }
    secondary_go_on(&on, &q);
    assert_int_equal(q.n, 2);
    assert_int_equal(q.lane[0], 10);
    assert_int_equal(q.lane[1], 20);
    NEAR(q.weight.x[0], 0.25, 0);
    NEAR(q.weight.y[1], 4, 0);
    NEAR(q.weight.z[1], 0.25, 0);
}

static void adding(void **state)
{
    static ray_queue q;
    static vec3s from, to;
    (void)state;
    q.n = 2;
    q.lane[0] = q.lane[1] = 7; /* a mirrored and a refracted ray of one place */
    lane_set(&q.weight, 0, (bs_vec3){R(0.5), 0, 1});
    lane_set(&q.weight, 1, (bs_vec3){R(0.25), 1, 1});
    lane_set(&from, 0, (bs_vec3){2, 2, 2});
    lane_set(&from, 1, (bs_vec3){4, 4, 4});
    secondary_add(&q, &from, &to);
    NEAR(to.x[7], 2, 0);
    NEAR(to.y[7], 4, 0);
    NEAR(to.z[7], 6, 0);
    CHECK(to.x[0], ==, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_mirror),    cmocka_unit_test(depth_ends_it), cmocka_unit_test(three_panes),
        cmocka_unit_test(clear_glass), cmocka_unit_test(going_on),      cmocka_unit_test(adding),
    };
    return cmocka_run_group_tests_name("secondary rays", tests, NULL, NULL);
}
