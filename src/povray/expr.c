/* From the program back to a text: each operation joins the texts of its operands, which nothing else uses. Sums stay
 * in the order in which kage adds, so parentheses stand wherever POV-Ray, from left to right, would add otherwise.
 *
 * Seen in POV-Ray 3.7: its functions have no ^ but pow, which is C's; mod is C's fmod, ln the natural logarithm, and
 * select compares with 0 as ours does.
 */
#include "povray/expr.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/errors.h"
#include "expr/program.h"
#include "povray/text.h"

enum binding { SUM, PRODUCT, ATOM };

typedef struct piece {
    char *text; /* owned; NULL: there is none */
    enum binding binds;
} piece;

static const char *const names[] = {
    [OP_SIN] = "sin",        [OP_COS] = "cos",   [OP_TAN] = "tan",   [OP_ASIN] = "asin",   [OP_ACOS] = "acos",
    [OP_ATAN] = "atan",      [OP_SINH] = "sinh", [OP_COSH] = "cosh", [OP_TANH] = "tanh",   [OP_EXP] = "exp",
    [OP_LOG] = "ln",         [OP_SQRT] = "sqrt", [OP_ABS] = "abs",   [OP_FLOOR] = "floor", [OP_MOD] = "mod",
    [OP_ATAN2] = "atan2",    [OP_POW] = "pow",   [OP_MIN] = "min",   [OP_MAX] = "max",     [OP_SELECT] = "select",
    [OP_SELECT4] = "select",
};

static piece make(enum binding binds, const char *fmt, ...) KAGE_PRINTF(2, 3);
static piece make(enum binding binds, const char *fmt, ...)
{
    va_list args, again;
    va_start(args, fmt);
    va_copy(again, args);
    int n = vsnprintf(NULL, 0, fmt, args);
    piece p = {n < 0 ? NULL : malloc((size_t)n + 1), binds};
    if (p.text)
        vsnprintf(p.text, (size_t)n + 1, fmt, again);
    va_end(again);
    va_end(args);
    return p;
}

static piece number(double k)
{
    pov_digits d = pov_exact(k);
    return !isfinite(k)                  ? (piece){0}
           : k == 3.14159265358979323846 ? make(ATOM, "pi")
                                         : make(k < 0 ? SUM : ATOM, "%s", d.text);
}

/* `a op b`; on the right what does not bind closer, or begins with a sign, is put in parentheses. */
static piece infix(piece a, const char *op, piece b, enum binding binds)
{
    bool left = a.binds < binds, right = b.binds <= binds || b.text[0] == '-';
    return make(binds, "%s%s%s%s%s%s%s", left ? "(" : "", a.text, left ? ")" : "", op, right ? "(" : "", b.text,
                right ? ")" : "");
}

static piece with_constant(enum expr_op op, piece a, double k)
{
    if (op == OP_MULK && k == -1)
        return a.binds < ATOM ? make(PRODUCT, "-(%s)", a.text) : make(PRODUCT, "-%s", a.text);
    piece b = number(op == OP_ADDK ? fabs(k) : k), z = {0};
    if (b.text && op == OP_ADDK)
        z = infix(a, k < 0 ? " - " : " + ", b, SUM);
    else if (b.text && op == OP_MULK) {
        b.binds = ATOM; /* a leading sign needs no parentheses */
        z = infix(b, "*", a, PRODUCT);
    } else if (b.text)
        z = make(ATOM, "pow(%s, %s)", a.text, b.text);
    free(b.text);
    return z;
}

static piece operation(const expr_code *c, const piece *x)
{
    switch ((enum expr_op)c->op) {
    case OP_CONST:
        return number(c->k);
    case OP_ADDK:
    case OP_MULK:
    case OP_POWI:
        return with_constant((enum expr_op)c->op, x[0], c->k);
    case OP_ADD:
        return infix(x[0], " + ", x[1], SUM);
    case OP_SUB:
        return infix(x[0], " - ", x[1], SUM);
    case OP_MUL:
        return infix(x[0], "*", x[1], PRODUCT);
    case OP_DIV:
        return infix(x[0], "/", x[1], PRODUCT);
    case OP_NOISE:
        return (piece){0};
    case OP_MOD:
    case OP_ATAN2:
    case OP_POW:
    case OP_MIN:
    case OP_MAX:
        return make(ATOM, "%s(%s, %s)", names[c->op], x[0].text, x[1].text);
    case OP_SELECT:
        return make(ATOM, "select(%s, %s, %s)", x[0].text, x[1].text, x[2].text);
    case OP_SELECT4:
        return make(ATOM, "select(%s, %s, %s, %s)", x[0].text, x[1].text, x[2].text, x[3].text);
    default:
        return make(ATOM, "%s(%s)", names[c->op], x[0].text);
    }
}

static int operands(enum expr_op op)
{
    return op == OP_CONST ? 0 : op < OP_ADD ? 1 : op < OP_SELECT ? 2 : op == OP_SELECT ? 3 : 4;
}

char *expr_pov(const expr *e)
{
    piece slot[EXPR_SLOTS] = {make(ATOM, "u"), make(ATOM, "w")};
    bool good = slot[0].text && slot[1].text;
    for (int k = 0; good && k < e->count; k++) {
        const expr_code *c = &e->code[k];
        const int n = operands((enum expr_op)c->op);
        piece x[4];
        for (int i = 0; i < n; i++)
            x[i] = slot[c->arg[i]];
        piece z = operation(c, x);
        for (int i = 0; i < n; i++)
            if (c->arg[i] > 1) {
                free(slot[c->arg[i]].text);
                slot[c->arg[i]].text = NULL;
            }
        slot[c->z] = z;
        good = z.text;
    }
    char *text = good ? slot[e->result].text : NULL;
    for (int k = 0; k < EXPR_SLOTS; k++)
        if (slot[k].text != text)
            free(slot[k].text);
    return text;
}
