/* Stage: shadow rays through transparent casters. */
#ifndef KAGE_RENDER_TRANSMITTANCE_H
#define KAGE_RENDER_TRANSMITTANCE_H

#include "render/trace.h"

/* All the light's colour. */
void transmittance_begin(hit_group *g);

/* g->tint *= what the transparent object `id` leaves of it along g->to_light: its colour's share each time its surface
 * is crossed, without refraction, as in POV-Ray. own: the segments start on it. */
void transmittance_light(const tracer *k, int id, bool own, hit_group *g, stats *st);

#endif
