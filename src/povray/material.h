/* Materials for POV-Ray, and which objects need a mesh for theirs. Private to the POV-Ray writer. */
#ifndef KAGE_POVRAY_MATERIAL_H
#define KAGE_POVRAY_MATERIAL_H

#include "pov_text/text.h"
#include "scene/scene.h"

/* Declare all materials. */
void pov_materials(pov_text *t, const scene *s);

/* The material of an object, on a part of its surface. */
void pov_texture(pov_text *t, const scene *s, const object *o, int part);

/* Whether each part of the object has a texture of its own; whether its mesh must say where in (u,w) vertices are. */
bool pov_by_parts(const scene *s, const object *o);
bool pov_by_uv(const scene *s, const object *o);

/* Whether an object is made by pov_patch: POV-Ray has no shape for it, none for its displacement, or no way to lay its
 * material on it. */
bool pov_is_patch(const scene *s, const object *o);

#endif
