/* True displacement of a sheet: its rough surface is a sheet too (patch_offset_new.c), and rays are searched for it as
 * for any other. */
#include "patch/surface.h"

#include "displaced/march.h"
#include "displaced/offset.h"

#include <stdlib.h>

#define FLAT 0.5 /* of leaves: what slopes of P turn is worth halving only where a ray comes */

void patch_surface_free_displaced(displaced_form *first)
{
    while (first) {
        displaced_form *k = first;
        first = k->next;
        surface_free(k->shape);
        free(k);
    }
}

static const displaced_form *form_of(const patch_surface *f, const bump *P)
{
    const displaced_form *k = f->rough;
    while (k->P != P)
        k = k->next;
    return k;
}

static const patch_surface *rough_of(const surface *base, const bump *P)
{
    return (const patch_surface *)form_of((const patch_surface *)base, P)->shape;
}

static void drop(patch_surface *f, const bump *P)
{
    for (displaced_form **at = &f->rough; *at; at = &(*at)->next)
        if ((*at)->P == P) {
            displaced_form *k = *at;
            *at = k->next;
            k->next = NULL;
            patch_surface_free_displaced(k);
            return;
        }
}

/* A P that was there before may be another one in the same place. */
static bool rough_prepare(surface *base, const bump *P)
{
    patch_surface *f = (patch_surface *)base;
    drop(f, P);
    displaced_form *k = calloc(1, sizeof *k);
    patch *q = k ? patch_offset_new(f->q, P) : NULL;
    patch_surface *shape = q ? patch_surface_make(q, FLAT) : NULL;
    if (!shape) {
        free(k);
        return false;
    }
    shape->broken = true;
    *k = (displaced_form){P, &shape->base, f->rough};
    f->rough = k;
    return true;
}

static void add_counts(displaced_counts *c, patch_counts q)
{
    c->evaluations += q.evaluations;
    c->uncertain += q.unsure;
}

static void rough_hit(const surface *base, const bump *P, int n, const rays *x, const ray_origins *from, int32_t id,
                      hits *h, displaced_counts *c)
{
    const patch_surface *f = rough_of(base, P);
    patch_counts q = {0};
    if (from)
        patch_surface_intersect_own(f, n, x, from, id, h, &q);
    else
        patch_surface_intersect(f, n, x, id, h, &q);
    add_counts(c, q);
}

static void rough_occlude(const surface *base, const bump *P, int n, const rays *x, bool own, real *lit,
                          displaced_counts *c)
{
    const patch_surface *f = rough_of(base, P);
    patch_counts q = {0};
    if (own)
        patch_surface_occlude_own(f, n, x, NULL, lit, &q);
    else
        patch_surface_occlude(f, n, x, lit, &q);
    add_counts(c, q);
}

/* The height, and how all change in space: the dual vectors of U, W and n at that height. */
static void rough_feet(const surface *base, const bump *P, int n, const rays *x, const real *t, int32_t *part,
                       closest_points *p)
{
    const surface *shape = form_of((const patch_surface *)base, P)->shape;
    partials q;
    shape->ops->locate(shape, n, x, t, part, p->u, p->w);
    base->ops->eval(base, n, part, p->u, p->w, 2, &q);
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

const displaced_ops patch_surface_displaced = {rough_prepare, rough_hit, rough_occlude, rough_feet};
