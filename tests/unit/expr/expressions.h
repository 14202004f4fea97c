/* Expressions for the tests of the room: parsed, evaluated at a point, and random ones. */
#ifndef KAGE_EXPRESSIONS_H
#define KAGE_EXPRESSIONS_H

#include "support/check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "expr/expr.h"

enum { JET = 6 };

static inline expr *parse(const char *text)
{
    expr_error error;
    expr *e = expr_parse(text, &error);
    if (!e)
        fail_msg("%s: %zu: %s", text, error.offset, error.message);
    return e;
}

static inline void part_of(const expr_jets *j, int i, double jet[JET])
{
    const double all[JET] = {j->v[i], j->u[i], j->w[i], j->uu[i], j->uw[i], j->ww[i]};
    memcpy(jet, all, sizeof all);
}

static inline void jet_at(const expr *e, double u, double w, double jet[JET])
{
    expr_jets out;
    expr_eval(e, 1, &u, &w, 2, &out);
    part_of(&out, 0, jet);
}

static inline double value_at(const expr *e, double u, double w)
{
    expr_jets out;
    expr_eval(e, 1, &u, &w, 0, &out);
    return out.v[0];
}

/* ---- random expressions ---- */

static uint64_t draw_state;

static inline uint32_t draw(uint32_t n)
{
    draw_state = draw_state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(draw_state >> 33) % n;
}

static inline double draw_in(double lo, double hi) { return lo + (hi - lo) * draw(1u << 30) / (double)(1u << 30); }

/* What random expressions are made of: % is another. The first SMOOTH have continuous derivatives. */
enum { SMOOTH = 24 };
/* clang-format off */
static const char *const forms[] = {
    "(%+%)", "(%-%)", "%*%", "%/(2+%^2)", "sin(%)", "cos(%)", "-(%)", "(%)^2", "(%)^3", "exp(sin(%))", "tanh(%)",
    "atan(%)", "sqrt(1+(%)^2)", "log(2+sin(%))", "sinh(sin(%))", "cosh(cos(%))", "noise(%,%)", "atan2(%,3+sin(%))",
    "asin(0.9*sin(%))", "acos(0.9*cos(%))", "tan(cos(%))", "(1.5+cos(%))^sin(%)", "(2+sin(%))^-1.5", "(1+(%)^2)^-2",
    "abs(%)", "floor(%)", "min(%,%,%)", "max(%,%)", "mod(%,2+sin(%))", "clamp(%,-1,sin(%))", "select(%,%,%)",
    "select(%,%,%,%)", "sqrt(%)", "log(%)", "%/%", "(%)^(%)", "asin(%)", "acos(%)", "tan(%)", "exp(%)", "(%)^-3",
    "(%)^0.7", "atan2(%,%)", "mod(%,%)", "smoothstep(%,%,%)", "cosh(%)", "sinh(%)",
};
/* clang-format on */

/* Append a random expression to `text`; smooth ones leave out what has edges. */
static inline void random_expr(char *text, size_t size, int depth, bool smooth)
{
    size_t n = strlen(text);
    if (depth == 0 || n > 1500) {
        static const char *const pieces[] = {"u", "w", "u", "w", "(u-w)"};
        if (draw(3) == 0)
            snprintf(text + n, size - n, "%.3f", draw_in(0, 3));
        else
            snprintf(text + n, size - n, "%s", pieces[draw(5)]);
        return;
    }
    const char *form = forms[draw(smooth ? SMOOTH : (uint32_t)(sizeof forms / sizeof forms[0]))];
    for (const char *f = form; *f; f++)
        if (*f == '%')
            random_expr(text, size, depth - 1, smooth);
        else {
            n = strlen(text);
            text[n] = *f;
            text[n + 1] = 0;
        }
}

static inline expr *random_parsed(char text[4096], int depth, bool smooth)
{
    text[0] = 0;
    random_expr(text, 4096, depth, smooth);
    return parse(text);
}

#endif
