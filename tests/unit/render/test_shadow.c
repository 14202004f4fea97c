/* Where shadow rays start, and how much of a light they see: the receiver's own shadow from p1, others' from r + s t0.
 */
#include "support/check.h"
#include "support/scene_text.h"

#define HEAD                                                                                                           \
    "camera: {from: [0, 6, 0], at: [0, 0, 0], up: [0, 0, 1], fov: 20}\n"                                               \
    "image: {size: [16, 8]}\n"                                                                                         \
    "materials: {clay: {color: [1, 1, 1]}, glass: {color: [0.5, 0.25, 1], filter: 0.8, transmit: 0.1}}\n"

/* The visibilities of the first light. */
static real *visible(const char *text, const char *method_text, bool self_shadow, real *lit)
{
    scene *s = scene_text(text);
    tracer tr = {.scene = s, .guard = true, .displaced = s->displaced, .self_shadow = self_shadow, .layers = true};
    assert_true(method_parse(method_text, &tr.shadow));
    workspace *v = camera_wave(&tr);
    trace(&tr, LANES, v);
    for (int i = 0; i < LANES; i++)
        lit[i] = v->visibility[0][i];
    workspace_free(v);
    scene_free(s);
    return lit;
}

/* A low wall before a floor of the height P = 0.2: it shades p1, and not the shifted place above it. */
#define WALL                                                                                                           \
    HEAD "lights: {sun: {at: [60, 6, 0], color: [1, 1, 1]}}\n"                                                         \
         "objects:\n"                                                                                                  \
         "  floor: {plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: clay, bump: {function: 0.2}}\n"  \
         "  wall: {rectangle: {origin: [5, 0.3, -9], u: [0, 0, 18], w: [0, 0.3, 0]}, material: clay}\n"

static void others_from_the_shifted_place(void **state)
{
    real lit[LANES];
    (void)state;
    /* from p1 the segment passes the wall, 0.3 to 0.6 high, at the height 0.5; from 0.2 above at 0.68 */
    CHECK(visible(WALL, "none", true, lit)[64 + 8], ==, 0);
    CHECK(visible(WALL, "0", true, lit)[64 + 8], ==, 1);
}

/* The light is low: it shines on the top of the ball, and not on the tangent plane of the place 0.5 above it. */
static void receiver_from_p1(void **state)
{
    real lit[LANES];
    (void)state;
    visible(HEAD "lights: {sun: {at: [40, 1.5, 0], color: [1, 1, 1]}}\n"
                 "objects: {ball: {sphere: {center: [0, 0, 0], radius: 2}, material: clay, bump: {function: 0.5}}}\n",
            "0", true, lit);
    CHECK(lit[64 + 8], ==, 1);
    CHECK(lit[64 + 5], ==, 0); /* on the other side of the top */
}

/* A light behind the ball, below: its own shadow, which is not asked for without self_shadow. */
static void own_shadow(void **state)
{
    static const char text[] = HEAD "lights: {sun: {at: [0, -9, 0], color: [1, 1, 1]}}\n"
                                    "objects: {ball: {box: {from: [-3, -1, -3], to: [3, 0, 3]}, material: clay, bump: "
                                    "{function: 0.001}}}\n";
    real lit[LANES];
    (void)state;
    CHECK(visible(text, "0", true, lit)[20], ==, 0);
    CHECK(visible(text, "0", false, lit)[20], ==, 1);
}

/* Half of the area's 2 x 1 samples are behind the wall. */
static void half_of_an_area(void **state)
{
    real lit[LANES];
    (void)state;
    visible(
        HEAD
        "lights: {lamp: {at: [0, 4, 0], color: [1, 1, 1], area: {u: [4, 0, 0], w: [0, 0, 0.01], samples: [2, 2]}}}\n"
        "objects:\n"
        "  floor: {plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: clay}\n"
        "  wall: {rectangle: {origin: [0.8, 0, -9], u: [0, 0, 18], w: [0, 3.5, 0]}, material: clay}\n",
        "none", true, lit);
    NEAR(lit[64 + 8], 0.5, EPS);
}

/* A pane is crossed once: what is left is color * filter + transmit, and the visibility is its mean. */
static void through_a_pane(void **state)
{
    real lit[LANES];
    (void)state;
    visible(HEAD "lights: {sun: {at: [40, 40, 0], color: [1, 1, 1]}}\n"
                 "objects:\n"
                 "  floor: {plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: clay}\n"
                 "  pane: {rectangle: {origin: [4, 0, -9], u: [0, 0, 18], w: [0, 9, 0]}, material: glass}\n",
            "none", true, lit);
    NEAR(lit[64 + 8], (0.5 * 0.8 + 0.1 + 0.25 * 0.8 + 0.1 + 0.8 + 0.1) / 3, 4 * EPS);
}

/* A ball of glass is crossed twice. */
static void through_a_ball(void **state)
{
    real lit[LANES];
    (void)state;
    visible(HEAD "lights: {sun: {at: [40, 40, 0], color: [1, 1, 1]}}\n"
                 "objects:\n"
                 "  floor: {plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: clay}\n"
                 "  ball: {sphere: {center: [8, 8, 0], radius: 3}, material: glass}\n",
            "none", true, lit);
    NEAR(lit[64 + 8], (0.5 * 0.5 + 0.3 * 0.3 + 0.9 * 0.9) / 3, 4 * EPS);
}

/* Sixteen points of the rectangle x = 4, 0 <= y <= 9, z0 <= z <= z0 + 9. */
static int put_patch(char *to, size_t size, double z0)
{
    int n = snprintf(to, size, "[");
    for (int k = 0; k < 16; k++)
        n += snprintf(to + n, size - (size_t)n, "%s[4, %d, %g]", k ? ", " : "", 3 * (k / 4), z0 + 3 * (k % 4));
    return n + snprintf(to + n, size - (size_t)n, "]");
}

/* A displaced pane of two patches: a segment that has crossed one goes on from there, whichever of them it is. */
static void through_displaced_patches(void **state)
{
    static char text[4096];
    real lit[LANES];
    (void)state;
    int n = snprintf(text, sizeof text, "%s",
                     HEAD "lights: {sun: {at: [40, 40, 0], color: [1, 1, 1]}}\n"
                          "render: {surface: displaced}\n"
                          "objects:\n"
                          "  floor: {plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: clay}\n"
                          "  pane: {material: glass, bump: {function: 0.01}, patches: {points: [");
    n += put_patch(text + n, sizeof text - (size_t)n, -9);
    n += snprintf(text + n, sizeof text - (size_t)n, ", ");
    n += put_patch(text + n, sizeof text - (size_t)n, 0);
    snprintf(text + n, sizeof text - (size_t)n, "]}}\n");
    visible(text, "none", true, lit);
    for (int i = 0; i < LANES; i++)
        NEAR(lit[i], (0.5 * 0.8 + 0.1 + 0.25 * 0.8 + 0.1 + 0.8 + 0.1) / 3, 4 * EPS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(others_from_the_shifted_place),
        cmocka_unit_test(receiver_from_p1),
        cmocka_unit_test(own_shadow),
        cmocka_unit_test(half_of_an_area),
        cmocka_unit_test(through_a_pane),
        cmocka_unit_test(through_a_ball),
        cmocka_unit_test(through_displaced_patches),
    };
    return cmocka_run_group_tests_name("shadow", tests, NULL, NULL);
}
