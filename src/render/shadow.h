/* Stage: which share of a light reaches a group. */
#ifndef KAGE_RENDER_SHADOW_H
#define KAGE_RENDER_SHADOW_H

#include "render/workspace.h"

/* For the group v->g on object `id`: g->lit = the share of light l that is seen, 0..1; and g->tint, where the scene has
 * transparent materials. */
void shadow_light(const tracer *tr, int32_t id, const light *l, workspace *v);

#endif
