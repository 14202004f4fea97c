/* What the parts of the scene reader share: its state, and the small readers. Private to scene_*.c. */
#ifndef KAGE_READ_READER_H
#define KAGE_READ_READER_H

#include "scene/scene.h"
#include "yaml/yaml.h"

/* Numbers of a scene: within these, no product of a few overflows float, and no square vanishes. */
#define BIG 1e6
#define SMALL 1e-6

typedef struct reader {
    yaml *y;
    scene *s;
    errors *e;
    const scene_source *from;
} reader;

/* An owned copy of a text; NULL of NULL. */
char *reader_copy(reader *r, const char *text);

/* Three numbers, each within BIG. An absent key leaves *v and is no error here. */
bool reader_vector(reader *r, node *map, const char *key, const char *what, vec3 *v);

/* A linear colour likewise. */
bool reader_color(reader *r, node *map, const char *key, vec3 *v);

/* A number lo <= x <= hi; `open`: lo < x. An absent key leaves *x and is no error here. */
bool reader_number(reader *r, node *map, const char *key, double lo, bool open, double hi, const char *what, double *x);

/* A name in a map of named things; owned. NULL: an error is told. */
char *reader_name(reader *r, node *map, node *key);

/* A map of named things: makes room for them. Returns their map, NULL where there is none or it is wrong. */
node *reader_named(reader *r, const char *key, const char *what, bool need, size_t size, void *array, int *count);

/* (scene_lights.c) */
void reader_lights(reader *r);

/* The file beside the scene, so that a scene finds its files from any working directory; owned. It is one of those that
 * the scene is made from. */
char *reader_beside(reader *r, const char *file);

/* Where a map lies on a surface with that extent: size or repeat, offset, wrap and samples. (scene_objects.c) */
bool reader_layout(reader *r, node *at, const double u[2], const double w[2], map_layout *l);

/* (scene_materials.c) The materials; the colour of an object's, where it is not constant. `at`: the object's material,
 * for errors. */
void reader_materials(reader *r);
void reader_color_texture(reader *r, node *at, object *o);

/* The surface of an object, by the one key of READER_SHAPES that it has. NULL: an error is told. (scene_surfaces.c) */
#define READER_SHAPES "plane rectangle disc box sphere cylinder cone torus parametric patches mesh"
surface *reader_surface(reader *r, node *at, shape_spec *said);
bool reader_no_shape(reader *r, node *at); /* it has none; otherwise an error is told */

/* What `transform` says, after what *m is already. False: an error is told. (scene_transform.c) */
bool reader_transform(reader *r, node *at, affine *m);

/* A round shape about the origin as a sheet, which bears every transform truly displaced. NULL: it has ends (caps) or
 * is not round, or out of memory. (scene_turned.c) */
surface *reader_revolution(const shape_spec *f, int threads);

/* Put an object's shape where `placed` says. False: an error is told, at the node. */
bool reader_place(reader *r, node *at, object *o);

/* The surfaces that are found by search. (scene_sheets.c) */
surface *reader_parametric(reader *r, node *at, shape_spec *said);
surface *reader_patches(reader *r, node *at, shape_spec *said);

/* Triangles from a file. (scene_mesh.c) */
surface *reader_mesh(reader *r, node *at, shape_spec *said);

/* Where a map or an image lies that says no size: the surface's extent, but of a mesh the square that its texture
 * coordinates are meant for. */
void reader_extent(const surface *f, const shape_spec *said, double u[2], double w[2]);

/* Whether what lies on (u,w), at the node, has (u,w) to lie on. False: an error is told. */
bool reader_textured(reader *r, node *at, const object *o);

/* A bump, or a colour, for a mesh some of whose texture is mirrored: it is folded (fold.h). */
bump *reader_fold_bump(reader *r, const object *o, bump *p);
color_texture *reader_fold_color(reader *r, const object *o, color_texture *c);

/* The objects with their surfaces and bumps; after the materials, whose names they give. (scene_objects.c) */
void reader_objects(reader *r);

#endif
