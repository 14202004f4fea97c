/* True displacement of a sheet: displace.c's search along a ray, over each leaf that the ray may pass as if it alone were there. A leaf
 * is so flat that the foot of a place above it is found by Newton's iteration from its middle, and that how fast (u,w) change in space
 * is about the same all over it. Many pairs of ray and leaf are searched side by side.
 */
#include "searched.h"

#include "displace.h"
#include "offset.h"

#include <math.h>
#include <stdlib.h>

enum {
    SEARCH = 256, /* steps along a ray over one leaf: what is steeper than they tell apart is at a pole, where (u,w) turn in no way */
    STEPS = 3, /* of Newton's iteration: the start is off by FLAT of a leaf (leaf.c), and each squares that */
};

#define OVERLAP 1e-4 /* by how much of their range leaves go on beyond it, so that no hit is between two */
#define AIR 1e-5     /* of the boxes, as in searched.c, against float */

#ifdef KAGE_DOUBLE
#define ROUNDING 4e-16
#else
#define ROUNDING 2.4e-7
#endif

static inline vec3 get(const vec3s *v, int i) { return (vec3){(double)v->x[i], (double)v->y[i], (double)v->z[i]}; }

/* ---- a leaf's rough surface ---- */

/* By how much n/|n| of a leaf may differ from that of its parallelogram; 1 where it can be anything. */
static double normal_spread(const leaf *f)
{
    const double a = vec3_length(f->A), b = vec3_length(f->B), area = vec3_length(vec3_cross(f->A, f->B));
    const double spread = 1.5 * (f->ea * b + f->eb * a + f->ea * f->eb) / area;
    return spread < 0.5 ? spread : 1; /* also NaN */
}

static vec3 middle_normal(const leaf *f) { return vec3_unit(vec3_cross(f->A, f->B)); }

/* The box of Q + P n/|n|. */
static void rough_box(const leaf *f, double lo, double hi, double box[2][3])
{
    const double spread = normal_spread(f), high = fmax(fabs(lo), fabs(hi));
    const vec3 n = middle_normal(f);
    const double N[3] = {n.x, n.y, n.z};
    for (int k = 0; k < 3; k++) {
        const double a = spread < 1 ? fmin(lo * N[k], hi * N[k]) - spread * high : -high;
        const double b = spread < 1 ? fmax(lo * N[k], hi * N[k]) + spread * high : high;
        box[0][k] = f->box[0][k] + a;
        box[1][k] = f->box[1][k] + b;
    }
}

static bool rough_prepare(surface *base, const perturb *P)
{
    searched *f = (searched *)base;
    const leaves *l = &f->l;
    const double C[3] = {l->centre.x, l->centre.y, l->centre.z};
    if (f->rough && f->lowest <= (double)P->Pmin && f->highest >= (double)P->Pmax)
        return true;
    const double lo = f->lowest = fmin(f->lowest, (double)P->Pmin), hi = f->highest = fmax(f->highest, (double)P->Pmax);
    f->height = fmax(fabs(lo), fabs(hi));
    bvh_box *box = malloc(sizeof *box * (size_t)l->n);
    const double air = AIR * (1 + f->height / l->radius);
    for (int i = 0; box && i < l->n; i++) {
        double b[2][3];
        rough_box(&l->leaf[i], lo, hi, b);
        for (int k = 0; k < 3; k++) {
            box[i].lo[k] = (float)((b[0][k] - C[k]) / l->radius - air);
            box[i].hi[k] = (float)((b[1][k] - C[k]) / l->radius + air);
        }
    }
    bvh_free(f->rough);
    f->rough = box ? bvh_new(l->n, box) : NULL;
    free(box);
    return f->rough;
}

/* ---- leaves as the ground of a search ---- */

typedef struct pieces {
    ground base;
    const searched *f;
    const int32_t *index; /* of each lane's leaf */
} pieces;

static const leaf *piece(const ground *g, int32_t lane)
{
    const pieces *k = (const pieces *)g;
    return &k->f->l.leaf[k->index[lane]];
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

/* In the box, and unless the leaf's normals are too different, over its parallelogram as far as it may lean, between Pmin and Pmax. */
static bool shell_of(const leaf *f, double air, vec3 r, vec3 s, double lo, double hi, double *from, double *to)
{
    const double spread = normal_spread(f), high = fmax(fabs(lo), fabs(hi)), off = (f->e + spread * high) * (1 + 1e-6) + air;
    const double R[3] = {r.x, r.y, r.z}, S[3] = {s.x, s.y, s.z};
    double box[2][3];
    rough_box(f, lo, hi, box);
    for (int k = 0; k < 3; k++)
        narrow(R[k], S[k], box[0][k] - off, box[1][k] + off, from, to);
    if (spread < 1) {
        const vec3 o = vec3_sub(r, f->c), N = middle_normal(f), a = vec3_cross(f->B, N), b = vec3_cross(N, f->A);
        const double ka = 1 / vec3_dot(f->A, a), kb = 1 / vec3_dot(f->B, b);
        const double ra = 1 + off * vec3_length(a) * fabs(ka), rb = 1 + off * vec3_length(b) * fabs(kb);
        narrow(ka * vec3_dot(o, a), ka * vec3_dot(s, a), -ra, ra, from, to);
        narrow(kb * vec3_dot(o, b), kb * vec3_dot(s, b), -rb, rb, from, to);
        narrow(vec3_dot(o, N), vec3_dot(s, N), lo - off, hi + off, from, to);
    }
    return *from <= *to;
}

static void pieces_shell(const ground *g, int n, const rays *x, const real *end, real Pmin, real Pmax, real *t0, real *t1)
{
    const double air = AIR * ((const pieces *)g)->f->l.radius;
    for (int i = 0; i < n; i++) {
        double from = 0, to = (double)end[i];
        const bool some = shell_of(piece(g, i), air, get(&x->r, i), get(&x->s, i), (double)Pmin, (double)Pmax, &from, &to);
        t0[i] = some ? (real)from : R(1);
        t1[i] = some ? real_min((real)to, end[i]) : R(-1);
    }
}

/* Places over leaves, and their feet by Newton's iteration for (p - Q).Qu = 0 = (p - Q).Qw; side by side. */
typedef struct perpendiculars {
    int n;
    int32_t part[SHEET_BATCH];
    double u[SHEET_BATCH], w[SHEET_BATCH], mu[SHEET_BATCH], mw[SHEET_BATCH], hu[SHEET_BATCH], hw[SHEET_BATCH];
    double x[SHEET_BATCH], y[SHEET_BATCH], z[SHEET_BATCH];
} perpendiculars;

/* Not farther from a leaf's middle than twice its range: what lies beyond it is another's. */
static inline double near_leaf(double x, double middle, double half)
{
    const double a = middle - 2 * half, b = middle + 2 * half, y = x > a ? x : a;
    return y < b ? y : b;
}

STAGE static void foot_step(perpendiculars *restrict p, const sheet_jets *restrict q)
{
    const expr_jets *X = &q->axis[0], *Y = &q->axis[1], *Z = &q->axis[2];
    for (int i = 0; i < p->n; i++) {
        const double dx = p->x[i] - X->v[i], dy = p->y[i] - Y->v[i], dz = p->z[i] - Z->v[i];
        const double ux = X->u[i], uy = Y->u[i], uz = Z->u[i], wx = X->w[i], wy = Y->w[i], wz = Z->w[i];
        const double uu = ux * ux + uy * uy + uz * uz - (X->uu[i] * dx + Y->uu[i] * dy + Z->uu[i] * dz);
        const double uw = ux * wx + uy * wy + uz * wz - (X->uw[i] * dx + Y->uw[i] * dy + Z->uw[i] * dz);
        const double ww = wx * wx + wy * wy + wz * wz - (X->ww[i] * dx + Y->ww[i] * dy + Z->ww[i] * dz);
        const double du = dx * ux + dy * uy + dz * uz, dw = dx * wx + dy * wy + dz * wz, det = uu * ww - uw * uw;
        const double k = det > 0 ? 1 / det : 0; /* beyond the centre of curvature, or at a pole: stay */
        p->u[i] = near_leaf(p->u[i] + k * (ww * du - uw * dw), p->mu[i], p->hu[i]);
        p->w[i] = near_leaf(p->w[i] + k * (uu * dw - uw * du), p->mw[i], p->hw[i]);
    }
}

static bs_vec3 to_real(const sheet_jets *j, int i, size_t which)
{
    const size_t at = which * SHEET_BATCH + (size_t)i; /* the parts of a jet are arrays of one size */
    const double *x = (const double *)&j->axis[0], *y = (const double *)&j->axis[1], *z = (const double *)&j->axis[2];
    return (bs_vec3){(real)x[at], (real)y[at], (real)z[at]};
}

/* What is known at a foot: the height, and how all change in space (the dual vectors of U, W and n at that height). */
static void tell(const perpendiculars *p, const sheet_jets *j, int i, feet *out, int lane)
{
    const bs_vec3 Qu = to_real(j, i, 1), Qw = to_real(j, i, 2);
    const double dx = p->x[i] - j->axis[0].v[i], dy = p->y[i] - j->axis[1].v[i], dz = p->z[i] - j->axis[2].v[i];
    const vec3 N = vec3_unit(vec3_cross((vec3){j->axis[0].u[i], j->axis[1].u[i], j->axis[2].u[i]}, (vec3){j->axis[0].w[i], j->axis[1].w[i], j->axis[2].w[i]}));
    out->u[lane] = (real)p->u[i];
    out->w[lane] = (real)p->w[i];
    out->h[lane] = (real)(dx * N.x + dy * N.y + dz * N.z);
    const offset o = offset_of(Qu, Qw, to_real(j, i, 3), to_real(j, i, 4), to_real(j, i, 5), out->h[lane]);
    const bs_vec3 Wn = bs_cross(o.W, o.n), nU = bs_cross(o.n, o.U);
    lane_set(&out->gh, lane, (bs_vec3){(real)N.x, (real)N.y, (real)N.z});
    lane_set(&out->gu, lane, offset_mix(Wn, 1 / bs_dot(o.U, Wn) - 1, Wn));
    lane_set(&out->gw, lane, offset_mix(nU, 1 / bs_dot(o.W, nU) - 1, nU));
}

/* Over leaf[i] each. */
static void feet_over(const searched *f, int n, const int32_t *leaf_of_lane, const rays *x, const real *t, feet *out)
{
    for (int at = 0; at < n; at += SHEET_BATCH) {
        perpendiculars p;
        sheet_jets j;
        p.n = n - at < SHEET_BATCH ? n - at : SHEET_BATCH;
        for (int i = 0; i < p.n; i++) {
            const leaf *l = &f->l.leaf[leaf_of_lane[at + i]];
            const vec3 place = vec3_add(get(&x->r, at + i), vec3_scale(get(&x->s, at + i), (double)t[at + i])), d = vec3_sub(place, l->c);
            const vec3 N = vec3_cross(l->A, l->B);
            const double N2 = vec3_dot(N, N), a = vec3_dot(d, vec3_cross(l->B, N)) / N2, b = vec3_dot(d, vec3_cross(N, l->A)) / N2;
            p.part[i] = l->part;
            p.hu[i] = 0.5 * (l->u[1] - l->u[0]);
            p.hw[i] = 0.5 * (l->w[1] - l->w[0]);
            p.mu[i] = l->u[0] + p.hu[i];
            p.mw[i] = l->w[0] + p.hw[i];
            p.u[i] = N2 > 0 ? near_leaf(p.mu[i] + a * p.hu[i], p.mu[i], p.hu[i]) : p.mu[i];
            p.w[i] = N2 > 0 ? near_leaf(p.mw[i] + b * p.hw[i], p.mw[i], p.hw[i]) : p.mw[i];
            p.x[i] = place.x, p.y[i] = place.y, p.z[i] = place.z;
        }
        for (int step = 0; step <= STEPS; step++) {
            f->q->is->eval(f->q, p.n, p.part, p.u, p.w, 2, &j);
            if (step < STEPS)
                foot_step(&p, &j);
        }
        for (int i = 0; i < p.n; i++)
            tell(&p, &j, i, out, at + i);
    }
}

static void pieces_foot(const ground *g, int n, const int32_t *lane, const rays *x, const real *t, feet *p)
{
    const pieces *k = (const pieces *)g;
    int32_t index[LANES];
    for (int i = 0; i < n; i++)
        index[i] = k->index[lane[i]];
    feet_over(k->f, n, index, x, t, p);
}

/* The directions of u and w lie in the tangent plane, across that of h. Within half of the least radius of curvature, less the
 * height, they at most double. */
static void pieces_steep(const ground *g, int n, const int32_t *lane, const rays *x, const feet *p, real Pu_max, real Pw_max, real *rate,
                         real *reach)
{
    const double height = ((const pieces *)g)->f->height;
    for (int i = 0; i < n; i++) {
        const leaf *f = piece(g, lane[i]);
        const double bend = fmin(vec3_length(f->A), vec3_length(f->B)) / normal_spread(f);
        const real radius = (real)fmax(bend - height, 0.1 * bend);
        const bs_vec3 gu = lane_get(&p->gu, i), gw = lane_get(&p->gw, i), d = lane_get(&x->s, i);
        const real s = real_sqrt(bs_dot(d, d)), k = 2 * (real_sqrt(bs_dot(gu, gu)) * Pu_max + real_sqrt(bs_dot(gw, gw)) * Pw_max);
        rate[i] = s * real_sqrt(1 + k * k);
        reach[i] = R(0.5) * radius / s;
    }
}

static void stretch(double range[2], const double of[2])
{
    const double more = OVERLAP * 0.5 * (of[1] - of[0]) + 4 * ROUNDING * fmax(fabs(of[0]), fabs(of[1]));
    range[0] = of[0] - more;
    range[1] = of[1] + more;
}

static void pieces_extent(const ground *g, int32_t lane, double u[2], double w[2])
{
    const leaf *f = piece(g, lane);
    stretch(u, f->u);
    stretch(w, f->w);
}

/* ---- rays and leaves ---- */

typedef struct tour {
    const searched *f;
    const perturb *P;
    const rays *x;
    real end[LANES];
    const int32_t *own; /* of each ray: it starts on the rough surface; NULL: none does */
    displace_counts counts;
    real *t; /* the nearest hits so far */
    int32_t *leaf;
    int lane;
    /* pairs that wait */
    int n;
    int32_t of[LANES], index[LANES]; /* lane and leaf */
    rays y;
} tour;

/* Whether each ray starts on the rough surface of its leaf. */
static void starts_on(tour *k, const pieces *g, int32_t *own)
{
    real zero[LANES];
    feet p;
    heights h;
    for (int i = 0; i < k->n; i++)
        zero[i] = 0;
    feet_over(k->f, k->n, k->index, &k->y, zero, &p);
    k->P->is->eval(k->P, k->n, p.u, p.w, 0, &h);
    k->counts.heights += k->n;
    for (int i = 0; i < k->n; i++) {
        double U[2], W[2];
        pieces_extent(&g->base, i, U, W);
        const double u = (double)p.u[i], w = (double)p.w[i], size = vec3_length(get(&k->y.r, i)) + k->f->height;
        const bool in = u >= U[0] && u <= U[1] && w >= W[0] && w <= W[1];
        own[i] = k->own[k->of[i]] && in && fabs((double)p.h[i] - (double)h.P[i]) <= 64 * ROUNDING * size;
    }
}

/* Each search knows its ray and its leaf alone, so that nothing depends on the order. */
static void search_all(tour *k)
{
    const pieces g = {{pieces_shell, pieces_foot, pieces_steep, pieces_extent, NULL, true, SEARCH}, k->f, k->index};
    real end[LANES], t[LANES];
    int32_t found[LANES], own[LANES];
    for (int i = 0; i < k->n; i++)
        end[i] = k->end[k->of[i]];
    if (k->own)
        starts_on(k, &g, own);
    k->counts.heights += displace_search_over(&g.base, k->P, k->n, &k->y, end, k->own ? own : NULL, t, found);
    for (int i = 0; i < k->n; i++) {
        const int at = k->of[i];
        const bool nearer = found[i] != DISPLACE_MISSED && t[i] > 0 && (t[i] < k->t[at] || (t[i] == k->t[at] && k->index[i] < k->leaf[at]));
        if (!nearer)
            continue;
        k->t[at] = t[i];
        k->leaf[at] = k->index[i];
        k->counts.uncertain += found[i] == DISPLACE_UNCERTAIN;
    }
    k->n = 0;
}

static void visit(void *user, int32_t index)
{
    tour *k = user;
    const vec3 r = get(&k->x->r, k->lane), s = get(&k->x->s, k->lane);
    double from = 0, to = (double)k->end[k->lane];
    if (!shell_of(&k->f->l.leaf[index], AIR * k->f->l.radius, r, s, (double)k->P->Pmin, (double)k->P->Pmax, &from, &to))
        return;
    const int i = k->n++;
    k->of[i] = k->lane;
    k->index[i] = index;
    lane_set(&k->y.r, i, lane_get(&k->x->r, k->lane));
    lane_set(&k->y.s, i, lane_get(&k->x->s, k->lane));
    if (k->n == LANES)
        search_all(k);
}

/* t[i] becomes the nearest hit with 0 < t < t[i], on the leaf[i], which is -1 where there is none. */
static void tour_leaves(const searched *f, const perturb *P, int n, const rays *x, const int32_t *own, real *t, int32_t *leaf_hit,
                        displace_counts *c)
{
    tour k;
    k.f = f;
    k.P = P;
    k.x = x;
    k.own = own;
    k.counts = (displace_counts){0};
    k.t = t;
    k.leaf = leaf_hit;
    k.n = 0;
    for (int i = 0; i < n; i++) {
        double from = 0, to = (double)t[i];
        float at[3], way[3], far;
        k.end[i] = t[i];
        leaf_hit[i] = -1;
        k.lane = i;
        if (searched_enter(f, f->l.radius + f->height, get(&x->r, i), get(&x->s, i), &from, &to, at, way, &far))
            bvh_along(f->rough, at, way, far, visit, &k);
    }
    search_all(&k);
    c->heights += k.counts.heights;
    c->uncertain += k.counts.uncertain;
}

static void rough_hit(const surface *base, const perturb *P, int n, const rays *x, const starts *from, int32_t id, hits *h,
                      displace_counts *c)
{
    int32_t leaf_hit[LANES], own[LANES] = {0};
    for (int i = 0; from && i < n; i++)
        own[i] = from->id[i] == id;
    tour_leaves((const searched *)base, P, n, x, from ? own : NULL, h->t, leaf_hit, c);
    for (int i = 0; i < n; i++)
        if (leaf_hit[i] >= 0) {
            h->id[i] = id;
            h->part[i] = leaf_hit[i];
        }
}

static void rough_occlude(const surface *base, const perturb *P, int n, const rays *x, bool from_it, real *lit, displace_counts *c)
{
    real t[LANES];
    int32_t leaf_hit[LANES], own[LANES] = {0};
    for (int i = 0; i < n; i++) {
        t[i] = lit[i] > 0 ? R(1) : R(-1);
        own[i] = 1;
    }
    tour_leaves((const searched *)base, P, n, x, from_it ? own : NULL, t, leaf_hit, c);
    for (int i = 0; i < n; i++)
        lit[i] = leaf_hit[i] >= 0 ? 0 : lit[i];
}

static void rough_feet(const surface *base, int n, const rays *x, const real *t, int32_t *part, feet *p)
{
    const searched *f = (const searched *)base;
    feet_over(f, n, part, x, t, p);
    for (int i = 0; i < n; i++)
        part[i] = f->l.leaf[part[i]].part;
}

const displaced searched_displaced = {rough_prepare, rough_hit, rough_occlude, rough_feet};
