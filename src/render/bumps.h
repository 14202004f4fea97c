/* Stage: the shadows that an object's bumps cast on the object itself. */
#ifndef KAGE_RENDER_BUMPS_H
#define KAGE_RENDER_BUMPS_H

#include "render/workspace.h"

/* Whether the bumps of object `id` cast shadows on it. Then n' alone says which side faces a light: a place that the
 * smooth surface turns away from the light may be lit. */
bool bumps_cast(const tracer *tr, int32_t id, const workspace *v);

/* For such an object: g->lit = 0 in the shadow of its bumps and, from where the way to the light leaves them, in that
 * of its smooth shape. l has one point. shared: the bumps' shadow is known from bumps_share. */
void bumps_shadow(const tracer *tr, int32_t id, const light *l, bool shared, workspace *v);

/* The share, 0..1, of an area light that is above the horizon, so that its samples need no test against the bumps.
 * False: not known, as there is no horizon map. */
bool bumps_share(const tracer *tr, int32_t id, const light *l, workspace *v, real *share);

#endif
