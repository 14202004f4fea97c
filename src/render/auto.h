/* The method auto: order 0, and a better place only where that may change what a light sees. */
#ifndef KAGE_RENDER_AUTO_H
#define KAGE_RENDER_AUTO_H

#include "render/workspace.h"

/* Improve tau and order of the group v->g on object `id`, which order 0 has set. Shadow rays from there see each light
 * as they would from the true place, up to an error of tr->shadow's pixels. */
void auto_shift(const tracer *tr, int32_t id, workspace *v);

#endif
