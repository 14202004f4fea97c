/* Texts that are no expressions, and the limits of those that are. */
#include "unit/expr/expressions.h"

/* ---- errors ---- */

static void check_error(const char *text, size_t offset, const char *message)
{
    expr_error error = {0};
    expr *e = expr_parse(text, &error);
    if (e || error.offset != offset || strcmp(error.message, message) != 0)
        fail_msg("%.40s: %s %zu: %s\nexpected %zu: %s", text, e ? "accepted" : "", error.offset, error.message, offset,
                 message);
}

static void test_errors(void **state)
{
    (void)state;
    check_error("", 0, "empty expression, expected a function of u and w");
    check_error("  ", 2, "empty expression, expected a function of u and w");
    check_error("sine(u)", 0, "unknown function 'sine', did you mean 'sin'?");
    check_error("1+Sqrt(u)", 2, "unknown function 'Sqrt', did you mean 'sqrt'?");
    check_error("frob(u)", 0, "unknown function 'frob', expected one of those of the language");
    check_error("u+x", 2, "unknown name 'x', expected u, w, pi or a function");
    check_error("nan", 0, "unknown name 'nan', did you mean 'tan'?");
    check_error("inf", 0, "unknown name 'inf', expected u, w, pi or a function");
    check_error("2*abcdefghijklmnopqrstuvwxyz", 2,
                "unknown name 'abcdefghijklmnopqrstuvwx', expected u, w, pi or a function");
    check_error("sin u", 4, "found 'u', expected '(' after the function 'sin'");
    check_error("sin", 3, "found the end, expected '(' after the function 'sin'");
    check_error("sin()", 0, "'sin' takes 1 argument, found 0");
    check_error("2*sin(u,w)", 2, "'sin' takes 1 argument, found 2");
    check_error("atan2(u)", 0, "'atan2' takes 2 arguments, found 1");
    check_error("clamp(u,w)", 0, "'clamp' takes 3 arguments, found 2");
    check_error("select(u,w)", 0, "'select' takes 3 or 4 arguments, found 2");
    check_error("select(u,1,2,3,4)", 0, "'select' takes 3 or 4 arguments, found 5");
    check_error("min(u)", 0, "'min' takes 2 or more arguments, found 1");
    check_error("sin(u", 5, "found the end, expected an operator, ',' or ')'");
    check_error("sin(u,)", 6, "found ')', expected a number, a name or '('");
    check_error("(u+1", 4, "found the end, expected an operator or ')'");
    check_error("(u,w)", 2, "found ',', expected an operator or ')'");
    check_error("u)", 1, "')' without '('");
    check_error("u,w", 1, "found ',', expected an operator or the end");
    check_error("u+", 2, "found the end, expected a number, a name or '('");
    check_error("u**2", 2, "found '*', expected a number, a name or '('");
    check_error("()", 1, "found ')', expected a number, a name or '('");
    check_error("u $ w", 2, "found '$', expected an operator or the end");
    check_error("u+\xc3\xa9", 2, "found the byte 0xC3, expected a number, a name or '('");
    check_error("u\x01", 1, "found the byte 0x01, expected an operator or the end");
    check_error("2u", 1, "missing operator before 'u': a product is written with '*'");
    check_error("3 sin(u)", 2, "missing operator before 'sin': a product is written with '*'");
    check_error("u(3)", 1, "missing operator before '(': a product is written with '*'");
    check_error("(2 u)", 3, "missing operator before 'u': a product is written with '*'");
    check_error("1.2.3", 3, "missing operator before '.': a product is written with '*'");
    check_error("0x10", 1, "missing operator before 'x10': a product is written with '*'");
    check_error("1+.", 2, "'.' without a digit, expected a number such as 0.5");
    check_error("1+2e", 2, "number with an exponent that has no digits, expected one such as 1e-3");
    check_error("1+2e+u", 2, "number with an exponent that has no digits, expected one such as 1e-3");
    check_error("1e309", 0, "number out of range, expected at most 1.79e308");
}

/* ---- limits ---- */

/* `count` copies of `piece` after `head`, before `tail`; the caller frees. */
static char *repeat(const char *head, const char *piece, int count, const char *tail)
{
    size_t size = strlen(head) + strlen(piece) * (size_t)count + strlen(tail) + 1;
    char *text = malloc(size);
    assert_non_null(text);
    strcpy(text, head);
    for (int i = 0; i < count; i++)
        strcat(text, piece);
    return strcat(text, tail);
}

static void check_limit(char *text, size_t offset, const char *message)
{
    if (message)
        check_error(text, offset, message);
    else
        expr_free(parse(text));
    free(text);
}

static char *nested(const char *open, int levels)
{
    char *close = repeat("", ")", levels, ""), *text = repeat("", open, levels, "u");
    char *all = repeat(text, close, 1, "");
    free(close);
    free(text);
    return all;
}

static void test_limits(void **state)
{
    (void)state;
    const char *deep = "nesting too deep, expected at most 64 levels";
    check_limit(nested("(", 63), 0, NULL);
    check_limit(nested("(", 64), 64, deep);
    check_limit(nested("(", 2000), 64, deep);
    check_limit(nested("sin(", 800), 256, deep);
    check_limit(repeat("", "2^", 63, "u"), 0, NULL);
    check_limit(repeat("", "2^", 1500, "u"), 128, deep);
    check_limit(repeat("", "-", 4000, "u"), 0, NULL);
    check_limit(repeat("u", "+u", 1024, ""), 0, NULL);
    check_limit(repeat("u", "+u", 1025, ""), 2049, "expression too long, expected at most 1024 operations");
    check_limit(nested("u+sin(", 29), 0, NULL);
    check_limit(nested("sin(u)+(", 60), 30 * 8,
                "too many intermediate results at a time, expected at most 30: nest the other way round");
    check_limit(repeat("u", " ", 4095, ""), 0, NULL);
    check_limit(repeat("u", " ", 4096, ""), 4096, "text too long, expected at most 4096 bytes");
    check_limit(repeat("min(u", ",w", 900, ")"), 0, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_errors),
        cmocka_unit_test(test_limits),
    };
    return cmocka_run_group_tests_name("errors", tests, NULL, NULL);
}
