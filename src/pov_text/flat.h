/* Where flat parts are, and what an object's transform makes of lengths and angles. Private to the POV-Ray writer. */
#ifndef KAGE_POV_TEXT_FLAT_H
#define KAGE_POV_TEXT_FLAT_H

#include "pov_text/text.h"
#include "scene/scene.h"

/* A flat part in the scene: Q = O + u U + w W; x runs along U, z along W, both in scene units, and y is the height over
 * it, so that U and W need not be at a right angle. */
typedef struct pov_flat {
    vec3 O, U, W;
    vec3 x, y, z; /* unit */
} pov_flat;

/* Of a part that is flat. */
pov_flat pov_flat_of(const object *o, int part);

bool pov_is_flat(const shape_spec *f, int part);

/* The radius of a disc, or of a flat part that is one; in units of u and w; it may be 0, and then there is no such
 * part. Negative: no disc. */
double pov_rim(const shape_spec *f, int part);

/* Clip an object's displaced disc, which is made as a square, to the disc. */
void pov_clip_rim(pov_text *t, const object *o, int part);

/* What the object's transform makes of lengths: 1 where it has none, 0 where not all grow alike. */
double pov_scale(const object *o);

/* Whether u runs the other way (surface_transformed); u of what turns about y, as a function of x and z. */
bool pov_mirrored(const object *o);
const char *pov_around(const object *o);

/* The shape's values with all lengths, and places, as large as the transform makes them. */
shape_values pov_sized(const object *o);

/* P's range and a little more: a container must hold all of the surface. */
void pov_levels(const object *o, double y[2]);

/* The part of an unbounded plane that matters for the picture, as ranges of u and w: what the camera sees of the
 * displaced surface, and what of it can shade that. (region.c) */
void pov_plane_region(const scene *s, const object *o, double u[2], double w[2]);

#endif
