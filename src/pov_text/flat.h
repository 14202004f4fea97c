/* Frames of an object's flat parts in the scene, and how its transform scales and mirrors. */
#ifndef KAGE_POV_TEXT_FLAT_H
#define KAGE_POV_TEXT_FLAT_H

#include "pov_text/text.h"
#include "scene/scene.h"

/* A flat part in the scene: Q = O + u U + w W. U and W need not be at a right angle. */
typedef struct pov_flat {
    vec3 O, U, W;
    vec3 x, y, z; /* unit vectors: x along U, z along W, y the normal */
} pov_flat;

pov_flat pov_flat_of(const object *o, int part);

bool pov_is_flat(const shape_spec *f, int part);

/* The radius of a disc or cap, in units of u and w. 0: the part does not exist. Negative: the part is no disc. */
double pov_rim(const shape_spec *f, int part);

/* Clip a displaced disc, which is written as a square. */
void pov_clip_rim(pov_text *t, const object *o, int part);

/* The factor by which the object's transform scales lengths: 1 without one, 0 if directions scale differently. */
double pov_scale(const object *o);

/* Whether the transform mirrors, which reverses u (surface_transformed). u around the y axis, as a function of x and z.
 */
bool pov_mirrored(const object *o);
const char *pov_around(const object *o);

/* The shape's values, lengths and places, times pov_scale. */
shape_values pov_sized(const object *o);

/* P's range and a little more, for containers that must hold all of the surface. */
void pov_levels(const object *o, double y[2]);

/* The ranges of u and w of an unbounded plane that matter: what the camera sees of the displaced surface, and what can
 * cast shadows there. (region.c) */
void pov_plane_region(const scene *s, const object *o, double u[2], double w[2]);

/* Whether the object is a plane without ends whose horizon is in the picture. (region.c) */
bool pov_has_horizon(const scene *s, const object *o);

#endif
