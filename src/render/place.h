/* Stage: the place of a hit that is shaded. */
#ifndef KAGE_RENDER_PLACE_H
#define KAGE_RENDER_PLACE_H

#include "render/workspace.h"

/* Shade at the smooth hit, as the paper does. */
void place_smooth(bool own, hit_group *g);

/* Shade at r + s t0 (ours): (u,w) of the group becomes the place of the smooth surface `f` whose normal leads there;
 * the bump and both normals are those of this place, and Q is r + s t0. Lanes whose t0 is before the ray's start or has
 * no value are shaded at the smooth hit. P is evaluated once a lane. own: for the bumps' own
 * shadows, see own_shadow.h: sets g->rough, too. */
void place_shifted(const surface *f, const bump *P, bool own, hit_group *g);

#endif
