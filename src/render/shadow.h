/* Stage: the visibility of a light from a group. */
#ifndef KAGE_RENDER_SHADOW_H
#define KAGE_RENDER_SHADOW_H

#include "render/workspace.h"

/* g->lit of the group v->g on object `id`: the visible share of light l, 0..1. Also g->tint, in scenes with transparent
 * materials. */
void shadow_light(const tracer *tr, int32_t id, const light *l, workspace *v);

/* Whether object `id` casts shadows. */
bool shadow_casts(const tracer *tr, int32_t id);

#endif
