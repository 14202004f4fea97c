/* Stage: the visibility of a light from a group. */
#ifndef KAGE_RENDER_SHADOW_H
#define KAGE_RENDER_SHADOW_H

#include "render/workspace.h"

/* g->lit of the group v->g on object `id`: the visible share of light l, 0..1. Also g->tint, in scenes with transparent
 * materials. */
void shadow_light(const tracer *tr, int32_t id, const light *l, workspace *v);

/* Whether light is kept from object `id` by its own bumps: then the smooth surface facing away from a light does not
 * mean that it is dark. */
bool shadow_is_own(const tracer *tr, int32_t id, const workspace *v);

/* Whether object `id` casts shadows. */
bool shadow_casts(const tracer *tr, int32_t id);

#endif
