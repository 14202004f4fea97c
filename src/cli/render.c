/* kage render: render a scene, write the pictures, print statistics. */
#include "cli/command.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Mistakes that are seen before the scene is read. */
static bool render_can_begin(const arguments *a)
{
    if (a->to_stdout && isatty(STDOUT_FILENO))
        return usage_error("-o -: standard output is a terminal, expected a pipe or a file, as in kage render %s -o - "
                           "> FILE.png",
                           a->operand[0]);
    if (!a->outputs && strcmp(a->operand[0], "-") == 0)
        return usage_error("a scene from standard input gives the picture no name, expected -o FILE");
    return outputs_differ(a->output, a->outputs);
}

/* The scene's file name with .png, in the current folder. NULL: out of memory. */
static char *default_output(const char *path)
{
    const char *base = base_name(path), *dot = strrchr(base, '.');
    int n = dot && dot > base ? (int)(dot - base) : (int)strlen(base);
    char *name = malloc((size_t)n + 5);
    if (name)
        snprintf(name, (size_t)n + 5, "%.*s.png", n, base);
    return name;
}

/* Whether a file that the user did not name may be written: nothing is there, or a picture by kage. */
static bool output_is_replaceable(const char *path)
{
    struct stat about;
    if (stat(path, &about) != 0 || !S_ISREG(about.st_mode) || kage_file_is_picture(path))
        return true;
    return usage_error("%s: kage did not write this file, expected -o with another name, or --overwrite", path);
}

/* Every word of --layers must name planes of the film. */
static bool check_layers(const char *layers, const kage_scene *s)
{
    for (const char *word = layers; word;) {
        char name[80]; /* longer than any plane's name */
        const int n = (int)strcspn(word, ",");
        snprintf(name, sizeof name, "%.*s", n, word);
        if (!kage_scene_has_layer(s, name))
            return usage_error(
                "--layers %.*s: no such layer, expected color, Z, P, N, uw, height, tau, order or visibility, or the "
                "name of a channel, with commas between them",
                n, word);
        word = word[n] ? word + n + 1 : NULL;
    }
    return true;
}

static bool is_exr(const arguments *a, int k)
{
    return a->format[k] ? strcmp(a->format[k], "exr") == 0 : has_ending(a->output[k], ".exr");
}

static bool has_exr(const arguments *a)
{
    for (int k = 0; k < a->outputs; k++)
        if (is_exr(a, k))
            return true;
    return false;
}

/* Whether the film needs other planes than R, G and B. */
static bool wants_layers(const arguments *a)
{
    for (const char *word = a->layers; word; word = strchr(word, ',') ? strchr(word, ',') + 1 : NULL)
        if (strncmp(word, "color", 5) != 0 && !(strchr("RGB", *word) && strchr(",", word[1])))
            return has_exr(a);
    return has_exr(a) && !a->layers;
}

/* The pixels of the picture, or of its crop. */
static long pixels_of(const kage_scene *s, const arguments *a)
{
    const kage_scene_info *i = kage_scene_get_info(s);
    const int *c = a->crop;
    return c[2] > 0 ? (long)(c[2] - c[0]) * (c[3] - c[1]) : (long)i->width * i->height;
}

/* A single large picture is rendered and written in bands, and so is one that is resumed. */
static bool in_bands(const kage_scene *s, const arguments *a)
{
    enum { LARGE = 1 << 24 };
    return a->resume || (a->outputs == 1 && pixels_of(s, a) > LARGE);
}

/* The name of the picture while it is unfinished. The caller frees it. NULL: out of memory, or there is none. */
static char *part_name(const char *output)
{
    const size_t size = kage_file_part(output, NULL, 0) + 1;
    char *part = size > 1 ? malloc(size) : NULL;
    if (part)
        kage_file_part(output, part, size);
    return part;
}

/* It is no input either. */
static bool part_spares_inputs(const kage_scene *s, const char *output)
{
    char *part = part_name(output);
    const char *const name[] = {part};
    const bool good = !part || outputs_spare_inputs(s, name, 1);
    free(part);
    return good;
}

/* Options that depend on the scene or on each other. */
static bool check_options(const kage_scene *s, const arguments *a)
{
    const kage_scene_info *i = kage_scene_get_info(s);
    const int *c = a->crop;
    const long most = 1L << 28;
    if (c[2] > i->width || c[3] > i->height)
        return usage_error("--crop %d,%d,%d,%d: the picture is %d x %d pixels", c[0], c[1], c[2], c[3], i->width,
                           i->height);
    if (a->layers && !has_exr(a))
        return usage_error("--layers %s: only an EXR has layers, expected -o with a name that ends in .exr", a->layers);
    if (a->resume && (a->outputs != 1 || !has_exr(a)))
        return usage_error("--resume: expected one -o, with a name that ends in .exr");
    if (pixels_of(s, a) > most && !in_bands(s, a))
        return usage_error("-o %s: a second output of %ld pixels, expected one, or at most %ld pixels", a->output[1],
                           pixels_of(s, a), most);
    return check_layers(a->layers, s) && (!in_bands(s, a) || part_spares_inputs(s, a->output[0]));
}

/* Errors of outputs come before the work. Special files are left alone. */
static kage_status probe_outputs(const arguments *a, kage_errors **e)
{
    kage_status status = KAGE_OK;
    for (int k = 0; status == KAGE_OK && k < a->outputs; k++) {
        tidy(a, a->output[k]);
        status = kage_file_probe(a->output[k], e);
    }
    return status;
}

static void print_stages(FILE *to, const kage_stats *t)
{
    double sum = 0;
    for (int k = 0; k < t->stage_count; k++)
        sum += t->stages[k].seconds;
    for (int k = 0; k < t->stage_count; k++) { /* timed in some tiles; here as its share of the whole */
        const double share = t->stages[k].seconds / sum;
        fprintf(to, "  %-8s%9.2f ms  %8.2f ns a sample  %5.1f %%\n", t->stages[k].name, t->seconds * 1e3 * share,
                t->seconds * 1e9 / (double)t->camera_rays * share, 100 * share);
    }
}

static void print_stats(FILE *to, const kage_stats *t, double output)
{
    fprintf(to, "render    %9.2f ms  %8.2f ns a sample  %7.2f Mrays/s (camera, shadow)\n", t->seconds * 1e3,
            t->seconds * 1e9 / (double)t->camera_rays, (double)(t->camera_rays + t->shadow_rays) / t->seconds / 1e6);
    print_stages(to, t);
    fprintf(to, "output    %9.2f ms\n", output * 1e3);
    fprintf(to, "camera rays %ld, shadow rays %ld, height look-ups %ld\n", (long)t->camera_rays, (long)t->shadow_rays,
            (long)t->height_lookups);
    if (t->secondary_rays)
        fprintf(to, "reflected and refracted rays %ld\n", (long)t->secondary_rays);
    fprintf(to, "bumped samples %ld by method %s", (long)t->bumped, t->method);
    if (t->bumped) {
        fprintf(to, ", fell back %ld (%.3f %%); by order", (long)t->fell_back,
                100.0 * (double)t->fell_back / (double)t->bumped);
        for (int k = 0; k < t->order_count; k++)
            if (t->orders[k].samples)
                fprintf(to, "  %s: %ld", t->orders[k].order, (long)t->orders[k].samples);
    }
    fprintf(to, "\n");
    fprintf(to, "memory    %9.2f MB at most\n", (double)t->memory / (1 << 20));
    if (t->undefined)
        fprintf(to, "samples without a value, smooth there: %ld\n", (long)t->undefined);
    if (t->unconfirmed)
        fprintf(to, "hits of displaced or parametric surfaces that are not confirmed: %ld\n", (long)t->unconfirmed);
}

/* ---- the work ---- */

/* What there is when the first n outputs are written. */
static void note_written(const arguments *a, int n)
{
    char names[200] = "";
    size_t used = 0;
    for (int k = 0; k < n && used < sizeof names; k++)
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", k ? ", " : "", a->output[k]);
    stop_outcome("%s%s", n ? "written: " : "nothing written", names);
}

static kage_status write_outputs(const arguments *a, const kage_film *f, progress_bar *p, kage_errors **e)
{
    const kage_write_options o = {
        .bits = a->bits, .layers = a->layers, .threads = a->threads, .progress = progress_bar_show, .user = p};
    kage_status status = KAGE_OK;
    for (int k = 0; status == KAGE_OK && k < a->outputs; k++) {
        kage_write_options each = o;
        each.layers = is_exr(a, k) ? o.layers : NULL;
        each.format = a->format[k];
        status = kage_film_write(f, a->output[k], &each, e);
        if (status == KAGE_OK)
            note_written(a, k + 1);
    }
    progress_bar_end(p);
    return status;
}

/* What is done of an EXR is kept when this is interrupted. */
static kage_status render_in_bands(kage_scene *s, const arguments *a, const kage_render_options *how, progress_bar *p,
                                   kage_film **f, kage_errors **e)
{
    const bool exr = is_exr(a, 0) && !a->to_stdout;
    const kage_write_options w = {.bits = a->bits,
                                  .layers = a->layers,
                                  .threads = a->threads,
                                  .keep = exr,
                                  .resume = a->resume,
                                  .format = a->format[0]};
    char *part = exr ? part_name(a->output[0]) : NULL;
    if (part)
        stop_outcome("--resume goes on with %s", part);
    const kage_status status = kage_render_file(s, how, a->output[0], &w, f, e);
    if (status == KAGE_OK)
        note_written(a, 1);
    free(part);
    progress_bar_end(p);
    return status;
}

/* The closing line, only on a terminal, and a warning. */
static void print_end(const arguments *a, const kage_stats *t, const char *name, const char *object, bool on_terminal)
{
    if (on_terminal) {
        fprintf(stderr, "%s: %.2f s", name, t->seconds);
        for (int k = 0; k < a->outputs; k++)
            fprintf(stderr, "%s %s", k ? "," : ";", a->output[k]);
        fprintf(stderr, "\n");
    }
    if (t->unconfirmed && !a->quiet)
        fprintf(stderr, "%s: %ld hits of displaced or parametric surfaces are not confirmed\n", name,
                (long)t->unconfirmed);
    if (t->undefined && !a->quiet)
        fprintf(stderr, "%s: no value at %ld samples, first on %s: smooth there, without a shift\n", name,
                (long)t->undefined, object);
}

static int status_of(kage_status status, kage_errors *e)
{
    if (status == KAGE_OK)
        return 0;
    return print_errors(e, status == KAGE_BAD_INPUT || status == KAGE_BAD_OPTION ? EXIT_INPUT : EXIT_OUTPUT);
}

static int render_outputs(kage_scene *s, const arguments *a)
{
    const char *name = base_name(kage_scene_get_info(s)->path);
    const int *c = a->crop;
    kage_errors *e = NULL;
    kage_film *f = NULL;
    progress_bar p;
    if (!check_options(s, a))
        return EXIT_INPUT;
    kage_status status = probe_outputs(a, &e);
    if (status != KAGE_OK)
        return status_of(status, e);
    note_written(a, 0);
    progress_bar_start(&p, a->quiet, name, pixels_of(s, a));
    const kage_render_options o = {.crop = {c[0], c[1], c[2], c[3]},
                                   .layers = wants_layers(a),
                                   .timing = a->stats,
                                   .threads = a->threads,
                                   .progress = progress_bar_show,
                                   .user = &p};
    const double start = clock_now();
    if (in_bands(s, a))
        status = render_in_bands(s, a, &o, &p, &f, &e);
    else {
        status = kage_render(s, &o, &f, &e);
        if (status == KAGE_OK)
            status = write_outputs(a, f, &p, &e);
    }
    if (status == KAGE_OK) {
        const kage_stats *t = kage_film_get_stats(f);
        const int lacks = t->undefined_object;
        print_end(a, t, name, lacks < 0 ? "" : kage_scene_get_info(s)->objects[lacks].name, p.on);
        if (a->stats)
            print_stats(a->to_stdout ? stderr : stdout, t, clock_now() - start - t->seconds);
    }
    kage_film_free(f);
    return status_of(status, e);
}

int command_render(const arguments *given)
{
    stop_outcome("nothing written");
    kage_scene *s = render_can_begin(given) ? load_scene(given) : NULL;
    if (!s)
        return EXIT_INPUT;
    char *fallback = given->outputs ? NULL : default_output(kage_scene_get_info(s)->path);
    arguments a = *given;
    int status = EXIT_OUTPUT;
    if (fallback)
        a.output[a.outputs++] = fallback;
    if (!a.outputs)
        usage_error("out of memory");
    else if (!outputs_spare_inputs(s, a.output, a.outputs) ||
             (fallback && !a.overwrite && !output_is_replaceable(fallback)))
        status = EXIT_INPUT;
    else
        status = render_outputs(s, &a);
    free(fallback);
    kage_scene_free(s);
    return status;
}
