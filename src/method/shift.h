/* Stages: the normals n and n', and tau, the shift of the shadow rays' origin along the viewing ray. */
#ifndef KAGE_METHOD_SHIFT_H
#define KAGE_METHOD_SHIFT_H

#include "wave/hit_group.h"
#include "method/method.h"
#include "texture/bump.h"

/* g->n_smooth and g->n_bump, from the partials of Q and, unless `bump` is NULL, of P. */
void shift_normals(hit_group *g, const bump *bump);

/* g->tau and g->order. Order none where the surface is not regular (bs_regular). guard: fall back where tau is outside
 * the slab. Returns how often P was evaluated. */
long shift_group(hit_group *g, const bump *bump, method m, bool guard);

/* For secondary rays: tau >= -t, so that the shifted place is not before the ray's start. */
void shift_within(hit_group *g);

/* g->t0 = t_hit + tau. */
void shift_origins(hit_group *g);

#endif
