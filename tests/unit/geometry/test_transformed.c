/* Surfaces under affine maps: all that they tell is what the surface itself tells of the rays taken back, and then
 * mapped; n points outward also where the map mirrors; rough ones are met where heights divided by the scale are met in
 * the surface's own space.
 */
#include "wave/lane.h"
#include "support/properties.h"
#include "support/displace.h"
#include "support/random_rays.h"
#include "geometry/surface.h"

enum { PLANE, RECTANGLE, DISC, BOX, SPHERE, DRUM, TUBE, HAT, TORUS, KINDS };
enum { MOVED, MIRRORED, STRETCHED, SHEARED, MAPS };
static const char *const kind_names[] = {"plane", "rectangle", "disc", "box", "sphere", "drum", "tube", "hat", "torus"};
static const char *const map_names[] = {"moved", "mirrored", "stretched", "sheared"};

static surface *make(int kind)
{
    switch (kind) {
    case PLANE:
        return plane_new((vec3){0.1, -0.3, 0.2}, (vec3){0.2, 0.1, 1.4}, (vec3){1.1, -0.2, 0.3}, false);
    case RECTANGLE:
        return plane_new((vec3){-1, 0.1, -1}, (vec3){0.2, 0.1, 2.4}, (vec3){2.1, -0.2, 0.3}, true);
    case DISC:
        return disc_new((vec3){0.1, -0.2, 0.1}, (vec3){0.3, 1.5, -0.4}, 1.3);
    case BOX:
        return box_new((vec3){0.7, -0.8, 1.1}, (vec3){-0.9, 0.5, -0.6});
    case SPHERE:
        return sphere_new((vec3){0.3, -0.2, 0.1}, 1.2);
    case DRUM:
        return cone_new((vec3){-0.1, -0.9, 0.2}, 0.9, (vec3){0.3, 0.8, -0.1}, 0.9, false);
    case TUBE:
        return cone_new((vec3){-0.8, 0.1, 0.2}, 0.8, (vec3){0.8, -0.1, -0.1}, 0.8, true);
    case HAT:
        return cone_new((vec3){-0.1, 0.6, 0.1}, 1.2, (vec3){0.2, -0.9, 0.2}, 0.3, false);
    default:
        return torus_new((vec3){0.1, -0.1, 0.2}, (vec3){0.3, 1, 0.5}, 0.9, 0.4);
    }
}

static bool is_flat(int kind) { return kind <= BOX; }
static bool is_closed(int kind)
{
    return kind == BOX || kind == SPHERE || kind == DRUM || kind == HAT || kind == TORUS;
}

/* A turn by 0.7 about an axis, then scales, then a turn about another (or none), then a way. */
static affine make_map(int kind)
{
    const double c = cos(0.7), s = sin(0.7);
    const affine turn = {{c, s, 0}, {-s, c, 0}, {0, 0, 1}, {0, 0, 0}},
                 other = {{c, 0, -s}, {0, 1, 0}, {s, 0, c}, {0.3, -0.2, 0.4}};
    const affine scales[MAPS] = {{{1.4, 0, 0}, {0, 1.4, 0}, {0, 0, 1.4}, {0, 0, 0}},
                                 {{0.7, 0, 0}, {0, 0.7, 0}, {0, 0, -0.7}, {0, 0, 0}},
                                 {{1.5, 0, 0}, {0, 0.6, 0}, {0, 0, 0.9}, {0, 0, 0}},
                                 {{1.2, 0, 0}, {0, -0.6, 0}, {0.3, 0.2, 0.9}, {0, 0, 0}}};
    affine m = affine_then(&turn, &scales[kind]);
    return affine_then(&m, &other);
}

static bs_vec3 narrow(vec3 v) { return (bs_vec3){(real)v.x, (real)v.y, (real)v.z}; }
static vec3 widen(bs_vec3 v) { return (vec3){(double)v.x, (double)v.y, (double)v.z}; }
static double apart(bs_vec3 a, vec3 b) { return vec3_length(vec3_sub(widen(a), b)); }

/* The image of a ray in the surface's own space. */
static void map_ray(const affine *m, const rays *own, rays *x, int i)
{
    lane_set(&x->r, i, narrow(affine_point(m, widen(lane_get(&own->r, i)))));
    lane_set(&x->s, i, narrow(affine_vector(m, widen(lane_get(&own->s, i)))));
}

static double turned(const surface *f, int part, const affine *m, double u)
{
    double U[2], W[2];
    f->ops->extent(f, part, U, W);
    return affine_volume(m) > 0 ? u : U[1] < HUGE_VAL ? U[0] + U[1] - u : -u;
}

typedef void check(int kind, int map, const surface *own, const surface *f, const affine *m);

/* *state: the number of a pair, KINDS x MAPS. */
static void for_pair(void **state, check *c)
{
    const int kind = *(const int *)*state / MAPS, map = *(const int *)*state % MAPS;
    const affine m = make_map(map);
    surface *own = make(kind), *f = surface_transformed(own, &m);
    assert_non_null(f);
    assert_string_equal(f->ops->kind, own->ops->kind);
    assert_int_equal(f->ops->parts, own->ops->parts);
    for (int round = 0; round < 10; round++)
        c(kind, map, own, f, &m);
    surface_free(f);
    surface_free(own);
}

/* ---- rays ---- */

/* Where rays pass a surface's edge the two may differ, seldom. */
static void rays_meet_alike(int kind, int map, const surface *own, const surface *f, const affine *m)
{
    static rays x, y;
    static hits h, g;
    static partials q, p;
    int32_t part[LANES], other[LANES];
    real u[LANES], w[LANES], v[LANES], z[LANES], lit[LANES], dark[LANES];
    int differ = 0, met = 0;
    for (int i = 0; i < LANES; i++) {
        random_ray(&y, i, 1);
        map_ray(m, &y, &x, i);
        lit[i] = dark[i] = 1;
    }
    no_hits(&h, LANES);
    no_hits(&g, LANES);
    f->ops->hit(f, LANES, &x, 7, &h);
    own->ops->hit(own, LANES, &y, 7, &g);
    f->ops->occlude(f, LANES, &x, lit);
    own->ops->occlude(own, LANES, &y, dark);
    f->ops->locate(f, LANES, &x, h.t, part, u, w);
    own->ops->locate(own, LANES, &y, h.t, other, v, z);
    f->ops->eval(f, LANES, part, u, w, 2, &q);
    own->ops->eval(own, LANES, other, v, z, 2, &p);
    for (int i = 0; i < LANES; i++) {
        const double s = (double)real_sqrt(bs_dot(lane_get(&y.s, i), lane_get(&y.s, i)));
        const double size =
            1 + (h.id[i] >= 0 ? s * (double)h.t[i] : 0); /* planes have hits far away, and flat to them */
        differ += lit[i] != dark[i];
        if (h.id[i] != g.id[i] || (h.id[i] >= 0 && fabs((double)(h.t[i] - g.t[i])) * s > 100 * EPS * size * size)) {
            differ++;
            continue;
        }
        if (h.id[i] < 0)
            continue;
        met++;
        assert_int_equal(h.id[i], 7);
        const double far = 100 * EPS * (1 + vec3_length(widen(lane_get(&q.Q, i))));
        const double off_ray = apart(lane_at(&x, i, h.t[i]), widen(lane_get(&q.Q, i)));
        const double off_image = apart(lane_get(&q.Q, i), affine_point(m, widen(lane_get(&p.Q, i))));
        if (!(off_ray < far && off_image < far)) {
            print_error("%s, %s: Q is %g off the ray, %g off the image, expected %g\n", own->ops->kind, map_names[map],
                        off_ray, off_image, far);
            fail();
        }
        if (part[i] != other[i]) { /* an edge */
            differ++;
            continue;
        }
        /* u goes over its ends at +-pi */
        const double off = fabs((double)u[i] - turned(own, part[i], m, (double)v[i]));
        differ += off > 1000 * EPS * size && fabs(off - 6.283185307179586) > 1000 * EPS;
        differ += fabs((double)(w[i] - z[i])) > 1000 * EPS * size;
        const bs_vec3 n = lane_unit(bs_normal(lane_get(&q.Qu, i), lane_get(&q.Qw, i)));
        if (is_closed(kind)) /* seen from outside */
            CHECK(bs_dot(n, lane_get(&x.s, i)), <, R(1e-3));
    }
    if (!(differ <= 3 && met > 10)) {
        print_error("%s, %s: %d of %d rays differ\n", own->ops->kind, map_names[map], differ, met);
        fail();
    }
}

static void rays_alike(void **state) { for_pair(state, rays_meet_alike); }

static void vectors_are_images(int kind, int map, const surface *own, const surface *f, const affine *m)
{
    const double turn = affine_volume(m) < 0 ? -1 : 1;
    (void)kind;
    (void)map;
    for (int32_t part = 0; part < own->ops->parts; part++) {
        static partials q, p;
        double U[2], W[2], A[2], B[2];
        own->ops->extent(own, part, U, W);
        f->ops->extent(f, part, A, B);
        CHECK(A[0], ==, U[0]);
        CHECK(A[1], ==, U[1]);
        CHECK(B[0], ==, W[0]);
        CHECK(B[1], ==, W[1]);
        const bool end = U[1] < HUGE_VAL;
        const real u = (real)random_in(end ? U[0] : -2, end ? U[1] : 2),
                   w = (real)random_in(end ? W[0] : -2, end ? W[1] : 2);
        const real v = (real)turned(own, part, m, (double)u);
        f->ops->eval(f, 1, &part, &u, &w, 2, &q);
        own->ops->eval(own, 1, &part, &v, &w, 2, &p);
        const struct {
            const vec3s *is, *of;
            double sign;
        } d[] = {
            {&q.Qu, &p.Qu, turn}, {&q.Qw, &p.Qw, 1}, {&q.Quu, &p.Quu, 1}, {&q.Quw, &p.Quw, turn}, {&q.Qww, &p.Qww, 1}};
        CHECK(apart(lane_get(&q.Q, 0), affine_point(m, widen(lane_get(&p.Q, 0)))), <, 30 * EPS);
        for (int k = 0; k < 5; k++)
            CHECK(apart(lane_get(d[k].is, 0), vec3_scale(affine_vector(m, widen(lane_get(d[k].of, 0))), d[k].sign)), <,
                  30 * EPS);
        /* the normal goes by the transpose of the way back, to the same side */
        const affine back = affine_back(m);
        const vec3 n = widen(bs_normal(lane_get(&q.Qu, 0), lane_get(&q.Qw, 0)));
        const vec3 o = widen(bs_normal(lane_get(&p.Qu, 0), lane_get(&p.Qw, 0)));
        const vec3 to = vec3_add(vec3_add(vec3_scale(back.x, o.x), vec3_scale(back.y, o.y)), vec3_scale(back.z, o.z));
        if (vec3_length(o) > 1e-3)
            CHECK(vec3_length(vec3_sub(vec3_unit(n), vec3_unit(to))), <, 1e4 * EPS);
    }
}

static void partials_and_normals(void **state) { for_pair(state, vectors_are_images); }

static void own_shadow_alike(int kind, int map, const surface *own, const surface *f, const affine *m)
{
    static rays x, y;
    static hits h;
    static partials q;
    int32_t part[LANES];
    real u[LANES], w[LANES], lit[LANES], dark[LANES];
    int n = 0, differ = 0;
    (void)map;
    CHECK(!f->ops->occlude_own, ==, !own->ops->occlude_own);
    if (!own->ops->occlude_own)
        return;
    for (int i = 0; i < LANES; i++)
        random_ray(&y, i, 1);
    no_hits(&h, LANES);
    own->ops->hit(own, LANES, &y, 0, &h);
    for (int i = 0; i < LANES; i++)
        if (h.id[i] == 0) {
            const bs_vec3 r = lane_get(&y.r, i), s = lane_get(&y.s, i);
            lane_set(&y.r, n, r);
            lane_set(&y.s, n, s);
            h.t[n++] = h.t[i];
        }
    own->ops->locate(own, n, &y, h.t, part, u, w);
    own->ops->eval(own, n, part, u, w, 1, &q);
    for (int i = 0; i < n; i++) {
        const bs_vec3 to = {(real)random_in(-4, 4), (real)random_in(-4, 4), (real)random_in(-4, 4)};
        lane_set(&y.r, i, lane_get(&q.Q, i));
        lane_set(&y.s, i, to);
        map_ray(m, &y, &x, i);
        lit[i] = dark[i] = 1;
    }
    f->ops->occlude_own(f, n, &x, part, lit);
    own->ops->occlude_own(own, n, &y, part, dark);
    /* and where the surface is met again */
    static hits again, want;
    static ray_origins from, there;
    no_hits(&again, LANES);
    no_hits(&want, LANES);
    from.at = x.r;
    there.at = y.r;
    for (int i = 0; i < n; i++) {
        from.id[i] = there.id[i] = 7;
        from.part[i] = there.part[i] = part[i];
        differ += lit[i] != dark[i];
    }
    vec3s_fill(&x.r, n, 9, 9, 9); /* it does not matter */
    f->ops->hit_own(f, n, &x, &from, 7, &again);
    own->ops->hit_own(own, n, &y, &there, 7, &want);
    for (int i = 0; i < n; i++) {
        const double s = (double)real_sqrt(bs_dot(lane_get(&y.s, i), lane_get(&y.s, i)));
        differ +=
            again.id[i] != want.id[i] || (want.id[i] == 7 && fabs((double)(again.t[i] - want.t[i])) * s > 1e4 * EPS);
    }
    CHECK(differ, <=, (kind == TORUS ? 4 : 2));
}

static void own_shadows(void **state) { for_pair(state, own_shadow_alike); }

/* ---- rough surfaces ---- */

static bool has_feet(int kind, int map) { return is_flat(kind) || map == MOVED || map == MIRRORED; }

/* A value and its slope over t, against the bound of its second derivative. */
static void check_bend(double was, double is, double slope_was, double slope_is, double bend, double t)
{
    const double air = 300 * EPS * (1 + fabs(was) + (1 + bend) * t + fabs(slope_was));
    CHECK(fabs(is - was - slope_was * t), <=, 0.5 * bend * t * t + air);
    CHECK(fabs(slope_is - slope_was), <=, bend * t + air * (1 + bend));
}

/* Along the ray from where p is, as far as the bounds reach, unless u or w have gone around. */
static void check_bends(const surface *f, int part, const rays *x, const closest_points *p, const path_bends *b)
{
    static closest_points q;
    const bs_vec3 d = lane_get(&x->s, 0);
    for (int k = 1; k <= 10; k++) {
        const real t = real_min(b->reach[0], 1) * R(0.1) * (real)k;
        f->ops->closest(f, part, 1, x, &t, &q);
        const double T = (double)t;
        if (real_abs(q.u[0] - p->u[0]) < 2)
            check_bend((double)p->u[0], (double)q.u[0], (double)bs_dot(d, lane_get(&p->gu, 0)),
                       (double)bs_dot(d, lane_get(&q.gu, 0)), (double)b->u[0], T);
        if (real_abs(q.w[0] - p->w[0]) < 2)
            check_bend((double)p->w[0], (double)q.w[0], (double)bs_dot(d, lane_get(&p->gw, 0)),
                       (double)bs_dot(d, lane_get(&q.gw, 0)), (double)b->w[0], T);
        check_bend((double)p->h[0], (double)q.h[0], (double)bs_dot(d, lane_get(&p->gh, 0)),
                   (double)bs_dot(d, lane_get(&q.gh, 0)), (double)b->h[0], T);
    }
}

/* Feet of places over the surface: (u,w), height and gradients. */
static void feet_are_below(int kind, int map, const surface *own, const surface *f, const affine *m)
{
    static partials q;
    static closest_points p, a, b;
    static rays x;
    (void)own;
    (void)m;
    CHECK((f->ops->closest != NULL), ==, has_feet(kind, map));
    CHECK((f->ops->bound != NULL), ==, has_feet(kind, map));
    CHECK((f->ops->bend != NULL), ==, has_feet(kind, map));
    if (!f->ops->closest)
        return;
    for (int32_t part = 0; part < f->ops->parts; part++) {
        double U[2], W[2];
        const real zero = 0, h = (real)random_in(-0.15, 0.3);
        f->ops->extent(f, part, U, W);
        const double mu = U[1] < HUGE_VAL ? 0.1 * (U[1] - U[0]) : 0, mw = W[1] < HUGE_VAL ? 0.1 * (W[1] - W[0]) : 0;
        const real u = (real)random_in(mu > 0 ? U[0] + mu : -2, mu > 0 ? U[1] - mu : 2);
        const real w = (real)random_in(mw > 0 ? W[0] + mw : -2, mw > 0 ? W[1] - mw : 2);
        f->ops->eval(f, 1, &part, &u, &w, 1, &q);
        const bs_vec3 Q = lane_get(&q.Q, 0), n = lane_unit(bs_normal(lane_get(&q.Qu, 0), lane_get(&q.Qw, 0)));
        const bs_vec3 X = {Q.x + h * n.x, Q.y + h * n.y, Q.z + h * n.z};
        lane_set(&x.r, 0, X);
        lane_set(&x.s, 0, n);
        f->ops->closest(f, part, 1, &x, &zero, &p);
        NEAR(p.u[0], u, 300 * EPS);
        NEAR(p.w[0], w, 300 * EPS);
        NEAR(p.h[0], h, 100 * EPS);
        CHECK(apart(lane_get(&p.gh, 0), widen(n)), <, 100 * EPS);
        /* along any way the three change by their gradients, and these by no more than `bend` says */
        const bs_vec3 d = {(real)random_in(-1, 1), (real)random_in(-1, 1), (real)random_in(-1, 1)};
        const double step = sqrt(EPS), half = 0.5 * step;
        const real t = (real)half, minus = (real)-half;
        lane_set(&x.s, 0, d);
        f->ops->closest(f, part, 1, &x, &t, &a);
        f->ops->closest(f, part, 1, &x, &minus, &b);
        NEAR((double)(a.u[0] - b.u[0]) / step, (double)bs_dot(d, lane_get(&p.gu, 0)), 60 * sqrt(EPS));
        NEAR((double)(a.w[0] - b.w[0]) / step, (double)bs_dot(d, lane_get(&p.gw, 0)), 60 * sqrt(EPS));
        NEAR((double)(a.h[0] - b.h[0]) / step, (double)bs_dot(d, lane_get(&p.gh, 0)), 60 * sqrt(EPS));
        path_bends bends;
        f->ops->bend(f, part, 1, &x, &p, &bends);
        CHECK(bends.reach[0], >, 0);
        check_bends(f, part, &x, &p, &bends);
    }
}

static void feet_of_images(void **state) { for_pair(state, feet_are_below); }

/* Heights h over the image are h/scale over the surface itself. */
static void rough_alike(int kind, int map, const surface *own, const surface *f, const affine *m)
{
    static rays x, y;
    static hits h, g;
    const double k = affine_scale(m);
    double U[2], W[2];
    displaced_counts counts = {0};
    int differ = 0, met = 0;
    expr_error wrong;
    if (map != MOVED && map != MIRRORED)
        return;
    /* the bounds for wide extents hold for all parts */
    const double all[2] = {-10, 10};
    own->ops->extent(own, 0, U, W);
    const bool turns = map == MIRRORED, one = kind == RECTANGLE || kind == BOX; /* u in 0..1 */
    bump *P = bump_function_new(expr_parse("0.06*sin(4*u+1)*cos(3*w)", &wrong), 1, all, all);
    bump *S = bump_function_new(expr_parse(!turns ? "0.06*sin(4*u+1)*cos(3*w)"
                                           : one  ? "0.06*sin(4*(1-u)+1)*cos(3*w)"
                                                  : "0.06*sin(1-4*u)*cos(3*w)",
                                           &wrong),
                                1 / k, all, all);
    for (int i = 0; i < LANES; i++) {
        random_ray(&y, i, 1);
        map_ray(m, &y, &x, i);
    }
    no_hits(&h, LANES);
    no_hits(&g, LANES);
    surface *of_image = displace(f, P, &counts), *original = displace(own, S, &counts);
    of_image->ops->hit(of_image, LANES, &x, 0, &h);
    original->ops->hit(original, LANES, &y, 0, &g);
    surface_free(of_image);
    surface_free(original);
    for (int i = 0; i < LANES; i++) {
        const double s = (double)real_sqrt(bs_dot(lane_get(&y.s, i), lane_get(&y.s, i)));
        met += g.id[i] == 0;
        differ += h.id[i] != g.id[i] || (h.id[i] == 0 && fabs((double)(h.t[i] - g.t[i])) * s > 1000 * EPS);
    }
    if (!(met > 20 && differ <= 3 && counts.uncertain <= 1)) {
        print_error("%s, %s: %d of %d differ, %ld uncertain\n", own->ops->kind, map_names[map], differ, met,
                    counts.uncertain);
        fail();
    }
    bump_free(P);
    bump_free(S);
}

static void rough_hits(void **state) { for_pair(state, rough_alike); }

/* On a box that is stretched or sheared hits are on Q + P n/|n|, along the normal of the image. */
static void rough_box(void **state)
{
    const double all[2] = {-0.5, 1.5};
    expr_error wrong;
    (void)state;
    for (int map = 0; map < MAPS; map++) {
        const affine m = make_map(map);
        surface *own = make(BOX), *f = surface_transformed(own, &m);
        bump *P = bump_function_new(expr_parse("0.05*sin(14*u+1)*cos(13*w)", &wrong), 1, all, all);
        static hit_group g;
        static hits h;
        static rays y;
        displaced_counts counts = {0};
        surface *d = displace(f, P, &counts);
        int met = 0;
        for (int i = 0; i < LANES; i++) {
            random_ray(&y, i, 1);
            map_ray(&m, &y, &g.picked.x, i);
        }
        no_hits(&h, LANES);
        hit_group_picked(&g);
        d->ops->hit(d, LANES, g.x, 0, &h);
        g.n = LANES;
        for (int i = 0; i < LANES; i++) {
            g.picked.t[i] = h.id[i] == 0 ? h.t[i] : R(1);
            g.part[i] = h.id[i] == 0 ? h.part[i] : 0;
        }
        displaced_shape(d, &g);
        for (int i = 0; i < LANES; i++) {
            partials q;
            if (h.id[i] < 0)
                continue;
            met++;
            f->ops->eval(f, 1, &g.part[i], &g.u[i], &g.w[i], 1, &q);
            const bs_vec3 Q = lane_get(&q.Q, 0), n = lane_unit(bs_normal(lane_get(&q.Qu, 0), lane_get(&q.Qw, 0)));
            const vec3 X = vec3_add(widen(Q), vec3_scale(widen(n), (double)g.bump.P[i]));
            CHECK(apart(lane_at(g.x, i, h.t[i]), X), <, 100 * EPS);
        }
        CHECK(met, >, 40);
        assert_int_equal(counts.uncertain, 0);
        surface_free(d);
        bump_free(P);
        surface_free(f);
        surface_free(own);
    }
}

static void none(void **state)
{
    const affine flat = {{1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 0}},
                 nan = {{(double)NAN, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        surface *own = make(kind);
        assert_null(surface_transformed(own, &flat));
        assert_null(surface_transformed(own, &nan));
        surface_free(own);
    }
}

static const property PROPERTIES[] = {
    {"rays alike", rays_alike, NULL},   {"partials and normals", partials_and_normals, NULL},
    {"own shadows", own_shadows, NULL}, {"feet of images", feet_of_images, NULL},
    {"rough hits", rough_hits, NULL},
};

int main(void)
{
    static char text[KINDS * MAPS][40];
    static const char *names[KINDS * MAPS];
    for (int k = 0; k < KINDS * MAPS; k++) {
        snprintf(text[k], sizeof text[k], "%s, %s", kind_names[k / MAPS], map_names[k % MAPS]);
        names[k] = text[k];
    }
    const struct CMUnitTest tests[] = {cmocka_unit_test(rough_box), cmocka_unit_test(none)};
    return run_properties("transformed surfaces", PROPERTIES, sizeof PROPERTIES / sizeof *PROPERTIES, names,
                          KINDS * MAPS, NULL, NULL) +
           cmocka_run_group_tests_name("transformed surfaces, each by itself", tests, NULL, NULL);
}
