/* Stage: shadow rays through transparent objects. */
#ifndef KAGE_RENDER_TRANSMITTANCE_H
#define KAGE_RENDER_TRANSMITTANCE_H

#include "render/workspace.h"

/* All the light's colour. */
void transmittance_begin(hit_group *g);

/* v->g.tint *= what the transparent object `id` leaves of it along g->to_light: its colour's share each time its
 * surface is crossed, without refraction, as in POV-Ray. own: the segments start on its surface. */
void transmittance_own(const scene *s, int32_t id, workspace *v);
void transmittance_other(const scene *s, int32_t id, workspace *v);

#endif
