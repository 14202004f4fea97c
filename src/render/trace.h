/* The way of a ray: one wave of rays from the eye to the light. */
#ifndef KAGE_RENDER_TRACE_H
#define KAGE_RENDER_TRACE_H

#include "render/workspace.h"

/* Trace the rays v->x of n lanes into v->out and, where layers are asked for, v->visibility. */
void trace(const tracer *tr, int n, workspace *v);

/* One of its steps: the group v->g, whose lanes have met the object `id`, from its x, t and part to its rgb, without
 * secondary rays. Visibilities are put by lanes of the wave. */
void trace_group(const tracer *tr, int32_t id, workspace *v);

#endif
