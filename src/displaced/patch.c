/* Displaced surfaces over patches: X is a patch too (offset_patch.c), and rays are searched for it as for any other. */
#include "displaced/form.h"

#include "displaced/offset.h"
#include "patch/surface.h"

/* Of X's pieces. Coarser than a smooth patch's: where slopes of P turn, halving pays only where a ray comes. */
#define FLAT 0.5

static const patch_surface *offset_of_patch(const displaced *d) { return (const patch_surface *)d->offset; }

static bool over_patch_prepare(displaced *d, const progress *w)
{
    patch *q = patch_offset_new(((const patch_surface *)d->smooth)->q, d->P);
    bool bounded = true;
    patch_surface *shape = q ? patch_surface_make(q, FLAT, w, &bounded) : NULL;
    d->unbounded = !bounded;
    if (!shape)
        return false;
    shape->broken = true;
    d->offset = &shape->base;
    return true;
}

static void over_patch_hit(const displaced *d, int n, const rays *x, const ray_origins *from, int32_t id, hits *h)
{
    patch_counts q = {.pulse = d->pulse};
    patch_surface_intersect(offset_of_patch(d), n, x, from, id, h, &q);
    displaced_count(d, q.evaluations, q.unsure);
}

static void over_patch_occlude(const displaced *d, int n, const rays *x, const int32_t *part, real *lit)
{
    patch_counts q = {.pulse = d->pulse};
    patch_surface_occlude(offset_of_patch(d), n, x, part != NULL, NULL, lit, &q);
    displaced_count(d, q.evaluations, q.unsure);
}

/* The height, and how all change in space: the dual vectors of U, W and n at that height. */
static void over_patch_closest(const displaced *d, int n, const rays *x, const real *t, int32_t *part,
                               closest_points *p)
{
    partials q;
    d->offset->ops->locate(d->offset, n, x, t, part, p->u, p->w);
    d->smooth->ops->eval(d->smooth, n, part, p->u, p->w, 2, &q);
    for (int i = 0; i < n; i++) {
        const bs_vec3 at = lane_at(x, i, t[i]), Q = lane_get(&q.Q, i), up = {at.x - Q.x, at.y - Q.y, at.z - Q.z};
        const bs_vec3 Qu = lane_get(&q.Qu, i), Qw = lane_get(&q.Qw, i);
        p->h[i] = bs_dot(up, offset_unit(bs_normal(Qu, Qw)));
        const offset o = offset_of(Qu, Qw, lane_get(&q.Quu, i), lane_get(&q.Quw, i), lane_get(&q.Qww, i), p->h[i]);
        const bs_vec3 Wn = bs_cross(o.W, o.n), nU = bs_cross(o.n, o.U);
        lane_set(&p->gh, i, o.n);
        lane_set(&p->gu, i, offset_scale(Wn, 1 / bs_dot(o.U, Wn)));
        lane_set(&p->gw, i, offset_scale(nU, 1 / bs_dot(o.W, nU)));
    }
}

const displaced_form displaced_over_patch = {patch_surface_is, over_patch_prepare, over_patch_hit, over_patch_occlude,
                                             over_patch_closest};
