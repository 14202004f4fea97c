/* bumpshadow.h's place to shade, gap and own shadows against the golden vectors of tests/golden/make_relief.py: planes,
 * spheres, cylinders and tori, seen from either side, computed at 50 digits without kage's approximations. Included by
 * a test for float and one for double.
 *
 * What is a formula must agree to rounding. What is an approximation must come nearer to the truth as the bumps and the
 * distances shrink together, by the order that docs/method.md gives.
 */
#include "unit/method/golden_values.h"

enum { ROWS = 4, COLUMNS = 25, MOST = 256 };

/* ---- one case ---- */

/* P = A (sin(f0 u + p0) cos(f1 w + p1) + sin(f2 u + f3 w + p2)/2) */
typedef struct bumps {
    double A, f[4], p[3];
} bumps;

static bumps bumps_of(struct fy_node *c)
{
    double x[8];
    assert_int_equal(golden_list(golden_get(c, "bumps"), 8, x), 8);
    const bumps b = {x[0], {x[1], x[2], x[3], x[4]}, {x[5], x[6], x[7]}};
    return b;
}

static double height(const bumps *b, double u, double w)
{
    return b->A *
           (sin(b->f[0] * u + b->p[0]) * cos(b->f[1] * w + b->p[1]) + sin(b->f[2] * u + b->f[3] * w + b->p[2]) / 2);
}

/* A ray at a place of a smooth surface, by the header; checked. */
typedef struct ray {
    bs_view v;
    bs_real curvature;
} ray;

static ray ray_of(int i, struct fy_node *c, const char *name)
{
    const bs_vec3 Qu = vector(c, "Qu"), Qw = vector(c, "Qw"), s = vector(c, name), n = bs_normal(Qu, Qw);
    const bs_vec3 Quu = vector(c, "Quu"), Quw = vector(c, "Quw"), Qww = vector(c, "Qww");
    const ray r = {bs_view_of(s, n, Qu, Qw), bs_curvature(bs_view_of(s, n, Qu, Qw), n, Quu, Quw, Qww)};
    const double size = sqrt((double)bs_dot(s, s)), a = golden_double(c, "a"), b = golden_double(c, "b");
    near(i, (double)r.v.sn, golden_double(c, "sn"), size);
    near(i, (double)r.v.a, a, size / sqrt((double)bs_dot(Qu, Qu)));
    near(i, (double)r.v.b, b, size / sqrt((double)bs_dot(Qw, Qw)));
    near(i, (double)r.curvature, golden_double(c, "curvature"),
         sqrt((double)bs_dot(Quu, Quu)) * a * a + 2 * sqrt((double)bs_dot(Quw, Quw)) * fabs(a * b) +
             sqrt((double)bs_dot(Qww, Qww)) * b * b);
    return r;
}

static int is_plane(struct fy_node *c) { return strcmp(fy_node_get_scalar0(golden_get(c, "surface")), "plane") == 0; }

static struct fy_node *cases_of(struct fy_document *d, const char *name, int *n)
{
    struct fy_node *cases = golden_get(fy_document_root(d), name);
    *n = fy_node_sequence_item_count(cases);
    CHECK(*n, <=, MOST);
    return cases;
}

static struct fy_document *open_golden(void) { return golden_open(KAGE_TESTS_DIR "/golden/relief.json"); }

/* The rows of a case: for bumps of height A, A/2, A/4, ... */
static void rows_of(struct fy_node *c, int columns, double x[ROWS][COLUMNS])
{
    struct fy_node *rows = golden_get(c, "rows");
    assert_int_equal(fy_node_sequence_item_count(rows), ROWS);
    for (int k = 0; k < ROWS; k++)
        assert_int_equal(golden_list(fy_node_sequence_get_by_index(rows, k), COLUMNS, x[k]), columns);
}

/* ---- orders of convergence ---- */

/* The exponents that the errors of many cases show when A is halved. */
typedef struct exponents {
    int n;
    double x[MOST];
} exponents;

static void halved(exponents *e, double error, double next) { e->x[e->n++] = log2(error / next); }

#ifdef BS_DOUBLE /* float rounds away what the lowest bumps leave */
static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The median is near the exponent of the leading term. In a single case that term may be small, and the next one larger
 * or of the other sign; 0.15 is the bound of test_slopes.c. */
static void converges(exponents *e, double order)
{
    CHECK(e->n, >, 8);
    qsort(e->x, (size_t)e->n, sizeof e->x[0], ascending);
    NEAR(e->x[e->n / 2], order, 0.15);
    CHECK(e->x[e->n / 8], >, order - 0.4);
}
#else
static void converges(const exponents *e, double order)
{
    (void)order;
    CHECK(e->n, >, 8);
}
#endif

/* ---- the place to shade, and the gap that is left ---- */

enum {
    TAU = 1,
    P_HIT,
    U1,
    W1,
    P1,
    PU1,
    PW1,
    GAP,
    REST,
    QU1 = 12,
    QW1 = 15,
    U2 = 18,
    W2,
    U_TRUE,
    W_TRUE,
    TRUE_HEIGHT,
    TRUE_GAP,
    TRUE_TAU
};

typedef struct found_place {
    double once, twice; /* distance of (u,w) from the true foot, after one move and after two */
    double gap;         /* error of the gap */
    double tau, newton; /* error of tau, and of tau with the gap over the slope taken off */
} found_place;

static found_place place_row(int i, const ray *r, double u0, double w0, const double *x)
{
    const bs_real tau = (bs_real)x[TAU];
    const bs_place one = bs_place_of(r->v, (bs_real)u0, (bs_real)w0, tau);
    near(i, (double)one.u, x[U1], 1);
    near(i, (double)one.w, x[W1], 1);

    const bs_vec3 rest = vector_of(x + REST), Qu = vector_of(x + QU1), Qw = vector_of(x + QW1);
    const bs_view v = bs_view_of(rest, bs_normal(Qu, Qw), Qu, Qw);
    const bs_place two = bs_place_of(v, (bs_real)x[U1], (bs_real)x[W1], 1);
    near(i, (double)two.u, x[U2], 1);
    near(i, (double)two.w, x[W2], 1);

    const bs_bump there = {(bs_real)x[P1], (bs_real)x[PU1], (bs_real)x[PW1], 0, 0, 0};
    const double bend = (double)(r->curvature * tau), rise = (double)r->v.sn;
    const double uphill = x[PU1] * (double)r->v.a, along = x[PW1] * (double)r->v.b,
                 slope = rise - bend - uphill - along;
    const double gap_size = fabs(x[TAU] * rise) + fabs(x[P1]) + fabs(bend * x[TAU]);
    const double slope_size = fabs(rise) + fabs(bend) + fabs(uphill) + fabs(along);
    const bs_real gap = bs_gap(r->v, r->curvature, tau, there.P),
                  residual = bs_residual(r->v, r->curvature, tau, there);
    near(i, (double)gap, x[GAP], gap_size);
    near(i, (double)residual, -x[GAP] / slope, (gap_size + fabs(x[GAP] / slope) * slope_size) / fabs(slope));

    const found_place f = {hypot((double)one.u - x[U_TRUE], (double)one.w - x[W_TRUE]),
                           hypot((double)two.u - x[U_TRUE], (double)two.w - x[W_TRUE]), fabs((double)gap - x[TRUE_GAP]),
                           fabs(x[TAU] - x[TRUE_TAU]), fabs(x[TAU] + (double)residual - x[TRUE_TAU])};
    return f;
}

/* On a plane all is exact but tau itself. On curved surfaces (u,w) is off by A^2, after the second move by A^3; the gap
 * by A^3, and so is the tau that it leads to, where order 0 is off by A^2. On a plane that tau is off by A^5: A of P's
 * second derivative, times the square of what order 0 leaves. */
static void places(void **state)
{
    (void)state;
    struct fy_document *d = open_golden();
    int n;
    struct fy_node *cases = cases_of(d, "places", &n);
    exponents once = {0}, twice = {0}, gap = {0}, tau = {0}, curved = {0}, flat = {0};
    for (int i = 0; i < n; i++) {
        struct fy_node *c = fy_node_sequence_get_by_index(cases, i);
        const bumps b = bumps_of(c);
        const ray r = ray_of(i, c, "s");
        const double u0 = golden_double(c, "u"), w0 = golden_double(c, "w"), across = golden_double(c, "across");
        near(i, (double)bs_pixels(vector(c, "s"), vector(c, "light"), (bs_real)0.25, -2), 8 * across, 16);
        double x[ROWS][COLUMNS];
        found_place f[ROWS];
        rows_of(c, COLUMNS, x);
        near(i, height(&b, u0, w0), x[0][P_HIT], b.A);
        for (int k = 0; k < ROWS; k++)
            f[k] = place_row(i, &r, u0, w0, x[k]);
        const found_place *last = &f[ROWS - 2], *next = &f[ROWS - 1];
        halved(&tau, last->tau, next->tau);
        if (is_plane(c)) {
            for (int k = 0; k < ROWS; k++)
                near(i, f[k].once + f[k].twice + f[k].gap, 0, 2);
            halved(&flat, last->newton, next->newton);
        } else {
            halved(&once, last->once, next->once);
            halved(&twice, last->twice, next->twice);
            halved(&gap, last->gap, next->gap);
            halved(&curved, last->newton, next->newton);
        }
    }
    CHECK(n, >=, 40);
    converges(&once, 2);
    converges(&twice, 3);
    converges(&gap, 3);
    converges(&tau, 2);
    converges(&curved, 3);
    converges(&flat, 5);
    fy_document_destroy(d);
}

/* ---- the bumps' own shadows ---- */

enum { T = 1, FORMULA, TRUE_H, U_WAY, W_WAY, U_FOOT, W_FOOT, WAY_COLUMNS };

/* Height and place on the way, and how far these are from the true ones. */
static void way_rows(int i, const ray *r, double u, double w, double P, double x[ROWS][COLUMNS], exponents *h,
                     exponents *place)
{
    double error[ROWS], off[ROWS];
    for (int k = 0; k < ROWS; k++) {
        const bs_real t = (bs_real)x[k][T];
        const double at = P / (1 << k) + (double)bs_gap(r->v, r->curvature, t, 0);
        const bs_place p = bs_place_of(r->v, (bs_real)u, (bs_real)w, t);
        near(i, at, x[k][FORMULA], 1);
        near(i, (double)p.u, x[k][U_WAY], 1);
        near(i, (double)p.w, x[k][W_WAY], 1);
        error[k] = fabs(at - x[k][TRUE_H]);
        off[k] = hypot((double)p.u - x[k][U_FOOT], (double)p.w - x[k][W_FOOT]);
    }
    if (h) {
        halved(h, error[ROWS - 2], error[ROWS - 1]);
        halved(place, off[ROWS - 2], off[ROWS - 1]);
    } else
        near(i, error[0] + off[0], 0, 2);
}

/* The march of the header's comment. */
static int march(const bs_way *y, const bumps *b, double u, double w, bs_real first, int N)
{
    int dark = first <= 0;
    for (int i = 1; i <= N; i++) {
        const bs_real t = bs_way_step(y->end, i, N);
        const double P = height(b, u + (double)(y->d.a * t), w + (double)(y->d.b * t));
        dark |= bs_way_below(*y, t, (bs_real)P);
    }
    return dark;
}

/* How far the gap over t may be off that a march of N steps sees, at the worst place. Between two steps it misses at
 * most half of P's second derivative along the way times the square of half their distance, over t: at t = end x^2 that
 * is end/N^2. On a curved surface height and place are off besides. The golden rows show by how much at one t: this
 * grows as t^3 and t^2, or, as far as it comes from P in the start, as t^2 and t. */
static double blind(const bs_way *y, const bumps *b, int N, const double *x)
{
    const double a = fabs((double)y->d.a), w = fabs((double)y->d.b), end = (double)y->end, *f = b->f;
    const double f0 = f[0] * a + f[1] * w, f1 = f[2] * a + f[3] * w;
    const double bend = b->A * (f0 * f0 + f1 * f1 / 2), slope = b->A * hypot(f[0] + f[2] / 2, f[1] + f[3] / 2);
    const double g = end / x[T], h = fabs(x[FORMULA] - x[TRUE_H]) * fmax(g * g * g, g * g),
                 off = hypot(x[U_WAY] - x[U_FOOT], x[W_WAY] - x[W_FOOT]) * fmax(g * g, g);
    return bend / 2 * end / (N * (double)N) + (h + slope * off) / end + TOLERANCE * 10;
}

typedef struct marches {
    int n, sure, wrong;
} marches;

/* Right wherever the light would have to move by more than the march is blind to. */
static void march_against_truth(int i, struct fy_node *c, const bs_way *y, const double *x, marches m[])
{
    static const int N[] = {4, 16, 64, 256};
    const bumps b = bumps_of(c);
    const double u = golden_double(c, "u"), w = golden_double(c, "w"), clearance = golden_double(c, "clearance");
    const bs_real first = y->side * bs_dot(vector(c, "n_perturbed"), vector(c, "d"));
    for (int k = 0; k < 4; k++) {
        const int dark = march(y, &b, u, w, first, N[k]), wrong = dark != (int)golden_double(c, "dark");
        const int sure = fabs(clearance) > blind(y, &b, N[k], x);
        m[k].n++;
        m[k].sure += sure;
        m[k].wrong += wrong;
        if (wrong && sure)
            fail_msg("way %d by %d steps: dark %d, which is wrong: the clearance is %g", i, N[k], dark, clearance);
    }
}

/* The partials of the offset surface through the place, and with these the rough surface's own normal. */
static void rough_normal(int i, struct fy_node *c)
{
    const bs_vec3 Qu = vector(c, "Qu"), Qw = vector(c, "Qw"), n = bs_normal(Qu, Qw);
    const bs_offset o = bs_offset_of(n, Qu, Qw, vector(c, "Quu"), vector(c, "Quw"), vector(c, "Qww"), number(c, "P"));
    double x[6];
    assert_int_equal(golden_list(golden_get(c, "offset"), 6, x), 6);
    near_vector(i, o.Qu, vector_of(x));
    near_vector(i, o.Qw, vector_of(x + 3));
    const bs_vec3 m = bs_normal(o.Qu, o.Qw), rough = vector(c, "n_rough");
    bs_vec3 np = bs_perturbed_normal(m, o.Qu, o.Qw, number(c, "Pu"), number(c, "Pw"));
    const bs_real scale = 1 / BS_SQRT(bs_dot(np, np));
    np.x *= scale, np.y *= scale, np.z *= scale;
    near_vector(i, np, rough);
}

static void ways(void **state)
{
    (void)state;
    struct fy_document *d = open_golden();
    int n;
    struct fy_node *cases = cases_of(d, "ways", &n);
    exponents h = {0}, place = {0};
    marches flat[4] = {{0}}, curved[4] = {{0}};
    for (int i = 0; i < n; i++) {
        struct fy_node *c = fy_node_sequence_get_by_index(cases, i);
        const int plane = is_plane(c);
        rough_normal(i, c);
        const double P = golden_double(c, "P"), side = golden_double(c, "side"), top = golden_double(c, "highest");
        const ray r = ray_of(i, c, "d");
        const bs_way y = bs_way_of((bs_real)side, r.v, r.curvature, (bs_real)P, (bs_real)-top, (bs_real)top);
        const double sn2 = (double)(r.v.sn * r.v.sn), rest = 2 * fabs((double)r.curvature) * (top + fabs(P));
        /* the root of sn^2 - 2 curvature rise: it may cancel */
        near(i, (double)y.end, golden_double(c, "end"), 1 + (sn2 + rest) / fabs(sn2 - rest));
        double x[ROWS][COLUMNS];
        rows_of(c, WAY_COLUMNS, x);
        way_rows(i, &r, golden_double(c, "u"), golden_double(c, "w"), P, x, plane ? NULL : &h, plane ? NULL : &place);
        march_against_truth(i, c, &y, x[0], plane ? flat : curved);
    }
    for (int k = 0; k < 4; k++) {
        print_message("%d steps: %d of %d wrong on planes, %d of %d on curved surfaces\n", 4 << 2 * k, flat[k].wrong,
                      flat[k].n, curved[k].wrong, curved[k].n);
        print_message("  sure %d, %d\n", flat[k].sure, curved[k].sure);
    }
    converges(&h, 3);
    converges(&place, 2);
    assert_int_equal(flat[3].wrong, 0);
    /* the bounds have not been stretched for all */
    CHECK(flat[3].sure, >, flat[3].n * 0.9);
    CHECK(curved[3].sure, >, curved[3].n / 2);
    fy_document_destroy(d);
}

/* ---- horizons ---- */

enum { LIGHT_A, LIGHT_B, LIGHT_SN, BEARING, RISE, HORIZON, LIGHT_COLUMNS };

/* Between K of the directions all around, by the header. */
static double between(const double *around, int all, int K, bs_real bearing)
{
    const bs_real x = bearing * (bs_real)K / 4;
    const int k = (int)x;
    const double here = around[k % K * (all / K)], next = around[(k + 1) % K * (all / K)];
    return (double)bs_horizon((bs_real)here, (bs_real)next, x - (bs_real)k);
}

/* A light's bearing and rise, and how much nearer its horizon is to the true one with twice as many directions. */
static void horizons(void **state)
{
    (void)state;
    struct fy_document *d = open_golden();
    int n, lights = 0;
    struct fy_node *cases = cases_of(d, "horizons", &n);
    double error[3] = {0};
    for (int i = 0; i < n; i++) {
        struct fy_node *c = fy_node_sequence_get_by_index(cases, i), *list = golden_get(c, "lights");
        double around[64], x[LIGHT_COLUMNS], most = 0;
        const int all = golden_list(golden_get(c, "around"), 64, around);
        for (int k = 0; k < all; k++)
            most = fmax(most, around[k]);
        for (int k = 0; k < fy_node_sequence_item_count(list); k++, lights++) {
            assert_int_equal(golden_list(fy_node_sequence_get_by_index(list, k), LIGHT_COLUMNS, x), LIGHT_COLUMNS);
            const bs_view v = {(bs_real)x[LIGHT_SN], (bs_real)x[LIGHT_A], (bs_real)x[LIGHT_B]};
            const bs_bearing g = bs_bearing_of(v, number(c, "ku"), number(c, "kw"));
            near(i, (double)g.bearing, x[BEARING], 4);
            near(i, (double)g.rise, x[RISE], fabs(x[RISE]));
            BETWEEN(0, g.bearing, 4);
            for (int m = 0; m < 3; m++)
                error[m] += fabs(between(around, all, 8 << m, g.bearing) - x[HORIZON]) / most;
        }
    }
    CHECK(lights, >, 60);
    for (int m = 0; m < 3; m++)
        print_message("%d directions: off by %.3g of the highest\n", 8 << m, error[m] / lights);
    CHECK(error[0] / lights, <, 0.08);
    /* it has kinks, where other hills take over, so it is of order 1 at least */
    CHECK(error[1], <, error[0] * 0.6);
    CHECK(error[2], <, error[0] * 0.25);
    fy_document_destroy(d);
}

/* The share of an area light: a polygon's area. A horizon that runs along a side, within 1 in 1000, is taken to be
 * askew by that much, which is 1/8 of it at most. */
static void shares(void **state)
{
    (void)state;
    struct fy_document *d = open_golden();
    int n;
    struct fy_node *cases = cases_of(d, "shares", &n);
    const bs_real least = (bs_real)1e-6;
    for (int i = 0; i < n; i++) {
        double x[4];
        assert_int_equal(golden_list(fy_node_sequence_get_by_index(cases, i), 4, x), 4);
        const double u = fabs(x[1]), w = fabs(x[2]), e = fmin(u, w) / fmax(u, w);
        const bs_real got = bs_horizon_share((bs_real)x[0], (bs_real)x[1], (bs_real)x[2], least);
        BETWEEN(0, got, 1);
        NEAR(got, x[3], e < 1e-3 ? 1e-3 / 8 + TOLERANCE : 4 * TOLERANCE);
    }
    CHECK(n, >=, 60);
    fy_document_destroy(d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(places),
        cmocka_unit_test(ways),
        cmocka_unit_test(horizons),
        cmocka_unit_test(shares),
    };
    return cmocka_run_group_tests_name(BUMPSHADOW_NAME, tests, NULL, NULL);
}
