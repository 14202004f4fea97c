/* The parts of the scene reader, in the order in which they build on each other: transforms, lights and materials on
 * values.h and layout.h; shapes on these; objects on all. Each adds its errors to the reader's and returns false, or
 * NULL, with one.
 */
#ifndef KAGE_READ_PARTS_H
#define KAGE_READ_PARTS_H

#include "read/layout.h"

/* The keys image, camera and render. */
void reader_view(reader *r);

void reader_lights(reader *r);

/* The materials. Then, for an object whose material has a pattern, its color texture; `at`: the object's material, for
 * errors. */
void reader_materials(reader *r);
void reader_color_texture(reader *r, node *at, object *o);

/* A list of steps: *m becomes *m followed by them. */
bool reader_transform(reader *r, node *at, affine *m);

/* Make the object's shape: the image of its own by `placed`; where true displacement needs it, as a patch. The bump
 * must have been read. Errors are at the node. */
bool reader_place(reader *r, node *at, object *o);

/* The surface of an object, from the one shape key that it has; *spec: what the file says of it. */
#define READER_SHAPES CLOSED_FORM_NAMES "parametric patches mesh"
surface *reader_shape(reader *r, node *at, shape_spec *spec);
bool reader_no_shape(reader *r, node *at); /* whether it has none; otherwise an error */

/* The shapes without closed forms; `at`: what is under their key. */
surface *reader_parametric(reader *r, node *at, shape_spec *spec);
surface *reader_patches(reader *r, node *at, shape_spec *spec);
surface *reader_mesh(reader *r, node *at, shape_spec *spec);

/* The bump of an object that has its own surface; fills in its bump_spec and map, too. */
bump *reader_bump(reader *r, node *at, object *o);

/* The objects with their surfaces and bumps; after the materials, whose names they give. */
void reader_objects(reader *r);

#endif
