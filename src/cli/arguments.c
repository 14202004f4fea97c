#include "cli/command.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool usage_error(const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    fputs("kage: ", stderr);
    vfprintf(stderr, fmt, args);
    fputs("\n", stderr);
    va_end(args);
    return false;
}

/* Whole numbers with `separator` between them, from 0 on, and nothing else. */
static bool whole_numbers(const char *text, char separator, int n, int *out)
{
    for (int k = 0; k < n; k++) {
        char *end;
        if (*text < '0' || *text > '9')
            return false;
        long v = strtol(text, &end, 10);
        if (v > 1000000 || *end != (k < n - 1 ? separator : 0))
            return false;
        out[k] = (int)v;
        text = end + 1;
    }
    return true;
}

static bool add_set(arguments *a, const char *fmt, ...) KAGE_PRINTF(2, 3);
static bool add_set(arguments *a, const char *fmt, ...)
{
    va_list args, again;
    if (a->sets == MAX_SETS)
        return usage_error("more than %d changes of the scene", MAX_SETS);
    va_start(args, fmt);
    va_copy(again, args);
    int n = vsnprintf(NULL, 0, fmt, args);
    char *text = n < 0 ? NULL : malloc((size_t)n + 1);
    if (text)
        vsnprintf(text, (size_t)n + 1, fmt, again);
    va_end(again);
    va_end(args);
    if (!text)
        return usage_error("out of memory");
    a->set[a->sets++] = text;
    return true;
}

static bool has_ending(const char *path, const char *ending)
{
    size_t n = strlen(path), m = strlen(ending);
    return n > m && strcmp(path + n - m, ending) == 0;
}

/* Options and the commands that have them. Those that change the scene become a --set. */
static bool option(arguments *a, const char *name, const char *v)
{
    int x[4];
    method m;
    if (strcmp(name, "-o") == 0) {
        if (strcmp(a->command, "pov") == 0) {
            if (!has_ending(v, ".pov"))
                return usage_error("-o %s: expected a name that ends in .pov", v);
            if (a->outputs)
                return usage_error("-o %s: a second output, expected one", v);
        } else if (!has_ending(v, ".png") && !has_ending(v, ".exr"))
            return usage_error("-o %s: no such kind of picture, expected a name that ends in .png or .exr", v);
        if (a->outputs == MAX_OUTPUTS)
            return usage_error("more than %d outputs", MAX_OUTPUTS);
        a->output[a->outputs++] = v;
        return true;
    }
    if (strcmp(name, "--shadow") == 0)
        return method_parse(v, &m) ? add_set(a, "render.shadow=%s", v)
                                   : usage_error("--shadow %s: no such method, expected %s", v, method_expected);
    if (strcmp(name, "--surface") == 0)
        return strcmp(v, "smooth") == 0 || strcmp(v, "displaced") == 0
                   ? add_set(a, "render.surface=%s", v)
                   : usage_error("--surface %s: expected smooth or displaced", v);
    if (strcmp(name, "--size") == 0)
        return whole_numbers(v, 'x', 2, x) && x[0] > 0 && x[1] > 0 && x[0] <= SCENE_MAX_SIDE && x[1] <= SCENE_MAX_SIDE
                   ? add_set(a, "image.size=[%d, %d]", x[0], x[1])
                   : usage_error("--size %s: expected WIDTHxHEIGHT, each from 1 to %d", v, SCENE_MAX_SIDE);
    if (strcmp(name, "--aa") == 0)
        return whole_numbers(v, 0, 1, x) && x[0] >= 1 && x[0] <= SCENE_MAX_AA
                   ? add_set(a, "render.aa=%d", x[0])
                   : usage_error("--aa %s: expected the samples along a pixel's side, 1 to %d", v, SCENE_MAX_AA);
    if (strcmp(name, "--aa-threshold") == 0) {
        char *end;
        double threshold = *v && strspn(v, "0123456789.") == strlen(v) ? strtod(v, &end) : -1;
        return threshold >= 0 && threshold <= 3 && !*end
                   ? add_set(a, "render.aa_threshold=%s", v)
                   : usage_error("--aa-threshold %s: expected how much two pixels may differ, 0 to 3", v);
    }
    if (strcmp(name, "--crop") == 0) {
        if (!whole_numbers(v, ',', 4, x) || x[0] >= x[2] || x[1] >= x[3])
            return usage_error("--crop %s: expected X0,Y0,X1,Y1 in pixels, with X0 < X1 and Y0 < Y1", v);
        a->crop = (window){x[0], x[1], x[2], x[3]};
        return true;
    }
    if (strcmp(name, "--threads") == 0) {
        if (!whole_numbers(v, 0, 1, x) || x[0] < 1 || x[0] > 1024)
            return usage_error("--threads %s: expected a number from 1 to 1024", v);
        a->threads = x[0];
        return true;
    }
    if (strcmp(name, "--layers") == 0) {
        a->layers = v;
        return true;
    }
    if (strcmp(name, "--bits") == 0) {
        if (!whole_numbers(v, 0, 1, x) || (x[0] != 8 && x[0] != 16))
            return usage_error("--bits %s: expected 8 or 16", v);
        a->bits = x[0];
        return true;
    }
    if (!strchr(v, '=') || *v == '=')
        return usage_error("--set %s: expected PATH=VALUE, as objects.ground.bump.scale=0.1", v);
    return add_set(a, "%s", v);
}

static bool flag(arguments *a, const char *name)
{
    if (strcmp(name, "--no-self-shadow") == 0)
        return add_set(a, "render.self_shadow=false");
    if (strcmp(name, "--no-guard") == 0)
        return add_set(a, "render.guard=false");
    if (strcmp(name, "--no-cast") == 0)
        a->no_cast = true;
    else if (strcmp(name, "--overwrite") == 0)
        a->overwrite = true;
    else if (strcmp(name, "--stats") == 0)
        a->stats = true;
    else
        a->quiet = true;
    return true;
}

/* The name in the list that the argument is, or NULL. */
static const char *find(const char *const *names, const char *arg)
{
    for (; *names; names++)
        if (strcmp(*names, arg) == 0)
            return *names;
    return NULL;
}

bool arguments_read(arguments *a, int argc, char **argv)
{
    static const char *const render_values[] = {"-o",        "--shadow",       "--surface", "--size",
                                                "--aa",      "--aa-threshold", "--crop",    "--set",
                                                "--threads", "--bits",         "--layers",  NULL};
    static const char *const render_flags[] = {"--no-guard", "--no-self-shadow", "--overwrite",
                                               "--stats",    "--quiet",          NULL};
    static const char *const pov_values[] = {"-o", "--surface", "--size", "--set", NULL};
    static const char *const pov_flags[] = {"--no-self-shadow", "--no-cast", NULL};
    static const char *const other_values[] = {"--set", "--size", NULL};
    static const char *const no_flags[] = {NULL};
    *a = (arguments){.command = argv[1], .bits = 8};
    const bool renders = strcmp(a->command, "render") == 0, exports = strcmp(a->command, "pov") == 0;
    const int operands = strcmp(a->command, "pixel") == 0 ? 2 : 1;
    const char *const *values = renders ? render_values : exports ? pov_values : other_values;
    const char *const *flags = renders ? render_flags : exports ? pov_flags : no_flags;
    for (int k = 2; k < argc; k++) {
        char *arg = argv[k], *equals = strncmp(arg, "--", 2) == 0 ? strchr(arg, '=') : NULL;
        if (arg[0] != '-' || !arg[1]) {
            if (a->operands == operands)
                return usage_error("%s: one argument too many; see kage --help", arg);
            a->operand[a->operands++] = arg;
            continue;
        }
        if (equals) /* --name=value */
            *equals = 0;
        if (find(values, arg)) {
            if (!equals && k + 1 == argc)
                return usage_error("%s lacks its value; see kage --help", arg);
            if (!option(a, arg, equals ? equals + 1 : argv[++k]))
                return false;
        } else if (find(flags, arg)) {
            if (equals)
                return usage_error("%s takes no value; see kage --help", arg);
            if (!flag(a, arg))
                return false;
        } else
            return usage_error("%s: no option of 'kage %s'; see kage --help", arg, a->command);
    }
    if (a->operands < operands)
        return usage_error("'kage %s' lacks %s; see kage --help", a->command,
                           a->operands ? "the pixel X,Y" : "a scene");
    return true;
}

void arguments_free(arguments *a)
{
    for (int k = 0; k < a->sets; k++)
        free(a->set[k]);
}
