/* Reads the values of options. */
#include "cli/options.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/spelling.h"

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

/* Read a number of these letters alone, to the end of the text. */
static bool number(const char *text, const char *letters, double *x)
{
    char *end = NULL;
    if (!*text || strspn(text, letters) != strlen(text))
        return false;
    *x = strtod(text, &end);
    return !*end;
}

#define DECIMAL "0123456789."

bool add_set(arguments *a, const char *fmt, ...)
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

static bool add_output(arguments *a, const char *v, const char *format)
{
    if (a->outputs == MAX_OUTPUTS)
        return usage_error("more than %d outputs", MAX_OUTPUTS);
    a->format[a->outputs] = format;
    a->output[a->outputs++] = v;
    return true;
}

/* Standard output: "-", and for a picture also "png:-" or "exr:-". */
static bool add_stdout(arguments *a, const char *name, const char *v, const char *format)
{
    if (a->to_stdout)
        return usage_error("%s %s: a second output to standard output, expected one", name, v);
    a->to_stdout = true;
    return add_output(a, "/dev/stdout", format);
}

bool read_picture(arguments *a, const char *name, const char *v)
{
    if (strcmp(v, "-") == 0 || strcmp(v, "png:-") == 0 || strcmp(v, "/dev/stdout") == 0)
        return add_stdout(a, name, v, "png");
    if (strcmp(v, "exr:-") == 0)
        return add_stdout(a, name, v, "exr");
    return has_ending(v, ".png") || has_ending(v, ".exr")
               ? add_output(a, v, NULL)
               : usage_error("%s %s: no such kind of picture, expected a name that ends in .png or .exr, or - for a "
                             "PNG to standard output",
                             name, v);
}

/* The one output of a command. */
static bool read_single(arguments *a, const char *name, const char *ending, const char *v)
{
    if (!has_ending(v, ending))
        return usage_error("%s %s: expected a name that ends in %s", name, v, ending);
    return a->outputs ? usage_error("%s %s: a second output, expected one", name, v) : add_output(a, v, NULL);
}

bool read_pov(arguments *a, const char *name, const char *v)
{
    return strcmp(v, "-") == 0 && !a->outputs ? add_stdout(a, name, v, NULL) : read_single(a, name, ".pov", v);
}

bool read_scene(arguments *a, const char *name, const char *v) { return read_single(a, name, ".yaml", v); }

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

bool read_shadow(arguments *a, const char *name, const char *v)
{
    char names[128];
    if (kage_method_is_known(v))
        return add_set(a, "render.shadow=%s", v);
    const char *colon = strchr(v, ':');
    if (strncmp(v, "iter:", 5) == 0 || strncmp(v, "march:", 6) == 0)
        return usage_error("%s %s: expected a whole number from 1 to %d after %.*s", name, v, KAGE_MAX_STEPS,
                           (int)(colon - v + 1), v);
    list_methods(names, sizeof names);
    return usage_error("%s %s: no such method, expected %s", name, v, names);
}

/* `smooth`, or the other word that a key of render may have. */
static bool read_smooth_or(arguments *a, const char *name, const char *key, const char *other, const char *v)
{
    return strcmp(v, "smooth") == 0 || strcmp(v, other) == 0
               ? add_set(a, "render.%s=%s", key, v)
               : usage_error("%s %s: expected smooth or %s", name, v, other);
}

bool read_surface(arguments *a, const char *name, const char *v)
{
    return read_smooth_or(a, name, "surface", "displaced", v);
}

bool read_shade(arguments *a, const char *name, const char *v)
{
    return read_smooth_or(a, name, "shade", "shifted", v);
}

bool read_bump_shadow(arguments *a, const char *name, const char *v)
{
    return kage_bump_shadow_is_known(v)
               ? add_set(a, "render.bump_shadow=%s", v)
               : usage_error("%s %s: expected none, march:N (N: 1 to %d), horizon or exact", name, v, KAGE_MAX_STEPS);
}

bool read_size(arguments *a, const char *name, const char *v)
{
    int x[2];
    return whole_numbers(v, 'x', 2, x) && x[0] > 0 && x[1] > 0 && x[0] <= KAGE_MAX_SIDE && x[1] <= KAGE_MAX_SIDE
               ? add_set(a, "image.size=[%d, %d]", x[0], x[1])
               : usage_error("%s %s: expected WIDTHxHEIGHT, each from 1 to %d", name, v, KAGE_MAX_SIDE);
}

bool read_aa(arguments *a, const char *name, const char *v)
{
    int n;
    return whole_numbers(v, 0, 1, &n) && n >= 1 && n <= KAGE_MAX_AA
               ? add_set(a, "render.aa=%d", n)
               : usage_error("%s %s: expected the samples along a pixel's side, 1 to %d", name, v, KAGE_MAX_AA);
}

bool read_threshold(arguments *a, const char *name, const char *v)
{
    double x;
    return number(v, DECIMAL, &x) && x >= 0 && x <= 3
               ? add_set(a, "render.aa_threshold=%s", v)
               : usage_error("%s %s: expected how much two pixels may differ, 0 to 3", name, v);
}

bool read_crop(arguments *a, const char *name, const char *v)
{
    int x[4];
    if (!whole_numbers(v, ',', 4, x) || x[0] >= x[2] || x[1] >= x[3])
        return usage_error("%s %s: expected X0,Y0,X1,Y1 in pixels, with X0 < X1 and Y0 < Y1", name, v);
    memcpy(a->crop, x, sizeof x);
    return true;
}

bool read_threads(arguments *a, const char *name, const char *v)
{
    int n;
    if (!whole_numbers(v, 0, 1, &n) || n < 1 || n > KAGE_MAX_THREADS)
        return usage_error("%s %s: expected a number from 1 to %d", name, v, KAGE_MAX_THREADS);
    a->threads = n;
    return true;
}

/* Bytes, or with K, M, G or T behind it 1024, 1024^2 ... bytes. */
static bool read_bytes(const char *v, int64_t *to)
{
    static const char units[] = "KMGT";
    char *end = NULL;
    const size_t digits = strspn(v, "0123456789.");
    double x = *v >= '0' && *v <= '9' ? strtod(v, &end) : -1;
    const char *unit = end && *end ? strchr(units, *end) : NULL;
    for (const char *k = units; unit && k <= unit; k++)
        x *= 1024;
    end = unit ? end + 1 : end;
    if (!(x >= 1 && x <= 1e18) || *end || digits + (unit != NULL) != strlen(v))
        return false;
    *to = (int64_t)x;
    return true;
}

bool read_memory(arguments *a, const char *name, const char *v)
{
    return read_bytes(v, &a->limits.memory) ||
           usage_error("%s %s: expected a size in bytes, or with K, M, G or T behind it: 4G", name, v);
}

/* The error that there is no limit of the name that v begins with. */
static bool refuse_limit(const char *name, const char *v)
{
    char words[512] = "", near[SPELLING_LONGEST + 1] = "", typed[SPELLING_LONGEST + 2];
    size_t used = 0;
    for (int k = 0; k < kage_limit_count() && used < sizeof words; k++)
        used += (size_t)snprintf(words + used, sizeof words - used, "%s%s", k ? " " : "", kage_limit_get(k).name);
    snprintf(typed, sizeof typed, "%.*s", (int)strcspn(v, "="), v);
    spelling_nearest(typed, words, near, sizeof near);
    return *near ? usage_error("%s %s: no such limit, did you mean '%s'?", name, v, near)
                 : usage_error("%s %s: no such limit, expected WHAT=N with one of: %s", name, v, words);
}

bool read_limit(arguments *a, const char *name, const char *v)
{
    const size_t n = strcspn(v, "=");
    kage_limit l = {0};
    for (int k = 0; k < kage_limit_count() && !l.name; k++)
        if (strncmp(kage_limit_get(k).name, v, n) == 0 && !kage_limit_get(k).name[n])
            l = kage_limit_get(k);
    if (!l.name)
        return refuse_limit(name, v);
    char most[32], *end = NULL;
    const char *value = v + n + (v[n] == '=');
    int64_t x = 0;
    const bool good =
        l.bytes ? read_bytes(value, &x) : *value >= '0' && *value <= '9' && ((x = strtoll(value, &end, 10)), !*end);
    if (!good || x < 1 || x > l.most)
        return usage_error("%s %s: expected %s=N, N from 1 to %s (%s)", name, v, l.name, limit_text(&l, most), l.text);
    *(int64_t *)((char *)&a->limits + l.offset) = x;
    return true;
}

bool read_seconds(arguments *a, const char *name, const char *v)
{
    return (*v != '.' && number(v, DECIMAL, &a->seconds) && a->seconds > 0 && a->seconds <= 1e6) ||
           usage_error("%s %s: expected a number of seconds above 0 and up to 1000000", name, v);
}

bool read_frames(arguments *a, const char *name, const char *v)
{
    if (!whole_numbers(v, 0, 1, &a->frames) || a->frames < 1)
        return usage_error("%s %s: expected a number from 1 to 1000000", name, v);
    return true;
}

bool read_layers(arguments *a, const char *name, const char *v)
{
    (void)name;
    a->layers = v;
    return true;
}

bool read_bits(arguments *a, const char *name, const char *v)
{
    int n;
    if (!whole_numbers(v, 0, 1, &n) || (n != 8 && n != 16))
        return usage_error("%s %s: expected 8 or 16", name, v);
    a->bits = n;
    return true;
}

bool read_set(arguments *a, const char *name, const char *v)
{
    if (!strchr(v, '=') || *v == '=')
        return usage_error("%s %s: expected PATH=VALUE, as objects.ground.bump.scale=0.1", name, v);
    return add_set(a, "%s", v);
}

bool read_bump(arguments *a, const char *name, const char *v)
{
    if (a->bumps == MAX_BUMPS)
        return usage_error("more than %d times %s", MAX_BUMPS, name);
    a->bump[a->bumps++] = v;
    return true;
}

bool read_camera(arguments *a, const char *name, const char *v)
{
    (void)name;
    a->camera = v;
    return true;
}

bool read_up(arguments *a, const char *name, const char *v)
{
    a->z_up = strcmp(v, "z") == 0;
    return a->z_up || strcmp(v, "y") == 0 || usage_error("%s %s: expected y or z", name, v);
}

bool read_brightness(arguments *a, const char *name, const char *v)
{
    return (number(v, DECIMAL "e+-", &a->brightness) && a->brightness > 0 && a->brightness <= 1e6) ||
           usage_error("%s %s: expected a number above 0 and up to 1000000", name, v);
}
