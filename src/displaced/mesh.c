/* Displaced surfaces over meshes: Q + P N over each triangle, N the unit normal interpolated between its corners. The
 * space over a triangle is a prism (prism.h). Neighbours share its sides, and there is no gap between them, unless
 * their normals differ (at a crease) or P does (at a seam of the texture).
 *
 * A ray is searched (march.h) over each triangle whose prism it may pass, many pairs of rays and triangles side by
 * side. The closest point to a place is that from which N points to it; Newton's iteration finds it.
 */
#include "displaced/form.h"

#include "displaced/march.h"
#include "displaced/prism.h"
#include "wave/lane.h"

#include <stdlib.h>

enum { SEARCH = 1024 }; /* step limit per triangle, reached only near poles of the texture */

#define ROOM 1e-5     /* of the mesh's radius, about boxes and stretches: more than float's roundings of places */
#define FLATTEST 1e-6 /* least turn of normals: normals that turn by less meet beyond a million sides */
#define ROUNDINGS 64  /* a hit's height, by the ray, Newton's iteration and P, is off by fewer */

static const mesh *mesh_of(const displaced *d) { return (const mesh *)d->smooth; }

static double greatest_height(const bump *P) { return fmax(fabs((double)P->Pmin), fabs((double)P->Pmax)); }

static bool over_mesh_prepare(displaced *d, const progress *w)
{
    const mesh *f = mesh_of(d);
    const double lo = fmin(0, (double)d->P->Pmin), hi = fmax(0, (double)d->P->Pmax);
    const double air = ROOM * (f->space.radius + greatest_height(d->P));
    bvh_box *box = memory_new(progress_memory(w), sizeof *box * (size_t)f->d.n);
    for (int i = 0; box && i < f->d.n; i++) {
        const mesh_triangle x = mesh_triangle_of(f, i);
        double b[2][3];
        prism_box(&x, lo, hi, b);
        for (int a = 0; a < 3; a++) {
            b[0][a] -= air;
            b[1][a] += air;
        }
        box[i] = bvh_box_in(&f->space, b[0], b[1]);
    }
    d->prisms = box ? bvh_new(f->d.n, box, 1, w) : NULL;
    memory_free(box);
    return d->prisms;
}

/* ---- triangles as the domain of a search ---- */

typedef struct triangles {
    domain base;
    double radius, height;  /* of the mesh; of the highest place over it */
    const mesh_triangle *x; /* of each lane */
} triangles;

static const mesh_triangle *piece(const domain *g, int32_t lane) { return &((const triangles *)g)->x[lane]; }

static void triangles_bound(const domain *g, int n, const rays *x, const real *end, real Pmin, real Pmax, real *t0,
                            real *t1)
{
    const double air = ROOM * ((const triangles *)g)->radius;
    for (int i = 0; i < n; i++) {
        double from = 0, to = (double)end[i];
        const bool some = prism_stretch(piece(g, i), air, vec3s_get(&x->r, i), vec3s_get(&x->s, i), (double)Pmin,
                                        (double)Pmax, &from, &to);
        t0[i] = some ? (real)from : R(1);
        t1[i] = some ? real_min((real)to, end[i]) : R(-1);
    }
}

static void triangles_closest(const domain *g, int n, const int32_t *lane, const rays *x, const real *t,
                              closest_points *p)
{
    for (int i = 0; i < n; i++)
        prism_closest(piece(g, lane[i]), vec3_add(vec3s_get(&x->r, i), vec3_scale(vec3s_get(&x->s, i), (double)t[i])),
                      p, i);
}

/* Normals that turn by `turn` along the shortest side meet about side/turn away. Halfway there gradients at most
 * double, and no part of the way changes them by more than its share of that twice over. Heights beyond a tenth of that
 * distance are not counted on: there P folds the surface anyway. */
static void triangles_bend(const domain *g, int n, const int32_t *lane, const rays *x, const closest_points *p,
                           path_bends *out)
{
    const double height = ((const triangles *)g)->height;
    for (int i = 0; i < n; i++) {
        const mesh_triangle *f = piece(g, lane[i]);
        double turn = 0, side = HUGE_VAL;
        for (int k = 0; k < 3; k++) {
            turn = fmax(turn, vec3_length(vec3_sub(f->normal[(k + 1) % 3], f->normal[k])));
            side = fmin(side, vec3_length(vec3_sub(f->at[(k + 1) % 3], f->at[k])));
        }
        const double bend = side / fmax(turn, FLATTEST), radius = fmax(bend - height, 0.1 * bend);
        const bs_vec3 gu = lane_get(&p->gu, i), gw = lane_get(&p->gw, i), gh = lane_get(&p->gh, i),
                      d = lane_get(&x->s, i);
        const real s2 = bs_dot(d, d), k = turn > 0 ? 4 * s2 / (real)radius : 0;
        out->u[i] = k * real_sqrt(bs_dot(gu, gu));
        out->w[i] = k * real_sqrt(bs_dot(gw, gw));
        out->h[i] = k * real_sqrt(bs_dot(gh, gh));
        out->reach[i] = (real)(0.5 * radius) / real_sqrt(s2);
    }
}

/* All of each triangle, with its overlap. */
static void triangles_places(const domain *g, int n, const int32_t *lane, rectangles *r)
{
    for (int i = 0; i < n; i++) {
        const mesh_triangle *x = piece(g, lane[i]);
        const double u0 = fmin(x->u[0], fmin(x->u[1], x->u[2])), u1 = fmax(x->u[0], fmax(x->u[1], x->u[2])),
                     w0 = fmin(x->w[0], fmin(x->w[1], x->w[2])), w1 = fmax(x->w[0], fmax(x->w[1], x->w[2])),
                     over = 2 * PRISM_OVERLAP, du = over * (u1 - u0), dw = over * (w1 - w0);
        r->u0[i] = (real)(u0 - du);
        r->u1[i] = (real)(u1 + du);
        r->w0[i] = (real)(w0 - dw);
        r->w1[i] = (real)(w1 + dw);
    }
}

/* (u,w) of the closest point, moved into the triangle with its overlap. So P is continuous beyond the triangle: a step
 * of it would be hit by rays that pass. */
static void triangles_within(const domain *g, int n, const int32_t *lane, const closest_points *p, real *u, real *w)
{
    for (int i = 0; i < n; i++) {
        const mesh_triangle *x = piece(g, lane[i]);
        double b, c;
        mesh_shares(x, (double)p->u[i], (double)p->w[i], &b, &c);
        u[i] = p->u[i];
        w[i] = p->w[i];
        if (b >= -PRISM_OVERLAP && c >= -PRISM_OVERLAP && b + c <= 1 + PRISM_OVERLAP)
            continue;
        b = b > -PRISM_OVERLAP ? b : -PRISM_OVERLAP;
        c = c > -PRISM_OVERLAP ? c : -PRISM_OVERLAP;
        const double k = b + c > 1 + PRISM_OVERLAP ? (1 + PRISM_OVERLAP) / (b + c) : 1;
        u[i] = (real)(x->u[0] + k * (b * (x->u[1] - x->u[0]) + c * (x->u[2] - x->u[0])));
        w[i] = (real)(x->w[0] + k * (b * (x->w[1] - x->w[0]) + c * (x->w[2] - x->w[0])));
    }
}

/* ---- rays and triangles ---- */

typedef struct traversal {
    const displaced *d;
    double height;
    const rays *x;
    real end[LANES];
    bool own[LANES]; /* the ray starts on the displaced surface */
    real *t;         /* the nearest hits so far */
    int32_t *index_hit;
    int lane;
    /* pairs that wait */
    int n;
    int32_t of[LANES], index[LANES]; /* lane and triangle */
    mesh_triangle triangle[LANES];
    rays y;
} traversal;

/* Whether each ray starts on the displaced surface of its triangle. */
static void starts_on(traversal *tv, const triangles *g, int32_t *own)
{
    real zero[LANES] = {0}, u[LANES], w[LANES];
    int32_t lane[LANES];
    closest_points p;
    bump_values h;
    for (int i = 0; i < tv->n; i++)
        lane[i] = i;
    triangles_closest(&g->base, tv->n, lane, &tv->y, zero, &p);
    triangles_within(&g->base, tv->n, lane, &p, u, w);
    tv->d->P->ops->eval(tv->d->P, tv->n, u, w, 0, &h);
    displaced_count(tv->d, tv->n, 0);
    for (int i = 0; i < tv->n; i++) {
        const double size = vec3_length(vec3s_get(&tv->y.r, i)) + tv->height;
        const bool in = u[i] == p.u[i] && w[i] == p.w[i];
        own[i] = tv->own[tv->of[i]] && in && fabs((double)p.h[i] - (double)h.P[i]) <= ROUNDINGS * REAL_ROUNDING * size;
    }
}

/* Each search knows its ray and its triangle alone, so that nothing depends on the order. */
static void search_all(traversal *tv)
{
    const triangles g = {{.bound = triangles_bound,
                          .closest = triangles_closest,
                          .bend = triangles_bend,
                          .places = triangles_places,
                          .within = triangles_within,
                          .unclamped = true,
                          .steps = SEARCH},
                         mesh_of(tv->d)->space.radius,
                         tv->height,
                         tv->triangle};
    real end[LANES], t[LANES];
    int32_t found[LANES], own[LANES];
    for (int i = 0; i < tv->n; i++)
        end[i] = tv->end[tv->of[i]];
    starts_on(tv, &g, own);
    displaced_count(tv->d, displaced_search(&g.base, tv->d->P, tv->n, &tv->y, end, own, false, t, found), 0);
    for (int i = 0; i < tv->n; i++) {
        const int at = tv->of[i];
        const bool nearer = found[i] != DISPLACED_MISSED && t[i] > 0 &&
                            (t[i] < tv->t[at] || (t[i] == tv->t[at] && tv->index[i] < tv->index_hit[at]));
        if (!nearer)
            continue;
        tv->t[at] = t[i];
        tv->index_hit[at] = tv->index[i];
        displaced_count(tv->d, 0, found[i] == DISPLACED_UNCERTAIN);
    }
    tv->n = 0;
}

static void visit(void *user, int32_t index)
{
    traversal *tv = user;
    const int i = tv->n;
    double from = 0, to = (double)tv->end[tv->lane];
    tv->triangle[i] = mesh_triangle_of(mesh_of(tv->d), index);
    if (!prism_stretch(&tv->triangle[i], ROOM * mesh_of(tv->d)->space.radius, vec3s_get(&tv->x->r, tv->lane),
                       vec3s_get(&tv->x->s, tv->lane), (double)tv->d->P->Pmin, (double)tv->d->P->Pmax, &from, &to))
        return;
    tv->n++;
    tv->of[i] = tv->lane;
    tv->index[i] = index;
    lane_set(&tv->y.r, i, lane_get(&tv->x->r, tv->lane));
    lane_set(&tv->y.s, i, lane_get(&tv->x->s, tv->lane));
    if (tv->n == LANES)
        search_all(tv);
}

static void traversal_begin(traversal *tv, const displaced *d)
{
    tv->d = d;
    tv->height = greatest_height(d->P);
    tv->n = 0;
}

/* t[i] becomes the nearest hit with 0 < t < t[i], on the triangle index[i], which is -1 where there is none. tv->own is
 * set. */
static void traverse(traversal *tv, int n, const rays *x, real *t, int32_t *index)
{
    tv->x = x;
    tv->t = t;
    tv->index_hit = index;
    for (int i = 0; i < n; i++) {
        double from = 0, to = (double)t[i];
        float at[3], way[3], far;
        tv->end[i] = t[i];
        index[i] = -1;
        tv->lane = i;
        if (bvh_enter(&mesh_of(tv->d)->space, mesh_of(tv->d)->space.radius + tv->height, vec3s_get(&x->r, i),
                      vec3s_get(&x->s, i), &from, &to, at, way, &far))
            bvh_along(tv->d->prisms, at, way, far, visit, tv);
    }
    search_all(tv);
}

static void over_mesh_hit(const displaced *d, int n, const rays *x, const ray_origins *from, int32_t id, hits *h)
{
    int32_t index[LANES];
    traversal tv;
    traversal_begin(&tv, d);
    for (int i = 0; i < n; i++)
        tv.own[i] = from && from->id[i] == id;
    traverse(&tv, n, x, h->t, index);
    for (int i = 0; i < n; i++)
        if (index[i] >= 0) {
            h->id[i] = id;
            h->part[i] = index[i];
        }
}

static void over_mesh_occlude(const displaced *d, int n, const rays *x, const int32_t *part, real *lit)
{
    int32_t index[LANES];
    real t[LANES];
    traversal tv;
    traversal_begin(&tv, d);
    for (int i = 0; i < n; i++) {
        t[i] = lit[i] > 0 ? R(1) : R(-1);
        tv.own[i] = part != NULL;
    }
    traverse(&tv, n, x, t, index);
    for (int i = 0; i < n; i++)
        lit[i] = index[i] >= 0 ? 0 : lit[i];
}

/* The height changes along N there, whatever the triangle itself is like: so the displaced surface is as smooth as the
 * mesh is shown. */
static void over_mesh_closest(const displaced *d, int n, const rays *x, const real *t, int32_t *part, closest_points *p)
{
    for (int i = 0; i < n; i++) {
        const mesh_triangle a = mesh_triangle_of(mesh_of(d), part[i]);
        double b, c;
        prism_closest(&a, vec3_add(vec3s_get(&x->r, i), vec3_scale(vec3s_get(&x->s, i), (double)t[i])), p, i);
        mesh_shares(&a, (double)p->u[i], (double)p->w[i], &b, &c);
        vec3s_set(&p->gh, i, vec3_unit(mesh_mix(a.normal, b, c)));
    }
}

const displaced_form displaced_over_mesh = {mesh_is, over_mesh_prepare, over_mesh_hit, over_mesh_occlude,
                                            over_mesh_closest};
