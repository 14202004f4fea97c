/* Decompiles an expression's program to text: each operation joins the texts of its operands, which are used once.
 * Parentheses keep the order of kage's sums, since POV-Ray adds from left to right.
 *
 * POV-Ray 3.7 has pow, as in C, instead of ^; mod is C's fmod, ln the natural logarithm, and select compares with 0 as
 * ours does.
 */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "expr/operation.h"
#include "pov_text/text.h"

/* In bytes. Nested formulas that have an operand twice double its text each time; other expressions of EXPR_MAX_TEXT
 * bytes need far less. */
enum { LONGEST = 1 << 18 };

enum binding { SUM, PRODUCT, ATOM };

typedef struct piece {
    char *text; /* owned; NULL: failed */
    enum binding binds;
} piece;

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

/* z, after freeing a text that went into it. */
static piece freeing(piece a, piece z)
{
    free(a.text);
    return z;
}

static piece number(double k)
{
    pov_digits d = pov_exact(k);
    return !isfinite(k) ? (piece){0} : k == KM_PI ? make(ATOM, "pi") : make(k < 0 ? SUM : ATOM, "%s", d.text);
}

/* `a op b`. The right operand has parentheses unless it binds closer and begins without a sign. */
static piece infix(piece a, const char *op, piece b, enum binding binds)
{
    bool left = a.binds < binds, right = b.binds <= binds || b.text[0] == '-';
    return make(binds, "%s%s%s%s%s%s%s", left ? "(" : "", a.text, left ? ")" : "", op, right ? "(" : "", b.text,
                right ? ")" : "");
}

static piece multiply_k(double k, piece a)
{
    if (k == -1)
        return a.binds < ATOM ? make(PRODUCT, "-(%s)", a.text) : make(PRODUCT, "-%s", a.text);
    piece b = number(k);
    b.binds = ATOM; /* a leading sign needs no parentheses */
    return b.text ? freeing(b, infix(b, "*", a, PRODUCT)) : b;
}

static piece add_k(piece a, double k)
{
    piece b = number(fabs(k));
    return b.text ? freeing(b, infix(a, k < 0 ? " - " : " + ", b, SUM)) : b;
}

/* The operands $1 to $4 put into a formula. */
static piece formula(const char *text, const piece *x)
{
    piece z = make(ATOM, "(");
    while (z.text && *text) {
        const size_t n = strcspn(text, "$");
        const char *put = text[n] ? x[text[n + 1] - '1'].text : "";
        z = freeing(z, make(ATOM, text[n] ? "%s%.*s(%s)" : "%s%.*s%s", z.text, (int)n, text, put));
        text += text[n] ? n + 2 : n;
    }
    return z.text ? freeing(z, make(ATOM, "%s)", z.text)) : z;
}

static piece call(const char *name, int n, const piece *x)
{
    piece z = make(ATOM, "%s(%s", name, x[0].text);
    for (int i = 1; z.text && i < n; i++)
        z = freeing(z, make(ATOM, "%s, %s", z.text, x[i].text));
    return z.text ? freeing(z, make(ATOM, "%s)", z.text)) : z;
}

static piece power_k(piece a, double k)
{
    piece b = number(k);
    return b.text ? freeing(b, call("pow", 2, (piece[]){a, b})) : b;
}

static piece operation(const expr_code *c, const piece *x)
{
    const expr_op *op = c->op;
    if (op == &expr_constant)
        return number(c->k);
    if (op == &expr_add_k)
        return add_k(x[0], c->k);
    if (op == &expr_multiply_k)
        return multiply_k(c->k, x[0]);
    if (op == &expr_power_k)
        return power_k(x[0], c->k);
    if (!op->pov)
        return (piece){0};
    if (op->binding != EXPR_CALL)
        return infix(x[0], op->pov, x[1], op->binding == EXPR_SUM ? SUM : PRODUCT);
    return strchr(op->pov, '$') ? formula(op->pov, x) : call(op->pov, op->operands, x);
}

char *expr_pov(const expr *e)
{
    piece slot[EXPR_SLOTS] = {make(ATOM, "u"), make(ATOM, "w")};
    bool good = slot[0].text && slot[1].text;
    for (int k = 0; good && k < e->count; k++) {
        const expr_code *c = &e->code[k];
        const int n = c->op->operands;
        piece x[EXPR_OPERANDS];
        for (int i = 0; i < n; i++)
            x[i] = slot[c->arg[i]];
        piece z = operation(c, x);
        for (int i = 0; i < n; i++)
            if (c->arg[i] > 1) {
                free(slot[c->arg[i]].text);
                slot[c->arg[i]].text = NULL;
            }
        slot[c->z] = z;
        good = z.text && strlen(z.text) <= LONGEST;
    }
    char *text = good ? slot[e->result].text : NULL;
    for (int k = 0; k < EXPR_SLOTS; k++)
        if (slot[k].text != text)
            free(slot[k].text);
    return text;
}
