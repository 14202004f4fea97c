/* Tests every object; each nearer hit shortens its ray. In scenes with many objects, each object gets only the rays
 * that the hierarchy found near it. */
#include "render/intersect.h"

#include "wave/gather.h"

static void intersect_some(const surface *f, int n, const int32_t *lane, const rays *x, const ray_origins *from,
                           int32_t id, hits *h)
{
    rays y;
    ray_origins begin;
    hits some;
    gather_rays(n, lane, x, &y);
    if (from)
        gather_ray_origins(n, lane, from, &begin);
    for (int i = 0; i < n; i++) {
        some.t[i] = h->t[lane[i]];
        some.id[i] = h->id[lane[i]];
        some.part[i] = h->part[lane[i]];
    }
    intersect_surface(f, n, &y, from ? &begin : NULL, id, &some);
    for (int i = 0; i < n; i++) {
        h->t[lane[i]] = some.t[i];
        h->id[lane[i]] = some.id[i];
        h->part[lane[i]] = some.part[i];
    }
}

/* Whether each ray hits the very thing that it starts on: the same object and of copies the same copy. */
static void find_own(const scene *s, int n, const ray_origins *from, const hits *h, int32_t *own)
{
    for (int i = 0; i < n; i++) {
        const int32_t id = h->id[i];
        const crowd *f = id >= 0 ? s->object[id].crowd : NULL;
        own[i] =
            id >= 0 && id == from->id[i] && (!f || crowd_copy_of(f, h->part[i]) == crowd_copy_of(f, from->part[i]));
    }
}

void intersect_nearest(const scene *s, int n, workspace *v)
{
    const ray_origins *from = v->of ? &v->of->from : NULL;
    int32_t lane[LANES], own[LANES];
    gather_begin(n, &v->nearest);
    if (v->candidates)
        object_bvh_find(s->object_bvh, n, &v->x, v->nearest.t, from ? from->id : NULL, v->candidates);
    for (int32_t id = intersect_next(s, v->candidates, -1); id >= 0; id = intersect_next(s, v->candidates, id)) {
        const int some = v->candidates ? candidates_rays(v->candidates, id, lane) : n;
        if (some < n)
            intersect_some(v->surface[id], some, lane, &v->x, from, id, &v->nearest);
        else
            intersect_surface(v->surface[id], n, &v->x, from, id, &v->nearest);
    }
    if (from) {
        find_own(s, n, from, &v->nearest, own);
        gather_move_origins(n, from, own, &v->x);
    }
    *(from ? &v->stats->secondary_rays : &v->stats->rays) += n;
}
