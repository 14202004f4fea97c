/* Stage: the shift tau, by the render's method. */
#ifndef KAGE_RENDER_TAU_H
#define KAGE_RENDER_TAU_H

#include "render/workspace.h"

/* The partials of Q that are needed at the smooth hit: 1 or, for its curvature, 2. */
int tau_partials(const tracer *tr, int32_t id, const workspace *v);

/* g->tau and g->order of the group v->g on object `id`; v->alone. Counts the orders. */
void tau_find(const tracer *tr, int32_t id, workspace *v);

#endif
