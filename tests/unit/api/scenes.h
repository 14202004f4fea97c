/* Small scenes as texts, and the calls of kage.h that must succeed, for the tests of the library's face. */
#ifndef KAGE_TESTS_API_SCENES_H
#define KAGE_TESTS_API_SCENES_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "kage.h"

#define HEAD                                                                                                           \
    "camera: {from: [0.5, 3, -5], at: [0, 0, 0], fov: 40}\n"                                                           \
    "image: {size: [48, 32], background: [0.1, 0.2, 0.3]}\n"                                                           \
    "lights:\n"                                                                                                        \
    "  lamp: {at: [-4, 5, -2], color: [1, 1, 1]}\n"                                                                    \
    "materials:\n"                                                                                                     \
    "  clay: {color: [0.8, 0.7, 0.6], ambient: 0.1, diffuse: 0.8}\n"                                                   \
    "objects:\n"                                                                                                       \
    "  cube: {box: {from: [-1, 0.5, -1], to: [0, 1.5, 0]}, material: clay}\n"

#define GROUND                                                                                                         \
    HEAD "  ground:\n"                                                                                                 \
         "    plane: {origin: [0, 0, 0], u: [0, 0, 1], w: [1, 0, 0]}\n"                                                \
         "    material: clay\n"                                                                                        \
         "    bump: {function: 0.1*sin(3*u)*cos(2*w)}\n"

#define WITH_MAP                                                                                                       \
    HEAD "  ball:\n"                                                                                                   \
         "    sphere: {center: [0, 0, 0], radius: 1.4}\n"                                                              \
         "    material: clay\n"                                                                                        \
         "    bump: {map: {file: bumps.png}, repeat: [2, 1], scale: 0.1, zero: 0.5, sign: up}\n"

#define PARAMETRIC                                                                                                     \
    HEAD "  dome:\n"                                                                                                   \
         "    parametric: {x: 2*cos(u)*sin(w), y: cos(w), z: 2*sin(u)*sin(w), u: [0, 3], w: [0.2, 1.4]}\n"             \
         "    material: clay\n"                                                                                        \
         "    bump: {function: 0.05*sin(9*u)}\n"

#define MODEL                                                                                                          \
    HEAD "  model:\n"                                                                                                  \
         "    mesh: {file: lantern.obj}\n"                                                                             \
         "    material: clay\n"

static inline void fail_by(const char *what, kage_errors *e)
{
    const kage_error *first = kage_errors_get(e, 0);
    fail_msg("%s: %s", what, first ? first->message : "failed without an error");
}

static inline kage_scene *parse_with(const char *text, const char *folder, const kage_load_options *o)
{
    kage_scene *s = NULL;
    kage_errors *e = NULL;
    if (kage_scene_parse(text, strlen(text), "test.yaml", folder, o, &s, &e) != KAGE_OK)
        fail_by("kage_scene_parse", e);
    assert_null(e);
    assert_non_null(s);
    return s;
}

static inline kage_scene *parse(const char *text) { return parse_with(text, NULL, NULL); }

static inline kage_film *render_with(kage_scene *s, const kage_render_options *o)
{
    kage_film *f = NULL;
    kage_errors *e = NULL;
    if (kage_render(s, o, &f, &e) != KAGE_OK)
        fail_by("kage_render", e);
    assert_null(e);
    assert_non_null(f);
    return f;
}

static inline size_t pixels_of(const kage_film *f) { return (size_t)kage_film_width(f) * (size_t)kage_film_height(f); }

/* Whether two films have the same planes with the same bytes. */
static inline int same_films(const kage_film *a, const kage_film *b)
{
    if (kage_film_plane_count(a) != kage_film_plane_count(b) || pixels_of(a) != pixels_of(b))
        return 0;
    for (int k = 0; k < kage_film_plane_count(a); k++) {
        const char *name = kage_film_plane_name(a, k);
        const float *x = kage_film_plane(a, name), *y = kage_film_plane(b, name);
        if (!y || memcmp(x, y, pixels_of(a) * sizeof *x) != 0)
            return 0;
    }
    return 1;
}

#endif
