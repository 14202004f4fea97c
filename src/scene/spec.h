/* What the scene file said, for exports and reports. Tracing does not read it, but for shape_has_inside. */
#ifndef KAGE_SCENE_SPEC_H
#define KAGE_SCENE_SPEC_H

#include <stdbool.h>

#include "base/vec3.h"
#include "mesh/mesh_data.h"
#include "texture/table.h"

/* Of a camera. */
typedef struct camera_view {
    vec3 at, up;
    double fov, width; /* width: of an orthographic one */
} camera_view;

/* What `kage check` says of a map; width 0: none. */
typedef struct map_note {
    char *file;
    int width, height;
    double low, high; /* of the samples, before scale and zero */
} map_note;

/* A shape as the file said it, for exports. */
typedef enum shape_kind {
    SHAPE_PLANE,
    SHAPE_RECTANGLE,
    SHAPE_DISC,
    SHAPE_BOX,
    SHAPE_SPHERE,
    SHAPE_CYLINDER,
    SHAPE_CONE,
    SHAPE_TORUS,
    SHAPE_PATCH, /* parametric, patches */
    SHAPE_MESH,
} shape_kind;

typedef struct shape_spec {
    shape_kind kind;
    vec3 a, u, w; /* plane, rectangle: origin, u, w; box: a and u are opposite corners; sphere, disc, torus: a is the
                     centre, u the normal or axis; cylinder, cone: a and u are the ends */
    double radius[2]; /* cylinder, cone: at a, at u; torus: major, minor */
    bool open;
    char *file;    /* mesh: as the file said it, */
    int triangles; /* and what is in it */
    mesh_notes found;
} shape_spec;

/* Whether light that goes through it goes into it. An endless plane has an inside, the side away from n. */
static inline bool shape_has_inside(const shape_spec *f)
{
    return f->kind != SHAPE_RECTANGLE && f->kind != SHAPE_DISC && f->kind != SHAPE_PATCH && f->kind != SHAPE_MESH &&
           !f->open;
}

/* A bump likewise: a function's text and scale, or where a map's samples lie (how many: map_note). */
typedef struct bump_spec {
    char *function; /* NULL: a map, or no bump */
    double scale;
    map_layout layout;
} bump_spec;

#endif
