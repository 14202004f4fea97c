/* Patch surfaces: partials against golden vectors, hits against closed forms and against
 * brute force, seams, silhouettes, corners and degenerate edges, shadows on themselves.
 */
#include <stdlib.h>
#include <string.h>

#include "displaced/form.h"
#include "support/golden_json.h"
#include "support/bump_of_map.h"
#include "wave/lane.h"
#include "displaced/offset.h"
#include "patch/patch_file.h"
#include "support/odd_rays.h"
#include "support/properties.h"
#include "support/displace.h"
#include "support/random_rays.h"
#include "patch/surface.h"
#include "geometry/surface.h"

static patch *function(const char *x, const char *y, const char *z, double u0, double u1, double w0, double w1)
{
    expr_error wrong;
    expr *e[3] = {expr_parse(x, &wrong), expr_parse(y, &wrong), expr_parse(z, &wrong)};
    assert_true(e[0] && e[1] && e[2]);
    return patch_function_new("parametric", e, (double[2]){u0, u1}, (double[2]){w0, w1});
}

static const double pi = 3.14159265358979323846;

static surface *moebius(void)
{
    return patch_surface_new(
        function("(1.2 + w*cos(u/2))*cos(u)", "w*sin(u/2)", "(1.2 + w*cos(u/2))*sin(u)", 0, 2 * pi, -0.4, 0.4), NULL);
}

static surface *klein(void)
{
    return patch_surface_new(function("(1 + 0.5*cos(u/2)*sin(w) - 0.5*sin(u/2)*sin(2*w))*cos(u)",
                                      "0.7*(sin(u/2)*sin(w) + cos(u/2)*sin(2*w))",
                                      "(1 + 0.5*cos(u/2)*sin(w) - 0.5*sin(u/2)*sin(2*w))*sin(u)", 0, 2 * pi, 0, 2 * pi),
                             NULL);
}

/* A patch with an edge across it. */
static surface *roof(void)
{
    return patch_surface_new(function("u", "0.3*abs(u - 0.1) + 0.2*sin(3*w)", "w", -1, 1, -1.1, 1.1), NULL);
}

static surface *ball(void)
{
    return patch_surface_new(
        function("0.3 + 1.2*sin(w)*cos(u)", "1.2*cos(w) - 0.2", "0.1 + 1.2*sin(w)*sin(u)", -pi, pi, 0, pi), NULL);
}

static surface *ring(void)
{
    return patch_surface_new(function("0.1 + (0.9 + 0.4*cos(w))*cos(u)", "-0.1 - 0.4*sin(w)",
                                      "0.2 + (0.9 + 0.4*cos(w))*sin(u)", -pi, pi, -pi, pi),
                             NULL);
}

static surface *teapot(void)
{
    errors e = {0};
    int n;
    vec3 *p =
        patch_file_read(KAGE_TESTS_DIR "/../scenes/data/teapot.txt", "teapot.txt", 1e6, (cap){PATCHES_MAX, ""}, &n, &e);
    assert_non_null(p);
    assert_int_equal(n, 32);
    for (int k = 0; k < 16 * n; k++)
        p[k] = vec3_scale(vec3_sub(p[k], (vec3){0.2, 1.5, 0}), 0.4);
    patch *q = patch_bezier_new(n, p);
    free(p);
    return patch_surface_new(q, NULL);
}

enum { MOEBIUS, KLEIN, ROOF, BALL, RING, TEAPOT, KINDS };
static surface *(*const make[KINDS])(void) = {moebius, klein, roof, ball, ring, teapot};
/* Made once, for all tests. */
static surface *made[KINDS];
static surface *surface_of(int kind)
{
    if (!made[kind])
        made[kind] = make[kind]();
    assert_non_null(made[kind]);
    return made[kind];
}

static int free_all(void **state)
{
    (void)state;
    for (int kind = 0; kind < KINDS; kind++)
        surface_free(made[kind]);
    return 0;
}

static const char *const names[KINDS] = {"moebius", "klein", "roof", "ball", "ring", "teapot"};

static double distance(bs_vec3 a, bs_vec3 b)
{
    double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y, z = (double)a.z - (double)b.z;
    return sqrt(x * x + y * y + z * z);
}

/* ---- partials ---- */

static void check_rows(const patch *q, struct fy_node *rows, double *worst, int *seen)
{
    for (int r = 0; r < fy_node_sequence_item_count(rows); r++) {
        struct fy_node *row = fy_node_sequence_get_by_index(rows, r);
        double want[20];
        for (int k = 0; k < 20; k++)
            assert_true(golden_number(fy_node_sequence_get_by_index(row, k), &want[k]));
        const int32_t part = 0;
        patch_jets j;
        q->ops->eval(q, 1, &part, &want[0], &want[1], 2, &j);
        for (int k = 0; k < 18; k++) {
            const expr_jets *a = &j.axis[k % 3];
            const double got[] = {a->v[0], a->u[0], a->w[0], a->uu[0], a->uw[0], a->ww[0]};
            const double off = fabs(got[k / 3] - want[2 + k]) / (1 + fabs(want[2 + k]));
            *worst = fmax(*worst, off);
            CHECK(off, <, 2e-14);
        }
        /* and what is bounded holds it, over a box about the place */
        patch_bounds b;
        patch_hessians c;
        const double u[2] = {want[0] - 0.01, want[0] + 0.03}, w[2] = {want[1] - 0.02, want[1] + 0.01};
        q->ops->bound(q, 0, u, w, &b, &c);
        for (int k = 0; k < 9; k++) {
            const expr_bounds *a = &b.axis[k % 3];
            const double *range = k < 3 ? a->v : k < 6 ? a->u : a->w;
            BETWEEN(range[0], want[2 + k], range[1]);
            CHECK(range[1] - range[0], <, 3);
        }
        for (int k = 0; k < 9; k++) {
            const expr_hessians *a = &c.axis[k % 3];
            const double *range = k < 3 ? a->uu : k < 6 ? a->uw : a->ww;
            const double zero = 1e-48; /* what 50 digits leave of 0 */
            CHECK(range[0], <=, want[11 + k] + zero);
            CHECK(want[11 + k], <=, range[1] + zero);
            CHECK(range[1] - range[0], <, 20);
        }
        ++*seen;
    }
}

static void golden_partials(void **state)
{
    (void)state;
    struct fy_document *doc = golden_open(KAGE_TESTS_DIR "/golden/sheet.json");
    struct fy_node *functions = golden_get(fy_document_root(doc), "functions"),
                   *patches = golden_get(fy_document_root(doc), "patches");
    double worst = 0;
    int seen = 0;
    for (int k = 0; k < fy_node_sequence_item_count(functions); k++) {
        struct fy_node *one = fy_node_sequence_get_by_index(functions, k), *xyz = golden_get(one, "xyz");
        const char *text[3];
        for (int a = 0; a < 3; a++)
            text[a] = fy_node_get_scalar0(fy_node_sequence_get_by_index(xyz, a));
        patch *q = function(text[0], text[1], text[2], -10, 10, -10, 10);
        check_rows(q, golden_get(one, "rows"), &worst, &seen);
        q->ops->free(q);
    }
    for (int k = 0; k < fy_node_sequence_item_count(patches); k++) {
        struct fy_node *one = fy_node_sequence_get_by_index(patches, k), *points = golden_get(one, "points");
        vec3 p[16];
        for (int i = 0; i < 16; i++) {
            struct fy_node *at = fy_node_sequence_get_by_index(points, i);
            assert_true(golden_number(fy_node_sequence_get_by_index(at, 0), &p[i].x) &&
                        golden_number(fy_node_sequence_get_by_index(at, 1), &p[i].y) &&
                        golden_number(fy_node_sequence_get_by_index(at, 2), &p[i].z));
        }
        patch *q = patch_bezier_new(1, p);
        check_rows(q, golden_get(one, "rows"), &worst, &seen);
        q->ops->free(q);
    }
    fy_document_destroy(doc);
    print_message("%d golden places, worst error %.2g of the scale\n", seen, worst);
    assert_int_equal(seen, 36 + 45);
}

/* ---- hits ---- */

static void hits_are_on_the_surface(void **state)
{
    const int kind = *(const int *)*state;
    surface *f = surface_of(kind);
    int met = 0;
    double worst = 0;
    assert_non_null(f);
    for (int round = 0; round < 8; round++) {
        static rays x;
        static hits h;
        static partials q;
        int32_t part[LANES];
        real u[LANES], w[LANES];
        for (int i = 0; i < LANES; i++)
            random_ray(&x, i, 1.3);
        no_hits(&h, LANES);
        f->ops->hit(f, LANES, &x, 3, &h);
        f->ops->locate(f, LANES, &x, h.t, part, u, w);
        f->ops->eval(f, LANES, part, u, w, 2, &q);
        for (int i = 0; i < LANES; i++) {
            if (h.id[i] < 0)
                continue;
            double U[2], W[2];
            f->ops->extent(f, part[i], U, W);
            BETWEEN(U[0] - 1e-6, u[i], U[1] + 1e-6);
            BETWEEN(W[0] - 1e-6, w[i], W[1] + 1e-6);
            met++;
            const double far = 1 + distance(lane_at(&x, i, 0), lane_at(&x, i, h.t[i]));
            worst = fmax(worst, distance(lane_get(&q.Q, i), lane_at(&x, i, h.t[i])) / (EPS * far));
        }
    }
    CHECK(met, >, 150);
    CHECK(worst, <, 12);
}

/* The sphere and the torus that have closed forms: the same hits, the same shadows, rays from within and such that
 * graze. */
static void as_closed_forms(void **state)
{
    const int kind = *(const int *)*state;
    surface *f = surface_of(kind);
    surface *g = kind == BALL ? sphere_new((vec3){0.3, -0.2, 0.1}, 1.2)
                              : torus_new((vec3){0.1, -0.1, 0.2}, (vec3){0, 1, 0}, 0.9, 0.4);
    int differ = 0, met = 0;
    for (int round = 0; round < 30; round++) {
        static rays x;
        static hits a, b;
        static partials q;
        int32_t part[LANES];
        real lit_a[LANES], lit_b[LANES], u[LANES], w[LANES];
        for (int i = 0; i < LANES; i++) {
            random_ray(&x, i, 1.3);
            if (round % 3 == 1) { /* from inside, or from between */
                x.r.x[i] *= R(0.2), x.r.y[i] *= R(0.05), x.r.z[i] *= R(0.2);
            }
            lit_a[i] = lit_b[i] = 1;
        }
        no_hits(&a, LANES);
        no_hits(&b, LANES);
        f->ops->hit(f, LANES, &x, 0, &a);
        g->ops->hit(g, LANES, &x, 0, &b);
        f->ops->occlude(f, LANES, &x, lit_a);
        g->ops->occlude(g, LANES, &x, lit_b);
        for (int i = 0; i < LANES; i++) {
            differ += a.id[i] != b.id[i] || lit_a[i] != lit_b[i];
            if (a.id[i] < 0 || b.id[i] < 0)
                continue;
            met++;
            const double off = distance(lane_at(&x, i, a.t[i]), lane_at(&x, i, b.t[i]));
            g->ops->locate(g, 1,
                           &(rays){.r = {.x = {x.r.x[i]}, .y = {x.r.y[i]}, .z = {x.r.z[i]}},
                                   .s = {.x = {x.s.x[i]}, .y = {x.s.y[i]}, .z = {x.s.z[i]}}},
                           &b.t[i], part, u, w);
            g->ops->eval(g, 1, part, u, w, 1, &q);
            const bs_vec3 n = lane_unit(bs_normal(lane_get(&q.Qu, 0), lane_get(&q.Qw, 0))),
                          s = lane_unit(lane_get(&x.s, i));
            const double sine = fabs((double)bs_dot(n, s));
            if (!(off <= 40 * EPS / fmax(sine, sqrt(EPS))))
                fail_msg("%s: %g apart, sine %g", names[kind], off, sine);
        }
    }
    CHECK(met, >, 800);
    CHECK(differ, <=, 2);
    surface_free(g);
}

/* From the surface itself, on both sides and however flat: what the closed form says. */
static void own_shadows(void **state)
{
    const int kind = *(const int *)*state;
    surface *f = surface_of(kind);
    surface *g = kind == BALL ? sphere_new((vec3){0.3, -0.2, 0.1}, 1.2)
                              : torus_new((vec3){0.1, -0.1, 0.2}, (vec3){0, 1, 0}, 0.9, 0.4);
    int differ = 0, dark = 0, n_all = 0;
    for (int round = 0; round < 20; round++) {
        static rays x, out;
        static hits h;
        static partials q;
        int32_t part[LANES];
        real u[LANES], w[LANES], a[LANES], b[LANES];
        for (int i = 0; i < LANES; i++)
            random_ray(&x, i, 1.3);
        no_hits(&h, LANES);
        g->ops->hit(g, LANES, &x, 0, &h);
        int n = 0;
        for (int i = 0; i < LANES; i++)
            if (h.id[i] >= 0)
                lane_set(&out.r, n++, lane_at(&x, i, h.t[i]));
        memset(part, 0, sizeof part);
        vec3s_fill(&out.s, n, 0, 0, 0);
        static real zero[LANES];
        f->ops->locate(f, n, &out, zero, part, u, w);
        f->ops->eval(f, n, part, u, w, 1, &q);
        for (int i = 0; i < n; i++) {
            bs_vec3 d = {(real)random_in(-3, 3), (real)random_in(-3, 3), (real)random_in(-3, 3)};
            const bs_vec3 N = lane_unit(bs_normal(lane_get(&q.Qu, i), lane_get(&q.Qw, i)));
            if (round % 2) { /* 1e-2 to either side of the tangent plane */
                const real c = bs_dot(d, N) - (i % 2 ? R(1e-2) : R(-1e-2));
                d.x -= c * N.x, d.y -= c * N.y, d.z -= c * N.z;
            }
            lane_set(&out.s, i, d);
            a[i] = b[i] = 1;
        }
        f->ops->occlude_own(f, n, &out, part, a);
        g->ops->occlude_own(g, n, &out, part, b);
        for (int i = 0; i < n; i++) {
            differ += a[i] != b[i];
            dark += b[i] == 0;
        }
        n_all += n;
    }
    print_message("%s: own shadows differ at %d of %d places\n", names[kind], differ, n_all);
    CHECK(dark, >, 200);
    CHECK(differ, <=, n_all / 500);
    surface_free(g);
}

/* Against two triangles for each cell of a fine grid. */
static double brute(const vec3 *v, int n, int parts, vec3 r, vec3 s)
{
    double best = HUGE_VAL;
    for (int p = 0; p < parts; p++)
        for (int j = 0; j < n; j++)
            for (int i = 0; i < n; i++) {
                const vec3 *a = v + (p * (n + 1) + j) * (n + 1) + i;
                for (int k = 0; k < 2; k++) {
                    const vec3 A = a[0], B = vec3_sub(k ? a[n + 2] : a[1], A), C = vec3_sub(k ? a[n + 1] : a[n + 2], A);
                    const vec3 o = vec3_sub(r, A), Cs = vec3_cross(C, s), sB = vec3_cross(s, B);
                    const double det = vec3_dot(B, Cs), x = vec3_dot(o, Cs) / det, y = vec3_dot(o, sB) / det;
                    const double t = -vec3_dot(o, vec3_cross(B, C)) / det;
                    if (x >= 0 && y >= 0 && x + y <= 1 && t > 0 && t < best)
                        best = t;
                }
            }
    return best;
}

static void brute_force(void **state)
{
    const int kind = *(const int *)*state;
    surface *f = surface_of(kind);
    const int parts = f->ops->parts, n = parts > 1 ? 40 : 220;
    vec3 *v = malloc(sizeof *v * (size_t)(parts * (n + 1) * (n + 1)));
    assert_non_null(v);
    for (int p = 0; p < parts; p++) {
        double U[2], W[2];
        f->ops->extent(f, p, U, W);
        for (int j = 0; j <= n; j++)
            for (int i = 0; i <= n; i++) {
                static partials q;
                const int32_t part = p;
                const real u = (real)(U[0] + (U[1] - U[0]) * i / n), w = (real)(W[0] + (W[1] - W[0]) * j / n);
                f->ops->eval(f, 1, &part, &u, &w, 1, &q);
                v[(p * (n + 1) + j) * (n + 1) + i] = (vec3){(double)q.Q.x[0], (double)q.Q.y[0], (double)q.Q.z[0]};
            }
    }
    static rays x;
    static hits h;
    int off = 0, met = 0;
    for (int i = 0; i < LANES; i++)
        random_ray(&x, i, 1.3);
    no_hits(&h, LANES);
    f->ops->hit(f, LANES, &x, 0, &h);
    for (int i = 0; i < LANES; i++) {
        const vec3 r = {(double)x.r.x[i], (double)x.r.y[i], (double)x.r.z[i]},
                   s = {(double)x.s.x[i], (double)x.s.y[i], (double)x.s.z[i]};
        const double t = brute(v, n, parts, r, s);
        met += t < HUGE_VAL;
        off += (t < HUGE_VAL) != (h.id[i] >= 0) || (t < HUGE_VAL && fabs(t - (double)h.t[i]) * vec3_length(s) > 0.01);
    }
    print_message("%-8s %3d hits of 128, %d unlike the facets\n", names[kind], met, off);
    CHECK(met, >, 15);
    CHECK(off, <=, 3); /* at silhouettes facets are off by their chords */
    free(v);
}

/* Rays through seams, poles, corners of patches and where patches join: none slips through. */
static void no_cracks(void **state)
{
    const int kind = *(const int *)*state;
    surface *f = surface_of(kind);
    int lost = 0, all = 0;
    for (int round = 0; round < 24; round++) {
        static rays x;
        static hits h;
        static partials q;
        int32_t part[LANES];
        real u[LANES], w[LANES];
        for (int i = 0; i < LANES; i++) {
            double U[2], W[2];
            part[i] = (i + round) % f->ops->parts;
            f->ops->extent(f, part[i], U, W);
            /* on an edge that something joins: the seam of u where u closes, any of a closed surface's or of a
             * patch */
            const bool edge_u = kind == MOEBIUS || kind == KLEIN || i % 2;
            double a = edge_u ? (i % 4 < 2 ? 0 : 1) : random_in(0, 1),
                   b = edge_u ? random_in(0.02, 0.98) : (i % 4 < 2 ? 0 : 1);
            if (kind == ROOF) /* on the edge, and on the middle, where leaves join */
                a = i % 2 ? 0.55 : 0.5, b = random_in(0.02, 0.98);
            if (round % 8 == 0 && kind != ROOF && kind != MOEBIUS)
                a = i % 2, b = i / 2 % 2; /* corners */
            u[i] = (real)(U[0] + a * (U[1] - U[0]));
            w[i] = (real)(W[0] + b * (W[1] - W[0]));
        }
        f->ops->eval(f, LANES, part, u, w, 1, &q);
        for (int i = 0; i < LANES; i++) {
            random_ray(&x, i, 1.3);
            const bs_vec3 n = lane_unit(bs_normal(lane_get(&q.Qu, i), lane_get(&q.Qw, i))), Q = lane_get(&q.Q, i);
            CHECK(bs_dot(n, n), >, R(0.9)); /* none is NaN, not even where Qu is 0 */
            /* from 0.05 above, up to 0.2 aside, straight to the place and on by as much */
            const double aside = kind == ROOF ? 0.01 : 0.1; /* flatter than the roof a ray passes under its edge */
            const bs_vec3 d = {n.x * R(0.05) + (real)random_in(-aside, aside),
                               n.y * R(0.05) + (real)random_in(-aside, aside),
                               n.z * R(0.05) + (real)random_in(-aside, aside)};
            const bs_vec3 r = {Q.x + d.x, Q.y + d.y, Q.z + d.z}, s = {-2 * d.x, -2 * d.y, -2 * d.z};
            lane_set(&x.r, i, r);
            lane_set(&x.s, i, s);
            x.s.x[i] *= fabs((double)bs_dot(n, d)) < 0.02 ? 0 : 1; /* too flat to say */
            if (x.s.x[i] == 0)
                lane_set(&x.s, i, (bs_vec3){-n.x, -n.y, -n.z}),
                    lane_set(&x.r, i, (bs_vec3){Q.x + R(0.05) * n.x, Q.y + R(0.05) * n.y, Q.z + R(0.05) * n.z});
        }
        no_hits(&h, LANES);
        f->ops->hit(f, LANES, &x, 0, &h);
        for (int i = 0; i < LANES; i++) {
            all++;
            lost += h.id[i] < 0;
        }
    }
    /* the teapot is open at the spout's end and where the handle ends in the body */
    print_message("%-8s %d of %d rays at joins lost\n", names[kind], lost, all);
    assert_true(kind == TEAPOT ? lost < all / 8 : lost == 0);
}

/* Where a side has no length n is that of the limit, and bs_regular says so. */
static void degenerate_edges(void **state)
{
    (void)state;
    static partials q;
    surface *f = surface_of(BALL);
    for (int i = 0; i < 12; i++) {
        const int32_t part = 0;
        const real u = (real)random_in(-3, 3), w = (real)(i % 2 ? pi : 0);
        f->ops->eval(f, 1, &part, &u, &w, 2, &q);
        const bs_vec3 Qu = lane_get(&q.Qu, 0), Qw = lane_get(&q.Qw, 0), N = bs_normal(Qu, Qw), n = lane_unit(N);
        CHECK(fabs((double)n.y - (i % 2 ? -1 : 1)), <, 1e-5);
        assert_false(bs_regular(N, Qu, Qw));
    }
    /* the middle of the teapot's lid and of its bottom: the first rows of patches 12 to 15, 20 to 23 */
    f = surface_of(TEAPOT);
    for (int i = 0; i < 8; i++) {
        const int32_t part = i < 4 ? 12 + i : 16 + i;
        const real u = R(0.3), w = 0;
        f->ops->eval(f, 1, &part, &u, &w, 2, &q);
        const bs_vec3 n = lane_unit(bs_normal(lane_get(&q.Qu, 0), lane_get(&q.Qw, 0)));
        if (!(fabs((double)n.y - (i < 4 ? 1 : -1)) < 1e-4))
            fail_msg("patch %d: n is %g %g %g", part, (double)n.x, (double)n.y, (double)n.z);
    }
}

static void odd_rays(void **state)
{
    const double nan = (double)NAN, inf = (double)INFINITY;
    const double odd[][6] = {
        {0, 0, 0, 0, 0, 0},          {nan, 0, 0, 1, 0, 0},
        {0, 0, 0, nan, nan, nan},    {0, 5, 0, 0, -inf, 0},
        {inf, 0, 0, -1, 0, 0},       {0.3, 5, 0.1, 0, -1, 0},
        {0.3, -5, 0.1, 0, 1, 0},     {1e30, 1e30, 1e30, -1, -1, -1},
        {0, 0, 0, 1e30, 1e30, 1e30}, {0, 0, 0, 1e-30, 1e-30, 0},
        {0.1, 5, 0.2, 0, -1e-20, 0}, {0.1, 5, 0.2, 0, -1, 0},
        {1.5, -0.2, 0.1, 0, 1, 0},   {-5, 0, 0, 1, 0, 0},
        {0, 0, -5, 0, 0, 1},         {0.04, 5, 0, 0, -1, 0},
    };
    surface *f = surface_of(*(const int *)*state);
    check_odd_rays(f, sizeof odd / sizeof *odd, odd);
}

/* A hit does not know what other rays were in the wave, nor how many. */
static void each_ray_by_itself(void **state)
{
    const int kind = *(const int *)*state;
    surface *f = surface_of(kind);
    static rays x, one;
    static hits h, alone;
    for (int i = 0; i < LANES; i++)
        random_ray(&x, i, 1.3);
    no_hits(&h, LANES);
    f->ops->hit(f, LANES, &x, 0, &h);
    for (int i = LANES - 1; i >= 0; i--) {
        lane_set(&one.r, 0, lane_get(&x.r, i));
        lane_set(&one.s, 0, lane_get(&x.s, i));
        no_hits(&alone, 1);
        f->ops->hit(f, 1, &one, 0, &alone);
        assert_memory_equal(&alone.t[0], &h.t[i], sizeof h.t[i]);
    }
}

/* ---- true displacement ---- */

static bump *bumps(double A, const double u[2], const double w[2])
{
    expr_error wrong;
    return bump_function_new(expr_parse("sin(2*u+w) + cos(3*w-u)/2 + 0.3", &wrong), A, u, w);
}

/* What it says of a rough surface over a box holds at all its places, and is close where n does not turn at once; its
 * partials are how it changes. */
static void check_rough(const patch *q, const bump *P, int *boxes, int *close)
{
    enum { STEP = 3 }; /* a place, and one a little farther along u and along w */
    patch *x = patch_offset_new(q, P);
    assert_non_null(x);
    for (int k = 0; k < 300; k++) {
        const double size = k % 3 ? 0.003 : 0.03, h = 1e-6, ru = size * (q->u[1] - q->u[0]),
                     rw = size * (q->w[1] - q->w[0]);
        const double u0 = random_in(q->u[0], q->u[1] - ru), w0 = random_in(q->w[0], q->w[1] - rw), u[2] = {u0, u0 + ru},
                     w[2] = {w0, w0 + rw};
        const int32_t part = (int32_t)random_in(0, q->parts - 1e-9), parts[STEP] = {part, part, part};
        patch_bounds b;
        x->ops->bound(x, part, u, w, &b, NULL);
        *boxes += 1;
        *close += b.axis[0].u[1] - b.axis[0].u[0] < HUGE_VAL;
        for (int i = 0; i < 20; i++) {
            const double a = random_in(u[0], u[1]), c = random_in(w[0], w[1]), U[STEP] = {a, a + h * ru, a},
                         W[STEP] = {c, c, c + h * rw};
            patch_jets j;
            x->ops->eval(x, STEP, parts, U, W, 1, &j);
            for (int axis = 0; axis < 3; axis++) {
                const expr_jets *z = &j.axis[axis];
                const expr_bounds *in = &b.axis[axis];
                BETWEEN(in->v[0], z->v[0], in->v[1]);
                CHECK(in->u[0], <=, z->u[0]);
                CHECK(z->u[0], <=, in->u[1]);
                CHECK(in->w[0], <=, z->w[0]);
                CHECK(z->w[0], <=, in->w[1]);
                /* the step is of second order in h, and its roundings count by 1/h; at poles partials are steep */
                const double du = (z->v[1] - z->v[0]) / (h * ru), dw = (z->v[2] - z->v[0]) / (h * rw);
                const double most = 1 + fabs(z->u[0]) + fabs(z->w[0]), off = 1e-3 * most + 1e-14 / (h * fmin(ru, rw));
                assert_true(in->u[1] - in->u[0] > 1 || (fabs(du - z->u[0]) < off && fabs(dw - z->w[0]) < off));
            }
        }
    }
    x->ops->free(x);
}

static void rough_bounds(void **state)
{
    (void)state;
    static float samples[12] = {0, 0.3f, 0.1f, 0.5f, 0.2f, 0.7f, 0.4f, 0.1f, 0.9f, 0.2f, 0.6f, 0.3f};
    const image map = {4, 3, samples};
    patch *q[] = {
        function("(1.2 + w*cos(u/2))*cos(u)", "w*sin(u/2)", "(1.2 + w*cos(u/2))*sin(u)", 0, 2 * pi, -0.4, 0.4),
        function("u", "0.3*abs(u - 0.1) + 0.2*sin(3*w)", "w", -1, 1, -1.1, 1.1),
        function("sin(w)*cos(u)", "cos(w)", "sin(w)*sin(u)", -pi, pi, 0, pi),
    };
    for (int k = 0; k < 3; k++) {
        const affine mirror = {{-1, 0.2, 0}, {0, 1.5, 0}, {0.3, 0, 1}, {1, 2, 3}};
        patch *moved = patch_affine_new(q[k], &mirror);
        expr_error wrong;
        bump *P[] = {
            bumps(0.04, q[k]->u, q[k]->w),
            bump_function_new(expr_parse("noise(7*u,5*w)", &wrong), 0.05, q[k]->u, q[k]->w),
            bump_of_map(&map, &(map_layout){{1.3, 0.7}, {0.1, 0}, MAP_REPEAT, false, 0.05, 0.2, 0}),
            bump_of_map(&map, &(map_layout){{1.3, 0.7}, {0.1, 0}, MAP_CLAMP, true, 0.05, 0.2, 0}),
        };
        int boxes = 0, close = 0;
        for (int i = 0; i < 4; i++) {
            check_rough(q[k], P[i], &boxes, &close);
            check_rough(moved, P[i], &boxes, &close);
            bump_free(P[i]);
        }
        print_message("%d boxes, %d with bounds of slopes\n", boxes, close);
        CHECK(close, >, 0.85 * boxes);
        moved->ops->free(moved);
        q[k]->ops->free(q[k]);
    }
}

/* The displaced torus is that which has closed forms for its feet; so are its shadows. */
static void displaced_as_closed_forms(void **state)
{
    (void)state;
    surface *f = surface_of(RING), *g = torus_new((vec3){0.1, -0.1, 0.2}, (vec3){0, 1, 0}, 0.9, 0.4);
    double U[2], W[2];
    displaced_counts c = {0};
    int differ = 0, met = 0;
    f->ops->extent(f, 0, U, W);
    bump *P = bumps(0.04, U, W);
    surface *over_patch = displace(f, P, &c), *over_closed = displace(g, P, &c);
    for (int round = 0; round < 6; round++) {
        static rays x;
        static hits a, b;
        real lit_a[LANES], lit_b[LANES];
        for (int i = 0; i < LANES; i++) {
            random_ray(&x, i, 1.3);
            if (round % 3 == 1)
                x.r.x[i] *= R(0.2), x.r.y[i] *= R(0.02), x.r.z[i] *= R(0.2);
            lit_a[i] = lit_b[i] = 1;
        }
        no_hits(&a, LANES);
        no_hits(&b, LANES);
        over_patch->ops->hit(over_patch, LANES, &x, 0, &a);
        over_closed->ops->hit(over_closed, LANES, &x, 0, &b);
        over_patch->ops->occlude(over_patch, LANES, &x, lit_a);
        over_closed->ops->occlude(over_closed, LANES, &x, lit_b);
        for (int i = 0; i < LANES; i++) {
            const double off = distance(lane_at(&x, i, a.t[i]), lane_at(&x, i, b.t[i]));
            differ += a.id[i] != b.id[i] || lit_a[i] != lit_b[i] || (a.id[i] >= 0 && off > sqrt(EPS));
            met += a.id[i] >= 0;
        }
    }
    print_message("displaced: %d hits, %d unlike the closed form's, %ld uncertain\n", met, differ, c.uncertain);
    CHECK(met, >, 300);
    CHECK(differ, <=, 1);
    CHECK(c.uncertain, <=, 1);
    surface_free(over_patch);
    surface_free(over_closed);
    bump_free(P);
    surface_free(g);
}

static bs_vec3 times(bs_vec3 v, real k) { return (bs_vec3){k * v.x, k * v.y, k * v.z}; }

/* In other units the rough surface has the same normals, and its partials are in these units. */
static void displaced_at_any_scale(void **state)
{
    (void)state;
    const bs_vec3 Qu = {R(1.1), R(0.2), R(-0.3)}, Qw = {R(-0.1), R(0.4), R(1.3)}, Quu = {R(0.2), R(-0.5), R(0.1)};
    const bs_vec3 Quw = {R(0.3), R(0.1), R(-0.2)}, Qww = {R(-0.1), R(0.6), R(0.2)};
    const real h = R(0.05), Pu = R(0.3), Pw = R(-0.4);
    const real scales[] = {R(1e-12), R(1e-3), 800, R(2e3), R(1e4), R(1e6), R(1e12)};
    const offset one = offset_of(Qu, Qw, Quu, Quw, Qww, h);
    const bs_vec3 normal = offset_normal(one, Pu, Pw);
    NEAR((double)bs_dot(one.n, one.n), 1, 4 * EPS);
    for (int i = 0; i < (int)(sizeof scales / sizeof *scales); i++) {
        const real k = scales[i];
        const offset o = offset_of(times(Qu, k), times(Qw, k), times(Quu, k), times(Quw, k), times(Qww, k), k * h);
        CHECK(distance(o.n, one.n), <, 8 * EPS);
        CHECK(distance(times(o.U, 1 / k), one.U), <, 8 * EPS);
        CHECK(distance(times(o.W, 1 / k), one.W), <, 8 * EPS);
        CHECK(distance(offset_normal(o, k * Pu, k * Pw), normal), <, 8 * EPS);
    }
}

static surface *saddle(double k)
{
    vec3 p[16];
    for (int i = 0; i < 16; i++)
        p[i] = vec3_scale((vec3){0.8 * (i % 4) - 1.2, 0.5 * (i % 3 == 0), 0.8 * (i / 4) - 1.2}, k);
    return patch_surface_new(patch_bezier_new(1, p), NULL);
}

/* How the height, u and w change in space: u and w by one over the scale. */
static void feet_at_any_scale(void **state)
{
    (void)state;
    const double U[2] = {0, 1}, W[2] = {0, 1}, scales[] = {1, 1e-3, 1e3, 1e4};
    static closest_points one, p;
    static rays x;
    static real t[LANES];
    int32_t part[LANES] = {0};
    for (int k = 0; k < 4; k++) {
        const double size = scales[k];
        const real c = (real)size;
        surface *f = saddle(size);
        bump *P = bumps(0.03 * size, U, W);
        surface *d = displace(f, P, NULL);
        partials q;
        bump_values h;
        for (int i = 0; i < LANES; i++) {
            p.u[i] = R(0.1) + R(0.8) * (real)(i % 8) / 8;
            p.w[i] = R(0.1) + R(0.8) * (real)(i / 8 % 8) / 8;
            t[i] = 0;
        }
        f->ops->eval(f, LANES, part, p.u, p.w, 1, &q);
        P->ops->eval(P, LANES, p.u, p.w, 1, &h);
        for (int i = 0; i < LANES; i++) {
            const bs_vec3 n = lane_unit(bs_normal(lane_get(&q.Qu, i), lane_get(&q.Qw, i))), Q = lane_get(&q.Q, i);
            lane_set(&x.r, i, (bs_vec3){Q.x + h.P[i] * n.x, Q.y + h.P[i] * n.y, Q.z + h.P[i] * n.z});
            lane_set(&x.s, i, n);
        }
        ((displaced *)d)->form->closest((displaced *)d, LANES, &x, t, part, &p);
        one = k ? one : p;
        for (int i = 0; i < LANES; i++) {
            NEAR(p.h[i], h.P[i], 20 * EPS * size);
            CHECK(distance(lane_get(&p.gh, i), lane_get(&one.gh, i)), <, 100 * EPS);
            CHECK(distance(times(lane_get(&p.gu, i), c), lane_get(&one.gu, i)), <, 100 * EPS);
            CHECK(distance(times(lane_get(&p.gw, i), c), lane_get(&one.gw, i)), <, 100 * EPS);
        }
        surface_free(d);
        bump_free(P);
        surface_free(f);
    }
}

#ifdef KAGE_DOUBLE
/* How the orders' errors shrink with the amplitude: as on a sphere (test_slopes.c). */
static double error_of(surface *f, double A, int order, const rays *x, const hits *h, const partials *q, const real *u,
                       const real *w)
{
    double U[2], W[2], worst = 0;
    displaced_counts c = {0};
    static hits rough;
    static bump_values p;
    f->ops->extent(f, 0, U, W);
    bump *P = bumps(A, U, W);
    surface *d = displace(f, P, &c);
    P->ops->eval(P, LANES, u, w, 3, &p);
    no_hits(&rough, LANES);
    d->ops->hit(d, LANES, x, 0, &rough);
    int n = 0;
    for (int i = 0; i < LANES; i++) {
        if (h->id[i] < 0 || rough.id[i] < 0)
            continue;
        const bs_vec3 Qu = lane_get(&q->Qu, i), Qw = lane_get(&q->Qw, i), N = bs_normal(Qu, Qw);
        const bs_view v = bs_view_of(lane_get(&x->s, i), N, Qu, Qw);
        const double speed = sqrt(bs_dot(lane_get(&x->s, i), lane_get(&x->s, i)));
        if (fabs(v.sn) < 0.6 * speed)
            continue;
        const bs_bump b = {p.P[i], p.Pu[i], p.Pw[i], p.Puu[i], p.Puw[i], p.Pww[i]};
        const bs_slab all = {-HUGE_VAL, HUGE_VAL};
        const double bend = bs_curvature(v, N, lane_get(&q->Quu, i), lane_get(&q->Quw, i), lane_get(&q->Qww, i));
        const double tau = bs_shift_of(order, 0, v, bend, b, all).tau;
        worst += log(fabs(rough.t[i] - h->t[i] - tau) * speed + 1e-300);
        n++;
    }
    surface_free(d);
    bump_free(P);
    CHECK(n, >, 15);
    return worst / n;
}

static void error_slopes(void **state)
{
    (void)state;
    const int want[4] = {2, 2, 2, 3};
    const int kinds[] = {RING, KLEIN, MOEBIUS};
    for (int k = 0; k < 3; k++) {
        surface *f = surface_of(kinds[k]);
        static rays x;
        static hits h;
        static partials q;
        int32_t part[LANES];
        real u[LANES], w[LANES];
        for (int i = 0; i < LANES; i++)
            random_ray(&x, i, 1.3);
        no_hits(&h, LANES);
        f->ops->hit(f, LANES, &x, 0, &h);
        f->ops->locate(f, LANES, &x, h.t, part, u, w);
        f->ops->eval(f, LANES, part, u, w, 2, &q);
        for (int order = 0; order < 4; order++) {
            const double a = error_of(f, 1e-3, order, &x, &h, &q, u, w), b = error_of(f, 1e-4, order, &x, &h, &q, u, w);
            const double slope = (a - b) / log(10);
            print_message("%-8s order %d: error as A^%.3f, expected A^%d\n", names[kinds[k]], order, slope,
                          want[order]);
            NEAR(slope, want[order], 0.2);
        }
    }
}
#endif

static void refused(void **state)
{
    (void)state;
    const vec3 same[16] = {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3},
                           {1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}};
    assert_null(patch_surface_new(patch_bezier_new(1, same), NULL));
    assert_null(patch_surface_new(function("1", "2", "3", 0, 1, 0, 1), NULL));
    assert_null(patch_surface_new(function("u", "1/w", "w", 0, 1, -1, 1), NULL));
    assert_null(patch_surface_new(function("u", "log(w)", "w", 0, 1, -2, -1), NULL));
}

/* The same surface with its pieces in another order, and a hierarchy of boxes that are too large, each in its own way:
 * it reports pieces in another order, and also those that a ray passes by. */
static void reorder(patch_surface *f)
{
    const double most = 0.05 * f->l.space.radius;
    bvh_box *box = calloc((size_t)f->l.n, sizeof *box);
    assert_non_null(box);
    for (int i = f->l.n - 1; i > 0; i--) {
        const int j = (int)random_in(0, i);
        const piece other = f->l.piece[i];
        f->l.piece[i] = f->l.piece[j];
        f->l.piece[j] = other;
    }
    for (int i = 0; i < f->l.n; i++) {
        double lo[3], hi[3];
        for (int k = 0; k < 3; k++) {
            lo[k] = f->l.piece[i].box[0][k] - random_in(0, most);
            hi[k] = f->l.piece[i].box[1][k] + random_in(0, most);
        }
        box[i] = bvh_box_in(&f->l.space, lo, hi);
    }
    bvh_free(f->tree);
    f->tree = bvh_new(f->l.n, box, 1, NULL);
    assert_non_null(f->tree);
    free(box);
}

static void any_order(const char *y)
{
    surface *f[2];
    patch_counts c[2] = {{0}};
    for (int k = 0; k < 2; k++)
        f[k] = patch_surface_new(function("u", y, "w", -1, 1, -1, 1), NULL);
    reorder((patch_surface *)f[1]);
    static rays x;
    static hits h[2];
    static real lit[2][LANES];
    for (int i = 0; i < LANES; i++)
        random_ray(&x, i, 1.2);
    for (int k = 0; k < 2; k++) {
        no_hits(&h[k], LANES);
        patch_surface_intersect((patch_surface *)f[k], LANES, &x, NULL, 0, &h[k], &c[k]);
        for (int i = 0; i < LANES; i++)
            lit[k][i] = 1;
        patch_surface_occlude((patch_surface *)f[k], LANES, &x, false, NULL, lit[k], &c[k]);
        surface_free(f[k]);
    }
    assert_memory_equal(h[0].t, h[1].t, sizeof h[0].t);
    assert_memory_equal(h[0].id, h[1].id, sizeof h[0].id);
    assert_memory_equal(lit[0], lit[1], sizeof lit[0]);
    assert_int_equal(c[0].unsure, c[1].unsure);
    CHECK(c[0].unsure, >, 10);
}

/* Also where rays reach their limit, so that a root may be missing: on waves that are as small as pieces, and where the
 * surface jumps. */
static void any_order_of_pieces(void **state)
{
    (void)state;
    any_order("0.1*sin(1e4*u + w)");
    any_order("0.1*floor(sin(20*u) + sin(20*w))");
}

static bool has_closed_form(int kind) { return kind == BALL || kind == RING; }

static const property PROPERTIES[] = {
    {"hits are on the surface", hits_are_on_the_surface, NULL},
    {"as by closed forms", as_closed_forms, has_closed_form},
    {"own shadows as by closed forms", own_shadows, has_closed_form},
    {"as by brute force", brute_force, NULL},
    {"no cracks", no_cracks, NULL},
    {"odd rays", odd_rays, NULL},
    {"each ray by itself", each_ray_by_itself, NULL},
};

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(golden_partials),
        cmocka_unit_test(degenerate_edges),
        cmocka_unit_test(refused),
        cmocka_unit_test(displaced_as_closed_forms),
        cmocka_unit_test(displaced_at_any_scale),
        cmocka_unit_test(feet_at_any_scale),
        cmocka_unit_test(rough_bounds),
        cmocka_unit_test(any_order_of_pieces),
#ifdef KAGE_DOUBLE
        cmocka_unit_test(error_slopes),
#endif
    };
    return run_properties("patch surfaces, " REAL_NAME, PROPERTIES, sizeof PROPERTIES / sizeof *PROPERTIES, names,
                          KINDS, NULL, NULL) +
           cmocka_run_group_tests_name("patch surfaces, each by itself, " REAL_NAME, tests, NULL, free_all);
}
