/* The parts of the scene reader, one for each kind of thing in a scene. scene.c calls those for the scene's keys;
 * objects.c calls those for an object. Each returns false, or NULL, with an error in the reader's list.
 */
#ifndef KAGE_READ_PARTS_H
#define KAGE_READ_PARTS_H

#include "read/values.h"

/* The keys image, camera and render. */
void reader_view(reader *r);

void reader_lights(reader *r);
void reader_materials(reader *r);

/* The objects; after the materials, which they use. */
void reader_objects(reader *r);

/* ---- sources.c: files and arrays that the scene names, and what other scenes have made from them ---- */

/* One of them: what the scene says; of a file its path, of an array what it is. */
typedef struct source {
    const char *name; /* of the yaml */
    char *path;       /* NULL: an array */
    const scene_array *array;
    char id[128]; /* another one where the file has changed; "": not known */
} source;

/* The source that a node names. what: "the file of a model". False with an error. */
bool reader_source(reader *r, node *file, bool is_mesh, const char *what, source *to);
void source_free(source *s);

/* A key for the functions below, as by printf; free() it. NULL: out of memory, with an error. */
char *reader_key(reader *r, const char *fmt, ...) KAGE_PRINTF(2, 3);

/* What this scene or another has under a key. The scene then has it, too. NULL: there is none. */
void *reader_found(reader *r, const char *key);

/* Put a thing on the scene's shelf under a key that reader_found has not found; it is the shelf's, also on failure.
 * NULL as the key: only free the thing. False with an error. */
bool reader_keep(reader *r, const char *key, void *thing, void (*free_thing)(void *thing));

/* The same of a surface or a bump, which belongs to the caller, too. NULL: none is found. */
surface *reader_found_surface(reader *r, const char *key);
bump *reader_found_bump(reader *r, const char *key);

/* Keep a surface or a bump. Returns it, which belongs to the caller; NULL where it is, or with an error. NULL as the
 * key: only return it. */
surface *reader_keep_surface(reader *r, const char *key, surface *f);
bump *reader_keep_bump(reader *r, const char *key, bump *p);

/* ---- truth.c: surfaces that true displacement alone needs, and that take long to make ---- */

/* The object's own mesh or patches mapped by m, as a mesh or patches. NULL: out of memory. */
surface *reader_moved(reader *r, const object *o, const affine *m);

/* The object's displaced surface; `at` is the object. NULL: an error is told. */
surface *reader_displaced(reader *r, node *at, const object *o);

/* ---- layout.c: where a height map or an image lies in (u,w) ---- */

/* The keys size or repeat, offset, wrap and samples, on a surface with the extent u and w. Those that are absent leave
 * the defaults, which *l must hold. */
bool reader_layout(reader *r, node *at, const double u[2], const double w[2], map_layout *l);

/* The extent that a map without a size covers: that of part 0; on a mesh 0..1, the range of texture coordinates. */
void reader_extent(const surface *f, const shape_spec *spec, double u[2], double w[2]);

/* Whether the object has (u,w) everywhere. `at`: the bump or material that needs them. */
bool reader_textured(reader *r, node *at, const object *o);

/* Wrap a bump or a color for a mesh with mirrored texture (texture/mirrored_uv.h). The result owns the argument, or is
 * the argument. NULL of NULL. */
bump *reader_mirror_bump(reader *r, const object *o, bump *p);
color_texture *reader_mirror_color(reader *r, const object *o, color_texture *c);

/* ---- names.c: the names of things ---- */

typedef struct names {
    uint32_t size;
    int32_t *slot; /* an object's index + 1; 0: free */
} names;

/* Make room for the names of `count` objects. False: out of memory. */
bool names_begin(names *n, int count);
void names_free(names *n);

/* Add object i, which has a name. False: another one has it. */
bool names_add(names *n, const object *o, int i);

/* The index of the object with a name; -1: there is none. */
int names_find(const names *n, const object *o, const char *name);

/* The index of the thing that the node names. `what`: "the name of a material"; `among`: the key of the things. -1
 * with an error. */
int reader_find(reader *r, node *at, const char *what, const char *among, const void *things, size_t size, int n);

/* The index of the material that a node names; -1 with an error. */
int reader_material(reader *r, node *at);

/* ---- the parts of an object ---- */

/* Set the object's color texture if its material has a pattern. `at`: the object's material. */
void reader_color_texture(reader *r, node *at, object *o);

/* Append a list of steps to *m. */
bool reader_transform(reader *r, node *at, affine *m);

/* About x, then y, then z, in degrees. With the left thumb along the axis, the fingers show the direction. */
affine reader_rotation(const double degrees[3]);

/* Make the object's shape from its own by the transform `placed`, after the bump; as a patch if true displacement needs
 * one. */
bool reader_place(reader *r, node *at, object *o);

/* The copies of object i from the list under its key `copies`. */
void reader_copies(reader *r, node *v, int i);

/* The surface under the object's one shape key; *spec becomes what the file says about it. */
#define READER_SHAPES CLOSED_FORM_NAMES "parametric patches mesh"
surface *reader_shape(reader *r, node *at, shape_spec *spec);
bool reader_no_shape(reader *r, node *at); /* true: it has no shape key */

/* The shapes without closed forms; `at`: the value of their key. */
surface *reader_parametric(reader *r, node *at, shape_spec *spec);
surface *reader_patches(reader *r, node *at, shape_spec *spec);
surface *reader_mesh(reader *r, node *at, shape_spec *spec);

/* The bump of an object that has its own surface. Also sets its bump_spec and map. */
bump *reader_bump(reader *r, node *at, object *o);

#endif
