/* The parts of the POV-Ray writer, which writer.c calls: materials, and one way to write an object for each of the
 * other files. An object's brace stays open, so that its texture can follow. */
#ifndef KAGE_POVRAY_PARTS_H
#define KAGE_POVRAY_PARTS_H

#include "pov_text/text.h"
#include "povray/povray.h"

/* ---- material.c ---- */

/* Declare all materials. */
void pov_materials(pov_text *t, const scene *s);

/* The material of an object, on a part of its surface. */
void pov_texture(pov_text *t, const scene *s, const object *o, int part);

/* Whether each part of the object has its own texture. pov_by_uv: whether its mesh needs (u,w) at vertices. */
bool pov_by_parts(const scene *s, const object *o);
bool pov_by_uv(const scene *s, const object *o);

/* Whether pov_patch writes the object: POV-Ray lacks its shape, its displacement, or a warp for its material. */
bool pov_is_patch(const scene *s, const object *o);

/* ---- objects ---- */

/* A closed form without bumps as a POV-Ray shape, from the template in closed_form.h. There, $ and the name of a
 * parameter stands for its value; $open for " open" or nothing; $plane for a plane's normal and distance; $rectangle
 * for a whole polygon; $axes for a matrix with y along the parameter that is a direction. */
void pov_smooth(pov_text *t, const scene *s, const object *o);

/* Declare P as a POV-Ray function of u and w. False: POV-Ray cannot evaluate it. */
bool pov_function(pov_text *t, const object *o, const char *name);

/* The displaced object as isosurfaces of the function `name`. pov_isosurface_gradient: a bound of the gradient on a
 * part; infinite: unknown, or too steep for an isosurface. */
double pov_isosurface_gradient(const object *o, int part);
void pov_isosurface(pov_text *t, const scene *s, const object *o, const char *name);

/* The displaced object as one mesh; *report gets the worst coarse one. False: out of memory. */
bool pov_mesh(pov_text *t, const scene *s, const pov_options *how, const object *o, pov_report *report);

/* An object that pov_is_patch, smooth or displaced, as one mesh. False: out of memory. */
bool pov_patch(pov_text *t, const scene *s, const pov_options *how, const object *o);

/* Of an object of copies: the object that each is an image of, and the union of those of one kind, once that is
 * declared under a name. */
object pov_original(const object *o);
void pov_copies(pov_text *t, const object *o, int kind, const char *name);

/* A mesh from a file, smooth or displaced. False: out of memory. */
bool pov_triangle_mesh(pov_text *t, const scene *s, const pov_options *how, const object *o);

#endif
