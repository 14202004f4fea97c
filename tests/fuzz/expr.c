/* An expression: its values, partials, bounds, and POV-Ray's text of it. */
#include "expr/expr.h"
#include "fuzz/fuzz.h"
#include "pov_text/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PLACES = 5, LONGEST = 2048 };

/* The ranges of u and of w, and places in a range as shares of it. */
static const double boxes[][2] = {
    {-1, 2}, {0, 1}, {0, 0}, {0.25, 0.2500001}, {-1e6, 1e6}, {2, 7}, {-HUGE_VAL, HUGE_VAL}};
static const double share[PLACES] = {0, 1, 0.5, 0.25, 0.828125};

static bool same(double a, double b) { return a == b || (isnan(a) && isnan(b)); }

static bool inside(const double range[2], double x) { return !isfinite(x) || (range[0] <= x && x <= range[1]); }

static double place_in(const double range[2], double s)
{
    return isfinite(range[0]) ? fmin(range[0] + s * (range[1] - range[0]), range[1]) : ldexp(s - 0.3, 40);
}

static void check_bounds(const expr *e, const double u[2], const double w[2])
{
    expr_bounds b, also;
    expr_hessians h;
    expr_bound_gradient(e, u[0], u[1], w[0], w[1], &b);
    expr_bound_hessian(e, u[0], u[1], w[0], w[1], &also, &h);
    HOLDS(memcmp(&b, &also, sizeof b) == 0, "bounds with and without second partials differ");
    HOLDS(b.v[0] <= b.v[1] && b.u[0] <= b.u[1] && b.w[0] <= b.w[1], "bounds %g..%g, %g..%g, %g..%g", b.v[0], b.v[1],
          b.u[0], b.u[1], b.w[0], b.w[1]);
    HOLDS(h.uu[0] <= h.uu[1] && h.uw[0] <= h.uw[1] && h.ww[0] <= h.ww[1], "second bounds %g..%g, %g..%g, %g..%g",
          h.uu[0], h.uu[1], h.uw[0], h.uw[1], h.ww[0], h.ww[1]);
    double x[PLACES * PLACES], y[PLACES * PLACES];
    for (int k = 0; k < PLACES * PLACES; k++) {
        x[k] = place_in(u, share[k % PLACES]);
        y[k] = place_in(w, share[k / PLACES]);
    }
    expr_jets all, first, value;
    expr_eval(e, PLACES * PLACES, x, y, 2, &all);
    expr_eval(e, PLACES * PLACES, x, y, 1, &first);
    expr_eval(e, PLACES * PLACES, x, y, 0, &value);
    for (int k = 0; k < PLACES * PLACES; k++) {
        HOLDS(same(all.v[k], value.v[k]) && same(all.v[k], first.v[k]), "value %g, %g with first, %g with all partials",
              value.v[k], first.v[k], all.v[k]);
        HOLDS(same(all.u[k], first.u[k]) && same(all.w[k], first.w[k]), "partials with and without second ones differ");
        HOLDS(inside(b.v, all.v[k]), "at %.17g %.17g the value %.17g is outside of %.17g..%.17g", x[k], y[k], all.v[k],
              b.v[0], b.v[1]);
    }
}

/* POV-Ray has no infinity and no NaN, and brackets must match. */
static void check_pov(const char *text)
{
    int depth = 0;
    for (const char *c = text; *c; c++) {
        depth += *c == '(' ? 1 : *c == ')' ? -1 : 0;
        HOLDS(depth >= 0 && *c >= ' ' && *c < 0x7f, "POV-Ray's text '%s'", text);
    }
    HOLDS(depth == 0 && !strstr(text, "nan") && !strstr(text, "inf"), "POV-Ray's text '%s'", text);
}

void fuzz_expr(const uint8_t *data, size_t size)
{
    char text[LONGEST + 1];
    if (size > LONGEST || memchr(data, 0, size))
        return;
    if (size)
        memcpy(text, data, size);
    text[size] = 0;
    expr_error why = {0, ""};
    expr *e = expr_parse(text, &why);
    HOLDS(!e == !!why.message[0], "message '%s'", why.message);
    if (!e) {
        HOLDS(why.offset <= size, "offset %zu of %zu", why.offset, size);
        for (const char *c = why.message; *c; c++)
            HOLDS((unsigned char)*c >= ' ' && *c != 0x7f, "message '%s'", why.message);
        return;
    }
    const int n = (int)(sizeof boxes / sizeof *boxes);
    for (int k = 0; k < n; k++) {
        check_bounds(e, boxes[k], boxes[k]);
        check_bounds(e, boxes[k], boxes[(k + 3) % n]);
    }
    char *pov = expr_pov(e);
    if (pov)
        check_pov(pov);
    free(pov);
    expr_free(e);
}
