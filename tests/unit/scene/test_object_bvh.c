/* Scenes of many objects: what the hierarchy leaves out is never met. Every ray finds with it just what it finds where
 * all objects are tried, to the last bit: from outside and inside, along axes, from far away, to lights, and from
 * surfaces by mirrors and glass.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "scene/object_bvh.h"
#include "wave/lane.h"
#include "support/check.h"
#include "support/random_in.h"
#include "render/trace.h"
#include "scene/scene.h"

enum { OBJECTS = 60, WAVES = 40 };

static const char head[] = "camera: {from: [0, 4, -12], at: [0, 1, 0]}\n"
                           "image: {size: [32, 18]}\n"
                           "render: {depth: 4%s}\n"
                           "lights:\n"
                           "  sun: {at: [-6, 9, -4], color: [1, 1, 1]}\n"
                           "  lamp: {at: [2, 2, 1], color: [0.4, 0.4, 0.5]}\n"
                           "materials:\n"
                           "  clay: {color: [0.8, 0.7, 0.6]}\n"
                           "  mirror: {color: [0.2, 0.2, 0.2], reflection: 0.7}\n"
                           "  glass: {color: [0.7, 0.9, 0.8], filter: 0.8, ior: 1.4}\n"
                           "objects:\n"
                           "  floor: {plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}, material: clay, bump: "
                           "{function: 0.04*sin(7*u)*sin(7*w)}}\n";

/* One of each kind in turn: p is a place, k a size. */
static void put_object(FILE *f, int i)
{
    static const char *const materials[] = {"clay", "mirror", "clay", "glass", "clay"};
    static const char parametric[] =
        "x: \"%.3f + %.3f*cos(u)*(2+cos(w))\", y: \"%.3f + %.3f*sin(w)\", z: \"%.3f + %.3f*sin(u)*(2+cos(w))\"";
    const double x = random_in(-5, 5), y = random_in(0.2, 4), z = random_in(-4, 6), k = random_in(0.1, 0.5),
                 a = random_in(-1, 1);
    fprintf(f, "  o%d:\n    material: %s\n    ", i, materials[i % 5]);
    switch (i % 16 == 15 ? 7 : i % 7) {
    case 0:
        fprintf(f, "sphere: {center: [%.3f, %.3f, %.3f], radius: %.3f}\n", x, y, z, k);
        break;
    case 1:
        fprintf(f, "box: {from: [%.3f, %.3f, %.3f], to: [%.3f, %.3f, %.3f]}\n", x, y, z, x + k, y + 2 * k, z - k);
        break;
    case 2:
        fprintf(f, "torus: {center: [%.3f, %.3f, %.3f], axis: [%.3f, 1, 0.4], major: %.3f, minor: %.3f}\n", x, y, z, a,
                k, k / 3);
        break;
    case 3:
        fprintf(f, "cylinder: {from: [%.3f, %.3f, %.3f], to: [%.3f, %.3f, %.3f], radius: %.3f}\n", x, y, z, x + k,
                y - k, z + a, k / 2);
        break;
    case 4:
        fprintf(f, "cone: {from: [%.3f, %.3f, %.3f], from_radius: %.3f, to: [%.3f, %.3f, %.3f], to_radius: 0}\n", x, y,
                z, k, x + a, y + k, z);
        break;
    case 5:
        fprintf(f, "disc: {center: [%.3f, %.3f, %.3f], normal: [%.3f, 0.7, -0.3], radius: %.3f}\n", x, y, z, a, k);
        break;
    case 6:
        fprintf(f, "rectangle: {origin: [%.3f, %.3f, %.3f], u: [%.3f, 0, %.3f], w: [0, %.3f, 0.1]}\n", x, y, z, k, a,
                k);
        break;
    default:
        fprintf(f, "parametric: {");
        fprintf(f, parametric, x, k / 3, y, k / 3, z, k / 3);
        fprintf(f, ", u: [0, 2*pi], w: [0, 2*pi]}\n");
        break;
    }
    if (i % 3 == 0)
        fprintf(f, "    bump: {function: 0.01*sin(9*u)*sin(9*w)}\n");
    if (i % 4 == 1)
        fprintf(f, "    transform: [{rotate: [%.1f, %.1f, 0]}, {scale: 1.2}]\n", 20 * a, 30 * a);
}

static scene *many(const char *more)
{
    char path[] = "/tmp/kage-crowd-XXXXXX";
    const int fd = mkstemp(path);
    FILE *f = fd >= 0 ? fdopen(fd, "w") : NULL;
    errors e = {0};
    assert_non_null(f);
    fprintf(f, head, more);
    for (int i = 0; i < OBJECTS; i++)
        put_object(f, i);
    fclose(f);
    scene *s = scene_read(&(scene_source){.path = path}, &e);
    unlink(path);
    if (!s)
        fail_msg("%s", e.text);
    errors_free(&e);
    assert_non_null(s->object_bvh);
    return s;
}

static bool is_disc(const surface *f, int part)
{
    const char *kind = f->ops->kind;
    return strcmp(kind, "disc") == 0 || (part > 0 && (strcmp(kind, "cylinder") == 0 || strcmp(kind, "cone") == 0));
}

/* The box of each object holds its surface. */
static void boxes(void **state)
{
    scene *s = many("");
    (void)state;
    for (int k = 0; k < s->objects; k++) {
        const surface *f = s->object[k].shape;
        double lo[3], hi[3];
        f->ops->box(f, lo, hi);
        for (int32_t part = 0; part < f->ops->parts; part++)
            for (int i = 0; i < 400; i++) {
                double U[2], W[2];
                partials q;
                f->ops->extent(f, part, U, W);
                const bool ends = U[1] < HUGE_VAL;
                const real u = (real)(ends ? random_in(U[0], U[1]) : random_in(-9, 9)),
                           w = (real)(ends ? random_in(W[0], W[1]) : random_in(-9, 9));
                f->ops->eval(f, 1, &part, &u, &w, 1, &q);
                if (is_disc(f, part) && (double)(u * u + w * w) > U[1] * U[1])
                    continue; /* the extent is a square about it */
                const double p[3] = {(double)q.Q.x[0], (double)q.Q.y[0], (double)q.Q.z[0]};
                for (int a = 0; a < 3; a++)
                    BETWEEN(lo[a] - 1e-5, p[a], hi[a] + 1e-5);
            }
    }
    scene_free(s);
}

static bs_vec3 place(double far)
{
    return (bs_vec3){(real)random_in(-far, far), (real)random_in(-far / 2, far), (real)random_in(-far, far)};
}

/* From a place to one among the objects; some along an axis, some from far away, some of a bundle. */
static void random_rays(int wave, workspace *v)
{
    const bs_vec3 eye = place(wave % 4 == 3 ? 300 : 7);
    for (int i = 0; i < LANES; i++) {
        const bs_vec3 r = wave % 2 ? eye : place(7), to = place(5);
        bs_vec3 s = {to.x - r.x, to.y - r.y, to.z - r.z};
        if (wave % 5 == 4)
            s = i % 3 == 0 ? (bs_vec3){s.x, 0, 0} : i % 3 == 1 ? (bs_vec3){0, s.y, 0} : (bs_vec3){0, 0, s.z};
        lane_set(&v->x.r, i, r);
        lane_set(&v->x.s, i, s);
    }
}

static void same_with(scene *s, const tracer *k, int waves)
{
    workspace *a = workspace_new(k, NULL);
    object_bvh *c = s->object_bvh;
    int met = 0;
    s->object_bvh = NULL;
    workspace *b = workspace_new(k, NULL);
    for (int wave = 0; wave < waves; wave++) {
        random_rays(wave, a);
        b->x = a->x;
        s->object_bvh = c;
        trace(k, LANES, a);
        s->object_bvh = NULL;
        trace(k, LANES, b);
        assert_memory_equal(&a->out.rgb, &b->out.rgb, sizeof a->out.rgb);
        assert_memory_equal(a->out.depth, b->out.depth, sizeof a->out.depth);
        for (int l = 0; l < s->lights; l++)
            assert_memory_equal(a->visibility[l], b->visibility[l], sizeof a->visibility[l]);
        for (int i = 0; i < LANES; i++)
            met += a->out.depth[i] < REAL_FAR;
    }
    assert_true(met > waves * LANES / 4);
    assert_int_equal(a->stats->secondary_rays, b->stats->secondary_rays);
    assert_true(a->stats->secondary_rays > waves);
    s->object_bvh = c;
    workspace_free(a);
    workspace_free(b);
    scene_free(s);
}

static void smooth(void **state)
{
    scene *s = many("");
    const tracer k = {.scene = s, .shadow = {METHOD_ORDER, 2}, .guard = true, .self_shadow = true, .layers = true};
    (void)state;
    same_with(s, &k, WAVES);
}

static void rough(void **state)
{
    scene *s = many(", surface: displaced");
    const tracer k = {.scene = s, .displaced = true, .self_shadow = true, .layers = true};
    (void)state;
    same_with(s, &k, WAVES / 8);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(boxes), cmocka_unit_test(smooth), cmocka_unit_test(rough)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
