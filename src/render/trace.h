/* The algorithm: one wave of rays from the eye to the light. */
#ifndef KAGE_RENDER_TRACE_H
#define KAGE_RENDER_TRACE_H

#include "render/workspace.h"

/* Trace the n rays v->x. Results: v->out and, with tr->layers, v->visibility. */
void trace(const tracer *tr, int n, workspace *v);

/* One step of it: shade the group v->g, whose lanes hit object `id`. In: g's x, t and part. Out: the rest of g, with
 * rgb without secondary rays, and with tr->layers v->visibility. */
void trace_group(const tracer *tr, int32_t id, workspace *v);

#endif
