/* Golden vectors of bumpshadow.h: their numbers as bs_real, and comparisons to rounding, for float and double.
 *
 * Tolerances, relative to the vector's or number's own size: straightforward code reaches 1e-14 in double and 1e-5 in
 * float, where a sum does not cancel. Where it does, `size` is that of its terms.
 */
#ifndef KAGE_GOLDEN_VALUES_H
#define KAGE_GOLDEN_VALUES_H

#include <math.h>

#include "bumpshadow.h"
#include "support/check.h"
#include "support/golden_json.h"

#ifdef BS_DOUBLE
#define TOLERANCE 1e-13
#else
#define TOLERANCE 3e-5
#endif

static inline double golden_double(struct fy_node *c, const char *key)
{
    double x;
    assert_true(golden_number(golden_get(c, key), &x));
    return x;
}

static inline bs_real number(struct fy_node *c, const char *key) { return (bs_real)golden_double(c, key); }

/* All numbers of a list, at most n; how many there are. */
static inline int golden_list(struct fy_node *list, int n, double *x)
{
    const int count = fy_node_sequence_item_count(list);
    CHECK(count, <=, n);
    for (int i = 0; i < count; i++)
        assert_true(golden_number(fy_node_sequence_get_by_index(list, i), &x[i]));
    return count;
}

static inline bs_vec3 vector_of(const double *x)
{
    bs_vec3 r = {(bs_real)x[0], (bs_real)x[1], (bs_real)x[2]};
    return r;
}

static inline bs_vec3 vector(struct fy_node *c, const char *key)
{
    double x[3];
    assert_int_equal(golden_list(golden_get(c, key), 3, x), 3);
    return vector_of(x);
}

static inline void near(int line, double got, double want, double size)
{
    if (!(fabs(got - want) <= TOLERANCE * size)) {
        print_error("case %d: %.17g, expected %.17g within %g\n", line, got, want, TOLERANCE * size);
        fail();
    }
}

static inline void near_vector(int line, bs_vec3 got, bs_vec3 want)
{
    double size = sqrt((double)bs_dot(want, want));
    near(line, (double)got.x, (double)want.x, size);
    near(line, (double)got.y, (double)want.y, size);
    near(line, (double)got.z, (double)want.z, size);
}

#endif
