/* What the lights see of brackets (method/bracket.h): the shadow rays from a bracket sweep a triangle with the light as
 * its apex.
 */
#ifndef KAGE_RENDER_SWEEP_H
#define KAGE_RENDER_SWEEP_H

#include "method/bracket.h"
#include "render/workspace.h"

/* The lanes of the group v->g on object `id` whose bracket some light may not see alike, in order, into lane[LANES].
 * Returns how many. Sets v->alone where no other object can shadow any lane. */
int sweep_lights(const tracer *tr, int32_t id, workspace *v, const brackets *k, int32_t *lane);

#endif
