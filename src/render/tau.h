/* Stage: the shift tau, by the render's method. */
#ifndef KAGE_RENDER_TAU_H
#define KAGE_RENDER_TAU_H

#include "render/workspace.h"

/* What surface_ops.eval is asked for at the smooth hit: 0, the partials of Q; 1 for a layer or the bumps' own shadows,
 * also Q; 2 for the curvature, all. */
int tau_partials(const tracer *tr, int32_t id, const workspace *v);

/* g->tau and g->order of the group v->g on object `id`; v->alone. Counts the orders. */
void tau_find(const tracer *tr, int32_t id, workspace *v);

#endif
