/* The functions of bumpshadow.h in loops over arrays, for methods.c in float and methods_double.c. No formula is here:
 * each line of FUNCTIONS reads the arguments of one place, calls the header and stores the result.
 */
#include "methods.h"

#include "bumpshadow.h"

/* ---- numbers of one place ---- */

typedef struct place_in {
    void *const *x;
    const ptrdiff_t *step;
    ptrdiff_t i;
} place_in;

static inline bs_real real_at(place_in c, int k) { return ((const bs_real *)c.x[k])[c.i * c.step[k]]; }
static inline int int_at(place_in c, int k) { return ((const int *)c.x[k])[c.i * c.step[k]]; }

static inline bs_vec3 vec_at(place_in c, int k)
{
    const bs_real *x = (const bs_real *)c.x[k] + c.i * c.step[k];
    return (bs_vec3){x[0], x[1], x[2]};
}

static inline bs_view view_at(place_in c, int k)
{
    return (bs_view){real_at(c, k), real_at(c, k + 1), real_at(c, k + 2)};
}

static inline bs_bump bump_at(place_in c, int k)
{
    return (bs_bump){real_at(c, k),     real_at(c, k + 1), real_at(c, k + 2),
                     real_at(c, k + 3), real_at(c, k + 4), real_at(c, k + 5)};
}

static inline bs_slab slab_at(place_in c, int k) { return (bs_slab){real_at(c, k), real_at(c, k + 1)}; }

static inline bs_march march_at(place_in c, int k)
{
    return (bs_march){real_at(c, k), real_at(c, k + 1), int_at(c, k + 2)};
}

static inline bs_way way_at(place_in c, int k)
{
    return (bs_way){real_at(c, k), view_at(c, k + 1), real_at(c, k + 4), real_at(c, k + 5), real_at(c, k + 6)};
}

static inline void put(place_in c, int k, bs_real r) { ((bs_real *)c.x[k])[c.i * c.step[k]] = r; }
static inline void put_int(place_in c, int k, int r) { ((int *)c.x[k])[c.i * c.step[k]] = r; }

static inline void put_vec(place_in c, int k, bs_vec3 r)
{
    bs_real *x = (bs_real *)c.x[k] + c.i * c.step[k];
    x[0] = r.x;
    x[1] = r.y;
    x[2] = r.z;
}

static inline void put_view(place_in c, int k, bs_view r)
{
    put(c, k, r.sn);
    put(c, k + 1, r.a);
    put(c, k + 2, r.b);
}

static inline void put_place(place_in c, int k, bs_place r)
{
    put(c, k, r.u);
    put(c, k + 1, r.w);
}

static inline void put_offset(place_in c, int k, bs_offset r)
{
    put_vec(c, k, r.Qu);
    put_vec(c, k + 1, r.Qw);
}

static inline void put_slab(place_in c, int k, bs_slab r)
{
    put(c, k, r.front);
    put(c, k + 1, r.back);
}

static inline void put_shift(place_in c, int k, bs_shift r)
{
    put(c, k, r.tau);
    put_int(c, k + 1, r.order);
}

static inline void put_march(place_in c, int k, bs_march r)
{
    put(c, k, r.tau);
    put(c, k + 1, r.gap);
    put_int(c, k + 2, r.found);
}

static inline void put_way(place_in c, int k, bs_way r)
{
    put(c, k, r.side);
    put_view(c, k + 1, r.d);
    put(c, k + 4, r.curvature);
    put(c, k + 5, r.P);
    put(c, k + 6, r.end);
}

static inline void put_turn(place_in c, int k, bs_turn r)
{
    put(c, k, r.A);
    put(c, k + 1, r.B);
}

static inline void put_bearing(place_in c, int k, bs_bearing r)
{
    put(c, k, r.bearing);
    put(c, k + 1, r.rise);
}

/* ---- the functions ---- */

/* Order 0 needs of the view only s.n/|n|, and so no partials of Q. */
static inline bs_real tau0(bs_vec3 n, bs_vec3 s, bs_real P)
{
    const bs_vec3 none = {0, 0, 0};
    return bs_tau0(bs_view_of(s, n, none, none), P);
}

static inline bs_real tau2(bs_view v, bs_bump p, bs_real A)
{
    const bs_real B = bs_slope(v, p);
    return bs_tau2(v, B, bs_discriminant(A, B, p.P), p.P);
}

/* clang-format off */
#define FUNCTIONS(X) \
    X(normal, "vv", "v", put_vec(c, 2, bs_normal(vec_at(c, 0), vec_at(c, 1)))) \
    X(regular, "vvv", "i", put_int(c, 3, bs_regular(vec_at(c, 0), vec_at(c, 1), vec_at(c, 2)))) \
    X(perturbed_normal, "vvvrr", "v", \
      put_vec(c, 5, bs_perturbed_normal(vec_at(c, 0), vec_at(c, 1), vec_at(c, 2), real_at(c, 3), real_at(c, 4)))) \
    X(view, "vvvv", "rrr", put_view(c, 4, bs_view_of(vec_at(c, 0), vec_at(c, 1), vec_at(c, 2), vec_at(c, 3)))) \
    X(place, "rrrrrr", "rr", put_place(c, 6, bs_place_of(view_at(c, 0), real_at(c, 3), real_at(c, 4), real_at(c, 5)))) \
    X(offset, "vvvvvvr", "vv", \
      put_offset(c, 7, bs_offset_of(vec_at(c, 0), vec_at(c, 1), vec_at(c, 2), vec_at(c, 3), vec_at(c, 4), \
                                    vec_at(c, 5), real_at(c, 6)))) \
    X(curvature, "rrrvvvv", "r", \
      put(c, 7, bs_curvature(view_at(c, 0), vec_at(c, 3), vec_at(c, 4), vec_at(c, 5), vec_at(c, 6)))) \
    X(gap, "rrrrrr", "r", put(c, 6, bs_gap(view_at(c, 0), real_at(c, 3), real_at(c, 4), real_at(c, 5)))) \
    X(tau0, "vvr", "r", put(c, 3, tau0(vec_at(c, 0), vec_at(c, 1), real_at(c, 2)))) \
    X(slope, "rrrrrrrrr", "r", put(c, 9, bs_slope(view_at(c, 0), bump_at(c, 3)))) \
    X(tau1, "rrrrrrrrr", "r", put(c, 9, bs_tau1(view_at(c, 0), bump_at(c, 3)))) \
    X(quadratic, "rrrrrrrrr", "r", put(c, 9, bs_quadratic(view_at(c, 0), bump_at(c, 3)))) \
    X(quadratic_plus, "rrrrrrrrrr", "r", \
      put(c, 10, bs_quadratic_plus(view_at(c, 0), bump_at(c, 3), real_at(c, 9)))) \
    X(discriminant, "rrr", "r", put(c, 3, bs_discriminant(real_at(c, 0), real_at(c, 1), real_at(c, 2)))) \
    X(tau2, "rrrrrrrrr", "r", \
      put(c, 9, tau2(view_at(c, 0), bump_at(c, 3), bs_quadratic(view_at(c, 0), bump_at(c, 3))))) \
    X(tau2_plus, "rrrrrrrrrr", "r", \
      put(c, 10, tau2(view_at(c, 0), bump_at(c, 3), \
                      bs_quadratic_plus(view_at(c, 0), bump_at(c, 3), real_at(c, 9))))) \
    X(slab, "rrrrr", "rr", put_slab(c, 5, bs_slab_of(view_at(c, 0), real_at(c, 3), real_at(c, 4)))) \
    X(shift, "iirrrrrrrrrrrr", "ri", \
      put_shift(c, 14, bs_shift_of(int_at(c, 0), int_at(c, 1), view_at(c, 2), real_at(c, 5), bump_at(c, 6), \
                                   slab_at(c, 12)))) \
    X(march_start, "rr", "rri", put_march(c, 2, bs_march_start(slab_at(c, 0)))) \
    X(march_tau, "rrii", "r", put(c, 4, bs_march_tau(slab_at(c, 0), int_at(c, 2), int_at(c, 3)))) \
    X(march_step, "rrirrrrr", "rri", \
      put_march(c, 8, bs_march_step(march_at(c, 0), real_at(c, 3), real_at(c, 4), view_at(c, 5)))) \
    X(residual, "rrrrrrrrrrr", "r", \
      put(c, 11, bs_residual(view_at(c, 0), real_at(c, 3), real_at(c, 4), bump_at(c, 5)))) \
    X(pixels, "vvrr", "r", put(c, 4, bs_pixels(vec_at(c, 0), vec_at(c, 1), real_at(c, 2), real_at(c, 3)))) \
    X(way, "rrrrrrrr", "rrrrrrr", \
      put_way(c, 8, bs_way_of(real_at(c, 0), view_at(c, 1), real_at(c, 4), real_at(c, 5), real_at(c, 6), \
                              real_at(c, 7)))) \
    X(turn, "rrrvvvvvv", "rr", \
      put_turn(c, 9, bs_turn_of(view_at(c, 0), vec_at(c, 3), vec_at(c, 4), vec_at(c, 5), vec_at(c, 6), vec_at(c, 7), \
                                vec_at(c, 8)))) \
    X(way_step, "rii", "r", put(c, 3, bs_way_step(real_at(c, 0), int_at(c, 1), int_at(c, 2)))) \
    X(way_below, "rrrrrrrrr", "i", put_int(c, 9, bs_way_below(way_at(c, 0), real_at(c, 7), real_at(c, 8)))) \
    X(bearing, "rrrrr", "rr", put_bearing(c, 5, bs_bearing_of(view_at(c, 0), real_at(c, 3), real_at(c, 4)))) \
    X(horizon, "rrr", "r", put(c, 3, bs_horizon(real_at(c, 0), real_at(c, 1), real_at(c, 2)))) \
    X(horizon_share, "rrrr", "r", \
      put(c, 4, bs_horizon_share(real_at(c, 0), real_at(c, 1), real_at(c, 2), real_at(c, 3))))
/* clang-format on */

#define LOOP(name, in, out, one)                                                                                       \
    static void loop_##name(ptrdiff_t n, void *const *x, const ptrdiff_t *step)                                        \
    {                                                                                                                  \
        for (place_in c = {x, step, 0}; c.i < n; c.i++)                                                                \
            one;                                                                                                       \
    }
FUNCTIONS(LOOP)

#ifdef BS_DOUBLE
#define TABLE methods_double
#else
#define TABLE methods_float
#endif

#define ROW(name, in, out, one) {#name, in, out, loop_##name},
const methods_loop TABLE[] = {FUNCTIONS(ROW){0, 0, 0, 0}};
