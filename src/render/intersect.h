/* Stage: where a wave's rays meet the objects first. */
#ifndef KAGE_RENDER_INTERSECT_H
#define KAGE_RENDER_INTERSECT_H

#include "render/workspace.h"
#include "scene/object_bvh.h"

/* The nearest hits of the rays v->x of n lanes, in v->nearest. A ray that meets again the object that it has left began
 * at its unshifted place there: its origin in v->x becomes that. */
void intersect_nearest(const scene *s, int n, workspace *v);

/* Nearer hits with one object, into h. from: where the rays have left surfaces; NULL: they come from the camera. */
static inline void intersect_surface(const surface *f, int n, const rays *x, const ray_origins *from, int32_t id,
                                     hits *h)
{
    if (from)
        f->ops->hit_own(f, n, x, from, id, h);
    else
        f->ops->hit(f, n, x, id, h);
}

/* The next object after `after` (-1: the first) that some ray may meet; -1: there is none. m: NULL: all may be met. */
static inline int32_t intersect_next(const scene *s, const candidates *m, int32_t after)
{
    return m ? candidates_next(m, after) : after + 1 < s->objects ? after + 1 : -1;
}

#endif
