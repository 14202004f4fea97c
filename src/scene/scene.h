/* A scene in memory. It owns all it points to. Nothing changes it after reading, so threads share it. */
#ifndef KAGE_SCENE_SCENE_H
#define KAGE_SCENE_SCENE_H

#include "base/affine.h"
#include "base/errors.h"
#include "base/files.h"
#include "base/progress.h"
#include "base/shelf.h"
#include "crowd/crowd.h"
#include "geometry/closed_form.h"
#include "geometry/surface.h"
#include "mesh/mesh_data.h"
#include "method/bump_shadow.h"
#include "method/method.h"
#include "scene/arrays.h"
#include "scene/camera.h"
#include "scene/light.h"
#include "scene/material.h"
#include "texture/bump.h"
#include "texture/color.h"
#include "texture/table.h"

/* ---- what the scene file says, for exports and reports ---- */

/* The camera's view, for another picture size and for exports. fov in degrees; width in scene units. */
typedef struct camera_view {
    vec3 at, up;
    double fov, width; /* pinhole: fov; orthographic: width */
} camera_view;

/* A height map, for reports. width 0: none. */
typedef struct map_note {
    char *file;        /* as the scene names it */
    int width, height; /* in samples */
    double low, high;  /* of the samples, before scale and zero */
    int bits;          /* of a sample, which has 2^bits values from 0 to 1; 0: it is a float */
} map_note;

/* A shape, for exports and transforms. */
typedef enum shape_kind {
    SHAPE_CLOSED, /* a surface with a formula for its hits */
    SHAPE_PATCH,  /* parametric, or Bezier patches */
    SHAPE_MESH,
} shape_kind;

typedef struct shape_spec {
    shape_kind kind;
    const closed_form *form; /* SHAPE_CLOSED; otherwise NULL */
    shape_values values;     /* of the form's parameters */
    char *file;              /* SHAPE_MESH: as the scene names it, owned */
    int triangles;           /* of the mesh */
    mesh_notes found;        /* repairs and defects of the mesh */
} shape_spec;

/* Whether it has an inside, so that a ray through it enters or leaves. A plane's inside is the side away from n. */
static inline bool shape_has_inside(const shape_spec *f)
{
    return f->kind == SHAPE_CLOSED && f->form->solid && !f->values.open;
}

/* A bump, for exports: a function's text and scale, or the layout of a map. */
typedef struct bump_spec {
    char *function; /* NULL: a map, or no bump */
    double scale;
    map_layout layout;
} bump_spec;

/* ---- the scene ---- */

typedef struct object {
    char *name;
    surface *shape;      /* Q(u,w) */
    surface *displaced;  /* Q + P n/|n|; NULL unless scene_wants_truth */
    surface *own;        /* the shape before the transform; `shape` itself without one */
    surface *centred;    /* the shape moved to the origin, which a transformed shape wraps */
    const char *copy_of; /* the name of the object that owns `own`; NULL: this one */
    const char *bump_of; /* the name of the object whose own the bump is; NULL: this one */
    bool moved;          /* it has the transform `placed` */
    bool shares_bump;    /* bump and the texts in bump_spec and map belong to another object */
    affine placed;
    shape_spec shape_spec; /* before the transform */
    bump_spec bump_spec;
    bump *bump;              /* NULL: smooth */
    color_texture *color;    /* NULL: the material's */
    map_layout color_layout; /* how the colour's image or checker lies on (u,w) */
    int material;            /* index into scene.material */
    map_note map;

    /* Of copies. A list with several materials is an object for each, one after another. They share the crowd and are
     * the kinds of its hits; the first stands for all where rays are tested. */
    const crowd *crowd; /* `shape` of the first; NULL: no copies */
    int32_t first;      /* an object that is not of copies: itself */
    int32_t inside;     /* for media: a number of its own; copies have those from here on */
    bool hidden;        /* not in the picture */
} object;

typedef struct scene {
    char *path;      /* of the file, or the name of a text in memory */
    char *source;    /* the text of the scene, before --set changes */
    files made_from; /* all files that were read */
    shelf shelf;     /* what other scenes may use, too */
    int width, height;
    vec3 background;
    camera camera;
    camera_view view;
    method shadow;
    bool guard;   /* orders fall back where their result is outside the slab */
    bool shifted; /* shade at r + s t0 */
    bump_shadow bump_shadow;
    bool displaced;   /* rays meet the displaced surfaces */
    bool self_shadow; /* bumped objects cast shadows */
    int aa;
    double aa_threshold; /* aa x aa samples only where neighbours differ by more; < 0: everywhere */
    int depth;           /* rays in a row; 1: only the camera's */
    bool sends, clear;   /* some material has secondary rays; some material is transparent */
    light *light;
    int lights;
    material *material;
    int materials;
    object *object;
    int objects;                   /* in the picture */
    int kept;                      /* with the hidden ones, which come last */
    struct horizons *horizons;     /* NULL unless scene_wants_horizons */
    struct object_bvh *object_bvh; /* of many objects; NULL: few, all are tested */
} scene;

/* Whether bumped objects need their displaced surfaces. */
static inline bool scene_wants_truth(const scene *s)
{
    return s->displaced || s->shadow.kind == METHOD_EXACT || s->bump_shadow.kind == BUMP_SHADOW_EXACT;
}

/* The setting that needs them, for messages. */
static inline const char *scene_truth_name(const scene *s)
{
    return s->displaced ? "surface displaced" : s->shadow.kind == METHOD_EXACT ? "shadow exact" : "bump_shadow exact";
}

/* Whether bumped objects need horizon maps. Displaced surfaces do not: their bumps are real. */
static inline bool scene_wants_horizons(const scene *s)
{
    return s->bump_shadow.kind == BUMP_SHADOW_HORIZON && !s->displaced;
}

/* Limits: pixels along a side; lights, materials; objects in the scene file; samples along a pixel's side; rays in a
 * row. */
enum {
    SCENE_MAX_SIDE = 32768,
    SCENE_MAX_ITEMS = 4096,
    SCENE_MAX_OBJECTS = 1 << 24,
    SCENE_MAX_AA = 16,
    SCENE_MAX_DEPTH = 32
};

/* Where a scene is read from. Only `path` is needed. */
typedef struct scene_source {
    const char *path; /* the file; for a text in memory its name in errors */
    const char *text; /* the scene, `size` bytes; NULL: read the file */
    size_t size;
    const char *folder; /* for relative file names; NULL: the folder of `path` */
    int sets;           /* changes of the form PATH=VALUE */
    const char *const *set;
    int threads;              /* 0: all processors */
    const char *model_reader; /* the program kage-import; NULL: mesh/reader.c looks for it */
    const progress *progress; /* while large files are read; may be NULL */
    const arrays *arrays;     /* that the scene may name; NULL: none. They live as long as the scene */
    int shelves;              /* that may have what the scene needs */
    const shelf *const *shelf;
    bool survey; /* no displaced surfaces and no horizons, which only rendering needs */
    bool again;  /* a scene that is changed: keep what further changes need */
} scene_source;

/* Read a scene. NULL: all errors are in *e, as `file:line:col: ...`, the line and a caret. */
scene *scene_read(const scene_source *from, errors *e);

void scene_free(scene *s);

#endif
