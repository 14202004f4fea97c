/* Stage: the nearest hits of a wave. */
#ifndef KAGE_RENDER_INTERSECT_H
#define KAGE_RENDER_INTERSECT_H

#include "render/workspace.h"
#include "scene/object_bvh.h"

/* The nearest hits of the n rays v->x, in v->nearest. A secondary ray that hits the object it started on gets its
 * unshifted start in v->x. */
void intersect_nearest(const scene *s, int n, workspace *v);

/* Update h with nearer hits of object `id`. from: where secondary rays start; NULL: camera rays. */
static inline void intersect_surface(const surface *f, int n, const rays *x, const ray_origins *from, int32_t id,
                                     hits *h)
{
    if (from)
        f->ops->hit_own(f, n, x, from, id, h);
    else
        f->ops->hit(f, n, x, id, h);
}

/* The next object after `after` (-1: the first) that some ray may hit; -1: none. m NULL: all objects. */
static inline int32_t intersect_next(const scene *s, const candidates *m, int32_t after)
{
    if (m)
        return candidates_next(m, after);
    for (after++; after < s->objects; after++)
        if (s->object[after].first == after)
            return after;
    return -1;
}

#endif
