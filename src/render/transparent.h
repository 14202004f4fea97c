/* The shadows of transparent objects. */
#ifndef KAGE_RENDER_TRANSPARENT_H
#define KAGE_RENDER_TRANSPARENT_H

#include "render/workspace.h"

/* Whether object `id` is transparent. */
bool transparent_is(const scene *s, int32_t id);

/* Multiply v->g.tint by the transmittance of object `id` at each hit along g->to_light, without refraction, as in
 * POV-Ray. Rays with too many hits get g->lit = 0. own: the rays start on this object. */
void transparent_cast(const scene *s, int32_t id, bool own, workspace *v);

#endif
