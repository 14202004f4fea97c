/* A wave of rays finds what each of its rays finds alone: groups, queues of secondary rays and candidates change
 * nothing. */
#include "support/check.h"
#include "support/scene_text.h"

/* Two bumped objects, a mirror, glass and an area light, so that groups are mixed and rays go on. */
#define MIXED                                                                                                          \
    "camera: {from: [0, 3, -8], at: [0, 0.6, 0], fov: 40}\n"                                                           \
    "image: {size: [16, 8]}\n"                                                                                         \
    "render: {depth: 5%s}\n"                                                                                           \
    "lights:\n"                                                                                                        \
    "  sun: {at: [-4, 6, -3], color: [1, 1, 1]}\n"                                                                     \
    "  lamp: {at: [2, 4, -2], color: [0.5, 0.4, 0.3], area: {u: [0.5, 0, 0], w: [0, 0, 0.5], samples: [2, 2]}}\n"      \
    "materials:\n"                                                                                                     \
    "  clay: {color: [0.8, 0.7, 0.6], phong: 0.5}\n"                                                                   \
    "  mirror: {color: [0.2, 0.2, 0.2], reflection: 0.7}\n"                                                            \
    "  glass: {color: [0.7, 0.9, 0.8], filter: 0.8, ior: 1.4}\n"                                                       \
    "objects:\n"                                                                                                       \
    "  floor: {plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: clay, bump: "                         \
    "{function: 0.05*sin(7*u)*sin(7*w)}}\n"                                                                            \
    "  ball: {sphere: {center: [-1, 1, 0], radius: 1}, material: mirror, bump: {function: 0.02*sin(9*u)*sin(9*w)}}\n"  \
    "  lens: {sphere: {center: [1.2, 0.9, -1], radius: 0.7}, material: glass}\n"                                       \
    "  block: {box: {from: [0.2, 0, 1], to: [1.4, 1.5, 2]}, material: clay}\n"

static void alone_as_in_a_wave(const char *more, tracer tr)
{
    char text[4096];
    snprintf(text, sizeof text, MIXED, more);
    scene *s = scene_text(text);
    tr.scene = s;
    tr.self_shadow = tr.layers = true;
    workspace *v = camera_wave(&tr), *one = workspace_new(&tr, NULL);
    const rays all = v->x;
    trace(&tr, LANES, v);
    CHECK(v->stats->secondary_rays, >, LANES / 4);
    for (int i = 0; i < LANES; i++) {
        lane_set(&one->x.r, 0, lane_get(&all.r, i));
        lane_set(&one->x.s, 0, lane_get(&all.s, i));
        trace(&tr, 1, one);
        CHECK(one->out.depth[0], ==, v->out.depth[i]);
        CHECK(one->out.tau[0], ==, v->out.tau[i]);
        CHECK(one->out.rgb.x[0], ==, v->out.rgb.x[i]);
        CHECK(one->out.rgb.y[0], ==, v->out.rgb.y[i]);
        CHECK(one->out.rgb.z[0], ==, v->out.rgb.z[i]);
        for (int l = 0; l < s->lights; l++)
            CHECK(one->visibility[l][0], ==, v->visibility[l][i]);
    }
    workspace_free(v);
    workspace_free(one);
    scene_free(s);
}

static void by_the_method(void **state)
{
    (void)state;
    alone_as_in_a_wave("", (tracer){.shadow = {METHOD_ORDER, 1}, .guard = true});
}

static void on_displaced_surfaces(void **state)
{
    (void)state;
    alone_as_in_a_wave(", surface: displaced", (tracer){.displaced = true});
}

/* Rays that meet nothing see the background, at no depth. */
static void nothing(void **state)
{
    (void)state;
    scene *s = scene_text("camera: {from: [0, 5, 0], at: [0, 6, 1]}\n"
                          "image: {size: [16, 8], background: [0.1, 0.2, 0.3]}\n"
                          "lights: {sun: {at: [0, 9, 0], color: [1, 1, 1]}}\n"
                          "materials: {clay: {color: [1, 1, 1]}}\n"
                          "objects: {ball: {sphere: {center: [0, 0, 0], radius: 1}, material: clay}}\n");
    const tracer tr = {.scene = s, .layers = true};
    workspace *v = camera_wave(&tr);
    trace(&tr, LANES, v);
    CHECK(v->out.depth[7], ==, REAL_FAR);
    NEAR(v->out.rgb.y[7], s->background.y, EPS);
    CHECK(v->out.order[7], ==, -1);
    CHECK(v->visibility[0][7], ==, 0);
    workspace_free(v);
    scene_free(s);
}

/* t0 = t_hit + tau, and the shifted place of a constant P = h lies h over the plane. */
static void shifted_place(void **state)
{
    (void)state;
    scene *s = scene_text("camera: {from: [0, 5, -5], at: [0, 0, 0], fov: 30}\n"
                          "image: {size: [16, 8]}\n"
                          "lights: {sun: {at: [0, 9, 0], color: [1, 1, 1]}}\n"
                          "materials: {clay: {color: [1, 1, 1]}}\n"
                          "objects: {floor: {plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: clay, "
                          "bump: {function: 0.25}}}\n");
    const tracer tr = {.scene = s, .shadow = {METHOD_ORDER, 0}, .guard = true};
    workspace *v = camera_wave(&tr);
    trace(&tr, LANES, v);
    for (int i = 0; i < LANES; i++) {
        CHECK(v->g.t0[i], ==, v->g.t[i] + v->g.tau[i]);
        NEAR(lane_at(v->g.x, i, v->g.t0[i]).y, 0.25, 40 * EPS);
    }
    workspace_free(v);
    scene_free(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(by_the_method),
        cmocka_unit_test(on_displaced_surfaces),
        cmocka_unit_test(nothing),
        cmocka_unit_test(shifted_place),
    };
    return cmocka_run_group_tests_name("trace", tests, NULL, NULL);
}
