/* A scene, as the tracer needs it. It owns all it points to. */
#ifndef KAGE_SCENE_SCENE_H
#define KAGE_SCENE_SCENE_H

#include "base/affine.h"
#include "base/errors.h"
#include "base/files.h"
#include "base/progress.h"
#include "geometry/surface.h"
#include "method/method.h"
#include "scene/camera.h"
#include "scene/light.h"
#include "scene/material.h"
#include "scene/spec.h"
#include "texture/bump.h"
#include "texture/color.h"

typedef struct object {
    char *name;
    surface *shape;      /* Q(u,w) */
    surface *displaced;  /* Q + P n/|n|, where scene_wants_truth; else NULL */
    surface *own;        /* the shape before its transform; without one the same */
    surface *centred;    /* what a moved shape is the image of: the same about the origin */
    const char *copy_of; /* the object whose `own` it is; NULL: its own */
    bool moved;          /* it has a transform, or what it copies has: `placed` */
    bool shares_bump;    /* bump, the texts of bump_spec and map are another's */
    affine placed;
    shape_spec shape_spec; /* before the transform */
    bump_spec bump_spec;
    bump *bump;              /* NULL: smooth */
    color_texture *color;    /* NULL: the material's */
    map_layout color_layout; /* how its image, or its fields, lie on (u,w) */
    int material;
    map_note map;
} object;

typedef struct scene {
    char *path;      /* of the file, or the name of a text in memory */
    char *source;    /* its text; with the maps and the --set changes all that the picture is made from */
    files made_from; /* with the scene's own file */
    int width, height;
    vec3 background;
    camera camera;
    camera_view view;
    method shadow;
    bool guard;
    bool displaced;   /* render.surface: rays meet the displaced surfaces */
    bool self_shadow; /* bumped objects cast shadows */
    int aa;
    double aa_threshold; /* < 0: none */
    int depth;           /* rays in a row: 1 for those of the camera alone */
    bool sends, clear;   /* some object's material sends rays on; lets light through */
    light *light;
    int lights;
    material *material;
    int materials;
    object *object;
    int objects;
    struct object_bvh *object_bvh; /* where there are many (object_bvh.h); NULL: few */
} scene;

/* Whether bumped objects need their displaced surfaces. */
static inline bool scene_wants_truth(const scene *s) { return s->displaced || s->shadow.kind == METHOD_EXACT; }

/* Limits: pixels along a side; lights, materials, objects; samples along a pixel's side; rays in a row. */
enum { SCENE_MAX_SIDE = 32768, SCENE_MAX_ITEMS = 4096, SCENE_MAX_AA = 16, SCENE_MAX_DEPTH = 32 };

/* Where a scene is read from. All but `path` may be zero. */
typedef struct scene_source {
    const char *path; /* of the file; of a text in memory a name, for errors */
    const char *text; /* the scene itself, `size` bytes; NULL: it is in the file */
    size_t size;
    const char *folder; /* that relative names of files begin in; NULL: that of `path` */
    int sets;           /* changes of the form PATH=VALUE, made first */
    const char *const *set;
    int threads;              /* 0: all processors */
    const char *model_reader; /* the program that reads models; NULL: where mesh/load.c finds it */
    const progress *progress; /* sees how large files come in; NULL: nobody */
} scene_source;

/* Read a scene. NULL: every error that can be found at once is in *e, as `file:line:col: ...`, the line and a caret. */
scene *scene_read(const scene_source *from, errors *e);

void scene_free(scene *s);

#endif
