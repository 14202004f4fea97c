/* The number type of the tracer, and how its loops become SIMD.
 *
 * `real` is float; `make REAL=double` builds the same code in double, for verification.
 */
#ifndef KAGE_BASE_REAL_H
#define KAGE_BASE_REAL_H

#include <math.h>

#ifdef KAGE_DOUBLE
typedef double real;
#define REAL_NAME "double"
#define REAL_INTEGER 6755399441055744.0 /* 1.5 * 2^52 */
#define REAL_WHOLE 4503599627370496.0   /* 2^52: numbers from here on have no fraction */
#define REAL_ROUNDING 4e-16             /* twice the relative rounding error of a sum or product */
#define real_sqrt(x) sqrt(x)
#define real_abs(x) fabs(x)
#else
typedef float real;
#define REAL_NAME "float"
#define REAL_INTEGER 12582912.0f /* 1.5 * 2^23 */
#define REAL_WHOLE 8388608.0f    /* 2^23 */
#define REAL_ROUNDING 2.4e-7
#define real_sqrt(x) sqrtf(x)
#define real_abs(x) fabsf(x)
#endif

/* A literal of type real: R(0.5). */
#define R(x) ((real)(x))

/* The t of a ray that hits nothing, which is Z in the film. Larger numbers count as no value, and colours end here. */
#define REAL_FAR ((real)1e30)
#define REAL_IS_FAR(x) (!(real_abs(x) < REAL_FAR)) /* NaN, infinite, or no place and no colour any more */

/* The least normal number of float; smaller squares of lengths have no digits. */
#define REAL_LEAST ((real)1.17549435e-38)

/* Marks a stage: a static function that is one plain loop over lanes. It is compiled for any x86-64, for AVX2 and (by
 * gcc) for AVX-512, and the loader chooses one. All give the same bytes: stages use only what IEEE 754 rounds exactly
 * (+ - * / sqrt, comparisons, conversions), without contraction (-ffp-contract=off). Static, as clang 14 exports clones
 * under another name, and with a name that no other stage of the library has, as clang 14 exports what chooses between
 * clones. Other processors build the same source without clones. */
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(KAGE_NO_CLONES)
#if defined(__clang__)
#define STAGE __attribute__((target_clones("default", "avx2")))
#else
#define STAGE __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#endif
#else
#define STAGE
#endif

/* As the SSE instructions: y where x or y is NaN. (fmin and fmax treat NaN otherwise, which costs a branch.) */
static inline real real_min(real x, real y) { return x < y ? x : y; }
static inline real real_max(real x, real y) { return x > y ? x : y; }
static inline double lesser(double x, double y) { return x < y ? x : y; }
static inline double greater(double x, double y) { return x > y ? x : y; }
static inline float lesser_float(float x, float y) { return x < y ? x : y; }
static inline float greater_float(float x, float y) { return x > y ? x : y; }

/* floor without libm, which SSE2 would need: adding REAL_WHOLE, with the sign of x, leaves no bits for a fraction. From
 * there on every number is whole. */
static inline real real_floor(real x)
{
    real whole = x < 0 ? -REAL_WHOLE : REAL_WHOLE, f = (x + whole) - whole;
    f = f > x ? f - 1 : f;
    return real_abs(x) < REAL_WHOLE ? f : x;
}

#endif
