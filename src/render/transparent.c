/* A shadow ray is followed through a transparent object, hit by hit, and takes the colour of each surface it crosses.
 */
#include "render/transparent.h"

#include "render/intersect.h"
#include "wave/gather.h"
#include "wave/lane.h"

enum { CROSSINGS = 64 }; /* hits followed on one object; a ray with more is dark */

/* The shadow rays that are still followed, side by side; the light is at t = 1. */
typedef struct segments {
    int n;
    int32_t lane[LANES];
    rays x;
    ray_origins from;
    hits h;
    real u[LANES], w[LANES];
    vec3s color;
} segments;

static void begin_segments(const hit_group *g, int32_t id, bool own, segments *a)
{
    a->n = 0;
    for (int i = 0; i < g->n; i++) { /* without a branch */
        a->lane[a->n] = i;
        a->n += g->lit[i] > 0;
    }
    gather_rays(a->n, a->lane, &g->to_light, &a->x);
    a->from.at = a->x.r;
    for (int i = 0; i < a->n; i++) {
        a->from.id[i] = own ? id : -1;
        a->from.part[i] = g->part[a->lane[i]];
    }
}

/* Keep the rays that hit the surface; they start again from the hit. */
static void cross_surface(int32_t id, segments *a)
{
    int n = 0;
    for (int i = 0; i < a->n; i++) {
        if (a->h.id[i] < 0)
            continue;
        const real t = a->h.t[i];
        bs_vec3 at = lane_at(&a->x, i, t), s = lane_get(&a->x.s, i),
                rest = {s.x * (1 - t), s.y * (1 - t), s.z * (1 - t)};
        a->lane[n] = a->lane[i];
        lane_set(&a->x.r, n, at);
        lane_set(&a->x.s, n, rest);
        lane_set(&a->from.at, n, at);
        a->from.id[n] = id;
        a->from.part[n] = a->h.part[i];
        n++;
    }
    a->n = n;
}

static void tint(const material *m, const segments *a, hit_group *g)
{
    const real filter = (real)m->filter, transmit = (real)m->transmit;
    const bs_vec3 plain = {(real)m->color.x, (real)m->color.y, (real)m->color.z};
    for (int i = 0; i < a->n; i++) {
        const int at = a->lane[i];
        if (a->h.id[i] < 0)
            continue;
        bs_vec3 c = m->pattern ? lane_get(&a->color, i) : plain;
        g->tint.x[at] = secondary_weight(g->tint.x[at] * (c.x * filter + transmit));
        g->tint.y[at] = secondary_weight(g->tint.y[at] * (c.y * filter + transmit));
        g->tint.z[at] = secondary_weight(g->tint.z[at] * (c.z * filter + transmit));
    }
}

void transparent_cast(const scene *s, int32_t id, bool own, workspace *v)
{
    const object *o = &s->object[id];
    const material *m = &s->material[o->material];
    const surface *f = v->surface[id];
    segments a;
    begin_segments(&v->g, id, own, &a);
    for (int crossing = 0; crossing < CROSSINGS && a.n; crossing++) {
        for (int i = 0; i < a.n; i++) {
            a.h.t[i] = 1;
            a.h.id[i] = -1;
            a.h.part[i] = 0;
        }
        intersect_surface(f, a.n, &a.x, &a.from, id, &a.h);
        f->ops->locate(f, a.n, &a.x, a.h.t, a.h.part, a.u, a.w);
        if (o->color)
            o->color->ops->eval(o->color, a.n, a.u, a.w, &a.color);
        tint(m, &a, &v->g);
        cross_surface(id, &a);
    }
    for (int i = 0; i < a.n; i++)
        v->g.lit[a.lane[i]] = 0;
}

bool transparent_is(const scene *s, int32_t id) { return material_clear(&s->material[s->object[id].material]); }
