/* The methods by name, and the derivatives they need. */
#include "method/method.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char method_expected[] = "none, 0, 1, 2, 2+, iter:K, march:N (K and N: 1 to 1024), exact or auto[:E]";

const method_help method_helps[] = {
    {"none", "the smooth hit: bump mapping only, as other renderers do it; also called bump"},
    {"0", "the paper's order 0: a plane at height P along the normal"},
    {"1", "the paper's order 1: the rough surface's tangent plane"},
    {"2", "the paper's order 2: with the pure second derivatives"},
    {"2+", "order 2 with the cross term and the smooth surface's curvature (ours)"},
    {"iter:K", "order 0 K times, the height looked up again at each place (ours)"},
    {"march:N", "N steps through the slab between lowest and highest P, one secant step (ours)"},
    {"exact", "the first hit of the displaced surface, for the shadow's origin alone (ours)"},
    {"auto[:E]", "order 0, and better only where a shadow may be off by more than E pixels, 0.25 by default (ours)"},
};
const int method_help_count = sizeof method_helps / sizeof *method_helps;

static const char *const names[ORDER_CODES] = {"none", "0", "1", "2", "2+", "iter", "march", "exact"}; /* by code + 1 */

/* Read a prefix and a number of steps. */
static bool steps(const char *text, const char *prefix, int *n)
{
    size_t k = strlen(prefix);
    if (strncmp(text, prefix, k) != 0 || text[k] < '1' || text[k] > '9')
        return false;
    char *end;
    long v = strtol(text + k, &end, 10);
    *n = (int)v;
    return !*end && v <= METHOD_STEPS_MAX;
}

/* A decimal number in millionths, 0 where it is none. By hand, as strtod depends on the locale. */
static int millionths(const char *text)
{
    long long v = 0;
    int decimals = -1; /* so many were read; -1: no point yet */
    if (*text < '0' || *text > '9')
        return 0;
    for (; *text; text++)
        if (*text == '.' && decimals < 0)
            decimals = 0;
        else if (*text >= '0' && *text <= '9' && v <= METHOD_ERROR_MAX && decimals < 6) {
            v = 10 * v + (*text - '0');
            decimals += decimals >= 0;
        } else
            return 0;
    for (int k = decimals > 0 ? decimals : 0; k < 6; k++)
        v *= 10;
    return v <= METHOD_ERROR_MAX ? (int)v : 0;
}

static void name_auto(int error, char name[METHOD_NAME_SIZE])
{
    snprintf(name, METHOD_NAME_SIZE, "auto:%d.%06d", error / METHOD_PIXEL, error % METHOD_PIXEL);
    char *end = name + strlen(name);
    while (end[-1] == '0')
        *--end = 0;
    if (end[-1] == '.')
        end[-1] = 0;
    if (error == METHOD_ERROR)
        strcpy(name, "auto");
}

bool method_parse(const char *text, method *m)
{
    if (strcmp(text, "none") == 0 || strcmp(text, "bump") == 0 || strcmp(text, "exact") == 0) {
        *m = (method){*text == 'e' ? METHOD_EXACT : METHOD_NONE, 0};
        return true;
    }
    for (int k = 0; k < 4; k++)
        if (strcmp(text, names[k + 1]) == 0) {
            *m = (method){METHOD_ORDER, k};
            return true;
        }
    int n = strcmp(text, "auto") == 0 ? METHOD_ERROR : strncmp(text, "auto:", 5) == 0 ? millionths(text + 5) : 0;
    if (n > 0)
        *m = (method){METHOD_AUTO, n};
    else if (steps(text, "iter:", &n))
        *m = (method){METHOD_ITER, n};
    else if (steps(text, "march:", &n))
        *m = (method){METHOD_MARCH, n};
    else
        return false;
    return true;
}

void method_name(method m, char name[METHOD_NAME_SIZE])
{
    const bool steps = m.kind == METHOD_ITER || m.kind == METHOD_MARCH;
    const char *code = method_code_name(method_code(m));
    if (m.kind == METHOD_AUTO)
        name_auto(m.n, name);
    else
        snprintf(name, METHOD_NAME_SIZE, steps ? "%s:%d" : "%s", code, m.n);
}

int method_order(method m) { return m.kind == METHOD_ORDER && m.n >= 2 ? m.n : 1; }

bool method_bends(method m)
{
    return m.kind == METHOD_MARCH || m.kind == METHOD_AUTO || (m.kind == METHOD_ORDER && m.n == 3);
}

int method_code(method m)
{
    static const int codes[] = {-1, 0, 4, 5, ORDER_EXACT, 0};
    return m.kind == METHOD_ORDER ? m.n : codes[m.kind];
}

const char *method_code_name(int code) { return names[code + 1]; }
