/* Stage: the colour of light behind transparent objects. */
#ifndef KAGE_RENDER_TRANSMITTANCE_H
#define KAGE_RENDER_TRANSMITTANCE_H

#include "render/workspace.h"

/* g->tint = 1. */
void transmittance_begin(hit_group *g);

/* Multiply v->g.tint by the transmittance of object `id` at each hit along g->to_light, without refraction, as in
 * POV-Ray. Rays with too many hits get g->lit = 0. own: the rays start on this object. */
void transmittance_follow(const scene *s, int32_t id, bool own, workspace *v);

#endif
