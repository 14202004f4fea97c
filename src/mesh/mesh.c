/* Triangle meshes: hits, places, Q and its partials, shadows. A ray against a triangle is Woop, Benthin and Wald's test
 * of 2013, in double: the ray becomes an axis, and each edge is on one side of it, told by a sum that is the same, but
 * for its sign, for the two triangles that share the edge. So no ray passes between them. Which triangles are tried,
 * Embree tells (bvh.h); of hits at one place the triangle of the lowest index counts, so that the order in which they
 * come does not.
 */
#include "mesh/mesh.h"

#include "wave/lane.h"

#include <stdlib.h>
#include <string.h>

#define MARGIN 4e-6f /* of where a ray ends in the tree's units, against float, as the boxes have it */
#define SPREAD (1 / 4096.0)
#define THIN                                                                                                           \
    2e-5 /* a texture triangle that is lower than this share of the largest coordinate has no digits of float left */

static inline vec3 get(const vec3s *v, int i) { return (vec3){(double)v->x[i], (double)v->y[i], (double)v->z[i]}; }
static inline vec3 wide(const float v[3]) { return (vec3){(double)v[0], (double)v[1], (double)v[2]}; }

static inline void put(vec3s *to, int i, vec3 v)
{
    to->x[i] = (real)v.x;
    to->y[i] = (real)v.y;
    to->z[i] = (real)v.z;
}

mesh_triangle mesh_triangle_of(const mesh *f, int32_t index)
{
    mesh_triangle x;
    for (int k = 0; k < 3; k++) {
        x.at[k] = wide(f->d.at[index][k]);
        x.normal[k] = wide(f->d.skin[index].normal[k]);
        x.u[k] = (double)f->d.skin[index].uv[k][0];
        x.w[k] = (double)f->d.skin[index].uv[k][1];
    }
    return x;
}

/* ---- a ray and a triangle ---- */

/* A ray as an axis: coordinate `z` is the one along which it goes most, and the others are sheared so that it goes
 * along that alone. */
typedef struct shear {
    int x, y, z;
    double r[3], sx, sy, sz;
} shear;

static shear shear_of(vec3 r, vec3 s)
{
    const double S[3] = {s.x, s.y, s.z};
    shear k = {.r = {r.x, r.y, r.z}};
    k.z = fabs(s.x) > fabs(s.y) ? (fabs(s.x) > fabs(s.z) ? 0 : 2) : (fabs(s.y) > fabs(s.z) ? 1 : 2);
    k.x = (k.z + 1) % 3;
    k.y = (k.z + 2) % 3;
    k.sz = 1 / S[k.z];
    k.sx = S[k.x] * k.sz;
    k.sy = S[k.y] * k.sz;
    return k;
}

static bool meets(const float at[3][3], const shear *k, double *t)
{
    double x[3], y[3], z[3];
    for (int i = 0; i < 3; i++) {
        z[i] = (double)at[i][k->z] - k->r[k->z];
        x[i] = (double)at[i][k->x] - k->r[k->x] - k->sx * z[i];
        y[i] = (double)at[i][k->y] - k->r[k->y] - k->sy * z[i];
    }
    const double U = x[2] * y[1] - y[2] * x[1], V = x[0] * y[2] - y[0] * x[2], W = x[1] * y[0] - y[1] * x[0],
                 all = U + V + W;
    if (((U < 0) | (V < 0) | (W < 0)) & ((U > 0) | (V > 0) | (W > 0)))
        return false;
    *t = (U * z[0] + V * z[1] + W * z[2]) * k->sz / all;
    return all != 0;
}

/* ---- walks ---- */

/* A ray on its way through the tree. Hits are looked for in from < t < to; `to` becomes that of the first one. */
typedef struct patch_query {
    const mesh *f;
    shear k;
    int32_t but, index; /* a triangle that does not count; the one that was met, -1: none */
    double from, to;
    double enter, unit; /* t where the ray in the tree begins, and how long it is there for one of t */
    bool any;           /* whichever hit comes first will do */
} patch_query;

static float visit(void *user, int32_t index, float end)
{
    patch_query *q = user;
    double t;
    if (index == q->but || !meets((const float(*)[3])q->f->d.at[index], &q->k, &t) || !(t > q->from))
        return end;
    if (!(t < q->to || (t == q->to && q->index >= 0 && index < q->index)))
        return end;
    q->to = t;
    q->index = index;
    if (q->any)
        return -1;
    const float now = (float)((t - q->enter) * q->unit) * (1 + 1e-6f) + MARGIN;
    return now < end ? now : end;
}

/* The first hit of r + s t in from < t < to, but for one triangle; in q->to and q->index. */
static void seek(patch_query *q, vec3 r, vec3 s, double from, double to, int32_t but)
{
    float at[3], way[3], end;
    double enter = from > 0 ? from : 0, leave = to;
    q->but = but;
    q->index = -1;
    q->from = from;
    q->to = to;
    if (!(from < to) || !bvh_enter(&q->f->space, q->f->space.radius, r, s, &enter, &leave, at, way, &end))
        return;
    q->k = shear_of(r, s);
    q->enter = enter;
    q->unit = vec3_length(s) / q->f->space.radius;
    bvh_toward(q->f->tree, at, way, end, visit, q);
}

static void take(const patch_query *q, int i, int32_t id, hits *h)
{
    const real t = (real)q->to;
    if (q->index >= 0 && t > 0 && t < h->t[i]) {
        h->t[i] = t;
        h->id[i] = id;
        h->part[i] = q->index;
    }
}

static void mesh_hit(const surface *base, int n, const rays *x, int32_t id, hits *h)
{
    patch_query q = {.f = (const mesh *)base};
    for (int i = 0; i < n; i++) {
        seek(&q, get(&x->r, i), get(&x->s, i), 0, (double)h->t[i], -1);
        take(&q, i, id, h);
    }
}

static void mesh_occlude(const surface *base, int n, const rays *x, real *lit)
{
    patch_query q = {.f = (const mesh *)base, .any = true};
    for (int i = 0; i < n; i++) {
        seek(&q, get(&x->r, i), get(&x->s, i), 0, lit[i] > 0 ? 1 : -1, -1);
        lit[i] = q.index >= 0 ? 0 : lit[i];
    }
}

/* ---- rays from the mesh itself ---- */

/* The shares of the second and the third corner at the foot of p on the triangle, kept within it. */
static void foot_shares(const mesh_triangle *x, vec3 p, double *b, double *c)
{
    const vec3 B = vec3_sub(x->at[1], x->at[0]), C = vec3_sub(x->at[2], x->at[0]), d = vec3_sub(p, x->at[0]),
               n = vec3_cross(B, C);
    const double k = 1 / vec3_dot(n, n);
    *b = k * vec3_dot(n, vec3_cross(d, C));
    *c = k * vec3_dot(n, vec3_cross(B, d));
}

static void keep_inside(double *b, double *c)
{
    *b = *b > 0 ? *b : 0;
    *c = *c > 0 ? *c : 0;
    const double sum = *b + *c, k = sum > 1 ? 1 / sum : 1;
    *b *= k;
    *c *= k;
}

/* Where on its triangle a ray starts, as double has it: the triangle itself is left out by its index, and a neighbour
 * at whose edge that is by `beyond`, where other hits begin: double's error over the sine of the ray's angle to it,
 * down to 1e-4. */
static vec3 departure(const mesh *f, int32_t index, vec3 at, vec3 s, double *beyond)
{
    const mesh_triangle x = mesh_triangle_of(f, index);
    double b, c;
    foot_shares(&x, at, &b, &c);
    keep_inside(&b, &c);
    const vec3 from = mesh_mix(x.at, b, c);
    *beyond = 1e-12 * (vec3_length(from) + f->space.radius) / vec3_length(s);
    return from;
}

static void mesh_hit_own(const surface *base, int n, const rays *x, const ray_origins *from, int32_t id, hits *h)
{
    patch_query q = {.f = (const mesh *)base};
    for (int i = 0; i < n; i++) {
        const bool own = from->id[i] == id;
        vec3 r = get(&x->r, i);
        const vec3 s = get(&x->s, i);
        double beyond = 0;
        if (own)
            r = departure(q.f, from->part[i], get(&from->at, i), s, &beyond);
        seek(&q, r, s, beyond, (double)h->t[i], own ? from->part[i] : -1);
        take(&q, i, id, h);
    }
}

static void mesh_occlude_own(const surface *base, int n, const rays *x, const int32_t *part, real *lit)
{
    patch_query q = {.f = (const mesh *)base, .any = true};
    for (int i = 0; i < n; i++) {
        if (!(lit[i] > 0))
            continue;
        double beyond;
        const vec3 r = get(&x->r, i), to = vec3_add(r, get(&x->s, i)),
                   from = departure(q.f, part[i], r, get(&x->s, i), &beyond);
        seek(&q, from, vec3_sub(to, from), beyond, 1, part[i]);
        lit[i] = q.index >= 0 ? 0 : lit[i];
    }
}

/* ---- places ---- */

static void mesh_locate(const surface *base, int n, const rays *x, const real *t, int32_t *part, real *u, real *w)
{
    const mesh *f = (const mesh *)base;
    for (int i = 0; i < n; i++) {
        const mesh_triangle a = mesh_triangle_of(f, part[i]);
        double b, c;
        foot_shares(&a, vec3_add(get(&x->r, i), vec3_scale(get(&x->s, i), (double)t[i])), &b, &c);
        keep_inside(&b, &c);
        u[i] = (real)(a.u[0] + b * (a.u[1] - a.u[0]) + c * (a.u[2] - a.u[0]));
        w[i] = (real)(a.w[0] + b * (a.w[1] - a.w[0]) + c * (a.w[2] - a.w[0]));
    }
}

void mesh_shares(const mesh_triangle *x, double u, double w, double *b, double *c)
{
    const double bu = x->u[1] - x->u[0], bw = x->w[1] - x->w[0], cu = x->u[2] - x->u[0], cw = x->w[2] - x->w[0],
                 k = 1 / (bu * cw - cu * bw);
    u -= x->u[0];
    w -= x->w[0];
    *b = k * (u * cw - w * cu);
    *c = k * (bu * w - bw * u);
}

static vec3 across(vec3 v, vec3 N) { return vec3_sub(v, vec3_scale(N, vec3_dot(v, N))); }

/* The change of `v` along u or along w, from those along the edges. */
static vec3 along(const vec3 v[3], double b, double c)
{
    return vec3_add(vec3_scale(vec3_sub(v[1], v[0]), b), vec3_scale(vec3_sub(v[2], v[0]), c));
}

static void mesh_eval(const surface *base, int n, const int32_t *part, const real *u, const real *w, int order,
                      partials *q)
{
    const mesh *f = (const mesh *)base;
    for (int i = 0; i < n; i++) {
        const mesh_triangle x = mesh_triangle_of(f, part[i]);
        const double bu = x.u[1] - x.u[0], bw = x.w[1] - x.w[0], cu = x.u[2] - x.u[0], cw = x.w[2] - x.w[0],
                     k = 1 / (bu * cw - cu * bw);
        double b, c;
        mesh_shares(&x, (double)u[i], (double)w[i], &b, &c);
        keep_inside(&b, &c);
        const vec3 N = mesh_mix(x.normal, b, c), n_unit = vec3_unit(N);
        const vec3 Qu = across(along(x.at, k * cw, -k * bw), n_unit), Qw = across(along(x.at, -k * cu, k * bu), n_unit);
        put(&q->Q, i, mesh_mix(x.at, b, c));
        put(&q->Qu, i, Qu);
        put(&q->Qw, i, Qw);
        if (order < 2)
            continue;
        const double over = 1 / vec3_length(N);
        const vec3 nu = vec3_scale(along(x.normal, k * cw, -k * bw), over),
                   nw = vec3_scale(along(x.normal, -k * cu, k * bu), over);
        put(&q->Quu, i, vec3_scale(n_unit, -vec3_dot(nu, Qu)));
        put(&q->Quw, i, vec3_scale(n_unit, -0.5 * (vec3_dot(nu, Qw) + vec3_dot(nw, Qu))));
        put(&q->Qww, i, vec3_scale(n_unit, -vec3_dot(nw, Qw)));
    }
}

static void mesh_extent(const surface *base, int part, double u[2], double w[2])
{
    const mesh *f = (const mesh *)base;
    (void)part;
    for (int k = 0; k < 2; k++) {
        u[k] = f->u[k];
        w[k] = f->w[k];
    }
}

/* ---- texture coordinates ---- */

/* Without any, each triangle has its own, so that there is a Qu and a Qw. */
static void lay_bare(mesh *f)
{
    static const float own[3][2] = {{0, 0}, {1, 0}, {0, 1}};
    f->u[0] = f->w[0] = 0;
    f->u[1] = f->w[1] = 1;
    for (int k = 0; k < f->d.n; k++)
        memcpy(f->d.skin[k].uv, own, sizeof own);
}

static void find_range(mesh *f)
{
    f->u[0] = f->w[0] = HUGE_VAL;
    f->u[1] = f->w[1] = -HUGE_VAL;
    for (int k = 0; k < f->d.n; k++)
        for (int i = 0; i < 3; i++) {
            const float *uv = f->d.skin[k].uv[i];
            f->u[0] = fmin(f->u[0], (double)uv[0]);
            f->u[1] = fmax(f->u[1], (double)uv[0]);
            f->w[0] = fmin(f->w[0], (double)uv[1]);
            f->w[1] = fmax(f->w[1], (double)uv[1]);
        }
    /* all of it on one line */
    f->u[1] = fmax(f->u[1], f->u[0] + 1e-3);
    f->w[1] = fmax(f->w[1], f->w[0] + 1e-3);
}

static double texture_area(const mesh_skin *x)
{
    const double bu = (double)x->uv[1][0] - (double)x->uv[0][0], bw = (double)x->uv[1][1] - (double)x->uv[0][1];
    const double cu = (double)x->uv[2][0] - (double)x->uv[0][0], cw = (double)x->uv[2][1] - (double)x->uv[0][1];
    return bu * cw - cu * bw;
}

/* Move two corners by `step`, each along u or w, so that the most area comes out. */
static void spread(mesh_skin *x, float step)
{
    mesh_skin best = *x;
    for (int k = 0; k < 8; k++) {
        mesh_skin y = *x;
        y.uv[1][k >> 2] += k & 1 ? -step : step;
        y.uv[2][1 - (k >> 2)] += k & 2 ? -step : step;
        if (k == 0 || texture_area(&y) > texture_area(&best))
            best = y;
    }
    *x = best;
}

static void lay_texture(mesh *f)
{
    find_range(f);
    const double most = fmax(fmax(fabs(f->u[0]), fabs(f->u[1])), fmax(fabs(f->w[0]), fabs(f->w[1])));
    const double range = f->u[1] - f->u[0], fold = f->u[1] + range,
                 step = SPREAD * fmax(most, fmax(range, f->w[1] - f->w[0]));
    f->d.notes.folded = f->d.notes.spread = 0;
    for (int k = 0; k < f->d.n; k++) {
        mesh_skin *x = &f->d.skin[k];
        double longest = 0;
        for (int i = 0; i < 3; i++)
            for (int a = 0; a < 2; a++)
                longest = fmax(longest, fabs((double)x->uv[i][a] - (double)x->uv[(i + 1) % 3][a]));
        if (!(fabs(texture_area(x)) > THIN * most * longest)) {
            spread(x, (float)step);
            f->d.notes.spread++;
        }
        if (texture_area(x) < 0) {
            for (int i = 0; i < 3; i++)
                x->uv[i][0] = (float)(2 * fold - (double)x->uv[i][0]);
            f->d.notes.folded++;
        }
    }
}

/* ---- making one ---- */

static void mesh_box(const surface *base, double lo[3], double hi[3])
{
    const mesh *f = (const mesh *)base;
    for (int a = 0; a < 3; a++) {
        lo[a] = HUGE_VAL;
        hi[a] = -HUGE_VAL;
        for (int k = 0; k < 3 * f->d.n; k++) {
            const double x = (double)f->d.at[k / 3][k % 3][a];
            lo[a] = x < lo[a] ? x : lo[a];
            hi[a] = x > hi[a] ? x : hi[a];
        }
    }
}

static void show_tree(void *user, double share) { progress_show(user, "building", share); }

static bvh *tree_of(const mesh *f, const progress *w)
{
    bvh_box *box = malloc(sizeof *box * (size_t)f->d.n);
    for (int k = 0; box && k < f->d.n; k++) {
        double lo[3], hi[3];
        for (int a = 0; a < 3; a++) {
            const double x = (double)f->d.at[k][0][a], y = (double)f->d.at[k][1][a], z = (double)f->d.at[k][2][a];
            lo[a] = fmin(x, fmin(y, z));
            hi[a] = fmax(x, fmax(y, z));
        }
        box[k] = bvh_box_in(&f->space, lo, hi);
    }
    progress to = w ? *w : (progress){NULL, NULL};
    bvh *b = box ? bvh_new_with_progress(f->d.n, box, show_tree, &to) : NULL;
    free(box);
    return b;
}

static void mesh_free(surface *base)
{
    mesh *f = (mesh *)base;
    bvh_free(f->tree);
    mesh_data_free(&f->d);
    free(f);
}

static const surface_ops methods = {
    .kind = "mesh",
    .hit = mesh_hit,
    .hit_own = mesh_hit_own,
    .locate = mesh_locate,
    .eval = mesh_eval,
    .occlude = mesh_occlude,
    .occlude_own = mesh_occlude_own,
    .extent = mesh_extent,
    .box = mesh_box,
    .parts = 1, /* all the same to who goes over them: part is the triangle */
};

bool mesh_is(const surface *f) { return f->ops == &methods; }

/* Range and texture are known. */
static surface *finish(mesh *f, const progress *w)
{
    f->base.ops = &methods;
    f->base.free = mesh_free;
    double lo[3], hi[3];
    mesh_box(&f->base, lo, hi);
    f->space = bvh_space_about(lo, hi);
    if (f->space.radius > 0 && (f->tree = tree_of(f, w)))
        return &f->base;
    mesh_free(&f->base);
    return NULL;
}

surface *mesh_new(mesh_data *d, const progress *w)
{
    mesh *f = calloc(1, sizeof *f);
    if (!f) {
        mesh_data_free(d);
        return NULL;
    }
    f->d = *d;
    *d = (mesh_data){0};
    f->textured = f->d.notes.bare == 0;
    if (f->textured)
        lay_texture(f);
    else
        lay_bare(f);
    return finish(f, w);
}

static void narrow(vec3 v, float to[3])
{
    to[0] = (float)v.x;
    to[1] = (float)v.y;
    to[2] = (float)v.z;
}

/* A map that mirrors exchanges what is outward, so corners follow the other way, and u is turned about the middle of
 * its range. */
surface *mesh_moved(const surface *base, const affine *m)
{
    const mesh *from = (const mesh *)base;
    const bool mirrors = affine_volume(m) < 0;
    const affine back = affine_back(m);
    mesh *f = calloc(1, sizeof *f);
    if (!f)
        return NULL;
    f->textured = from->textured;
    memcpy(f->u, from->u, sizeof f->u);
    memcpy(f->w, from->w, sizeof f->w);
    f->d = (mesh_data){from->d.n, malloc(sizeof *f->d.at * (size_t)from->d.n),
                       malloc(sizeof *f->d.skin * (size_t)from->d.n), from->d.notes};
    for (int k = 0; f->d.at && f->d.skin && k < f->d.n; k++)
        for (int i = 0; i < 3; i++) {
            const int to = mirrors && i ? 3 - i : i;
            const vec3 n = wide(from->d.skin[k].normal[i]);
            const vec3 to_n =
                vec3_add(vec3_add(vec3_scale(back.x, n.x), vec3_scale(back.y, n.y)), vec3_scale(back.z, n.z));
            narrow(affine_point(m, wide(from->d.at[k][i])), f->d.at[k][to]);
            narrow(vec3_unit(to_n), f->d.skin[k].normal[to]);
            f->d.skin[k].uv[to][0] = mirrors ? (float)(from->u[0] + from->u[1] - (double)from->d.skin[k].uv[i][0])
                                             : from->d.skin[k].uv[i][0];
            f->d.skin[k].uv[to][1] = from->d.skin[k].uv[i][1];
        }
    if (f->d.at && f->d.skin)
        return finish(f, NULL);
    mesh_free(&f->base);
    return NULL;
}

void mesh_data_free(mesh_data *d)
{
    free(d->at);
    free(d->skin);
    *d = (mesh_data){0};
}
