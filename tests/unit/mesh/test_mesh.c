/* Triangle meshes: hits against brute force, edges and corners that no ray passes between, places and partials, shadows
 * on the mesh itself, images by maps, true displacement against closed forms, and textures without sense.
 */
#include <stdlib.h>
#include <string.h>

#include "displaced/prism.h"
#include "mesh/mesh.h"
#include "support/check.h"
#include "support/displace.h"
#include "support/random_rays.h"
#include "wave/lane.h"

static const double pi = 3.14159265358979323846;

/* ---- models ---- */

typedef void model(double a, double b, float at[3], float uv[2]);

static void put(float to[3], double x, double y, double z)
{
    to[0] = (float)x;
    to[1] = (float)y;
    to[2] = (float)z;
}

/* The unit sphere by sphere_new's (u,w). */
static void ball(double a, double b, float at[3], float uv[2])
{
    const double u = pi * (2 * a - 1), w = pi * b, ring = b == 0 || b == 1 ? 0 : sin(w);
    const double turn = a == 1 ? -pi : u; /* the seam is closed to the last digit */
    put(at, ring * cos(turn), cos(w), ring * sin(turn));
    uv[0] = (float)u;
    uv[1] = (float)w;
}

/* The plane through the origin with u along z and w along x, as in test_slopes.c; 4 x 4. */
static void floor_of(double a, double b, float at[3], float uv[2])
{
    put(at, 4 * b - 2, 0, 4 * a - 2);
    uv[0] = at[2];
    uv[1] = at[0];
}

/* n x m cells of two triangles; normals as `mesh_clean` finds them. */
static mesh_data grid(model *of, int n, int m)
{
    mesh_data d = {.n = 2 * n * m,
                   .at = memory_new(NULL, sizeof *d.at * 2 * (size_t)(n * m)),
                   .skin = memory_new(NULL, sizeof *d.skin * 2 * (size_t)(n * m))};
    assert_true(d.at && d.skin);
    memset(d.skin, 0, sizeof *d.skin * 2 * (size_t)(n * m));
    for (int k = 0; k < d.n; k++) {
        static const int corner[2][3][2] = {{{0, 0}, {1, 0}, {1, 1}}, {{0, 0}, {1, 1}, {0, 1}}};
        const int i = k / 2 % n, j = k / 2 / n;
        for (int c = 0; c < 3; c++)
            of((double)(i + corner[k % 2][c][0]) / n, (double)(j + corner[k % 2][c][1]) / m, d.at[k][c],
               d.skin[k].uv[c]);
    }
    return d;
}

static mesh *mesh_from(mesh_data d, mesh_normals normals, double crease)
{
    char why[MESH_WHY];
    assert_true(mesh_clean(&d, normals, crease, 1e6, 2, NULL, why));
    surface *f = mesh_new(&d, 1, NULL);
    assert_non_null(f);
    return (mesh *)f;
}

static mesh *mesh_of(model *of, int n, int m) { return mesh_from(grid(of, n, m), MESH_NORMALS_SMOOTH, 60); }

/* Triangles all over the place. */
static mesh *object_bvh(int n)
{
    mesh_data d = {
        .n = n, .at = memory_new(NULL, sizeof *d.at * (size_t)n), .skin = memory_new(NULL, sizeof *d.skin * (size_t)n)};
    assert_true(d.at && d.skin);
    memset(d.skin, 0, sizeof *d.skin * (size_t)n);
    for (int k = 0; k < n; k++)
        for (int i = 0; i < 9; i++)
            d.at[k][i / 3][i % 3] =
                (float)(random_in(-0.3, 0.3) + (i < 3 ? random_in(-1, 1) : (double)d.at[k][0][i % 3]));
    for (int k = 0; k < 6 * n; k++)
        d.skin[k / 6].uv[k % 6 / 2][k % 2] = (float)random_in(0, 1);
    return mesh_from(d, MESH_NORMALS_SMOOTH, 40);
}

/* ---- rays ---- */

static vec3 wide(bs_vec3 v) { return (vec3){(double)v.x, (double)v.y, (double)v.z}; }
static double apart(bs_vec3 a, bs_vec3 b) { return vec3_length(vec3_sub(wide(a), wide(b))); }

/* t of the plane of a triangle, and whether the ray is within its edges by the signs of volumes; in long double. */
static bool brute(const mesh *f, int k, vec3 r, vec3 s, long double *t)
{
    const long double R[3] = {(long double)r.x, (long double)r.y, (long double)r.z};
    long double p[3][3], S[3] = {(long double)s.x, (long double)s.y, (long double)s.z}, v[3];
    for (int i = 0; i < 3; i++)
        for (int a = 0; a < 3; a++)
            p[i][a] = (long double)f->d.at[k][i][a] - R[a];
    for (int i = 0; i < 3; i++) {
        const long double *b = p[i], *c = p[(i + 1) % 3];
        v[i] = S[0] * (b[1] * c[2] - b[2] * c[1]) + S[1] * (b[2] * c[0] - b[0] * c[2]) +
               S[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    if (!((v[0] >= 0 && v[1] >= 0 && v[2] >= 0) || (v[0] <= 0 && v[1] <= 0 && v[2] <= 0)))
        return false;
    long double e[2][3], n[3], up = 0, down = 0;
    for (int a = 0; a < 3; a++) {
        e[0][a] = p[1][a] - p[0][a];
        e[1][a] = p[2][a] - p[0][a];
    }
    for (int a = 0; a < 3; a++) {
        n[a] = e[0][(a + 1) % 3] * e[1][(a + 2) % 3] - e[0][(a + 2) % 3] * e[1][(a + 1) % 3];
        up += n[a] * p[0][a];
        down += n[a] * S[a];
    }
    *t = up / down;
    return down != 0;
}

static void hits_as_by_brute_force(void **state)
{
    (void)state;
    mesh *f = object_bvh(300);
    int met = 0, dark = 0;
    for (int round = 0; round < 12; round++) {
        static rays x;
        static hits h;
        static partials q;
        real lit[LANES], u[LANES], w[LANES];
        for (int i = 0; i < LANES; i++) {
            random_ray(&x, i, 1);
            if (round % 3 == 1) { /* from among them */
                x.r.x[i] *= R(0.2), x.r.y[i] *= R(0.2), x.r.z[i] *= R(0.2);
            }
            lit[i] = 1;
        }
        no_hits(&h, LANES);
        f->base.ops->hit(&f->base, LANES, &x, 3, &h);
        f->base.ops->occlude(&f->base, LANES, &x, lit);
        f->base.ops->locate(&f->base, LANES, &x, h.t, h.part, u, w);
        f->base.ops->eval(&f->base, LANES, h.part, u, w, 1, &q);
        for (int i = 0; i < LANES; i++) {
            long double best = HUGE_VALL, t;
            int at = -1;
            for (int k = 0; k < f->d.n; k++)
                if (brute(f, k, wide(lane_get(&x.r, i)), wide(lane_get(&x.s, i)), &t) && t > 0 && t < best) {
                    best = t;
                    at = k;
                }
            assert_int_equal(h.id[i] < 0, at < 0);
            assert_int_equal(lit[i] > 0, !(best < 1));
            dark += !(lit[i] > 0);
            if (at < 0)
                continue;
            met++;
            assert_int_equal(h.part[i], at);
            /* rounded to a real, from double's digits on thin triangles and flat rays */
            NEAR((double)h.t[i], (double)best, (EPS + 1e-12) * (double)best);
            /* float's (u,w) tell the place to a share of the triangle's size; the thinnest of these have little of it
             */
            CHECK(apart(lane_get(&q.Q, i), lane_at(&x, i, h.t[i])), <, 1e4 * EPS * 4);
        }
    }
    print_message("%d hits and %d shadows as by brute force\n", met, dark);
    CHECK(met, >, 700);
    CHECK(dark, >, 300);
    surface_free(&f->base);
}

/* Rays at vertices and at places on edges, as exactly as the number type lets them, and from far away: the ball is
 * closed. */
static void no_ray_passes_between(void **state)
{
    (void)state;
    mesh *f = mesh_of(ball, 24, 12);
    int lost = 0, all = 0;
    for (int k = 0; k < f->d.n; k++) {
        static rays x;
        static hits h;
        for (int i = 0; i < LANES; i++) {
            const mesh_triangle a = mesh_triangle_of(f, k);
            const double b = i % 4 == 0 ? 0 : random_in(0, 1), far = i % 3 == 0 ? 1 : i % 3 == 1 ? 30 : 1000;
            const vec3 to = vec3_add(vec3_scale(a.at[i % 3], 1 - b), vec3_scale(a.at[(i + 1) % 3], b));
            /* from within and from outside, where a place that is met means that the ball is */
            const vec3 r = i % 2 ? (vec3){random_in(-0.1, 0.1), random_in(-0.1, 0.1), random_in(-0.1, 0.1)}
                                 : vec3_add(vec3_scale(to, far),
                                            (vec3){random_in(-0.2, 0.2), random_in(-0.2, 0.2), random_in(-0.2, 0.2)});
            const vec3 s = vec3_sub(i % 2 ? to : (vec3){0.1, 0.1, 0.1}, r);
            lane_set(&x.r, i, (bs_vec3){(real)r.x, (real)r.y, (real)r.z});
            lane_set(&x.s, i, (bs_vec3){(real)s.x, (real)s.y, (real)s.z});
        }
        no_hits(&h, LANES);
        f->base.ops->hit(&f->base, LANES, &x, 0, &h);
        for (int i = 0; i < LANES; i++)
            lost += h.id[i] < 0;
        all += LANES;
    }
    print_message("%d rays through edges and vertices, %d lost\n", all, lost);
    assert_int_equal(lost, 0);
    surface_free(&f->base);
}

/* n is along the mean of the corners' normals, and the partials are what changes: Q by differences, N by the second
 * ones. */
static void partials_are_those_of_the_triangle(void **state)
{
    (void)state;
    mesh *f = mesh_of(ball, 24, 12);
    double worst = 0;
    for (int k = 0; k < 400; k++) {
        const int32_t part = (int32_t)random_in(0, f->d.n - 1e-3), parts[3] = {part, part, part};
        const mesh_triangle a = mesh_triangle_of(f, part);
        const double b = random_in(0.1, 0.5), c = random_in(0.1, 0.4), d = 1e-3;
        const double u0 = a.u[0] + b * (a.u[1] - a.u[0]) + c * (a.u[2] - a.u[0]),
                     w0 = a.w[0] + b * (a.w[1] - a.w[0]) + c * (a.w[2] - a.w[0]);
        const real u[3] = {(real)u0, (real)(u0 + d), (real)u0}, w[3] = {(real)w0, (real)w0, (real)(w0 + d)};
        static partials q;
        f->base.ops->eval(&f->base, 3, parts, u, w, 2, &q);
        vec3 N[3], Q[3];
        for (int i = 0; i < 3; i++) {
            N[i] = vec3_unit(wide(bs_normal(lane_get(&q.Qu, i), lane_get(&q.Qw, i))));
            Q[i] = wide(lane_get(&q.Q, i));
        }
        CHECK(vec3_length(vec3_sub(N[0], vec3_unit(mesh_mix(a.normal, b, c)))), <, 1e3 * EPS);
        const double du = (double)(u[1] - u[0]), dw = (double)(w[2] - w[0]), digits = 1e2 * EPS / d;
        const vec3 Qu = vec3_scale(vec3_sub(Q[1], Q[0]), 1 / du), Qw = vec3_scale(vec3_sub(Q[2], Q[0]), 1 / dw);
        const vec3 nu = vec3_scale(vec3_sub(N[1], N[0]), 1 / du), nw = vec3_scale(vec3_sub(N[2], N[0]), 1 / dw);
        /* without their parts along N */
        const vec3 flat_u = vec3_sub(Qu, vec3_scale(N[0], vec3_dot(Qu, N[0]))),
                   flat_w = vec3_sub(Qw, vec3_scale(N[0], vec3_dot(Qw, N[0])));
        worst = fmax(worst, vec3_length(vec3_sub(flat_u, wide(lane_get(&q.Qu, 0)))));
        CHECK(vec3_length(vec3_sub(flat_u, wide(lane_get(&q.Qu, 0)))), <, digits + d);
        CHECK(vec3_length(vec3_sub(flat_w, wide(lane_get(&q.Qw, 0)))), <, digits + d);
        CHECK(fabs(vec3_dot(wide(lane_get(&q.Quu, 0)), N[0]) + vec3_dot(nu, flat_u)), <, digits + 4 * d);
        CHECK(fabs(vec3_dot(wide(lane_get(&q.Qww, 0)), N[0]) + vec3_dot(nw, flat_w)), <, digits + 4 * d);
        CHECK(fabs(vec3_dot(wide(lane_get(&q.Quw, 0)), N[0]) + 0.5 * (vec3_dot(nu, flat_w) + vec3_dot(nw, flat_u))), <,
              digits + 4 * d);
    }
    print_message("Qu at most %.2g off\n", worst);
    surface_free(&f->base);
}

/* Of places Q + h N, (u,w) change along a ray by the method's a and b exactly; on a flat mesh the partials are the
 * plane's. */
static void the_way_past(void **state)
{
    (void)state;
    for (int flat = 0; flat < 2; flat++) {
        mesh *f = flat ? mesh_of(floor_of, 8, 8) : mesh_of(ball, 24, 12);
        for (int k = 0; k < 400; k++) {
            const int32_t part = (int32_t)random_in(0, f->d.n - 1e-3);
            const mesh_triangle x = mesh_triangle_of(f, part);
            const double b = random_in(0, 0.5), c = random_in(0, 0.5);
            const real u = (real)(x.u[0] + b * (x.u[1] - x.u[0]) + c * (x.u[2] - x.u[0]));
            const real w = (real)(x.w[0] + b * (x.w[1] - x.w[0]) + c * (x.w[2] - x.w[0]));
            const bs_vec3 s = {(real)random_in(-1, 1), (real)random_in(-1, 1), (real)random_in(-1, 1)};
            static partials q;
            vec3 gu, gw;
            f->base.ops->eval(&f->base, 1, &part, &u, &w, 2, &q);
            const bs_vec3 Qu = lane_get(&q.Qu, 0), Qw = lane_get(&q.Qw, 0);
            const bs_view v = bs_view_of(s, bs_normal(Qu, Qw), Qu, Qw);
            const prism_point p = prism_at(&x, b, c, 0);
            prism_gradients(&x, &p, vec3_dot(vec3_cross(p.Xb, p.Xc), p.N), &gu, &gw);
            /* (u,w), which are reals here, tell b and c to 1e3 roundings on these triangles, of 1/24 and more of 2 pi
             */
            NEAR((double)v.a, vec3_dot(gu, wide(s)), 1e3 * EPS * (1 + vec3_length(gu)));
            NEAR((double)v.b, vec3_dot(gw, wide(s)), 1e3 * EPS * (1 + vec3_length(gw)));
            if (flat) {
                CHECK(apart(Qu, (bs_vec3){0, 0, 1}), <, 4 * EPS);
                CHECK(apart(Qw, (bs_vec3){1, 0, 0}), <, 4 * EPS);
                CHECK(vec3_length(wide(lane_get(&q.Quu, 0))) + vec3_length(wide(lane_get(&q.Quw, 0))) +
                          vec3_length(wide(lane_get(&q.Qww, 0))),
                      ==, 0);
            }
        }
        surface_free(&f->base);
    }
}

/* A ball's mesh from its own surface: outward all is light, inward all is dark, from every place on it, edges and
 * vertices with them. */
static void own_shadows(void **state)
{
    (void)state;
    mesh *f = mesh_of(ball, 40, 20);
    int wrong = 0, all = 0;
    for (int k = 0; k < f->d.n; k++) {
        static rays x;
        int32_t part[LANES];
        real lit[LANES];
        const mesh_triangle a = mesh_triangle_of(f, k);
        const vec3 n = vec3_unit(vec3_cross(vec3_sub(a.at[1], a.at[0]), vec3_sub(a.at[2], a.at[0])));
        for (int i = 0; i < LANES; i++) {
            const double b = i % 4 ? random_in(0, 1) : 0, c = i % 3 ? random_in(0, 1 - b) : 0;
            const vec3 from = mesh_mix(a.at, b, c);
            const vec3 side = vec3_scale((vec3){random_in(-1, 1), random_in(-1, 1), random_in(-1, 1)}, 0.7);
            const vec3 s =
                vec3_scale(vec3_add(vec3_scale(n, i % 2 ? 1.5 : -1.5), side), 16); /* through the ball in any case */
            lane_set(&x.r, i, (bs_vec3){(real)from.x, (real)from.y, (real)from.z});
            lane_set(&x.s, i, (bs_vec3){(real)s.x, (real)s.y, (real)s.z});
            part[i] = k;
            lit[i] = 1;
        }
        f->base.ops->occlude_own(&f->base, LANES, &x, part, lit);
        for (int i = 0; i < LANES; i++)
            wrong += (lit[i] > 0) != (i % 2 == 1);
        all += LANES;
    }
    print_message("own shadows are wrong at %d of %d places\n", wrong, all);
    assert_int_equal(wrong, 0);
    surface_free(&f->base);
}

/* Rays at the image of a mesh, and the mesh of the images; by a map that turns and stretches, and by one that mirrors,
 * too. */
static void images(void **state)
{
    (void)state;
    static const affine maps[] = {{{1.2, 0.3, 0}, {-0.2, 0.9, 0.4}, {0.1, 0, 1.1}, {0.3, -0.2, 0.5}},
                                  {{-1.2, 0.3, 0}, {-0.2, 0.9, 0.4}, {0.1, 0, 1.1}, {0.3, -0.2, 0.5}}};
    mesh *f = mesh_of(ball, 24, 12);
    for (size_t m = 0; m < 2; m++) {
        surface *g = surface_transformed(&f->base, &maps[m]), *k = mesh_moved(&f->base, &maps[m], 1, NULL);
        assert_true(g && k);
        static rays x;
        static hits a, b;
        static partials p, q;
        real u[2][LANES], w[2][LANES];
        int met = 0;
        for (int i = 0; i < LANES; i++)
            random_ray(&x, i, 1);
        no_hits(&a, LANES);
        no_hits(&b, LANES);
        g->ops->hit(g, LANES, &x, 0, &a);
        k->ops->hit(k, LANES, &x, 0, &b);
        g->ops->locate(g, LANES, &x, a.t, a.part, u[0], w[0]);
        k->ops->locate(k, LANES, &x, b.t, b.part, u[1], w[1]);
        g->ops->eval(g, LANES, a.part, u[0], w[0], 1, &p);
        k->ops->eval(k, LANES, b.part, u[1], w[1], 1, &q);
        for (int i = 0; i < LANES; i++) {
            if (a.id[i] < 0 || a.part[i] != b.part[i]) /* at an edge float may take either */
                continue;
            met++;
            /* the moved mesh has its corners rounded to float, in either build */
            CHECK(apart(lane_at(&x, i, a.t[i]), lane_at(&x, i, b.t[i])), <, 3e-5);
            NEAR(u[0][i], u[1][i], 1e-4);
            NEAR(w[0][i], w[1][i], 1e-4);
            CHECK(apart(lane_get(&p.Qu, i), lane_get(&q.Qu, i)), <, 0.2);
            CHECK(apart(lane_get(&p.Qw, i), lane_get(&q.Qw, i)), <, 0.2);
            const vec3 n = wide(bs_normal(lane_get(&p.Qu, i), lane_get(&p.Qw, i))), s = wide(lane_get(&x.s, i));
            CHECK(vec3_dot(n, wide(bs_normal(lane_get(&q.Qu, i), lane_get(&q.Qw, i)))), >, 0);
            CHECK(vec3_dot(n, s), <,
                  0.35 * vec3_length(n) * vec3_length(s)); /* outward, but for what normals are bent */
        }
        CHECK(met, >, 40);
        surface_free(k);
        surface_free(g);
    }
    surface_free(&f->base);
}

/* ---- true displacement ---- */

static bump *bumped(const char *text, double scale, const mesh *f)
{
    expr_error wrong;
    expr *e = expr_parse(text, &wrong);
    assert_non_null(e);
    bump *P = bump_function_new(e, scale, f->u, f->w);
    assert_non_null(P);
    return P;
}

/* Lane i of a wave as one more of the group. */
static void put_hit(hit_group *g, const rays *x, int i, real t, int32_t part)
{
    const int k = g->n++;
    hit_group_picked(g);
    lane_set(&g->picked.x.r, k, lane_get(&x->r, i));
    lane_set(&g->picked.x.s, k, lane_get(&x->s, i));
    g->picked.t[k] = t;
    g->part[k] = part;
}

/* Against the same surface in closed form: `within` of its hits, as the mesh lies within that of it. */
static void displaced_as(const char *name, mesh *f, surface *g, const char *text, double scale, double within,
                         double share)
{
    bump *P = bumped(text, scale, f);
    int met = 0, far = 0, differ = 0, dark = 0, darker = 0;
    displaced_counts c = {0, 0};
    surface *over_mesh = displace(&f->base, P, &c), *over_closed = displace(g, P, &c);
    for (int round = 0; round < 4; round++) {
        static rays x;
        static hits a, b;
        static hit_group g_a, g_b;
        real lit_a[LANES], lit_b[LANES];
        for (int i = 0; i < LANES; i++) {
            random_ray(&x, i, 1);
            lit_a[i] = lit_b[i] = 1;
        }
        no_hits(&a, LANES);
        no_hits(&b, LANES);
        over_mesh->ops->hit(over_mesh, LANES, &x, 0, &a);
        over_closed->ops->hit(over_closed, LANES, &x, 0, &b);
        over_mesh->ops->occlude(over_mesh, LANES, &x, lit_a);
        over_closed->ops->occlude(over_closed, LANES, &x, lit_b);
        g_a.n = g_b.n = 0;
        for (int i = 0; i < LANES; i++) {
            differ += a.id[i] != b.id[i];
            dark += lit_b[i] == 0;
            darker += lit_a[i] != lit_b[i];
            if (a.id[i] < 0 || b.id[i] < 0)
                continue;
            met++;
            if (!(apart(lane_at(&x, i, a.t[i]), lane_at(&x, i, b.t[i])) <= within)) {
                far++; /* past a bump's edge */
                continue;
            }
            put_hit(&g_a, &x, i, a.t[i], a.part[i]);
            put_hit(&g_b, &x, i, b.t[i], b.part[i]);
        }
        displaced_shape(over_mesh, &g_a);
        displaced_shape(over_closed, &g_b);
        for (int k = 0; k < g_a.n; k++)
            if (!(apart(lane_get(&g_a.n_bump, k), lane_get(&g_b.n_bump, k)) < 20 * within + 0.02))
                far++;
    }
    print_message("%-6s %3d hits, %d beyond, %d missed by one, %d of %d shadows differ, %ld not sure\n", name, met, far,
                  differ, darker, dark, c.uncertain);
    CHECK(met, >, 150);
    CHECK(dark, >, 100);
    CHECK(far, <=, share * met);
    CHECK(differ, <=, share * met);
    CHECK(darker, <=, share * dark);
    surface_free(over_mesh);
    surface_free(over_closed);
    bump_free(P);
    surface_free(g);
    surface_free(&f->base);
}

static void displaced_plane(void **state)
{
    (void)state;
    surface *g = plane_new((vec3){-2, 0, -2}, (vec3){0, 0, 4}, (vec3){4, 0, 0}, true);
    /* the rectangle's (u,w) are 0..1 */
    mesh *f = mesh_of(floor_of, 6, 5);
    for (int k = 0; k < f->d.n; k++)
        for (int i = 0; i < 3; i++) {
            f->d.skin[k].uv[i][0] = f->d.skin[k].uv[i][0] / 4 + 0.5f;
            f->d.skin[k].uv[i][1] = f->d.skin[k].uv[i][1] / 4 + 0.5f;
        }
    f->u[0] = f->w[0] = 0;
    f->u[1] = f->w[1] = 1;
    /* a mesh has its (u,w) in float in either build, and P is 2 steep; the hits that float finds are 2e-6 off
     * (test_displace.c), in scenes as wide */
    displaced_as("plane", f, g, "sin(20*u)*cos(15*w)", 0.1, 1e-5, 0);
}

static void displaced_ball(void **state)
{
    (void)state;
    /* 200 x 100 cells: 4e-4 between chord and arc of twice 1.8 degrees at most, where rays graze more of it */
    displaced_as("ball", mesh_of(ball, 200, 100), sphere_new((vec3){0, 0, 0}, 1), "sin(w)^2*sin(9*u)*sin(8*w)", 0.06,
                 3e-3, 0.02);
}

#ifdef KAGE_DOUBLE
/* The mean logarithm of a method's error, against true displacement. */
static double error_of(mesh *f, double A, int order)
{
    static rays x;
    static hits h, rough;
    static partials q;
    static bump_values p;
    real u[LANES], w[LANES];
    double sum = 0;
    int n = 0;
    displaced_counts c = {0, 0};
    bump *P = bumped("sin(2*u + w) + 0.5*cos(3*w - u) + 0.3", A, f);
    surface *d = displace(&f->base, P, &c);
    for (int round = 0; round < 4; round++) {
        for (int i = 0; i < LANES; i++)
            random_ray(&x, i, 1);
        no_hits(&h, LANES);
        no_hits(&rough, LANES);
        f->base.ops->hit(&f->base, LANES, &x, 0, &h);
        d->ops->hit(d, LANES, &x, 0, &rough);
        f->base.ops->locate(&f->base, LANES, &x, h.t, h.part, u, w);
        f->base.ops->eval(&f->base, LANES, h.part, u, w, 2, &q);
        P->ops->eval(P, LANES, u, w, 3, &p);
        for (int i = 0; i < LANES; i++) {
            const bs_vec3 s = lane_get(&x.s, i), Qu = lane_get(&q.Qu, i), Qw = lane_get(&q.Qw, i),
                          N = bs_normal(Qu, Qw);
            const double speed = sqrt(bs_dot(s, s));
            if (h.id[i] < 0 || rough.id[i] < 0 || rough.part[i] != h.part[i])
                continue; /* over an edge the flat triangle's formulas do not go */
            const bs_view v = bs_view_of(s, N, Qu, Qw);
            if (fabs(v.sn) < 0.6 * speed)
                continue;
            const bs_bump b = {p.P[i], p.Pu[i], p.Pw[i], p.Puu[i], p.Puw[i], p.Pww[i]};
            const bs_slab all = {-HUGE_VAL, HUGE_VAL};
            const double bend = bs_curvature(v, N, lane_get(&q.Quu, i), lane_get(&q.Quw, i), lane_get(&q.Qww, i));
            sum += log(fabs(rough.t[i] - h.t[i] - bs_shift_of(order, 0, v, bend, b, all).tau) * speed + 1e-300);
            n++;
        }
    }
    surface_free(d);
    bump_free(P);
    CHECK(n, >, 60);
    return sum / n;
}

/* How the errors shrink with the amplitude: on a flat mesh as on a plane (test_slopes.c). Where normals are not the
 * triangles' own, the way to the height P is P (N.n)/(s.n), n the triangle's, and not P/(s.N): an error as the
 * amplitude, and as the angle between the two. */
static void error_slopes(void **state)
{
    (void)state;
    const int want[4] = {2, 3, 3, 4};
    mesh *f = mesh_of(floor_of, 3, 3);
    for (int order = 0; order < 4; order++) {
        const double slope = (error_of(f, 1e-2, order) - error_of(f, 1e-3, order)) / log(10);
        print_message("flat order %d: error as A^%.3f, expected A^%d\n", order, slope, want[order]);
        NEAR(slope, want[order], 0.25); /* other rays each time */
    }
    surface_free(&f->base);
    mesh *coarse = mesh_of(ball, 40, 20), *fine = mesh_of(ball, 160, 80);
    const double a = error_of(coarse, 1e-4, 3), times = (a - error_of(coarse, 1e-5, 3)) / log(10),
                 finer = (a - error_of(fine, 1e-4, 3)) / log(4);
    print_message("ball order 3: error as A^%.3f, and as the cells' size^%.3f\n", times, finer);
    NEAR(times, 1, 0.25);
    NEAR(finer, 1, 0.25);
    surface_free(&coarse->base);
    surface_free(&fine->base);
}
#endif

/* ---- data ---- */

static mesh_data one(const float at[3][3], int n)
{
    mesh_data d = {.n = n,
                   .at = memory_new(NULL, sizeof *d.at * (size_t)n),
                   .skin = memory_zeroed(NULL, (size_t)n * sizeof *d.skin)};
    assert_true(d.at && d.skin);
    for (int k = 0; k < n; k++)
        memcpy(d.at[k], at, sizeof d.at[k]);
    return d;
}

/* Textures without an area, and mirrored ones: all that is asked for is finite, n outward, and the place found again.
 */
static void odd_textures(void **state)
{
    (void)state;
    static const float odd[][3][2] = {
        {{0.5f, 0.5f}, {0.5f, 0.5f}, {0.5f, 0.5f}}, {{0, 0}, {0.5f, 0.5f}, {1, 1}}, {{0, 0}, {1, -1}, {1, -1}},
        {{0.2f, 0.7f}, {0.2f, 0.7f}, {0.9f, 0.1f}}, {{0, 0}, {0, 1}, {1, 0}},       {{0, 0}, {1, 0}, {0, 1}},
    };
    enum { N = sizeof odd / sizeof *odd };
    static const float at[3][3] = {{0, 0, 0}, {1, 0.1f, 0}, {0.2f, 1, 0}};
    mesh_data d = one(at, N);
    for (int k = 0; k < N; k++)
        memcpy(d.skin[k].uv, odd[k], sizeof odd[k]);
    mesh *f = mesh_from(d, MESH_NORMALS_FLAT, 0);
    assert_int_equal(f->d.notes.spread, 4);
    assert_int_equal(f->d.notes.folded, 1);
    for (int k = 0; k < N; k++) {
        static rays x;
        static partials q;
        const int32_t part = k;
        int32_t told = k;
        const real t = 1;
        real u, w;
        lane_set(&x.r, 0, (bs_vec3){R(0.4), R(0.3), -1});
        lane_set(&x.s, 0, (bs_vec3){0, 0, 1});
        f->base.ops->locate(&f->base, 1, &x, &t, &told, &u, &w);
        assert_int_equal(told, k);
        f->base.ops->eval(&f->base, 1, &part, &u, &w, 2, &q);
        CHECK(apart(lane_get(&q.Q, 0), lane_at(&x, 0, 1)), <, 1e-3); /* float's digits of u in 1/4096 */
        const bs_vec3 n = bs_normal(lane_get(&q.Qu, 0), lane_get(&q.Qw, 0));
        assert_true(n.z > 0 && bs_regular(n, lane_get(&q.Qu, 0), lane_get(&q.Qw, 0)));
    }
    surface_free(&f->base);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hits_as_by_brute_force),
        cmocka_unit_test(no_ray_passes_between),
        cmocka_unit_test(partials_are_those_of_the_triangle),
        cmocka_unit_test(the_way_past),
        cmocka_unit_test(own_shadows),
        cmocka_unit_test(images),
        cmocka_unit_test(displaced_plane),
        cmocka_unit_test(displaced_ball),
        cmocka_unit_test(odd_textures),
#ifdef KAGE_DOUBLE
        cmocka_unit_test(error_slopes),
#endif
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
