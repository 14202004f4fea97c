/* Stages: the normals n and n', and tau, the shift of the shadow rays' origin along the viewing ray. */
#ifndef KAGE_METHOD_SHIFT_H
#define KAGE_METHOD_SHIFT_H

#include "wave/hit_group.h"
#include "method/method.h"
#include "texture/bump.h"

/* Count lane i among those without a value. */
void shift_undefined(hit_group *g, int i);

/* g->n_smooth and g->n_bump, from the partials of Q and, unless `bump` is NULL, of P. Lanes where the surface is not
 * regular (bs_regular), or where P or n' has no value, are counted. */
void shift_normals(hit_group *g, const bump *bump);

/* g->tau and g->order: of lanes without a value 0 and none. guard: fall back where tau is outside the slab. Returns how
 * often P was evaluated. */
long shift_group(hit_group *g, const bump *bump, method m, bool guard);

/* Where P or tau has no value (for a ray along the surface tau has none), tau becomes 0, by order none. The lane is
 * counted. */
void shift_known(hit_group *g);

/* tau > -t, so that the shifted place is behind the ray's start: an eye can be inside the slab of P, and secondary rays
 * start there. It is 1/1024 of the way behind: the start of a secondary ray is a point of another surface, and whether
 * a ray from that very point meets that surface would be decided by rounding. Without the guard a camera ray's tau is
 * the bare formula's. */
void shift_within(hit_group *g);

/* g->t0 = t_hit + tau. */
void shift_origins(hit_group *g);

#endif
