/* Surfaces: hits lie on Q(u,w), partials are the derivatives of Q, n points outward, shadows agree with hits, and rays
 * without sense do no harm.
 */
#include <stdbool.h>
#include <string.h>

#include "base/frame.h"
#include "geometry/surface.h"
#include "support/odd_rays.h"
#include "support/properties.h"
#include "support/random_rays.h"
#include "wave/lane.h"

enum { PLANE, RECTANGLE, BOX, SPHERE, DISC, DRUM, TUBE, BELL, CUP, HAT, TORUS, THIN, KINDS };

/* The surfaces with an inside that no ray from outside sees, and those of them that never shade themselves from
 * outside. */
static bool is_closed(int kind)
{
    return kind != PLANE && kind != RECTANGLE && kind != DISC && kind != TUBE && kind != CUP;
}
static bool is_convex(int kind) { return is_closed(kind) && kind != TORUS && kind != THIN; }

static bool is_flat(int kind) { return kind == PLANE || kind == RECTANGLE || kind == DISC; }

static const char *const NAMES[KINDS] = {"plane", "rectangle", "box", "sphere", "disc",  "drum",
                                         "tube",  "bell",      "cup", "hat",    "torus", "thin torus"};

static surface *make(int kind)
{
    switch (kind) {
    case PLANE:
        return plane_new((vec3){0.1, -0.3, 0.2}, (vec3){0.2, 0.1, 1.4}, (vec3){1.1, -0.2, 0.3}, false);
    case RECTANGLE:
        return plane_new((vec3){-1, 0.1, -1}, (vec3){0.2, 0.1, 2.4}, (vec3){2.1, -0.2, 0.3}, true);
    case BOX:
        return box_new((vec3){0.7, -0.8, 1.1}, (vec3){-0.9, 0.5, -0.6});
    case SPHERE:
        return sphere_new((vec3){0.3, -0.2, 0.1}, 1.2);
    case DISC:
        return disc_new((vec3){0.1, -0.2, 0.1}, (vec3){0.3, 1.5, -0.4}, 1.3);
    case DRUM:
        return cone_new((vec3){-0.1, -0.9, 0.2}, 0.9, (vec3){0.3, 0.8, -0.1}, 0.9, false);
    case TUBE:
        return cone_new((vec3){-0.8, 0.1, 0.2}, 0.8, (vec3){0.8, -0.1, -0.1}, 0.8, true);
    case BELL:
        return cone_new((vec3){-0.1, -0.7, 0.1}, 1.1, (vec3){0.2, 0.7, 0.2}, 0.5, false);
    case CUP:
        return cone_new((vec3){-0.1, -0.2, 0.1}, 0.3, (vec3){0.2, 0.6, 0.2}, 1.2, true);
    case HAT:
        return cone_new((vec3){-0.1, 0.6, 0.1}, 1.2, (vec3){0.2, -0.9, 0.2}, 0, false);
    case TORUS:
        return torus_new((vec3){0.1, -0.1, 0.2}, (vec3){0.3, 1, 0.5}, 0.9, 0.4);
    default:
        return torus_new((vec3){0.1, -0.1, 0.2}, (vec3){1, 0.1, -0.2}, 1.2, 0.05);
    }
}

static double distance(bs_vec3 a, bs_vec3 b)
{
    bs_vec3 d = {a.x - b.x, a.y - b.y, a.z - b.z};
    return sqrt((double)bs_dot(d, d));
}

static void hits_are_on_the_surface(void **state)
{
    const int kind = *(const int *)*state;
    surface *f = make(kind);
    int met = 0;
    for (int round = 0; round < 40; round++) {
        static rays x;
        static hits h;
        static partials q;
        int32_t part[LANES];
        real u[LANES], w[LANES];
        for (int i = 0; i < LANES; i++)
            random_ray(&x, i, 1);
        no_hits(&h, LANES);
        f->ops->hit(f, LANES, &x, 3, &h);
        f->ops->locate(f, LANES, &x, h.t, part, u, w);
        f->ops->eval(f, LANES, part, u, w, 2, &q);
        for (int i = 0; i < LANES; i++) {
            if (h.id[i] < 0)
                continue;
            met++;
            assert_int_equal(h.id[i], 3);
            CHECK(h.t[i], >, 0);
            CHECK(h.t[i], <, REAL_FAR);
            double far = 1 + distance(lane_at(&x, i, 0), lane_at(&x, i, h.t[i]));
            double off = distance(lane_get(&q.Q, i), lane_at(&x, i, h.t[i]));
            CHECK(off, <=, 24 * EPS * far);
            /* on what is closed, seen from outside, the first hit's n faces the viewer */
            bs_vec3 n = bs_normal(lane_get(&q.Qu, i), lane_get(&q.Qw, i));
            if (is_closed(kind))
                CHECK(bs_dot(n, lane_get(&x.s, i)), <, R(1e-4));
        }
    }
    CHECK(met, >, (kind == THIN ? 200 : 500));
    surface_free(f);
}

static void partials_are_derivatives(void **state)
{
    const int kind = *(const int *)*state;
    const double h = sqrt(EPS) * 0.3; /* balances the curve's error, h^2, and the rounding, EPS/h */
    surface *f = make(kind);
    for (int round = 0; round < 200; round++) {
        static partials q[5];
        real u[1], w[1];
        int32_t part[1] = {round % f->ops->parts};
        double u0 = random_in(0.3, 0.7), w0 = random_in(0.4, 0.6), du[5] = {0, h, -h, 0, 0}, dw[5] = {0, 0, 0, h, -h};
        double du_[5], dw_[5];
        if (kind != PLANE) {
            double U[2], W[2];
            f->ops->extent(f, part[0], U, W);
            u0 = random_in(U[0] + 0.1, U[1] - 0.1), w0 = random_in(W[0] + 0.1, W[1] - 0.1);
            if (!(U[0] < U[1])) /* a hat has no upper cap */
                continue;
        }
        for (int k = 0; k < 5; k++) {
            u[0] = (real)(u0 + du[k]);
            w[0] = (real)(w0 + dw[k]);
            du_[k] = (double)u[0];
            dw_[k] = (double)w[0];
            f->ops->eval(f, 1, part, u, w, 2, &q[k]);
        }
        const struct {
            vec3s *a, *b, *want;
            double step;
        } tests[] = {
            {&q[1].Q, &q[2].Q, &q[0].Qu, du_[1] - du_[2]},    {&q[3].Q, &q[4].Q, &q[0].Qw, dw_[3] - dw_[4]},
            {&q[1].Qu, &q[2].Qu, &q[0].Quu, du_[1] - du_[2]}, {&q[3].Qu, &q[4].Qu, &q[0].Quw, dw_[3] - dw_[4]},
            {&q[1].Qw, &q[2].Qw, &q[0].Quw, du_[1] - du_[2]}, {&q[3].Qw, &q[4].Qw, &q[0].Qww, dw_[3] - dw_[4]},
        };
        for (int k = 0; k < 6; k++) {
            bs_vec3 a = lane_get(tests[k].a, 0), b = lane_get(tests[k].b, 0), c = lane_get(tests[k].want, 0);
            bs_vec3 d = {(real)((double)(a.x - b.x) / tests[k].step), (real)((double)(a.y - b.y) / tests[k].step),
                         (real)((double)(a.z - b.z) / tests[k].step)};
            if (!(distance(d, c) < 20 * sqrt(EPS)))
                fail_msg("derivative %d is off by %g", k, distance(d, c));
        }
    }
    surface_free(f);
}

/* Every face of the box has its own (u,w) over 0..1 and n outward; the six cover it. */
static void box_faces(void **state)
{
    (void)state;
    surface *f = make(BOX);
    static partials q;
    int32_t part[6] = {0, 1, 2, 3, 4, 5};
    real u[6], w[6];
    for (int i = 0; i < 6; i++)
        u[i] = w[i] = R(0.5);
    f->ops->eval(f, 6, part, u, w, 1, &q);
    const double middle[3] = {-0.1, -0.15, 0.25}, half[3] = {0.8, 0.65, 0.85};
    for (int i = 0; i < 6; i++) {
        bs_vec3 Q = lane_get(&q.Q, i), n = bs_normal(lane_get(&q.Qu, i), lane_get(&q.Qw, i));
        double want[3] = {middle[0], middle[1], middle[2]}, out[3] = {0, 0, 0};
        want[i / 2] += (i % 2 ? 1 : -1) * half[i / 2];
        out[i / 2] = i % 2 ? 1 : -1;
        bs_vec3 place = {(real)want[0], (real)want[1], (real)want[2]}, to = {(real)out[0], (real)out[1], (real)out[2]};
        CHECK(distance(Q, place), <, 1e-6);
        CHECK(distance(lane_unit(n), to), <, 1e-6);
    }
    surface_free(f);
}

/* occlude says 0 just where a hit lies in (0,1). */
static void shadows_agree_with_hits(void **state)
{
    surface *f = make(*(const int *)*state);
    int dark = 0;
    for (int round = 0; round < 20; round++) {
        static rays x;
        static hits h;
        real lit[LANES];
        for (int i = 0; i < LANES; i++) {
            random_ray(&x, i, 1);
            lit[i] = 1;
        }
        no_hits(&h, LANES);
        f->ops->hit(f, LANES, &x, 0, &h);
        f->ops->occlude(f, LANES, &x, lit);
        for (int i = 0; i < LANES; i++) {
            const bool met = h.id[i] >= 0 && h.t[i] < 1;
            CHECK(lit[i], ==, !met);
            dark += met;
        }
    }
    CHECK(dark, >, 100);
    surface_free(f);
}

static void dark_stays_dark(void **state)
{
    surface *f = make(*(const int *)*state);
    static rays x;
    real lit[LANES] = {0};
    for (int i = 0; i < LANES; i++)
        random_ray(&x, i, 1);
    f->ops->occlude(f, LANES, &x, lit);
    for (int i = 0; i < LANES; i++)
        CHECK(lit[i], ==, 0);
    surface_free(f);
}

static void only_flat_ones_cannot_shade_themselves(void **state)
{
    const int kind = *(const int *)*state;
    surface *f = make(kind);
    CHECK(f->ops->occlude_own == NULL, ==, is_flat(kind));
    surface_free(f);
}

/* Random points of a surface, as rays from outside hit them. */
typedef struct points {
    int n;
    rays x; /* these rays */
    real t[LANES];
    int32_t part[LANES];
    bs_vec3 at[LANES], normal[LANES]; /* the normal a unit vector */
} points;

static void random_points(const surface *f, points *p)
{
    static hits h;
    static partials q;
    real u[LANES], w[LANES];
    for (int i = 0; i < LANES; i++)
        random_ray(&p->x, i, 1);
    no_hits(&h, LANES);
    f->ops->hit(f, LANES, &p->x, 0, &h);
    p->n = 0;
    for (int i = 0; i < LANES; i++)
        if (h.id[i] >= 0) {
            bs_vec3 r = lane_get(&p->x.r, i), s = lane_get(&p->x.s, i);
            lane_set(&p->x.r, p->n, r);
            lane_set(&p->x.s, p->n, s);
            p->t[p->n++] = h.t[i];
        }
    f->ops->locate(f, p->n, &p->x, p->t, p->part, u, w);
    f->ops->eval(f, p->n, p->part, u, w, 1, &q);
    for (int i = 0; i < p->n; i++) {
        p->at[i] = lane_at(&p->x, i, p->t[i]);
        p->normal[i] = lane_unit(bs_normal(lane_get(&q.Qu, i), lane_get(&q.Qw, i)));
    }
}

static bs_vec3 random_direction(void)
{
    bs_vec3 d = {(real)random_in(-9, 9), (real)random_in(-9, 9), (real)random_in(-9, 9)};
    return d;
}

/* Segments from points of a convex surface: which are lit that leave it, or that enter it and are longer than it is
 * wide. In every fourth round they are within 1e-3 of the tangent plane: there is no epsilon that these could fall
 * under. */
static void own_segments(int kind, bool outward)
{
    surface *f = make(kind);
    int some = 0;
    for (int round = 0; round < 40; round++) {
        static points p;
        static rays out;
        real lit[LANES], cosine[LANES], length[LANES];
        random_points(f, &p);
        for (int i = 0; i < p.n; i++) {
            bs_vec3 d = random_direction(), n = p.normal[i];
            if (round % 4 == 0) {
                real c = bs_dot(d, n) - (i % 2 ? R(1e-3) : R(-1e-3));
                d.x -= c * n.x, d.y -= c * n.y, d.z -= c * n.z;
            }
            cosine[i] = bs_dot(d, n);
            length[i] = real_sqrt(bs_dot(d, d));
            lane_set(&out.r, i, p.at[i]);
            lane_set(&out.s, i, d);
            lit[i] = 1;
        }
        f->ops->occlude_own(f, p.n, &out, p.part, lit);
        for (int i = 0; i < p.n; i++)
            if (outward ? cosine[i] > R(1e-4) : cosine[i] < R(-1e-4) && length[i] > 4) {
                CHECK(lit[i], ==, outward);
                some++;
            }
    }
    CHECK(some, >, 300);
    surface_free(f);
}

static void outward_is_lit(void **state) { own_segments(*(const int *)*state, true); }
static void inward_is_dark(void **state) { own_segments(*(const int *)*state, false); }

/* Rays from points of a surface, as object 7. */
static void own_rays(const points *p, int round, rays *out, ray_origins *from)
{
    for (int i = 0; i < p->n; i++) {
        bs_vec3 d = random_direction();
        d.x = round == 1 ? 0 : d.x;                                /* along a face of the box */
        lane_set(&out->r, i, lane_at(&p->x, i, p->t[i] * R(0.9))); /* another origin, which must not matter */
        lane_set(&out->s, i, d);
        lane_set(&from->at, i, p->at[i]);
        from->id[i] = 7;
        from->part[i] = p->part[i];
    }
}

/* A ray from a flat surface never returns, nor does one that leaves a convex surface. One that enters a closed surface
 * meets it again. The own start never counts. */
static void own_rays_meet_what_is_ahead(void **state)
{
    const int kind = *(const int *)*state;
    surface *f = make(kind);
    int met = 0;
    for (int round = 0; round < 40; round++) {
        static points p;
        static rays out;
        static hits h;
        static ray_origins from;
        random_points(f, &p);
        own_rays(&p, round, &out, &from);
        no_hits(&h, p.n);
        f->ops->hit_own(f, p.n, &out, &from, 7, &h);
        for (int i = 0; i < p.n; i++) {
            const real cosine = bs_dot(lane_unit(lane_get(&out.s, i)), p.normal[i]);
            if (is_flat(kind) || (is_convex(kind) && cosine > R(1e-4)))
                CHECK(h.id[i], ==, -1);
            else if (is_closed(kind) && cosine < R(-1e-3))
                CHECK(h.id[i], ==, 7);
            CHECK(h.t[i], >, 0);
            met += h.id[i] == 7;
        }
    }
    BETWEEN(is_flat(kind) ? 0 : is_closed(kind) && kind != THIN ? 500 : 100, met, is_flat(kind) ? 0 : 1e9);
    surface_free(f);
}

/* What a ray from the surface meets is a point of the surface, seen from within where the ray has entered, and on a box
 * another face. */
static void own_hits_are_on_the_surface(void **state)
{
    const int kind = *(const int *)*state;
    const double within = (kind == HAT || kind == THIN ? 300 : 60) * EPS; /* a tip, and a tube of radius 0.05 */
    surface *f = make(kind);
    for (int round = 0; round < 40; round++) {
        static points p;
        static rays out;
        static hits h;
        static partials q;
        static ray_origins from;
        int32_t part[LANES];
        real u[LANES], w[LANES];
        random_points(f, &p);
        own_rays(&p, round, &out, &from);
        no_hits(&h, p.n);
        f->ops->hit_own(f, p.n, &out, &from, 7, &h);
        for (int i = 0; i < p.n; i++)
            h.t[i] = h.id[i] == 7 ? h.t[i] : 1;
        out.r = from.at;
        f->ops->locate(f, p.n, &out, h.t, part, u, w);
        f->ops->eval(f, p.n, part, u, w, 1, &q);
        for (int i = 0; i < p.n; i++) {
            if (h.id[i] != 7)
                continue;
            const bs_vec3 s = lane_get(&out.s, i), n = bs_normal(lane_get(&q.Qu, i), lane_get(&q.Qw, i));
            NEAR(distance(lane_get(&q.Q, i), lane_at(&out, i, h.t[i])), 0, within);
            if (is_closed(kind))
                CHECK(bs_dot(s, n) > 0, ==, bs_dot(s, p.normal[i]) < 0);
            if (kind == BOX)
                CHECK(part[i], !=, p.part[i]);
        }
    }
    surface_free(f);
}

/* Rays that start on another surface are treated as hit treats them, to the bit. */
static void rays_from_elsewhere_as_hit(void **state)
{
    surface *f = make(*(const int *)*state);
    for (int round = 0; round < 10; round++) {
        static points p;
        static rays out;
        static hits h, want;
        static ray_origins from;
        random_points(f, &p);
        own_rays(&p, round, &out, &from);
        no_hits(&h, p.n);
        no_hits(&want, p.n);
        f->ops->hit_own(f, p.n, &p.x, &from, 3, &h);
        f->ops->hit(f, p.n, &p.x, 3, &want);
        assert_memory_equal(h.t, want.t, (size_t)p.n * sizeof(real));
        assert_memory_equal(h.id, want.id, (size_t)p.n * sizeof(int32_t));
    }
    surface_free(f);
}

/* Rays from within see the inner side. */
static void from_inside(void **state)
{
    const int kind = *(const int *)*state;
    surface *f = make(kind);
    static rays x;
    static hits h;
    for (int i = 0; i < LANES; i++) {
        random_ray(&x, i, 1);
        x.r.x[i] = R(0.1), x.r.y[i] = R(-0.1), x.r.z[i] = R(0.2);
    }
    no_hits(&h, LANES);
    f->ops->hit(f, LANES, &x, 0, &h);
    for (int i = 0; i < LANES; i++) {
        CHECK(h.id[i], ==, 0);
        CHECK(h.t[i], >, 0);
    }
    surface_free(f);
}

static void odd_rays(void **state)
{
    const double nan = (double)NAN, inf = (double)INFINITY;
    const double odd[][6] = {
        {0, 0, 0, 0, 0, 0},
        {nan, 0, 0, 1, 0, 0},
        {0, 0, 0, nan, nan, nan},
        {0, 5, 0, 0, -inf, 0},
        {inf, 0, 0, -1, 0, 0},
        {0.7, -0.8, -3, 0, 0, 1},
        {0.7, 5, 1.1, 0, -1, 0},
        {-0.9, -0.8, -0.6, 1, 1, 1},
        {-3, 0.5, 0, 1, 0, 0},
        {0.7, 0.5, 5, 0, 0, -1},
        {0.3, 5, 0.1, 0, -1, 0},
        {0.3, -5, 0.1, 0, 1, 0},
        {1.5, -5, 0.1, 0, 1, 0},
        {1.5, 0, 0.1, 0, 0, 1},
        {0.1, -0.3, 0.2, 1, 0, 0},
        {1e30, 1e30, 1e30, -1, -1, -1},
        {0, 0, 0, 1e30, 1e30, 1e30},
        {0, 0, 0, 1e-30, 1e-30, 0},
        {0.1, 5, 0.2, 0, -1e-20, 0},
        /* along axes of cylinders, cones and tori, and along their sides */
        {-0.3, -1.75, 0.35, 0.4, 1.7, -0.3},
        {-0.1, -0.9, 0.2, 0.4, 1.7, -0.3},
        {0.1, -0.1, 0.2, 0.3, 1, 0.5},
        {-0.5, -2.1, -0.8, 0.3, 1, 0.5},
        {0.2, -0.9, 0.2, -0.3, 1.5, -0.1},
        {-2.4, 0.3, 0.5, 1.6, -0.2, -0.3},
    };
    surface *f = make(*(const int *)*state);
    check_odd_rays(f, sizeof odd / sizeof *odd, odd);
    surface_free(f);
}

/* Round surfaces have their seams where the documentation says, and u to the right where w goes down. */
static void ways_around(void **state)
{
    (void)state;
    surface *const f[] = {cone_new((vec3){1, 0, 0}, 2, (vec3){1, 3, 0}, 1, false),
                          torus_new((vec3){0, 1, 0}, (vec3){0, 2, 0}, 2, 0.5),
                          disc_new((vec3){0, 1, 0}, (vec3){0, 3, 0}, 2)};
    const struct {
        int f, part;
        double u, w, Q[3];
    } want[] = {
        {0, 0, 0, 0, {2, 3, 0}},
        {0, 0, 1.5707963, 0, {1, 3, 1}},
        {0, 0, 0, 3.1622777, {3, 0, 0}},
        {0, 0, 3.1415927, 3.1622777, {-1, 0, 0}},
        {0, 1, 0.5, 0.25, {1.5, 3, -0.25}},
        {0, 2, 0.5, 0.25, {1.5, 0, 0.25}},
        {1, 0, 0, 0, {2.5, 1, 0}},
        {1, 0, 0, -1.5707963, {2, 1.5, 0}},
        {1, 0, 1.5707963, 3.1415927, {0, 1, 1.5}},
        {2, 0, 0.5, 0.25, {0.5, 1, -0.25}},
    };
    for (int k = 0; k < (int)(sizeof want / sizeof *want); k++) {
        static partials q;
        int32_t part = want[k].part;
        real u = (real)want[k].u, w = (real)want[k].w;
        f[want[k].f]->ops->eval(f[want[k].f], 1, &part, &u, &w, 1, &q);
        bs_vec3 Q = {(real)want[k].Q[0], (real)want[k].Q[1], (real)want[k].Q[2]};
        CHECK(distance(lane_get(&q.Q, 0), Q), <, 1e-6);
    }
    for (int k = 0; k < 3; k++)
        surface_free(f[k]);
}

/* The frame: unit vectors at right angles, of the scene's hand, about any axis. */
static void frames(void **state)
{
    (void)state;
    const vec3 axes[] = {{0, 1, 0},  {1, 0, 0},       {0, 0, 1},    {0, -2, 0},
                         {-1, 0, 0}, {0.9, 0.1, 0.3}, {1e-6, 0, 0}, {3e5, 2e5, 1e5}};
    for (int k = 0; k < (int)(sizeof axes / sizeof *axes); k++) {
        frame a = frame_about(axes[k]);
        CHECK(vec3_length(vec3_sub(vec3_cross(a.x, a.y), a.z)), <, 1e-15);
        CHECK(vec3_length(vec3_sub(vec3_cross(a.y, a.z), a.x)), <, 1e-15);
        CHECK(vec3_length(vec3_sub(a.y, vec3_unit(axes[k]))), <, 1e-15);
    }
    frame up = frame_about((vec3){0, 7, 0});
    CHECK(up.x.x, ==, 1);
    CHECK(up.y.y, ==, 1);
    CHECK(up.z.z, ==, 1);
}

/* A small ball far away keeps its round shadow: the discriminant does not cancel. */
static void small_and_far(void **state)
{
    (void)state;
    surface *f = sphere_new((vec3){1000, 0, 0}, 0.01);
    static rays x;
    static hits h;
    const double at[5] = {0, 0.005, 0.0099, 0.0101, 0.02};
    for (int i = 0; i < 5; i++) {
        x.r.x[i] = 0, x.r.y[i] = (real)at[i], x.r.z[i] = 0;
        x.s.x[i] = 1, x.s.y[i] = 0, x.s.z[i] = 0;
    }
    no_hits(&h, 5);
    f->ops->hit(f, 5, &x, 0, &h);
    for (int i = 0; i < 5; i++)
        assert_int_equal(h.id[i], i < 3 ? 0 : -1);
    surface_free(f);
}

static void constructors_refuse_nonsense(void **state)
{
    (void)state;
    const vec3 o = {0, 0, 0}, x = {1, 0, 0}, nan = {(double)NAN, 0, 0}, inf = {(double)INFINITY, 0, 0};
    assert_null(plane_new(o, x, x, false));
    assert_null(plane_new(o, x, o, false));
    assert_null(plane_new(o, x, nan, true));
    assert_null(plane_new(o, inf, (vec3){0, 1, 0}, true));
    assert_null(box_new(o, (vec3){1, 0, 1}));
    assert_null(sphere_new(o, 0));
    assert_null(sphere_new(o, -1));
    assert_null(sphere_new(o, (double)NAN));
    assert_null(disc_new(o, o, 1));
    assert_null(disc_new(o, nan, 1));
    assert_null(disc_new(o, x, 0));
    assert_null(cone_new(o, 1, o, 1, false));
    assert_null(cone_new(o, 0, x, 0, false));
    assert_null(cone_new(o, -1, x, 1, true));
    assert_null(cone_new(o, 1, inf, 1, true));
    assert_null(cone_new(o, (double)NAN, x, 1, true));
    assert_null(torus_new(o, x, 1, 1));
    assert_null(torus_new(o, x, 1, 0));
    assert_null(torus_new(o, o, 2, 1));
    assert_null(torus_new(o, x, (double)INFINITY, 1));
    assert_null(torus_new(o, x, (double)NAN, 1));
}

/* The foot of Q + h n/|n| is where Q is, however the ray to it runs, on the same part. */
static void feet_are_below_their_points(void **state)
{
    const int kind = *(const int *)*state;
    surface *f = make(kind);
    int met = 0;
    for (int round = 0; round < 20; round++) {
        static rays x;
        static hits h;
        static partials q;
        int32_t part[LANES], part_there[LANES];
        real u[LANES], w[LANES], u_there[LANES], w_there[LANES], one[LANES];
        for (int i = 0; i < LANES; i++)
            random_ray(&x, i, 1);
        no_hits(&h, LANES);
        f->ops->hit(f, LANES, &x, 3, &h);
        f->ops->locate(f, LANES, &x, h.t, part, u, w);
        f->ops->eval(f, LANES, part, u, w, 1, &q);
        for (int i = 0; i < LANES; i++) { /* rays that end at h = 0.02 or -0.02 over the hit, at t = 1 */
            bs_vec3 Q = lane_get(&q.Q, i), n = bs_normal(lane_get(&q.Qu, i), lane_get(&q.Qw, i));
            const real high = (i % 2 ? R(0.02) : R(-0.02)) / real_sqrt(bs_dot(n, n));
            bs_vec3 to = {Q.x + high * n.x, Q.y + high * n.y, Q.z + high * n.z}, r = lane_get(&x.r, i),
                    s = {to.x - r.x, to.y - r.y, to.z - r.z};
            lane_set(&x.s, i, s);
            one[i] = 1;
            part_there[i] = part[i];
            u_there[i] = w_there[i] = 0;
        }
        f->ops->foot(f, LANES, &x, one, part_there, u_there, w_there);
        for (int i = 0; i < LANES; i++) {
            if (h.id[i] < 0)
                continue;
            bs_vec3 Qu = lane_get(&q.Qu, i), Qw = lane_get(&q.Qw, i);
            const double du = (double)(u_there[i] - u[i]), dw = (double)(w_there[i] - w[i]);
            const bool around = fabs(du) > 3 || fabs(dw) > 3; /* across the end of a turn */
            if (around || !bs_regular(bs_normal(Qu, Qw), Qu, Qw))
                continue;
            met++;
            assert_int_equal(part_there[i], part[i]);
            const double off = fabs(du) * sqrt((double)bs_dot(Qu, Qu)) + fabs(dw) * sqrt((double)bs_dot(Qw, Qw));
            CHECK(off, <=, 200 * EPS * (1 + distance(lane_at(&x, i, 0), lane_at(&x, i, 1))));
        }
    }
    CHECK(met, >, (kind == THIN ? 100 : 250));
    surface_free(f);
}

static const property PROPERTIES[] = {
    {"hits are on the surface", hits_are_on_the_surface, NULL},
    {"feet are below their points", feet_are_below_their_points, NULL},
    {"partials are derivatives", partials_are_derivatives, NULL},
    {"shadows agree with hits", shadows_agree_with_hits, NULL},
    {"dark stays dark", dark_stays_dark, NULL},
    {"only flat ones cannot shade themselves", only_flat_ones_cannot_shade_themselves, NULL},
    {"outward is lit", outward_is_lit, is_convex},
    {"inward is dark", inward_is_dark, is_convex},
    {"own rays meet what is ahead", own_rays_meet_what_is_ahead, NULL},
    {"own hits are on the surface", own_hits_are_on_the_surface, NULL},
    {"rays from elsewhere as by hit", rays_from_elsewhere_as_hit, NULL},
    {"from inside", from_inside, is_convex},
    {"odd rays", odd_rays, NULL},
};

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(box_faces),
        cmocka_unit_test(ways_around),
        cmocka_unit_test(frames),
        cmocka_unit_test(small_and_far),
        cmocka_unit_test(constructors_refuse_nonsense),
    };
    return run_properties("surfaces", PROPERTIES, sizeof PROPERTIES / sizeof *PROPERTIES, NAMES, KINDS, NULL, NULL) +
           cmocka_run_group_tests_name("surfaces, each by itself", tests, NULL, NULL);
}
