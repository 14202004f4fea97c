/* Bumps by functions, for tests. */
#ifndef KAGE_TESTS_FUNCTION_BUMP_H
#define KAGE_TESTS_FUNCTION_BUMP_H

#include "support/check.h"
#include "texture/bump.h"

/* P(u,w) over all of the plane. The caller frees it. */
static inline bump *function(const char *text)
{
    const double all[2] = {-HUGE_VAL, HUGE_VAL};
    expr_error e;
    expr *x = expr_parse(text, &e);
    assert_non_null(x);
    bump *p = bump_function_new(x, 1, all, all);
    assert_non_null(p);
    return p;
}

#endif
