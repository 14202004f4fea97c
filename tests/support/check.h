/* Checks that print the values of both sides when they fail, for C tests; and EPS, the rounding of `real`.
 *
 *     CHECK(met, >, 40);                       test_mesh.c:12: met > 40, where it is 7 > 40
 *     NEAR(shift.tau, want, 8 * EPS);          |shift.tau - want| <= 8 * EPS, with both values and the distance
 *     BETWEEN(0, lit, 1);                      0 <= lit <= 1
 *
 * Values are compared and printed as doubles. A comparison with NaN fails. For strings, pointers and exact integers
 * there are cmocka's own assert_string_equal, assert_non_null and assert_int_equal, which print them too.
 */
#ifndef KAGE_CHECK_H
#define KAGE_CHECK_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#ifdef KAGE_DOUBLE
#define EPS 2.2e-16
#else
#define EPS 1.2e-7
#endif

#define CHECK(a, op, b)                                                                                                \
    do {                                                                                                               \
        const double check_a = (double)(a), check_b = (double)(b);                                                     \
        if (!(check_a op check_b))                                                                                     \
            fail_msg("%s %s %s, where it is %.17g %s %.17g", #a, #op, #b, check_a, #op, check_b);                      \
    } while (0)

#define NEAR(got, want, within)                                                                                        \
    do {                                                                                                               \
        const double check_got = (double)(got), check_want = (double)(want), check_within = (double)(within);          \
        if (!(fabs(check_got - check_want) <= check_within))                                                           \
            fail_msg("%s is %.17g, expected %s = %.17g within %g: %g off", #got, check_got, #want, check_want,         \
                     check_within, fabs(check_got - check_want));                                                      \
    } while (0)

#define BETWEEN(low, x, high)                                                                                          \
    do {                                                                                                               \
        const double check_low = (double)(low), check_x = (double)(x), check_high = (double)(high);                    \
        if (!(check_low <= check_x && check_x <= check_high))                                                          \
            fail_msg("%s is %.17g, expected %.17g .. %.17g", #x, check_x, check_low, check_high);                      \
    } while (0)

#endif
