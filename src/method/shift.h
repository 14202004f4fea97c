/* Stage: how far the origin of the shadow rays is shifted along the viewing ray, by every method. */
#ifndef KAGE_METHOD_SHIFT_H
#define KAGE_METHOD_SHIFT_H

#include "wave/hit_group.h"
#include "method/method.h"
#include "texture/bump.h"

/* n and n' of a group from the partials of Q, and of P where `bump` is not NULL: g->n_smooth, g->n_bump. */
void shift_normals(hit_group *g, const bump *bump);

/* g->tau and g->order, from all that is in g before them. Where the surface has no two directions (bs_regular) the
 * order is none. Returns the number of heights that were looked up on the way. */
long shift_group(hit_group *g, const bump *bump, method m, bool guard);

/* A secondary ray starts amid the scene; the shifted place is not before its start: tau >= -t. */
void shift_within(hit_group *g);

/* g->t0 = t_hit + tau, when tau is final. */
void shift_origins(hit_group *g);

#endif
