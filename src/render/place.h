/* Stage: the place of a hit that is shaded. */
#ifndef KAGE_RENDER_PLACE_H
#define KAGE_RENDER_PLACE_H

#include "render/workspace.h"

/* Set g->t_shade of the group v->g on object `id`: the smooth hit, as in the paper, or r + s t0 (ours). With r + s t0
 * the group's (u,w) and shade_part become the place of the smooth surface whose normal leads there; the bump, q and
 * both normals are those of this place, and q.Q is r + s t0. Lanes whose t0 is before the ray's start or has no value
 * are shaded at the smooth hit. Sets g->rough, too, if the object's bumps cast shadows on it (bumps.h). */
void place_find(const tracer *tr, int32_t id, workspace *v);

#endif
