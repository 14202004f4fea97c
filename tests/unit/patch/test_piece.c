/* Pieces of patches: their bounds hold, halves cover the whole, and what is proved for a ray is true. Each property is
 * a test for each of some patches, with random pieces of them.
 */
#include "patch/piece.h"
#include "support/properties.h"
#include "support/random_in.h"

#define PI 3.14159265358979323846
#define ROUNDING 1e-13 /* of double, for places a few units from the origin */

static patch *function(const char *x, const char *y, const char *z, double u0, double u1, double w0, double w1)
{
    expr_error wrong;
    expr *e[3] = {expr_parse(x, &wrong), expr_parse(y, &wrong), expr_parse(z, &wrong)};
    assert_true(e[0] && e[1] && e[2]);
    return patch_function_new("parametric", e, (double[2]){u0, u1}, (double[2]){w0, w1});
}

static patch *ball(void)
{
    return function("0.3 + 1.2*sin(w)*cos(u)", "1.2*cos(w) - 0.2", "0.1 + 1.2*sin(w)*sin(u)", -PI, PI, 0, PI);
}

/* With an edge across it. */
static patch *roof(void) { return function("u", "0.3*abs(u - 0.1) + 0.2*sin(3*w)", "w", -1, 1, -1.1, 1.1); }

static patch *waves(void) { return function("u", "0.2*sin(5*u*w) + noise(3*u, 3*w)/9", "w", -1, 1, -1, 1); }

/* Three patches with random control points, which fold over themselves. */
static patch *folds(void)
{
    vec3 p[48];
    for (int k = 0; k < 48; k++)
        p[k] = (vec3){random_in(-1, 1), random_in(-1, 1), random_in(-1, 1)};
    return patch_bezier_new(3, p);
}

static patch *const *image_of;
static patch *image(void)
{
    const affine m = {{0.5, 0.1, 0}, {0.2, -1.5, 0.3}, {0, 0.4, 0.8}, {3, 1, -2}}; /* it mirrors */
    return patch_affine_new(*image_of, &m);
}

enum { BALL, ROOF, WAVES, FOLDS, IMAGE, KINDS };
static patch *made[KINDS];
static const char *const NAMES[KINDS] = {"ball", "roof", "waves", "folded Bezier patches", "their image"};

static int make_all(void **state)
{
    static patch *(*const make[KINDS])(void) = {ball, roof, waves, folds, image};
    (void)state;
    image_of = &made[FOLDS];
    for (int kind = 0; kind < KINDS; kind++)
        assert_non_null(made[kind] = make[kind]());
    return 0;
}

static int free_all(void **state)
{
    (void)state;
    for (int kind = KINDS; kind--;)
        made[kind]->ops->free(made[kind]);
    return 0;
}

/* A random range of a patch, from all of it down to about 1/500. */
static piece random_piece(const patch *q)
{
    piece f = piece_of(q, (int32_t)random_in(0, q->parts), q->u, q->w);
    for (int halvings = (int)random_in(0, 19); halvings; halvings--)
        f = piece_half(q, &f, random_in(0, 1) < 0.5);
    return f;
}

typedef struct point {
    double a, b, u, w; /* the place in the piece's range, -1..1 */
    vec3 Q, Qu, Qw;
} point;

static point point_at(const patch *q, const piece *f, double a, double b)
{
    point p = {a,
               b,
               0.5 * ((1 - a) * f->u[0] + (1 + a) * f->u[1]),
               0.5 * ((1 - b) * f->w[0] + (1 + b) * f->w[1]),
               {0, 0, 0},
               {0, 0, 0},
               {0, 0, 0}};
    patch_jets j;
    q->ops->eval(q, 1, &f->part, &p.u, &p.w, 1, &j);
    p.Q = (vec3){j.axis[0].v[0], j.axis[1].v[0], j.axis[2].v[0]};
    p.Qu = patch_jets_u(&j, 0);
    p.Qw = patch_jets_w(&j, 0);
    return p;
}

static point random_point(const patch *q, const piece *f) { return point_at(q, f, random_in(-1, 1), random_in(-1, 1)); }

/* ---- bounds ---- */

static void for_points(const patch *q, void (*check)(const piece *f, const point *p))
{
    for (int round = 0; round < 300; round++) {
        const piece f = random_piece(q);
        for (int k = 0; k < 20; k++) {
            const point p = random_point(q, &f);
            check(&f, &p);
        }
    }
}

static void in_box(const piece *f, const point *p)
{
    const double Q[3] = {p->Q.x, p->Q.y, p->Q.z};
    for (int k = 0; k < 3; k++)
        BETWEEN(f->box[0][k] - ROUNDING, Q[k], f->box[1][k] + ROUNDING);
}

static void near_parallelogram(const piece *f, const point *p)
{
    const vec3 flat = vec3_add(f->c, vec3_add(vec3_scale(f->A, p->a), vec3_scale(f->B, p->b)));
    CHECK(vec3_length(vec3_sub(p->Q, flat)), <=, f->e);
}

static void in_radius(const piece *f, const point *p)
{
    CHECK(vec3_length(vec3_sub(p->Q, f->c)), <=, piece_radius(f) + ROUNDING);
}

static void partials_near_sides(const piece *f, const point *p)
{
    const double hu = 0.5 * (f->u[1] - f->u[0]), hw = 0.5 * (f->w[1] - f->w[0]);
    CHECK(vec3_length(vec3_sub(vec3_scale(p->Qu, hu), f->A)), <=, f->ea + ROUNDING);
    CHECK(vec3_length(vec3_sub(vec3_scale(p->Qw, hw), f->B)), <=, f->eb + ROUNDING);
}

static void the_box_holds(void **state) { for_points(made[*(const int *)*state], in_box); }
static void the_error_holds(void **state) { for_points(made[*(const int *)*state], near_parallelogram); }
static void the_radius_holds(void **state) { for_points(made[*(const int *)*state], in_radius); }
static void the_sides_hold(void **state) { for_points(made[*(const int *)*state], partials_near_sides); }

/* The bounds become close, or nothing would ever be proved: those of a smooth piece of half the size are about a
 * quarter as wide. */
static void errors_shrink(void **state)
{
    const patch *q = made[*(const int *)*state];
    const double m = 0.3, u[2] = {q->u[0] + m * (q->u[1] - q->u[0]), 0}, w[2] = {q->w[0] + m * (q->w[1] - q->w[0]), 0};
    double e[2];
    for (int k = 0; k < 2; k++) {
        const double share = k ? 1 / 2048. : 1 / 1024.;
        const double ur[2] = {u[0], u[0] + share * (q->u[1] - q->u[0])},
                     wr[2] = {w[0], w[0] + share * (q->w[1] - q->w[0])};
        e[k] = piece_of(q, 0, ur, wr).e;
    }
    CHECK(e[0], >, 0);
    CHECK(e[1], <, 0.3 * e[0]);
}

/* ---- halves ---- */

static void halves_cover_the_whole(void **state)
{
    const patch *q = made[*(const int *)*state];
    for (int round = 0; round < 300; round++) {
        const piece f = random_piece(q), a = piece_half(q, &f, 0), b = piece_half(q, &f, 1);
        const bool along_u = a.u[1] != f.u[1];
        const double *cut = along_u ? a.u : a.w, *rest = along_u ? b.u : b.w, *whole = along_u ? f.u : f.w;
        CHECK(cut[0], ==, whole[0]);
        CHECK(cut[1], ==, rest[0]);
        CHECK(rest[1], ==, whole[1]);
        NEAR(cut[1] - cut[0], 0.5 * (whole[1] - whole[0]), 1e-12);
        assert_int_equal(a.part, f.part);
        assert_int_equal(b.part, f.part);
    }
}

/* ---- a ray ---- */

static vec3 random_vector(double size)
{
    return (vec3){random_in(-size, size), random_in(-size, size), random_in(-size, size)};
}

/* No ray misses a piece through whose point it goes. */
static void no_hit_is_missed(void **state)
{
    const patch *q = made[*(const int *)*state];
    for (int round = 0; round < 1500; round++) {
        const piece f = random_piece(q);
        const point p = random_point(q, &f);
        const vec3 s = random_vector(1), r = vec3_sub(p.Q, vec3_scale(s, 2));
        double a, b;
        CHECK(piece_intersect(&f, r, s, 0, 3, &a, &b), !=, PIECE_MISSED);
        CHECK(piece_intersect(&f, r, s, 2 - 1e-9, 2 + 1e-9, &a, &b), !=, PIECE_MISSED);
    }
}

/* A ray through two points of a piece is never said to meet it once at the most. */
static void no_second_hit_is_missed(void **state)
{
    const patch *q = made[*(const int *)*state];
    for (int round = 0; round < 1500; round++) {
        const piece f = random_piece(q);
        const point p = random_point(q, &f), p2 = random_point(q, &f);
        const vec3 s = vec3_sub(p2.Q, p.Q), r = vec3_sub(p.Q, s);
        double a, b;
        if (vec3_length(s) > 1e-3 * piece_radius(&f))
            CHECK(piece_intersect(&f, r, s, 0, 3, &a, &b), ==, PIECE_OPEN);
    }
}

/* Small pieces are proved to be met once by most rays through them, and (a,b) is close to the hit. */
static void most_rays_are_decided(void **state)
{
    const patch *q = made[*(const int *)*state];
    int once = 0, tries = 0;
    for (int round = 0; round < 1000; round++) {
        piece f = random_piece(q);
        for (int k = 0; k < 8; k++)
            f = piece_half(q, &f, random_in(0, 1) < 0.5);
        const point p = random_point(q, &f);
        const vec3 s = random_vector(1), r = vec3_sub(p.Q, vec3_scale(s, 2));
        double a, b;
        tries++;
        if (piece_intersect(&f, r, s, 0, 3, &a, &b) != PIECE_ONCE)
            continue;
        once++;
        NEAR(a, p.a, 1);
        NEAR(b, p.b, 1);
    }
    CHECK(once, >, 0.5 * tries);
}

/* Rays that pass a piece at a distance, and rays that end before it or begin behind it, miss it. */
static void distant_rays_miss(void **state)
{
    const patch *q = made[*(const int *)*state];
    for (int round = 0; round < 1000; round++) {
        const piece f = random_piece(q);
        const double far = 3 * piece_radius(&f);
        if (!(far < 1e9)) /* at an edge no bound is known */
            continue;
        const vec3 s = vec3_unit(random_vector(1)), side = vec3_unit(vec3_cross(s, random_vector(1)));
        const vec3 beside = vec3_add(f.c, vec3_scale(side, far)), r = vec3_sub(f.c, vec3_scale(s, far));
        double a, b;
        if (vec3_length(f.A) > 10 * f.ea && vec3_length(f.B) > 10 * f.eb)
            CHECK(piece_intersect(&f, beside, s, -far, far, &a, &b), ==, PIECE_MISSED);
        CHECK(piece_intersect(&f, r, s, 0, 0.5 * far, &a, &b), ==, PIECE_MISSED);
        CHECK(piece_intersect(&f, r, s, 1.5 * far, 9 * far, &a, &b), ==, PIECE_MISSED);
    }
}

/* ---- whole patches ---- */

static void pieces_cover_the_patch(void **state)
{
    const patch *q = made[*(const int *)*state];
    pieces l;
    bool bounded;
    assert_true(pieces_of(q, 0.3, NULL, &l, &bounded));
    double area = 0;
    for (int k = 0; k < l.n; k++)
        area += (l.piece[k].u[1] - l.piece[k].u[0]) * (l.piece[k].w[1] - l.piece[k].w[0]);
    const double whole = (q->u[1] - q->u[0]) * (q->w[1] - q->w[0]) * q->parts;
    CHECK(l.n, >, 64);
    NEAR(area, whole, 1e-9 * whole);
    pieces_free(&l);
}

static void box_and_sphere_hold_the_patch(void **state)
{
    const patch *q = made[*(const int *)*state];
    pieces l;
    bool bounded;
    assert_true(pieces_of(q, 0.3, NULL, &l, &bounded));
    for (int round = 0; round < 2000; round++) {
        const piece f = random_piece(q);
        const point p = random_point(q, &f);
        const double Q[3] = {p.Q.x, p.Q.y, p.Q.z};
        for (int k = 0; k < 3; k++)
            BETWEEN(l.lo[k] - ROUNDING, Q[k], l.hi[k] + ROUNDING);
        CHECK(vec3_length(vec3_sub(p.Q, l.space.centre)), <=, l.space.radius + ROUNDING);
    }
    pieces_free(&l);
}

static void a_point_has_no_pieces(void **state)
{
    (void)state;
    patch *q = function("3", "2 + 0*u", "1", 0, 1, 0, 1);
    pieces l;
    bool bounded = true;
    assert_false(pieces_of(q, 0.3, NULL, &l, &bounded));
    assert_false(bounded);
    pieces_free(&l);
    q->ops->free(q);
}

static void no_bounds_no_pieces(void **state)
{
    (void)state;
    patch *q = function("u", "1/u", "w", -1, 1, 0, 1);
    pieces l;
    bool bounded = true;
    assert_false(pieces_of(q, 0.3, NULL, &l, &bounded));
    assert_false(bounded);
    pieces_free(&l);
    q->ops->free(q);
}

static const property PROPERTIES[] = {
    {"the box holds", the_box_holds, NULL},
    {"the error holds", the_error_holds, NULL},
    {"the radius holds", the_radius_holds, NULL},
    {"the sides hold", the_sides_hold, NULL},
    {"errors shrink", errors_shrink, NULL},
    {"halves cover the whole", halves_cover_the_whole, NULL},
    {"no hit is missed", no_hit_is_missed, NULL},
    {"no second hit is missed", no_second_hit_is_missed, NULL},
    {"most rays are decided", most_rays_are_decided, NULL},
    {"distant rays miss", distant_rays_miss, NULL},
    {"pieces cover the patch", pieces_cover_the_patch, NULL},
    {"box and sphere hold the patch", box_and_sphere_hold_the_patch, NULL},
};

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_point_has_no_pieces), cmocka_unit_test(no_bounds_no_pieces)};
    return run_properties("pieces of patches", PROPERTIES, sizeof PROPERTIES / sizeof *PROPERTIES, NAMES, KINDS,
                          make_all, free_all) +
           cmocka_run_group_tests_name("patches without pieces", tests, NULL, NULL);
}
