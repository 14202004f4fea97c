/* True displacement of a sheet: its rough surface is a sheet too (sheet_rough.c), and rays are searched for it as for any other. */
#include "patch/surface.h"

#include "displaced/march.h"
#include "displaced/offset.h"

#include <stdlib.h>

#define FLAT 0.5 /* of leaves: what slopes of P turn is worth halving only where a ray comes */

void searched_free_rough(rough_form *first)
{
    while (first) {
        rough_form *k = first;
        first = k->next;
        surface_free(k->shape);
        free(k);
    }
}

static const rough_form *form_of(const searched *f, const perturb *P)
{
    const rough_form *k = f->rough;
    while (k->P != P)
        k = k->next;
    return k;
}

static const searched *rough_of(const surface *base, const perturb *P)
{
    return (const searched *)form_of((const searched *)base, P)->shape;
}

static void drop(searched *f, const perturb *P)
{
    for (rough_form **at = &f->rough; *at; at = &(*at)->next)
        if ((*at)->P == P) {
            rough_form *k = *at;
            *at = k->next;
            k->next = NULL;
            searched_free_rough(k);
            return;
        }
}

/* A P that was there before may be another one in the same place. */
static bool rough_prepare(surface *base, const perturb *P)
{
    searched *f = (searched *)base;
    drop(f, P);
    rough_form *k = calloc(1, sizeof *k);
    sheet *q = k ? sheet_rough(f->q, P) : NULL;
    searched *shape = q ? searched_make(q, FLAT) : NULL;
    if (!shape) {
        free(k);
        return false;
    }
    shape->broken = true;
    *k = (rough_form){P, &shape->base, f->rough};
    f->rough = k;
    return true;
}

static void add_counts(displace_counts *c, quest_counts q)
{
    c->heights += q.looks;
    c->uncertain += q.unsure;
}

static void rough_hit(const surface *base, const perturb *P, int n, const rays *x, const starts *from, int32_t id, hits *h,
                      displace_counts *c)
{
    const searched *f = rough_of(base, P);
    quest_counts q = {0};
    if (from)
        searched_hits_own(f, n, x, from, id, h, &q);
    else
        searched_hits(f, n, x, id, h, &q);
    add_counts(c, q);
}

static void rough_occlude(const surface *base, const perturb *P, int n, const rays *x, bool own, real *lit, displace_counts *c)
{
    const searched *f = rough_of(base, P);
    quest_counts q = {0};
    if (own)
        searched_darken_own(f, n, x, NULL, lit, &q);
    else
        searched_darken(f, n, x, lit, &q);
    add_counts(c, q);
}

/* The height, and how all change in space: the dual vectors of U, W and n at that height. */
static void rough_feet(const surface *base, const perturb *P, int n, const rays *x, const real *t, int32_t *part, feet *p)
{
    const surface *shape = form_of((const searched *)base, P)->shape;
    partials q;
    shape->is->locate(shape, n, x, t, part, p->u, p->w);
    base->is->eval(base, n, part, p->u, p->w, 2, &q);
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

const displaced searched_displaced = {rough_prepare, rough_hit, rough_occlude, rough_feet};
