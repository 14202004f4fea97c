/* A recursive-descent parser, one function for each rule of the grammar. It emits each operation after its operands.
 *
 *   sum      product { ("+" | "-") product }
 *   product  signed { ("*" | "/") signed }
 *   signed   { "+" | "-" } primary [ "^" signed ]      so -u^2 is -(u^2), and 2^u^w is 2^(u^w)
 *   primary  number | "u" | "w" | "pi" | function "(" sum { "," sum } ")" | "(" sum ")"
 */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/errors.h"
#include "base/spelling.h"
#include "expr/operation.h"

enum { LONGEST_NAME = 24 };

/* All functions of the language. */
static const expr_op *const *const tables[] = {expr_elementary, expr_functions, expr_choices};
enum { TABLES = sizeof tables / sizeof *tables };

typedef struct parser {
    const char *text, *at; /* at: the first byte not yet read, never a blank between two calls */
    int depth;
    cap deepest, longest;
    bool failed; /* the first error stands in *error */
    expr_error *error;
    emitter emitter;
} parser;

/* Characters by ASCII, whatever the locale is. */
static bool is_digit(char c) { return c >= '0' && c <= '9'; }
static bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

/* Record an error at `where`, unless there is one already, and let the parser see the end of the text. */
static operand fail(parser *p, const char *where, const char *fmt, ...) KAGE_PRINTF(3, 4);
static operand fail(parser *p, const char *where, const char *fmt, ...)
{
    if (!p->failed) {
        va_list args;
        va_start(args, fmt);
        vsnprintf(p->error->message, sizeof p->error->message, fmt, args);
        va_end(args);
        p->error->offset = (size_t)(where - p->text);
        p->failed = true;
    }
    p->at += strlen(p->at);
    return expr_emit_constant(0);
}

static void skip_blanks(parser *p) { p->at += strspn(p->at, " \t\r\n"); }

static bool accept(parser *p, char c)
{
    if (*p->at != c)
        return false;
    p->at++;
    skip_blanks(p);
    return true;
}

/* The word or character at `at`, for messages. */
typedef struct found {
    char text[LONGEST_NAME + 8];
} found;

static found found_at(const char *at)
{
    found f;
    int n = 0;
    while (n < LONGEST_NAME && (is_letter(at[n]) || is_digit(at[n])))
        n++;
    unsigned char c = (unsigned char)*at;
    if (!c)
        snprintf(f.text, sizeof f.text, "the end");
    else if (c < 0x20 || c > 0x7e)
        snprintf(f.text, sizeof f.text, "the byte 0x%02X", c);
    else
        snprintf(f.text, sizeof f.text, "'%.*s'", n ? n : 1, at);
    return f;
}

static operand emit_op(parser *p, const char *where, const expr_op *op, int n, const operand *arg)
{
    if (p->failed)
        return expr_emit_constant(0);
    operand z = op->build ? op->build(&p->emitter, n, arg) : expr_emit(&p->emitter, op, n, arg);
    return p->emitter.problem ? fail(p, where, "%s", p->emitter.problem) : z;
}

static operand parse_sum(parser *p);

static operand parse_number(parser *p)
{
    const char *start = p->at;
    size_t digits = strspn(p->at, "0123456789");
    p->at += digits;
    if (*p->at == '.') {
        size_t fraction = strspn(++p->at, "0123456789");
        p->at += fraction;
        digits += fraction;
    }
    if (!digits)
        return fail(p, start, "'.' without a digit, expected a number such as 0.5");
    if (*p->at == 'e' || *p->at == 'E') {
        p->at += p->at[1] == '+' || p->at[1] == '-' ? 2 : 1;
        if (!is_digit(*p->at))
            return fail(p, start, "number with an exponent that has no digits, expected one such as 1e-3");
        p->at += strspn(p->at, "0123456789");
    }
    double k = strtod(start, NULL); /* reads as far: what it would take besides (0x, inf) is no number here */
    if (!(k < HUGE_VAL))
        return fail(p, start, "number out of range, expected at most 1.79e308");
    skip_blanks(p);
    return expr_emit_constant(k);
}

static const expr_op *function_named(const char *name)
{
    for (int t = 0; t < TABLES; t++)
        for (const expr_op *const *f = tables[t]; *f; f++)
            if (strcmp(name, (*f)->name) == 0)
                return *f;
    return NULL;
}

static operand unknown_name(parser *p, const char *where, const char *name, bool called)
{
    const char *nearest = NULL;
    int best = 3; /* more than two slips are another word */
    for (int t = 0; t < TABLES; t++)
        for (const expr_op *const *f = tables[t]; *f; f++) {
            int d = spelling_distance(name, strlen(name), (*f)->name, strlen((*f)->name));
            if (d < best && d < (int)strlen(name) - 1) {
                best = d;
                nearest = (*f)->name;
            }
        }
    const char *kind = called ? "function" : "name";
    if (nearest)
        return fail(p, where, "unknown %s '%s', did you mean '%s'?", kind, name, nearest);
    if (called)
        return fail(p, where, "unknown function '%s', expected one of those of the language", name);
    return fail(p, where, "unknown name '%s', expected u, w, pi or a function", name);
}

static const char *arguments_of(const expr_op *f)
{
    static const char *const words[] = {"", "1 argument", "2 arguments", "3 arguments", "3 or 4 arguments"};
    return f->most == EXPR_ANY_NUMBER ? "2 or more arguments" : words[f->most];
}

/* The error where an expression could have ended. */
static operand unexpected(parser *p, const char *expected)
{
    char c = *p->at;
    const found here = found_at(p->at);
    const char *what = here.text;
    if (is_letter(c) || is_digit(c) || c == '.' || c == '(')
        return fail(p, p->at, "missing operator before %s: a product is written with '*'", what);
    return fail(p, p->at, "found %s, expected %s", what, expected);
}

/* f(...) after the name, with p->at on the parenthesis. Chains such as min(a,b,c,...) are folded as they
 * are read. */
static operand parse_call(parser *p, const char *where, const expr_op *f)
{
    operand arg[EXPR_OPERANDS] = {{0}};
    int n = 0;
    accept(p, '(');
    if (*p->at != ')')
        do {
            operand next = parse_sum(p);
            if (n > 0 && f->most == EXPR_ANY_NUMBER)
                arg[0] = emit_op(p, where, f, 2, (operand[]){arg[0], next});
            else if (n < EXPR_OPERANDS)
                arg[n] = next;
            n++;
        } while (accept(p, ','));
    if (!accept(p, ')'))
        return unexpected(p, "an operator, ',' or ')'");
    if (n < f->least || n > f->most)
        return fail(p, where, "'%s' takes %s, found %d", f->name, arguments_of(f), n);
    if (f->most == EXPR_ANY_NUMBER)
        return arg[0];
    return emit_op(p, where, f, n, arg);
}

static operand parse_name(parser *p)
{
    const char *where = p->at;
    char name[LONGEST_NAME + 1];
    int n = 0;
    for (; is_letter(*p->at) || is_digit(*p->at); p->at++)
        if (n < LONGEST_NAME)
            name[n++] = *p->at;
    name[n] = 0;
    skip_blanks(p);

    if (strcmp(name, "u") == 0)
        return (operand){.slot = SLOT_U};
    if (strcmp(name, "w") == 0)
        return (operand){.slot = SLOT_W};
    if (strcmp(name, "pi") == 0)
        return expr_emit_constant(KM_PI);
    const expr_op *f = function_named(name);
    if (f && *p->at != '(')
        return fail(p, p->at, "found %s, expected '(' after the function '%s'", found_at(p->at).text, name);
    return f ? parse_call(p, where, f) : unknown_name(p, where, name, *p->at == '(');
}

static operand parse_primary(parser *p)
{
    if (is_digit(*p->at) || *p->at == '.')
        return parse_number(p);
    if (is_letter(*p->at))
        return parse_name(p);
    if (accept(p, '(')) {
        operand inner = parse_sum(p);
        return accept(p, ')') ? inner : unexpected(p, "an operator or ')'");
    }
    return fail(p, p->at, "found %s, expected a number, a name or '('", found_at(p->at).text);
}

static operand parse_signed(parser *p)
{
    if (++p->depth > p->deepest.most)
        return fail(p, p->at, "nesting too deep, expected at most %d levels%s", (int)p->deepest.most, p->deepest.by);
    bool minus = false;
    const char *where = p->at;
    while (*p->at == '+' || *p->at == '-') {
        minus ^= *p->at == '-';
        accept(p, *p->at);
    }
    operand a = parse_primary(p);
    const char *caret = p->at;
    if (accept(p, '^')) {
        operand exponent = parse_signed(p);
        a = emit_op(p, caret, &expr_pow, 2, (operand[]){a, exponent});
    }
    p->depth--;
    return minus ? emit_op(p, where, &expr_multiply, 2, (operand[]){expr_emit_constant(-1), a}) : a;
}

/* Operands read by `part`, joined from left to right by either of the two signs. */
static operand parse_chain(parser *p, operand (*part)(parser *), const char signs[2], const expr_op *const op[2])
{
    operand a = part(p);
    while (*p->at == signs[0] || *p->at == signs[1]) {
        const char *where = p->at;
        accept(p, *where);
        operand b = part(p);
        a = emit_op(p, where, op[*where == signs[1]], 2, (operand[]){a, b});
    }
    return a;
}

static operand parse_product(parser *p)
{
    return parse_chain(p, parse_signed, "*/", (const expr_op *[]){&expr_multiply, &expr_divide});
}

static operand parse_sum(parser *p)
{
    return parse_chain(p, parse_product, "+-", (const expr_op *[]){&expr_add, &expr_subtract});
}

static operand parse_whole(parser *p)
{
    const size_t most = (size_t)p->longest.most;
    if (strnlen(p->text, most + 1) > most) {
        p->at = p->text + most;
        return fail(p, p->at, "text too long, expected at most %d bytes%s", (int)most, p->longest.by);
    }
    skip_blanks(p);
    if (!*p->at)
        return fail(p, p->at, "empty expression, expected a function of u and w");
    operand a = parse_sum(p);
    if (*p->at == ')')
        return fail(p, p->at, "')' without '('");
    return *p->at ? unexpected(p, "an operator or the end") : a;
}

expr *expr_parse(const char *text, expr_error *error) { return expr_parse_within(NULL, text, error); }

expr *expr_parse_within(const limits *l, const char *text, expr_error *error)
{
    parser p = {.text = text,
                .at = text,
                .deepest = limit_of(l, LIMIT_EXPRESSION_NESTING, EXPR_MAX_DEPTH),
                .longest = limit_of(l, LIMIT_EXPRESSION, EXPR_MAX_TEXT),
                .error = error};
    emitter_begin(&p.emitter);
    operand result = parse_whole(&p);
    if (p.failed)
        return NULL;
    expr *e = emitter_end(&p.emitter, result);
    if (!e)
        fail(&p, text, "out of memory");
    return e;
}
