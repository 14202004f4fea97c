/* Reads the command line, by a table of options. */
#include "cli/command.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Read exactly n whole numbers, 0 to 1000000, with `separator` between them. */
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

static bool add_set(arguments *a, const char *fmt, ...) CLI_PRINTF(2, 3);
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

/* ---- the options, each by its name and value ---- */

static bool read_output(arguments *a, const char *name, const char *v)
{
    (void)name;
    if (a->command == COMMAND_POV || a->command == COMMAND_IMPORT) {
        const char *ending = a->command == COMMAND_POV ? ".pov" : ".yaml";
        if (!has_ending(v, ending))
            return usage_error("-o %s: expected a name that ends in %s", v, ending);
        if (a->outputs)
            return usage_error("-o %s: a second output, expected one", v);
    } else if (!has_ending(v, ".png") && !has_ending(v, ".exr"))
        return usage_error("-o %s: no such kind of picture, expected a name that ends in .png or .exr", v);
    if (a->outputs == MAX_OUTPUTS)
        return usage_error("more than %d outputs", MAX_OUTPUTS);
    a->output[a->outputs++] = v;
    return true;
}

/* The methods' names: none, 0, 1 ... or auto[:E]. */
static void list_methods(char *text, size_t size)
{
    const int n = kage_method_count();
    size_t used = 0;
    for (int k = 0; k < n && used < size; k++)
        used += (size_t)snprintf(text + used, size - used, "%s%s",
                                 k == 0      ? ""
                                 : k < n - 1 ? ", "
                                             : " or ",
                                 kage_method_get(k).name);
}

static bool read_shadow(arguments *a, const char *name, const char *v)
{
    char names[128];
    list_methods(names, sizeof names);
    return kage_method_is_known(v) ? add_set(a, "render.shadow=%s", v)
                                   : usage_error("%s %s: no such method, expected %s", name, v, names);
}

/* `smooth`, or the other word that a key of render may have. */
static bool read_smooth_or(arguments *a, const char *name, const char *key, const char *other, const char *v)
{
    return strcmp(v, "smooth") == 0 || strcmp(v, other) == 0
               ? add_set(a, "render.%s=%s", key, v)
               : usage_error("%s %s: expected smooth or %s", name, v, other);
}

static bool read_surface(arguments *a, const char *name, const char *v)
{
    return read_smooth_or(a, name, "surface", "displaced", v);
}

static bool read_shade(arguments *a, const char *name, const char *v)
{
    return read_smooth_or(a, name, "shade", "shifted", v);
}

static bool read_bump_shadow(arguments *a, const char *name, const char *v)
{
    return kage_bump_shadow_is_known(v) ? add_set(a, "render.bump_shadow=%s", v)
                                        : usage_error("%s %s: expected none, march:N, horizon or exact", name, v);
}

static bool read_size(arguments *a, const char *name, const char *v)
{
    int x[2];
    return whole_numbers(v, 'x', 2, x) && x[0] > 0 && x[1] > 0 && x[0] <= KAGE_MAX_SIDE && x[1] <= KAGE_MAX_SIDE
               ? add_set(a, "image.size=[%d, %d]", x[0], x[1])
               : usage_error("%s %s: expected WIDTHxHEIGHT, each from 1 to %d", name, v, KAGE_MAX_SIDE);
}

static bool read_aa(arguments *a, const char *name, const char *v)
{
    int n;
    return whole_numbers(v, 0, 1, &n) && n >= 1 && n <= KAGE_MAX_AA
               ? add_set(a, "render.aa=%d", n)
               : usage_error("%s %s: expected the samples along a pixel's side, 1 to %d", name, v, KAGE_MAX_AA);
}

static bool read_threshold(arguments *a, const char *name, const char *v)
{
    char *end = NULL;
    const double x = *v && strspn(v, "0123456789.") == strlen(v) ? strtod(v, &end) : -1;
    return x >= 0 && x <= 3 && !*end ? add_set(a, "render.aa_threshold=%s", v)
                                     : usage_error("%s %s: expected how much two pixels may differ, 0 to 3", name, v);
}

static bool read_crop(arguments *a, const char *name, const char *v)
{
    int x[4];
    if (!whole_numbers(v, ',', 4, x) || x[0] >= x[2] || x[1] >= x[3])
        return usage_error("%s %s: expected X0,Y0,X1,Y1 in pixels, with X0 < X1 and Y0 < Y1", name, v);
    memcpy(a->crop, x, sizeof x);
    return true;
}

static bool read_threads(arguments *a, const char *name, const char *v)
{
    int n;
    if (!whole_numbers(v, 0, 1, &n) || n < 1 || n > KAGE_MAX_THREADS)
        return usage_error("%s %s: expected a number from 1 to %d", name, v, KAGE_MAX_THREADS);
    a->threads = n;
    return true;
}

static bool read_frames(arguments *a, const char *name, const char *v)
{
    if (!whole_numbers(v, 0, 1, &a->frames) || a->frames < 1)
        return usage_error("%s %s: expected a number from 1 to 1000000", name, v);
    return true;
}

static bool read_layers(arguments *a, const char *name, const char *v)
{
    (void)name;
    a->layers = v;
    return true;
}

static bool read_bits(arguments *a, const char *name, const char *v)
{
    int n;
    if (!whole_numbers(v, 0, 1, &n) || (n != 8 && n != 16))
        return usage_error("%s %s: expected 8 or 16", name, v);
    a->bits = n;
    return true;
}

static bool read_set(arguments *a, const char *name, const char *v)
{
    if (!strchr(v, '=') || *v == '=')
        return usage_error("%s %s: expected PATH=VALUE, as objects.ground.bump.scale=0.1", name, v);
    return add_set(a, "%s", v);
}

static bool read_bump(arguments *a, const char *name, const char *v)
{
    if (a->bumps == MAX_BUMPS)
        return usage_error("more than %d times %s", MAX_BUMPS, name);
    a->bump[a->bumps++] = v;
    return true;
}

static bool read_camera(arguments *a, const char *name, const char *v)
{
    (void)name;
    a->camera = v;
    return true;
}

static bool read_up(arguments *a, const char *name, const char *v)
{
    a->z_up = strcmp(v, "z") == 0;
    return a->z_up || strcmp(v, "y") == 0 || usage_error("%s %s: expected y or z", name, v);
}

static bool read_brightness(arguments *a, const char *name, const char *v)
{
    char *end = NULL;
    a->brightness = *v && strspn(v, "0123456789.e+-") == strlen(v) ? strtod(v, &end) : -1;
    return (a->brightness > 0 && a->brightness <= 1e6 && !*end) ||
           usage_error("%s %s: expected a number above 0 and up to 1000000", name, v);
}

/* ---- the table ---- */

typedef struct option {
    const char *name;
    int commands; /* that have it */
    bool (*read)(arguments *a, const char *name,
                 const char *value); /* NULL: it has no value, but one of the next two */
    const char *change[3];           /* of the scene; NULL: none */
    size_t flag;                     /* the offset of a bool in `arguments` */
} option;

enum {
    ALL = COMMAND_RENDER | COMMAND_CHECK | COMMAND_PIXEL | COMMAND_POV | COMMAND_VIEW,
    PICTURES = COMMAND_RENDER | COMMAND_POV,
    MAKERS = COMMAND_RENDER | COMMAND_IMPORT,
    LOOKS = COMMAND_RENDER | COMMAND_VIEW
};

static const option options[] = {
    {"-o", PICTURES | COMMAND_IMPORT, read_output, {NULL}, 0},
    {"--shadow", LOOKS, read_shadow, {NULL}, 0},
    {"--shade", LOOKS, read_shade, {NULL}, 0},
    {"--bump-shadow", LOOKS, read_bump_shadow, {NULL}, 0},
    {"--relief",
     LOOKS,
     NULL,
     {"render.shadow=" KAGE_RELIEF_METHOD, "render.shade=shifted", "render.bump_shadow=" KAGE_RELIEF_BUMP_SHADOW},
     0},
    {"--surface", PICTURES | COMMAND_VIEW, read_surface, {NULL}, 0},
    {"--size", ALL, read_size, {NULL}, 0},
    {"--aa", LOOKS, read_aa, {NULL}, 0},
    {"--aa-threshold", LOOKS, read_threshold, {NULL}, 0},
    {"--crop", COMMAND_RENDER, read_crop, {NULL}, 0},
    {"--set", ALL, read_set, {NULL}, 0},
    {"--threads", MAKERS | LOOKS, read_threads, {NULL}, 0},
    {"--bits", COMMAND_RENDER, read_bits, {NULL}, 0},
    {"--layers", COMMAND_RENDER, read_layers, {NULL}, 0},
    {"--no-guard", LOOKS, NULL, {"render.guard=false"}, 0},
    {"--no-self-shadow", PICTURES | COMMAND_VIEW, NULL, {"render.self_shadow=false"}, 0},
    {"--no-cast", COMMAND_POV, NULL, {NULL}, offsetof(arguments, no_cast)},
    {"--overwrite", MAKERS, NULL, {NULL}, offsetof(arguments, overwrite)},
    {"--resume", COMMAND_RENDER, NULL, {NULL}, offsetof(arguments, resume)},
    {"--stats", COMMAND_RENDER, NULL, {NULL}, offsetof(arguments, stats)},
    {"--bump", COMMAND_IMPORT, read_bump, {NULL}, 0},
    {"--camera", COMMAND_IMPORT, read_camera, {NULL}, 0},
    {"--up", COMMAND_IMPORT, read_up, {NULL}, 0},
    {"--brightness", COMMAND_IMPORT, read_brightness, {NULL}, 0},
    {"--frames", COMMAND_VIEW, read_frames, {NULL}, 0},
    {"--report", COMMAND_VIEW, NULL, {NULL}, offsetof(arguments, report)},
    {"--quiet", MAKERS, NULL, {NULL}, offsetof(arguments, quiet)},
};

/* NULL: the command has no such option. */
static const option *find(int command, const char *name)
{
    for (size_t k = 0; k < sizeof options / sizeof *options; k++)
        if ((options[k].commands & command) && strcmp(options[k].name, name) == 0)
            return &options[k];
    return NULL;
}

/* Read the option at argv[*k], and its value, which may be the next argument. */
static bool read_option(arguments *a, int argc, char **argv, int *k)
{
    char *arg = argv[*k], *equals = strncmp(arg, "--", 2) == 0 ? strchr(arg, '=') : NULL;
    if (equals) /* --name=value */
        *equals = 0;
    const option *o = find(a->command, arg);
    if (!o)
        return usage_error("%s: no option of 'kage %s'; see kage --help", arg, a->name);
    if (!o->read && equals)
        return usage_error("%s takes no value; see kage --help", arg);
    for (int c = 0; c < 3 && o->change[c]; c++)
        if (!add_set(a, "%s", o->change[c]))
            return false;
    if (o->change[0])
        return true;
    if (!o->read)
        return *(bool *)((char *)a + o->flag) = true;
    if (!equals && *k + 1 == argc)
        return usage_error("%s lacks its value; see kage --help", arg);
    return o->read(a, o->name, equals ? equals + 1 : argv[++*k]);
}

bool arguments_read(arguments *a, int argc, char **argv, int command)
{
    const int operands = command == COMMAND_PIXEL ? 2 : 1;
    *a = (arguments){.name = argv[1], .command = command, .bits = 8};
    for (int k = 2; k < argc; k++) {
        char *arg = argv[k];
        if (arg[0] == '-' && arg[1]) {
            if (!read_option(a, argc, argv, &k))
                return false;
        } else {
            if (a->operands == operands)
                return usage_error("%s: one argument too many; see kage --help", arg);
            a->operand[a->operands++] = arg;
        }
    }
    if (a->operands < operands)
        return usage_error("'kage %s' lacks %s; see kage --help", a->name,
                           a->operands                 ? "the pixel X,Y"
                           : command == COMMAND_IMPORT ? "a model"
                                                       : "a scene");
    return true;
}

void arguments_free(arguments *a)
{
    for (int k = 0; k < a->sets; k++)
        free(a->set[k]);
}
