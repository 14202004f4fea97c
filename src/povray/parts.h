/* The writers of one object, for the file as a whole. Each leaves the object's brace open. Private to the POV-Ray
 * writer. */
#ifndef KAGE_POVRAY_PARTS_H
#define KAGE_POVRAY_PARTS_H

#include "povray/povray.h"
#include "pov_text/text.h"

/* A closed form without bumps, in POV-Ray's own shapes, as its form says (closed_form.h). In that text, $ and the name
 * of a parameter stands for its value; $open for nothing or the word; $plane for a plane's normal and distance;
 * $rectangle for the whole shape; $axes for a matrix whose y is along the parameter that is a direction. */
void pov_smooth(pov_text *t, const scene *s, const object *o);

/* P as a POV-Ray function of u and w, named by `name`. False where there is none. */
bool pov_function(pov_text *t, const object *o, const char *name);

/* The displaced object as isosurfaces that call the function `name`. pov_isosurface_gradient: the bound of its
 * gradient, infinite where none is known or none serves. */
double pov_isosurface_gradient(const object *o, int part);
void pov_isosurface(pov_text *t, const scene *s, const object *o, const char *name);

/* The displaced object as one mesh. False: out of memory. */
bool pov_mesh(pov_text *t, const scene *s, const object *o, pov_report *report);

/* An object without a shape of POV-Ray's, smooth or displaced as the scene says, as one mesh. False: out of memory. */
bool pov_patch(pov_text *t, const scene *s, const object *o);

/* A mesh from a file, smooth or displaced. False: out of memory. */
bool pov_triangle_mesh(pov_text *t, const scene *s, const object *o);

#endif
