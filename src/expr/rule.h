/* A rule computes the value and the partials of a function at one point, without branches. RULE1(f) defines the stage
 * rule_f, for an expr_op, from the rule f_at. The compiler removes the partials that a loop does not store.
 */
#ifndef KAGE_EXPR_RULE_H
#define KAGE_EXPR_RULE_H

#include "base/real.h"
#include "expr/jets.h"
#include "math/kmath.h"

/* f(a), df/da, d2f/da2 */
typedef struct rule1 {
    double f, d, dd;
} rule1;

/* f(a,b) and its partials */
typedef struct rule2 {
    double f, a, b, aa, ab, bb;
} rule2;

/* f(a,b,c) and its partials */
typedef struct rule3 {
    double f, a, b, c, aa, ab, ac, bb, bc, cc;
} rule3;

#define RULE_EACH(...)                                                                                                 \
    for (int i = 0; i < n; i++) {                                                                                      \
        __VA_ARGS__                                                                                                    \
    }

#define RULE1(name)                                                                                                    \
    STAGE static void rule_##name(int n, int order, const double *restrict a, double *restrict f, double *restrict d,  \
                                  double *restrict dd)                                                                 \
    {                                                                                                                  \
        if (order == 0)                                                                                                \
            RULE_EACH(f[i] = name##_at(a[i]).f;)                                                                       \
        else if (order == 1)                                                                                           \
            RULE_EACH(const rule1 r = name##_at(a[i]); f[i] = r.f, d[i] = r.d;)                                        \
        else                                                                                                           \
            RULE_EACH(const rule1 r = name##_at(a[i]); f[i] = r.f, d[i] = r.d, dd[i] = r.dd;)                          \
    }

#define RULE2(name)                                                                                                    \
    STAGE static void rule_##name(int n, int order, const double *restrict a, const double *restrict b,                \
                                  double *restrict f, expr_partials *restrict p)                                       \
    {                                                                                                                  \
        if (order == 0)                                                                                                \
            RULE_EACH(f[i] = name##_at(a[i], b[i]).f;)                                                                 \
        else if (order == 1)                                                                                           \
            RULE_EACH(const rule2 r = name##_at(a[i], b[i]); f[i] = r.f, p->d[0][i] = r.a, p->d[1][i] = r.b;)          \
        else                                                                                                           \
            RULE_EACH(const rule2 r = name##_at(a[i], b[i]); f[i] = r.f, p->d[0][i] = r.a, p->d[1][i] = r.b;           \
                      p->dd[0][i] = r.aa, p->dd[1][i] = r.ab, p->dd[3][i] = r.bb;)                                     \
    }

#define RULE3(name)                                                                                                    \
    STAGE static void rule_##name(int n, int order, const double *restrict a, const double *restrict b,                \
                                  const double *restrict c, double *restrict f, expr_partials *restrict p)             \
    {                                                                                                                  \
        if (order == 0)                                                                                                \
            RULE_EACH(f[i] = name##_at(a[i], b[i], c[i]).f;)                                                           \
        else if (order == 1)                                                                                           \
            RULE_EACH(const rule3 r = name##_at(a[i], b[i], c[i]);                                                     \
                      f[i] = r.f, p->d[0][i] = r.a, p->d[1][i] = r.b, p->d[2][i] = r.c;)                               \
        else                                                                                                           \
            RULE_EACH(const rule3 r = name##_at(a[i], b[i], c[i]);                                                     \
                      f[i] = r.f, p->d[0][i] = r.a, p->d[1][i] = r.b, p->d[2][i] = r.c;                                \
                      p->dd[0][i] = r.aa, p->dd[1][i] = r.ab, p->dd[2][i] = r.ac;                                      \
                      p->dd[3][i] = r.bb, p->dd[4][i] = r.bc, p->dd[5][i] = r.cc;)                                     \
    }

#endif
