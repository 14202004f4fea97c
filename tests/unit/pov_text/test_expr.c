/* Expressions as POV-Ray's functions: the text, and what POV-Ray itself makes of it, against expr_eval. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pov_text/text.h"

/* An expression, and its text; NULL: any that has the same values. */
static const struct {
    const char *from, *to;
} cases[] = {
    {"u", "u"},
    {"2", "2"},
    {"pi", "pi"},
    {"u + w - 2*u", "u + w - 2*u"},
    {"u - (w - u) - (2 - w)", NULL},
    {"u + (w + u)", "u + (w + u)"},
    {"-u^2 + 2^3^2", "-pow(u, 2) + 512"},
    {"(-u)^3", "pow(-u, 3)"},
    {"2*(u*w)", "2*(u*w)"},
    {"u/w/2", "u/w/2"},
    {"u/(w*2)", NULL},
    {"u/(w*u)", "u/(w*u)"},
    {"-(u + w)*u", "-(u + w)*u"},
    {"-(-u)", NULL},
    {"u*-w", "u*(-w)"},
    {"u - -3*w", NULL},
    {"1e-7*u + 1e20*w - 3e-5", NULL},
    {"0.1*u - -w", NULL},
    {"pow(u, -3) + u^-2", NULL},
    {"abs(u)^w", "pow(abs(u), w)"},
    {"abs(u)^0.5", "sqrt(abs(u))"},
    {"abs(u)^-1.5", NULL},
    {"mod(u, w)", "mod(u, w)"},
    {"mod(-7.5*u, 2) + mod(7.5*u, -2)", NULL},
    {"floor(u) + 10*floor(-w)", NULL},
    {"atan2(u, w) + 10*atan2(-u, -w)", NULL},
    {"sin(pi*u)*cos(w) + tan(u/4)", NULL},
    {"asin(sin(u)) + acos(cos(w)) + atan(u*w)", NULL},
    {"sinh(u) - cosh(w) + tanh(u)", NULL},
    {"exp(-u^2) + log(abs(w) + 1)", NULL},
    {"min(u, w, 0.5) + max(u, 0.25, w)", NULL},
    {"clamp(u, -1, w)", "min(max(u, -1), w)"},
    {"select(u, w, 2)", "select(u, w, 2)"},
    {"select(u - w, 1, 2, 3) + 10*select(w, 1, 2, 3)", NULL},
    {"smoothstep(-w, 2, u) + 10*smoothstep(u, w + 4, smoothstep(3, -1, w))", NULL},
    {"0.03*(sin(6*u)*cos(5.4*w) + 0.5*sin(10.2*u + 6.6*w))", "0.03*(sin(6*u)*cos(5.4*w) + 0.5*sin(10.2*u + 6.6*w))"},
};
enum { CASES = sizeof cases / sizeof *cases, PLACES = 6 };

static const double places[PLACES][2] = {{0.7, 1.3},   {-1.6, 0.45}, {1.25, -2.75},
                                         {-0.3, -0.3}, {2.5, 2.5},   {-3.75, -1.5}};

static expr *parse(const char *text)
{
    expr_error wrong;
    expr *e = expr_parse(text, &wrong);
    assert_non_null(e);
    return e;
}

static void test_text(void **state)
{
    (void)state;
    for (int k = 0; k < CASES; k++) {
        expr *e = parse(cases[k].from);
        char *text = expr_pov(e);
        assert_non_null(text);
        assert_null(strchr(text, '^'));
        if (cases[k].to)
            assert_string_equal(text, cases[k].to);
        free(text);
        expr_free(e);
    }
}

static void test_none(void **state)
{
    static const char *const texts[] = {"noise(u, w)", "u + 0.1*sin(noise(3*u, w) + w)", "u + 1/0", "min(u, 0/0)"};
    (void)state;
    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
        expr *e = parse(texts[k]);
        assert_null(expr_pov(e));
        expr_free(e);
    }
}

/* One file for all: POV-Ray tells the values in its debug stream. */
static void test_values(void **state)
{
    char folder[] = "/tmp/kage-XXXXXX", name[64], line[256];
    (void)state;
    if (system("command -v povray > /dev/null 2>&1") != 0) {
        if (getenv("CI"))
            fail_msg("povray is not there");
        skip();
    }
    assert_non_null(mkdtemp(folder));
    snprintf(name, sizeof name, "%s/f.pov", folder);
    FILE *f = fopen(name, "w");
    assert_non_null(f);
    fprintf(f, "#version 3.7;\nglobal_settings { assumed_gamma 1 }\ncamera {}\n");
    for (int k = 0; k < CASES; k++) {
        expr *e = parse(cases[k].from);
        char *text = expr_pov(e);
        fprintf(f, "#declare F%d = function(u, w) { %s }\n", k, text);
        for (int i = 0; i < PLACES; i++)
            fprintf(f, "#debug concat(\"value %d %d \", str(F%d(%.17g, %.17g), 0, 15), \"\\n\")\n", k, i, k,
                    places[i][0], places[i][1]);
        free(text);
        expr_free(e);
    }
    fclose(f);
    char command[256];
    snprintf(command, sizeof command, "cd %s && povray +If.pov +W4 +H4 -D -F -V +GDvalues > words 2>&1", folder);
    int status = system(command), seen = 0;
    snprintf(name, sizeof name, "%s/values", folder);
    f = fopen(name, "r");
    assert_non_null(f);
    while (fgets(line, sizeof line, f)) {
        int k, i;
        double theirs;
        if (sscanf(line, "value %d %d %lf", &k, &i, &theirs) != 3)
            continue;
        expr_jets out;
        expr *e = parse(cases[k].from);
        expr_eval(e, 1, &places[i][0], &places[i][1], 0, &out);
        expr_free(e);
        if (!(fabs(out.v[0] - theirs) <= 1e-12 * fmax(1, fabs(theirs))))
            fail_msg("%s at %g, %g: %.17g, POV-Ray has %.17g", cases[k].from, places[i][0], places[i][1], out.v[0],
                     theirs);
        seen++;
    }
    fclose(f);
    snprintf(command, sizeof command, "rm -r %s", folder);
    assert_int_equal(system(command), 0);
    assert_int_equal(status, 0);
    assert_int_equal(seen, CASES * PLACES);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_text), cmocka_unit_test(test_none),
                                       cmocka_unit_test(test_values)};
    return cmocka_run_group_tests_name("expr_pov", tests, NULL, NULL);
}
