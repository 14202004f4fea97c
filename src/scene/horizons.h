/* The horizon maps of a scene's bumped objects, for their bumps' own shadows. */
#ifndef KAGE_SCENE_HORIZONS_H
#define KAGE_SCENE_HORIZONS_H

#include "scene/scene.h"
#include "texture/horizon.h"

typedef struct horizons horizons;

/* Build them. An object has one for each part of its surface: over the part's extent, or over one period of its map
 * where the surface has no ends. It has none where that is not known: a function on a plane without ends, meshes and
 * patches. The result does not depend on the threads. NULL: out of memory. */
horizons *horizons_new(const scene *s, int threads, const progress *w);

/* NULL is allowed. */
void horizons_free(horizons *h);

/* NULL: it has none. */
const horizon *horizons_of(const horizons *h, int id, int part);

#endif
