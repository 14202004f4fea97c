/* The methods by name, and the derivatives they need. */
#include "method/method.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char method_expected[] = "none, 0, 1, 2, 2+, iter:K, march:N or exact";

const method_help method_helps[] = {
    {"none", "the smooth hit: what renderers with bump mapping do"},
    {"0", "the paper's order 0: a plane at height P along the normal"},
    {"1", "the paper's order 1: the rough surface's tangent plane"},
    {"2", "the paper's order 2: with the pure second derivatives"},
    {"2+", "order 2 with the cross term and the smooth surface's curvature (ours)"},
    {"iter:K", "order 0 K times, the height looked up again at each place (ours)"},
    {"march:N", "N steps through the slab between lowest and highest P, one secant step (ours)"},
    {"exact", "the first hit of the displaced surface, for the shadow's origin alone (ours)"},
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

bool method_parse(const char *text, method *m)
{
    if (strcmp(text, "none") == 0 || strcmp(text, "exact") == 0) {
        *m = (method){*text == 'n' ? METHOD_NONE : METHOD_EXACT, 0};
        return true;
    }
    for (int k = 0; k < 4; k++)
        if (strcmp(text, names[k + 1]) == 0) {
            *m = (method){METHOD_ORDER, k};
            return true;
        }
    int n = 0;
    if (steps(text, "iter:", &n))
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
    snprintf(name, METHOD_NAME_SIZE, steps ? "%s:%d" : "%s", code, m.n);
}

int method_order(method m) { return m.kind == METHOD_ORDER && m.n >= 2 ? 2 : 1; }

bool method_bends(method m) { return m.kind == METHOD_MARCH || (m.kind == METHOD_ORDER && m.n == 3); }

int method_code(method m)
{
    static const int codes[] = {-1, 0, 4, 5, ORDER_EXACT};
    return m.kind == METHOD_ORDER ? m.n : codes[m.kind];
}

const char *method_code_name(int code) { return names[code + 1]; }
