/* kage render: render a scene, write the pictures, print statistics. */
#include "cli/command.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

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

static bool has_exr(const arguments *a)
{
    for (int k = 0; k < a->outputs; k++)
        if (has_ending(a->output[k], ".exr"))
            return true;
    return false;
}

/* Options that depend on the scene or on each other. */
static bool check_options(const kage_scene *s, const arguments *a)
{
    const kage_scene_info *i = kage_scene_get_info(s);
    const int *c = a->crop;
    if (c[2] > i->width || c[3] > i->height)
        return usage_error("--crop %d,%d,%d,%d: the picture is %d x %d pixels", c[0], c[1], c[2], c[3], i->width,
                           i->height);
    if (a->layers && !has_exr(a))
        return usage_error("--layers %s: only an EXR has layers, expected -o with a name that ends in .exr", a->layers);
    return check_layers(a->layers, s);
}

static void print_stages(const kage_stats *t)
{
    double sum = 0;
    for (int k = 0; k < t->stage_count; k++)
        sum += t->stages[k].seconds;
    for (int k = 0; k < t->stage_count; k++) { /* timed in some tiles; here as its share of the whole */
        const double share = t->stages[k].seconds / sum;
        printf("  %-8s%9.2f ms  %8.2f ns a sample  %5.1f %%\n", t->stages[k].name, t->seconds * 1e3 * share,
               t->seconds * 1e9 / (double)t->camera_rays * share, 100 * share);
    }
}

static void print_stats(const kage_stats *t, double output)
{
    printf("render    %9.2f ms  %8.2f ns a sample  %7.2f Mrays/s (camera and shadow)\n", t->seconds * 1e3,
           t->seconds * 1e9 / (double)t->camera_rays, (double)(t->camera_rays + t->shadow_rays) / t->seconds / 1e6);
    print_stages(t);
    printf("output    %9.2f ms\n", output * 1e3);
    printf("camera rays %ld, shadow rays %ld, height look-ups %ld\n", (long)t->camera_rays, (long)t->shadow_rays,
           (long)t->height_lookups);
    if (t->secondary_rays)
        printf("reflected and refracted rays %ld\n", (long)t->secondary_rays);
    printf("bumped samples %ld by method %s", (long)t->bumped, t->method);
    if (t->bumped) {
        printf(", fell back %ld (%.3f %%); by order", (long)t->fell_back,
               100.0 * (double)t->fell_back / (double)t->bumped);
        for (int k = 0; k < t->order_count; k++)
            if (t->orders[k].samples)
                printf("  %s: %ld", t->orders[k].order, (long)t->orders[k].samples);
    }
    printf("\n");
    if (t->unconfirmed)
        printf("hits of displaced surfaces that Newton's iteration did not confirm: %ld\n", (long)t->unconfirmed);
}

/* Ctrl-C while files are written takes effect after the current one, so each file is whole or absent. */
static volatile sig_atomic_t stopped;

static void stop(int signal) { stopped = signal; }

static void hold_signals(const int held[2], struct sigaction before[2])
{
    struct sigaction hold = {.sa_handler = stop, .sa_flags = SA_RESTART};
    sigemptyset(&hold.sa_mask);
    for (int k = 0; k < 2; k++) {
        sigaction(held[k], NULL, &before[k]);
        if (before[k].sa_handler != SIG_IGN)
            sigaction(held[k], &hold, NULL);
    }
}

static kage_status write_outputs(const arguments *a, const kage_film *f, kage_errors **e)
{
    static const int held[2] = {SIGINT, SIGTERM};
    struct sigaction before[2];
    kage_status status = KAGE_OK;
    hold_signals(held, before);
    for (int k = 0; status == KAGE_OK && !stopped && k < a->outputs; k++)
        status = has_ending(a->output[k], ".png") ? kage_film_write_png(f, a->output[k], a->bits, e)
                                                  : kage_film_write_exr(f, a->output[k], a->layers, a->threads, e);
    for (int k = 0; k < 2; k++)
        sigaction(held[k], &before[k], NULL);
    if (stopped)
        raise(stopped);
    return status;
}

/* The closing line, only on a terminal, and a warning. */
static void print_end(const arguments *a, const kage_stats *t, const char *name, bool on_terminal)
{
    if (on_terminal) {
        fprintf(stderr, "%s: %.2f s", name, t->seconds);
        for (int k = 0; k < a->outputs; k++)
            fprintf(stderr, "%s %s", k ? "," : ";", a->output[k]);
        fprintf(stderr, "\n");
    }
    if (t->unconfirmed && !a->quiet)
        fprintf(stderr, "%s: %ld hits of displaced surfaces are not confirmed to the last digits\n", name,
                (long)t->unconfirmed);
}

static int render_outputs(kage_scene *s, const arguments *a)
{
    const kage_scene_info *i = kage_scene_get_info(s);
    const char *name = base_name(i->path);
    const int *c = a->crop;
    const bool cropped = c[2] > 0;
    kage_errors *e;
    kage_film *f;
    progress_bar p;
    if (!check_options(s, a))
        return EXIT_INPUT;
    progress_bar_start(&p, a->quiet, name, cropped ? (long)(c[2] - c[0]) * (c[3] - c[1]) : (long)i->width * i->height);
    const kage_render_options o = {.crop = {c[0], c[1], c[2], c[3]},
                                   .layers = has_exr(a),
                                   .timing = a->stats,
                                   .threads = a->threads,
                                   .progress = progress_bar_show,
                                   .user = &p};
    kage_status status = kage_render(s, &o, &f, &e);
    progress_bar_end(&p);
    const double start = clock_now();
    if (status == KAGE_OK)
        status = write_outputs(a, f, &e);
    if (status == KAGE_OK) {
        const kage_stats *t = kage_film_get_stats(f);
        print_end(a, t, name, p.on);
        if (a->stats)
            print_stats(t, clock_now() - start);
    }
    kage_film_free(f);
    return status == KAGE_OK ? 0 : print_errors(e, EXIT_OUTPUT);
}

int command_render(const arguments *given)
{
    kage_scene *s = load_scene(given);
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
