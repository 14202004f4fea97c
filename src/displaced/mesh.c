/* Displaced surfaces over meshes: Q + P N over each triangle, N the unit of the normal between its corners. What stands
 * over a triangle is a prism whose sides two neighbours share where their normals at the common corners are the same:
 * there the displaced surface has no gap. It has one at a crease, and at a seam of the texture where P differs.
 *
 * A ray is searched (march.h) over each triangle whose prism it may pass, many pairs of rays and triangles side by
 * side. The closest point to a place is that from which N leads to it, by Newton's iteration.
 */
#include "displaced/form.h"

#include "displaced/march.h"
#include "mesh/mesh.h"
#include "wave/lane.h"

#include <stdlib.h>

enum {
    SEARCH = 1024, /* step limit per triangle, reached only near poles of the texture */
    STEPS = 4, /* of Newton's iteration: normals turn by less than a right angle over a triangle, mostly by far less */
};

#define OVERLAP                                                                                                        \
    1e-4          /* of a triangle: its displaced surface goes on beyond it by this, so that no hit is between two     \
                   */
#define ROOM 1e-5 /* of the mesh's radius, about boxes and shells: more than float's roundings of places */
#define CONVERGED 1e-16 /* squared distance over the triangle's area: the step before was off by 1e-8 of its size */
#define STEEPEST 1e-6   /* least volume of the prism over its area, where normals meet: bounds gradients */
#define FLATTEST 1e-6   /* least turn of normals: normals that turn by less meet beyond a million sides */
#define ROUNDINGS 64    /* a hit's height, by the ray, Newton's iteration and P, is off by fewer */

static inline vec3 get(const vec3s *v, int i) { return (vec3){(double)v->x[i], (double)v->y[i], (double)v->z[i]}; }
static inline bs_vec3 to_real(vec3 v) { return (bs_vec3){(real)v.x, (real)v.y, (real)v.z}; }

/* ---- a triangle's prism ---- */

/* The mean of the normals, and by how much N may differ from what lies in a straight line between them. */
static vec3 mean_normal(const mesh_triangle *x, double *bulge)
{
    const vec3 n = vec3_unit(vec3_add(x->normal[0], vec3_add(x->normal[1], x->normal[2])));
    const double least = fmin(vec3_dot(n, x->normal[0]), fmin(vec3_dot(n, x->normal[1]), vec3_dot(n, x->normal[2])));
    *bulge = 1 - fmax(least, 0);
    return n;
}

static void prism_box(const mesh_triangle *x, double lo, double hi, double box[2][3])
{
    double bulge;
    mean_normal(x, &bulge);
    const double more = bulge * fmax(fabs(lo), fabs(hi));
    for (int a = 0; a < 3; a++) {
        box[0][a] = HUGE_VAL;
        box[1][a] = -HUGE_VAL;
        for (int k = 0; k < 6; k++) {
            const vec3 p = vec3_add(x->at[k % 3], vec3_scale(x->normal[k % 3], k < 3 ? lo : hi));
            const double c = a == 0 ? p.x : a == 1 ? p.y : p.z;
            box[0][a] = fmin(box[0][a], c - more);
            box[1][a] = fmax(box[1][a], c + more);
        }
    }
}

static const mesh *mesh_of(const displaced *d) { return (const mesh *)d->smooth; }

static double greatest_height(const bump *P) { return fmax(fabs((double)P->Pmin), fabs((double)P->Pmax)); }

static bool over_mesh_prepare(displaced *d)
{
    const mesh *f = mesh_of(d);
    const double lo = fmin(0, (double)d->P->Pmin), hi = fmax(0, (double)d->P->Pmax);
    const double air = ROOM * (f->space.radius + greatest_height(d->P));
    bvh_box *box = malloc(sizeof *box * (size_t)f->d.n);
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
    d->prisms = box ? bvh_new(f->d.n, box) : NULL;
    free(box);
    return d->prisms;
}

/* Narrow t0..t1 to where a + b t is in lo..hi. */
static void narrow(double a, double b, double lo, double hi, double *t0, double *t1)
{
    const double x = (lo - a) / b, y = (hi - a) / b;
    if (b == 0) {
        *t1 = a < lo || a > hi ? -HUGE_VAL : *t1;
        return;
    }
    *t0 = fmax(*t0, fmin(x, y));
    *t1 = fmin(*t1, fmax(x, y));
}

/* Between what is lowest and highest of it along the mean normal, and not farther out past each side than the normals
 * there lean. */
static bool stretch_of(const mesh_triangle *x, double air, vec3 r, vec3 s, double lo, double hi, double *from,
                       double *to)
{
    double bulge, low = HUGE_VAL, high = -HUGE_VAL;
    const vec3 n = mean_normal(x, &bulge);
    const double most = fmax(fabs(lo), fabs(hi)), more = bulge * most + air;
    for (int k = 0; k < 3; k++) {
        const double at = vec3_dot(n, vec3_sub(x->at[k], x->at[0])), up = vec3_dot(n, x->normal[k]);
        low = fmin(low, at + fmin(lo * up, hi * up));
        high = fmax(high, at + fmax(lo * up, hi * up));
    }
    narrow(vec3_dot(n, vec3_sub(r, x->at[0])), vec3_dot(n, s), low - more, high + more, from, to);
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3;
        const vec3 side = vec3_sub(x->at[l], x->at[k]), out = vec3_unit(vec3_cross(side, n));
        const double lean = most * fmax(fabs(vec3_dot(out, x->normal[k])), fabs(vec3_dot(out, x->normal[l])));
        const double wide = OVERLAP * vec3_length(side);
        narrow(vec3_dot(out, vec3_sub(r, x->at[k])), vec3_dot(out, s), -HUGE_VAL, lean + more + wide, from, to);
    }
    return *from <= *to;
}

/* ---- closest points ---- */

mesh_prism mesh_prism_at(const mesh_triangle *x, double b, double c, double h)
{
    const vec3 M = mesh_mix(x->normal, b, c), Mb = vec3_sub(x->normal[1], x->normal[0]),
               Mc = vec3_sub(x->normal[2], x->normal[0]);
    const double length = vec3_length(M), k = h / length;
    mesh_prism p;
    p.N = vec3_scale(M, 1 / length);
    p.Xb = vec3_add(vec3_sub(x->at[1], x->at[0]), vec3_scale(vec3_sub(Mb, vec3_scale(p.N, vec3_dot(Mb, p.N))), k));
    p.Xc = vec3_add(vec3_sub(x->at[2], x->at[0]), vec3_scale(vec3_sub(Mc, vec3_scale(p.N, vec3_dot(Mc, p.N))), k));
    p.place = vec3_add(mesh_mix(x->at, b, c), vec3_scale(p.N, h));
    return p;
}

void mesh_gradients(const mesh_triangle *x, const mesh_prism *p, double det, vec3 *gu, vec3 *gw)
{
    const vec3 gb = vec3_scale(vec3_cross(p->Xc, p->N), 1 / det), gc = vec3_scale(vec3_cross(p->N, p->Xb), 1 / det);
    *gu = vec3_add(vec3_scale(gb, x->u[1] - x->u[0]), vec3_scale(gc, x->u[2] - x->u[0]));
    *gw = vec3_add(vec3_scale(gb, x->w[1] - x->w[0]), vec3_scale(gc, x->w[2] - x->w[0]));
}

/* Not farther beyond a triangle than it is wide: what lies there is another's. */
static double near_triangle(double b) { return b < -1 ? -1 : b > 2 ? 2 : b; }

static void closest_of(const mesh_triangle *x, vec3 at, closest_points *out, int lane)
{
    const vec3 n = vec3_cross(vec3_sub(x->at[1], x->at[0]), vec3_sub(x->at[2], x->at[0]));
    double b = 1.0 / 3, c = 1.0 / 3, h = vec3_dot(vec3_sub(at, x->at[0]), n) / vec3_length(n);
    double off = HUGE_VAL, area = vec3_length(n);
    for (int step = 0; step < STEPS && off > CONVERGED * area; step++) {
        const mesh_prism p = mesh_prism_at(x, b, c, h);
        const vec3 d = vec3_sub(at, p.place), up = vec3_cross(p.Xb, p.Xc);
        const double det = vec3_dot(up, p.N), k = det > 0 ? 1 / det : 0; /* beyond where normals meet: stay */
        b = near_triangle(b + k * vec3_dot(d, vec3_cross(p.Xc, p.N)));
        c = near_triangle(c + k * vec3_dot(d, vec3_cross(p.N, p.Xb)));
        h += k * vec3_dot(d, up);
        off = vec3_dot(d, d);
    }
    const mesh_prism p = mesh_prism_at(x, b, c, h);
    const vec3 up = vec3_cross(p.Xb, p.Xc);
    const double det = fmax(vec3_dot(up, p.N), STEEPEST * area);
    vec3 gu, gw;
    mesh_gradients(x, &p, det, &gu, &gw);
    out->u[lane] = (real)(x->u[0] + b * (x->u[1] - x->u[0]) + c * (x->u[2] - x->u[0]));
    out->w[lane] = (real)(x->w[0] + b * (x->w[1] - x->w[0]) + c * (x->w[2] - x->w[0]));
    out->h[lane] = (real)h;
    lane_set(&out->gu, lane, to_real(gu));
    lane_set(&out->gw, lane, to_real(gw));
    lane_set(&out->gh, lane, to_real(vec3_scale(up, 1 / det)));
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
        const bool some =
            stretch_of(piece(g, i), air, get(&x->r, i), get(&x->s, i), (double)Pmin, (double)Pmax, &from, &to);
        t0[i] = some ? (real)from : R(1);
        t1[i] = some ? real_min((real)to, end[i]) : R(-1);
    }
}

static void triangles_closest(const domain *g, int n, const int32_t *lane, const rays *x, const real *t,
                              closest_points *p)
{
    for (int i = 0; i < n; i++)
        closest_of(piece(g, lane[i]), vec3_add(get(&x->r, i), vec3_scale(get(&x->s, i), (double)t[i])), p, i);
}

/* Normals that turn by `turn` along the shortest side meet about side/turn away. Halfway there gradients at most
 * double. Heights beyond a tenth of that distance are not counted on: there P folds the surface anyway. */
static void triangles_lipschitz(const domain *g, int n, const int32_t *lane, const rays *x, const closest_points *p,
                                real Pu_max, real Pw_max, real *rate, real *reach)
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
        const real s = real_sqrt(bs_dot(d, d));
        const real k = 2 * (real_sqrt(bs_dot(gu, gu)) * Pu_max + real_sqrt(bs_dot(gw, gw)) * Pw_max);
        const real up = (turn > 0 ? 2 : 1) * real_sqrt(bs_dot(gh, gh));
        rate[i] = s * (up + k);
        reach[i] = (real)(0.5 * radius) / s;
    }
}

/* (u,w) of a place of the triangle, as far as it goes on, that is near the closest point: that itself where it is one.
 * So P goes on from there without a step, which a ray that comes by would cross. */
static void triangles_within(const domain *g, int n, const int32_t *lane, const closest_points *p, real *u, real *w)
{
    for (int i = 0; i < n; i++) {
        const mesh_triangle *x = piece(g, lane[i]);
        double b, c;
        mesh_shares(x, (double)p->u[i], (double)p->w[i], &b, &c);
        u[i] = p->u[i];
        w[i] = p->w[i];
        if (b >= -OVERLAP && c >= -OVERLAP && b + c <= 1 + OVERLAP)
            continue;
        b = b > -OVERLAP ? b : -OVERLAP;
        c = c > -OVERLAP ? c : -OVERLAP;
        const double k = b + c > 1 + OVERLAP ? (1 + OVERLAP) / (b + c) : 1;
        u[i] = (real)(x->u[0] + k * (b * (x->u[1] - x->u[0]) + c * (x->u[2] - x->u[0])));
        w[i] = (real)(x->w[0] + k * (b * (x->w[1] - x->w[0]) + c * (x->w[2] - x->w[0])));
    }
}

/* ---- rays and triangles ---- */

typedef struct traversal {
    const displaced *d;
    const mesh *f;
    const bump *P;
    double height;
    const rays *x;
    real end[LANES];
    bool own[LANES]; /* the ray starts on the displaced surface */
    long evaluations, uncertain;
    real *t; /* the nearest hits so far */
    int32_t *index_hit;
    int lane;
    /* pairs that wait */
    int n;
    int32_t of[LANES], index[LANES]; /* lane and triangle */
    mesh_triangle triangle[LANES];
    rays y;
} traversal;

/* Whether each ray starts on the displaced surface of its triangle. */
static void starts_on(traversal *k, const triangles *g, int32_t *own)
{
    real zero[LANES] = {0}, u[LANES], w[LANES];
    int32_t lane[LANES];
    closest_points p;
    bump_values h;
    for (int i = 0; i < k->n; i++)
        lane[i] = i;
    triangles_closest(&g->base, k->n, lane, &k->y, zero, &p);
    triangles_within(&g->base, k->n, lane, &p, u, w);
    k->P->ops->eval(k->P, k->n, u, w, 0, &h);
    k->evaluations += k->n;
    for (int i = 0; i < k->n; i++) {
        const double size = vec3_length(get(&k->y.r, i)) + k->height;
        const bool in = u[i] == p.u[i] && w[i] == p.w[i];
        own[i] = k->own[k->of[i]] && in && fabs((double)p.h[i] - (double)h.P[i]) <= ROUNDINGS * REAL_ROUNDING * size;
    }
}

/* Each search knows its ray and its triangle alone, so that nothing depends on the order. */
static void search_all(traversal *k)
{
    const triangles g = {{.bound = triangles_bound,
                          .closest = triangles_closest,
                          .lipschitz = triangles_lipschitz,
                          .within = triangles_within,
                          .unclamped = true,
                          .steps = SEARCH},
                         k->f->space.radius,
                         k->height,
                         k->triangle};
    real end[LANES], t[LANES];
    int32_t found[LANES], own[LANES];
    for (int i = 0; i < k->n; i++)
        end[i] = k->end[k->of[i]];
    starts_on(k, &g, own);
    k->evaluations += displaced_search(&g.base, k->P, k->n, &k->y, end, own, t, found);
    for (int i = 0; i < k->n; i++) {
        const int at = k->of[i];
        const bool nearer = found[i] != DISPLACED_MISSED && t[i] > 0 &&
                            (t[i] < k->t[at] || (t[i] == k->t[at] && k->index[i] < k->index_hit[at]));
        if (!nearer)
            continue;
        k->t[at] = t[i];
        k->index_hit[at] = k->index[i];
        k->uncertain += found[i] == DISPLACED_UNCERTAIN;
    }
    k->n = 0;
}

static void visit(void *user, int32_t index)
{
    traversal *k = user;
    const int i = k->n;
    double from = 0, to = (double)k->end[k->lane];
    k->triangle[i] = mesh_triangle_of(k->f, index);
    if (!stretch_of(&k->triangle[i], ROOM * k->f->space.radius, get(&k->x->r, k->lane), get(&k->x->s, k->lane),
                    (double)k->P->Pmin, (double)k->P->Pmax, &from, &to))
        return;
    k->n++;
    k->of[i] = k->lane;
    k->index[i] = index;
    lane_set(&k->y.r, i, lane_get(&k->x->r, k->lane));
    lane_set(&k->y.s, i, lane_get(&k->x->s, k->lane));
    if (k->n == LANES)
        search_all(k);
}

static void traversal_begin(traversal *k, const displaced *d)
{
    k->d = d;
    k->f = mesh_of(d);
    k->P = d->P;
    k->height = greatest_height(d->P);
    k->evaluations = k->uncertain = 0;
    k->n = 0;
}

/* t[i] becomes the nearest hit with 0 < t < t[i], on the triangle index[i], which is -1 where there is none. k->own is
 * set. */
static void traverse(traversal *k, int n, const rays *x, real *t, int32_t *index)
{
    k->x = x;
    k->t = t;
    k->index_hit = index;
    for (int i = 0; i < n; i++) {
        double from = 0, to = (double)t[i];
        float at[3], way[3], far;
        k->end[i] = t[i];
        index[i] = -1;
        k->lane = i;
        if (bvh_enter(&k->f->space, k->f->space.radius + k->height, get(&x->r, i), get(&x->s, i), &from, &to, at, way,
                      &far))
            bvh_along(k->d->prisms, at, way, far, visit, k);
    }
    search_all(k);
    displaced_count(k->d, k->evaluations, k->uncertain);
}

static void over_mesh_hit(const displaced *d, int n, const rays *x, const ray_origins *from, int32_t id, hits *h)
{
    int32_t index[LANES];
    traversal k;
    traversal_begin(&k, d);
    for (int i = 0; i < n; i++)
        k.own[i] = from && from->id[i] == id;
    traverse(&k, n, x, h->t, index);
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
    traversal k;
    traversal_begin(&k, d);
    for (int i = 0; i < n; i++) {
        t[i] = lit[i] > 0 ? R(1) : R(-1);
        k.own[i] = part != NULL;
    }
    traverse(&k, n, x, t, index);
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
        closest_of(&a, vec3_add(get(&x->r, i), vec3_scale(get(&x->s, i), (double)t[i])), p, i);
        mesh_shares(&a, (double)p->u[i], (double)p->w[i], &b, &c);
        lane_set(&p->gh, i, to_real(vec3_unit(mesh_mix(a.normal, b, c))));
    }
}

const displaced_form displaced_over_mesh = {mesh_is, over_mesh_prepare, over_mesh_hit, over_mesh_occlude,
                                            over_mesh_closest};
