/* A scene, as the tracer needs it. Read from a file by scene_*.c; owns all it points to. */
#ifndef KAGE_SCENE_SCENE_H
#define KAGE_SCENE_SCENE_H

#include "base/errors.h"
#include "base/files.h"
#include "scene/light.h"
#include "mesh/mesh_data.h"
#include "method/method.h"
#include "texture/bump.h"
#include "texture/color.h"
#include "geometry/closed_form.h"
#include "base/progress.h"

/* The ray of a pixel, with x and y in -1..1 over the image:
 *     a pinhole      from + t (forward + x right + y up), so that s is no unit vector
 *     orthographic   from + x right + y up + t forward
 * In both t is the depth along forward. */
typedef struct camera {
    vec3 from;
    vec3 forward;   /* unit */
    vec3 right, up; /* to the edges of the image: half the picture's width and height, a pinhole's at unit depth */
    bool orthographic;
} camera;

/* A camera at `from` that looks at `at`; fov is the horizontal angle of the picture in degrees. False where the
 * directions have no sense: at = from, or up along the view. */
bool camera_look(camera *c, vec3 from, vec3 at, vec3 up, double fov, int width, int height);

/* Likewise an orthographic one, whose picture is `across` scene units wide. */
bool camera_orthographic(camera *c, vec3 from, vec3 at, vec3 up, double across, int width, int height);

/* The same as the file said it, for exports. */
typedef struct camera_view {
    vec3 at, up;
    double fov, width; /* width: of an orthographic one */
} camera_view;

/* What a colour is made of. */
typedef enum pattern { PATTERN_NONE, PATTERN_CHECKER, PATTERN_IMAGE } pattern;

/* POV-Ray's finish: ambient and diffuse light on the colour, and two kinds of highlight in the light's colour. */
typedef struct material {
    char *name;
    vec3 color;        /* linear */
    pattern pattern;   /* none: the colour is the same everywhere; otherwise it is the object's */
    vec3 field[2];     /* of a checker */
    map_layout layout; /* of the checker's fields; of an image the wrap alone, as the rest depends on the surface */
    texels *texels;    /* of an image, shared by the objects */
    char *file;        /* the image as the file said it, */
    bool exr, linear, nearest; /* its kind; a PNG taken for linear; without interpolation */
    double ambient, diffuse;
    double phong, phong_size;
    double specular, roughness;
    vec3 reflection;         /* of the light from the mirrored direction */
    double filter, transmit; /* of the light from behind, in the material's colour and in its own */
    double ior;
} material;

/* Whether light comes from behind; the share of ambient and diffuse light that is left; whether rays go on from here.
 */
static inline bool material_clear(const material *m) { return m->filter + m->transmit > 0; }
static inline double material_opacity(const material *m) { return 1 - m->filter - m->transmit; }
static inline bool material_mirrors(const material *m)
{
    return m->reflection.x + m->reflection.y + m->reflection.z > 0;
}
static inline bool material_sends(const material *m) { return material_clear(m) || material_mirrors(m); }

/* What `kage check` says of a map; width 0: none. */
typedef struct map_note {
    char *file;
    int width, height;
    double low, high; /* of the samples, before scale and zero */
} map_note;

/* A shape as the file said it, for exports and transforms. */
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

typedef struct object {
    char *name;
    surface *shape;
    surface *own;        /* the shape before its transform: the same where it has none */
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
    bool displaced;   /* render.surface: bumped objects as what they stand for */
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
    struct object_bvh *object_bvh; /* where there are many (crowd.h); NULL: few */
} scene;

/* Whether true hits of bumped objects are asked for (displace.h). */
static inline bool scene_wants_truth(const scene *s) { return s->displaced || s->shadow.kind == METHOD_EXACT; }

/* The number of threads, lights and so on that a scene can have at most. */
enum { SCENE_MAX_SIDE = 32768, SCENE_MAX_ITEMS = 4096, SCENE_MAX_AA = 16, SCENE_MAX_DEPTH = 32 };

/* Where a scene is read from. All but `path` may be zero. */
typedef struct scene_source {
    const char *path;         /* of the file; of a text in memory a name, for errors */
    const char *text;         /* the scene itself, `size` bytes; NULL: it is in the file */
    size_t size;
    const char *folder;       /* that relative names of files begin in; NULL: that of `path` */
    int sets;                 /* changes of the form PATH=VALUE, made first */
    const char *const *set;
    int threads;              /* 0: all processors */
    const char *model_reader; /* the program that reads models; NULL: where mesh/load.c finds it */
    const progress *progress; /* sees how large files come in; NULL: nobody */
} scene_source;

/* Read a scene. NULL: every error that can be found at once is in *e, as `file:line:col: ...`, the line and a caret. */
scene *scene_read(const scene_source *from, errors *e);

void scene_free(scene *s);

#endif
