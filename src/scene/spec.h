/* What the scene file said, for exports and reports. Tracing reads only shape_has_inside of it. */
#ifndef KAGE_SCENE_SPEC_H
#define KAGE_SCENE_SPEC_H

#include <stdbool.h>

#include "base/vec3.h"
#include "geometry/closed_form.h"
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

/* A shape, for exports and transforms. */
typedef enum shape_kind {
    SHAPE_CLOSED, /* of a closed form */
    SHAPE_PATCH,  /* parametric, patches */
    SHAPE_MESH,
} shape_kind;

typedef struct shape_spec {
    shape_kind kind;
    const closed_form *form; /* NULL of other kinds */
    shape_values values;     /* of the form's parameters */
    char *file;              /* mesh: as the file said it, owned; */
    int triangles;           /* and what is in it */
    mesh_notes found;
} shape_spec;

/* Whether light that goes through it goes into it. An endless plane has an inside, the side away from n. */
static inline bool shape_has_inside(const shape_spec *f)
{
    return f->kind == SHAPE_CLOSED && f->form->solid && !f->values.open;
}

/* A bump likewise: a function's text and scale, or where a map's samples lie (how many: map_note). */
typedef struct bump_spec {
    char *function; /* NULL: a map, or no bump */
    double scale;
    map_layout layout;
} bump_spec;

#endif
