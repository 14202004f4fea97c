/* A mesh as a surface: (u,w) of a hit, Q and its partials, and how a mesh is made. The rays are in intersect.c. */
#include "mesh/mesh.h"

#include "wave/lane.h"

#include <stdlib.h>
#include <string.h>

enum { SOME = 16 };

/* The triangles of some lanes, side by side. */
typedef struct triangles {
    float at[3][3][SOME], normal[3][3][SOME], uv[3][2][SOME];
} triangles;

static void gather(const mesh *f, int n, const int32_t *part, bool normals, triangles *to)
{
    for (int i = 0; i < n; i++) {
        const float(*at)[3] = (const float(*)[3])f->d.at[part[i]];
        const mesh_skin *x = &f->d.skin[part[i]];
        for (int c = 0; c < 3; c++) {
            for (int a = 0; a < 3; a++)
                to->at[c][a][i] = at[c][a];
            for (int a = 0; normals && a < 3; a++)
                to->normal[c][a][i] = x->normal[c][a];
            to->uv[c][0][i] = x->uv[c][0];
            to->uv[c][1][i] = x->uv[c][1];
        }
    }
}

static inline vec3 get(const float (*v)[SOME], int i)
{
    return (vec3){(double)v[0][i], (double)v[1][i], (double)v[2][i]};
}

static inline mesh_triangle triangle_of(const triangles *f, int i)
{
    mesh_triangle x;
    for (int c = 0; c < 3; c++) {
        x.at[c] = get(f->at[c], i);
        x.normal[c] = get(f->normal[c], i);
        x.u[c] = (double)f->uv[c][0][i];
        x.w[c] = (double)f->uv[c][1][i];
    }
    return x;
}

STAGE static void triangle_places(const triangles *restrict f, int n, const vec3s *restrict r, const vec3s *restrict s,
                                  int first, const real *restrict t, real *restrict u, real *restrict w)
{
    for (int i = 0; i < n; i++) {
        const mesh_triangle a = triangle_of(f, i);
        const int l = first + i;
        double b, c;
        mesh_foot_shares(&a, vec3_add(vec3s_get(r, l), vec3_scale(vec3s_get(s, l), (double)t[l])), &b, &c);
        mesh_keep_inside(&b, &c);
        u[l] = (real)(a.u[0] + b * (a.u[1] - a.u[0]) + c * (a.u[2] - a.u[0]));
        w[l] = (real)(a.w[0] + b * (a.w[1] - a.w[0]) + c * (a.w[2] - a.w[0]));
    }
}

static void mesh_locate(const surface *base, int n, const rays *x, const real *t, int32_t *part, real *u, real *w)
{
    triangles f;
    for (int i = 0; i < n; i += SOME) {
        const int some = n - i < SOME ? n - i : SOME;
        gather((const mesh *)base, some, part + i, false, &f);
        triangle_places(&f, some, &x->r, &x->s, i, t, u, w);
    }
}

/* The place on the triangle's plane whose N leads to p, from the foot of p on: N turns little within the height of p.
 */
static void shares_along_normal(const mesh_triangle *a, vec3 p, double *b, double *c)
{
    enum { STEPS = 4 };
    const vec3 n = vec3_cross(vec3_sub(a->at[1], a->at[0]), vec3_sub(a->at[2], a->at[0]));
    mesh_foot_shares(a, p, b, c);
    for (int k = 0; k < STEPS; k++) {
        double inside_b = *b, inside_c = *c;
        mesh_keep_inside(&inside_b, &inside_c);
        const vec3 N = mesh_mix(a->normal, inside_b, inside_c);
        const double high = vec3_dot(vec3_sub(p, a->at[0]), n) / vec3_dot(N, n);
        mesh_foot_shares(a, vec3_sub(p, vec3_scale(N, high)), b, c);
    }
}

/* On the ray's own triangle where the point is over it, else where the normal there meets the mesh. Beyond the mesh's
 * edge (u,w) stays at the edge. */
static void mesh_foot(const surface *base, int n, const rays *x, const real *t, int32_t *part, real *u, real *w)
{
    enum { REACH = 4 }; /* times the point's height: at a crease neighbours are farther away along N */
    const mesh *f = (const mesh *)base;
    for (int i = 0; i < n; i++) {
        const vec3 p = vec3_add(vec3s_get(&x->r, i), vec3_scale(vec3s_get(&x->s, i), (double)t[i]));
        mesh_triangle a = mesh_triangle_of(f, part[i]);
        double b, c;
        shares_along_normal(&a, p, &b, &c);
        const bool over = b >= 0 && c >= 0 && b + c <= 1;
        mesh_keep_inside(&b, &c);
        const vec3 N = vec3_unit(mesh_mix(a.normal, b, c));
        const double high = vec3_length(vec3_sub(p, mesh_mix(a.at, b, c)));
        if (!over && mesh_near(f, p, vec3_scale(N, REACH * high), &part[i])) {
            a = mesh_triangle_of(f, part[i]);
            shares_along_normal(&a, p, &b, &c);
            mesh_keep_inside(&b, &c);
        }
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

/* v without its part along N. */
static vec3 across(vec3 v, vec3 N) { return vec3_sub(v, vec3_scale(N, vec3_dot(v, N))); }

/* A partial of the linear function with values v at the corners, from those of b and c. */
static vec3 along(const vec3 v[3], double b, double c)
{
    return vec3_add(vec3_scale(vec3_sub(v[1], v[0]), b), vec3_scale(vec3_sub(v[2], v[0]), c));
}

/* gcc finds it too long to be part of both stages. */
#define INLINE __attribute__((always_inline)) inline

/* Q and its partials at (u,w); the second partials only if `second`. */
INLINE static void eval_one(const triangles *restrict f, int i, int l, const real *u, const real *w, bool second,
                            partials *restrict q)
{
    const mesh_triangle x = triangle_of(f, i);
    const double bu = x.u[1] - x.u[0], bw = x.w[1] - x.w[0], cu = x.u[2] - x.u[0], cw = x.w[2] - x.w[0],
                 k = 1 / (bu * cw - cu * bw);
    double b, c;
    mesh_shares(&x, (double)u[l], (double)w[l], &b, &c);
    mesh_keep_inside(&b, &c);
    const vec3 N = mesh_mix(x.normal, b, c), n_unit = vec3_unit(N);
    const vec3 Qu = across(along(x.at, k * cw, -k * bw), n_unit), Qw = across(along(x.at, -k * cu, k * bu), n_unit);
    vec3s_set(&q->Q, l, mesh_mix(x.at, b, c));
    vec3s_set(&q->Qu, l, Qu);
    vec3s_set(&q->Qw, l, Qw);
    if (!second)
        return;
    const double over = 1 / vec3_length(N);
    const vec3 nu = vec3_scale(along(x.normal, k * cw, -k * bw), over),
               nw = vec3_scale(along(x.normal, -k * cu, k * bu), over);
    vec3s_set(&q->Quu, l, vec3_scale(n_unit, -vec3_dot(nu, Qu)));
    vec3s_set(&q->Quw, l, vec3_scale(n_unit, -0.5 * (vec3_dot(nu, Qw) + vec3_dot(nw, Qu))));
    vec3s_set(&q->Qww, l, vec3_scale(n_unit, -vec3_dot(nw, Qw)));
}

STAGE static void triangle_eval(const triangles *restrict f, int n, int first, const real *restrict u,
                                const real *restrict w, partials *restrict q)
{
    for (int i = 0; i < n; i++)
        eval_one(f, i, first + i, u, w, false, q);
}

STAGE static void triangle_bends(const triangles *restrict f, int n, int first, const real *restrict u,
                                 const real *restrict w, partials *restrict q)
{
    for (int i = 0; i < n; i++)
        eval_one(f, i, first + i, u, w, true, q);
}

static void mesh_eval(const surface *base, int n, const int32_t *part, const real *u, const real *w, int order,
                      partials *q)
{
    triangles f;
    for (int i = 0; i < n; i += SOME) {
        const int some = n - i < SOME ? n - i : SOME;
        gather((const mesh *)base, some, part + i, true, &f);
        (order < 2 ? triangle_eval : triangle_bends)(&f, some, i, u, w, q);
    }
}

static void mesh_extent(const surface *base, int part, double u[2], double w[2])
{
    const mesh *f = (const mesh *)base;
    (void)part;
    memcpy(u, f->u, sizeof f->u);
    memcpy(w, f->w, sizeof f->w);
}

/* ---- making one ---- */

static void mesh_box(const surface *base, double lo[3], double hi[3])
{
    const mesh *f = (const mesh *)base;
    memcpy(lo, f->lo, sizeof f->lo);
    memcpy(hi, f->hi, sizeof f->hi);
}

static void set_box(mesh *f)
{
    for (int a = 0; a < 3; a++) {
        double lo = HUGE_VAL, hi = -HUGE_VAL;
        for (int k = 0; k < f->d.n; k++)
            for (int i = 0; i < 3; i++) {
                const double x = (double)f->d.at[k][i][a];
                lo = lesser(lo, x);
                hi = greater(hi, x);
            }
        f->lo[a] = lo;
        f->hi[a] = hi;
    }
}

static bvh *tree_of(mesh *f, int threads, const progress *w)
{
    bvh_box *box;
    const bool good = mesh_clusters_new(&f->d, &f->space, threads, w, &f->clusters, &box);
    bvh *b = good ? bvh_new(f->clusters.n, box, threads, w) : NULL;
    memory_free(box);
    return b;
}

static void mesh_free(surface *base)
{
    mesh *f = (mesh *)base;
    bvh_free(f->tree);
    mesh_clusters_free(&f->clusters);
    mesh_data_free(&f->d);
    free(f);
}

static const surface_ops methods = {
    .kind = "mesh",
    .hit = mesh_hit,
    .hit_own = mesh_hit_own,
    .locate = mesh_locate,
    .foot = mesh_foot,
    .eval = mesh_eval,
    .occlude = mesh_occlude,
    .occlude_own = mesh_occlude_own,
    .extent = mesh_extent,
    .box = mesh_box,
    .parts = 1, /* though `part` is the triangle */
};

bool mesh_is(const surface *f) { return f->ops == &methods; }

/* Set all else from the triangles and their texture coordinates. */
static surface *finish(mesh *f, int threads, const progress *w)
{
    f->base.ops = &methods;
    f->base.free = mesh_free;
    set_box(f);
    f->space = bvh_space_about(f->lo, f->hi);
    if (f->space.radius > 0 && (f->tree = tree_of(f, threads, w)))
        return &f->base;
    mesh_free(&f->base);
    return NULL;
}

surface *mesh_new(mesh_data *d, int threads, const progress *w)
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
        mesh_lay_texture(f);
    else
        mesh_lay_bare(f);
    return finish(f, threads, w);
}

/* A map that mirrors swaps inside and outside. So the corners get the opposite order, and u is reflected about the
 * middle of its range. */
surface *mesh_moved(const surface *base, const affine *m, int threads, const progress *w)
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
    f->d = (mesh_data){.n = from->d.n,
                       .at = memory_new(progress_memory(w), sizeof *f->d.at * (size_t)from->d.n),
                       .skin = memory_new(progress_memory(w), sizeof *f->d.skin * (size_t)from->d.n),
                       .notes = from->d.notes};
    for (int k = 0; f->d.at && f->d.skin && k < f->d.n; k++)
        for (int i = 0; i < 3; i++) {
            const int to = mirrors && i ? 3 - i : i;
            /* normals are mapped by the transpose of the inverse */
            const vec3 n = affine_vector(&back, mesh_get(from->d.skin[k].normal[i]));
            mesh_set(f->d.at[k][to], affine_point(m, mesh_get(from->d.at[k][i])));
            mesh_set(f->d.skin[k].normal[to], vec3_unit(n));
            f->d.skin[k].uv[to][0] = mirrors ? (float)(from->u[0] + from->u[1] - (double)from->d.skin[k].uv[i][0])
                                             : from->d.skin[k].uv[i][0];
            f->d.skin[k].uv[to][1] = from->d.skin[k].uv[i][1];
        }
    if (f->d.at && f->d.skin)
        return finish(f, threads, w);
    mesh_free(&f->base);
    return NULL;
}

void mesh_data_free(mesh_data *d)
{
    memory_free(d->at);
    memory_free(d->skin);
    memory_free(d->part);
    *d = (mesh_data){0};
}
