#include "cli/command.h"
#include "render/render.h"
#include "base/version.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The scene's file name with .png, for the current folder. */
static char *default_output(const char *path)
{
    const char *base = base_name(path), *dot = strrchr(base, '.');
    int n = dot && dot > base ? (int)(dot - base) : (int)strlen(base);
    char *name = malloc((size_t)n + 5);
    if (name)
        snprintf(name, (size_t)n + 5, "%.*s.png", n, base);
    return name;
}

/* The changes made to the scene, a line each. */
static char *joined_sets(const arguments *a)
{
    size_t size = 1;
    for (int k = 0; k < a->sets; k++)
        size += strlen(a->set[k]) + 1;
    char *text = calloc(1, size);
    for (int k = 0; text && k < a->sets; k++)
        strcat(strcat(text, k ? "\n" : ""), a->set[k]);
    return text;
}

/* Whether a word of a list, up to its comma, names a channel: as it is called, or what stands before its dot (N for
 * N.X), or color for R, G and B. */
static bool names_channel(const char *word, const char *channel)
{
    const size_t n = strcspn(word, ",");
    if (n == 5 && strncmp(word, "color", n) == 0)
        return strlen(channel) == 1 && strchr("RGB", *channel);
    return n > 0 && strncmp(word, channel, n) == 0 && (!channel[n] || channel[n] == '.');
}

/* The word after this one, or NULL. */
static const char *next_word(const char *word)
{
    const char *comma = strchr(word, ',');
    return comma ? comma + 1 : NULL;
}

static bool is_wanted(const char *layers, const char *channel)
{
    const char *word = layers;
    while (word && !names_channel(word, channel))
        word = next_word(word);
    return !layers || word;
}

/* Every word of --layers names something that the film has. */
static bool check_layers(const char *layers, const film *f)
{
    for (const char *word = layers; word; word = next_word(word)) {
        int k = 0;
        while (k < f->planes && !names_channel(word, f->name[k]))
            k++;
        if (k == f->planes)
            return usage_error(
                "--layers %.*s: no such layer, expected color, Z, P, N, uw, height, tau, order or visibility, or the "
                "name of a channel, with commas between them",
                (int)strcspn(word, ","), word);
    }
    return true;
}

/* All that the picture is made from, but for the maps: so that it can be made again from itself. No clock, no path, no
 * number of threads: the same picture has the same bytes. */
static bool write_output(const char *path, const scene *s, const arguments *a, const film *f, const char *sets,
                         errors *e)
{
    char crop[64], shadow[METHOD_NAME_SIZE];
    const int width = f->part.x1 - f->part.x0, height = f->part.y1 - f->part.y0;
    method_name(s->shadow, shadow);
    snprintf(crop, sizeof crop, "%d,%d,%d,%d", f->part.x0, f->part.y0, f->part.x1, f->part.y1);
    const image_text text[] = {
        {"Software", OUTPUT_SOFTWARE " " KAGE_VERSION " " REAL_NAME},
        {"kage:file", base_name(s->path)},
        {"kage:scene", s->source},
        {"kage:set", sets},
        {"kage:crop", crop},
        {"kage:shadow", shadow},
        {"kage:guard", s->guard ? "yes" : "no"},
    };
    const int texts = sizeof text / sizeof *text;
    if (strcmp(path + strlen(path) - 4, ".png") == 0)
        return image_write_png(path, width, height, a->bits, f->plane[FILM_R], f->plane[FILM_G], f->plane[FILM_B],
                               texts, text, e);
    image_channel *channel = malloc((size_t)f->planes * sizeof *channel);
    if (!channel)
        return errors_add(e, "%s: out of memory", path);
    int channels = 0;
    for (int k = 0; k < f->planes; k++)
        if (is_wanted(a->layers, f->name[k]))
            channel[channels++] = (image_channel){f->name[k], f->plane[k]};
    bool good = image_write_exr(path, width, height, channels, channel, texts, text, e);
    free(channel);
    return good;
}

static void print_stats(const stats *t, const scene *s, double seconds, double output)
{
    double sum = 0, n = (double)t->rays;
    for (int k = 0; k < STAGES; k++)
        sum += t->seconds[k];
    printf("render    %9.2f ms  %8.2f ns a sample  %7.2f Mrays/s (camera and shadow)\n", seconds * 1e3,
           seconds * 1e9 / n, (double)(t->rays + t->shadow_rays) / seconds / 1e6);
    for (int k = 0; k < STAGES; k++) /* timed in some tiles; here as its share of the whole */
        printf("  %-8s%9.2f ms  %8.2f ns a sample  %5.1f %%\n", stage_names[k], seconds * 1e3 * t->seconds[k] / sum,
               seconds * 1e9 / n * t->seconds[k] / sum, 100 * t->seconds[k] / sum);
    printf("output    %9.2f ms\n", output * 1e3);
    printf("camera rays %ld, shadow rays %ld, height look-ups %ld\n", t->rays, t->shadow_rays,
           t->evaluations + t->displaced.evaluations);
    if (t->secondary_rays)
        printf("reflected and refracted rays %ld\n", t->secondary_rays);
    char name[METHOD_NAME_SIZE];
    method_name(s->shadow, name);
    printf("bumped samples %ld by method %s", t->bumped, name);
    if (t->bumped) {
        printf(", fell back %ld (%.3f %%); by order", t->fell_back, 100.0 * (double)t->fell_back / (double)t->bumped);
        for (int k = 0; k < ORDER_CODES; k++)
            if (t->orders[k])
                printf("  %s: %ld", method_code_name(k - 1), t->orders[k]);
    }
    printf("\n");
    if (t->displaced.uncertain)
        printf("hits of displaced surfaces that Newton's iteration did not confirm: %ld\n", t->displaced.uncertain);
}

/* Ctrl-C while files are written takes effect between two of them: each is whole or not there. */
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

static bool write_outputs(const scene *s, const arguments *a, const char *const *output, int outputs, const film *f,
                          errors *e)
{
    static const int held[2] = {SIGINT, SIGTERM};
    struct sigaction before[2];
    char *sets = joined_sets(a);
    bool good = sets || errors_add(e, "out of memory");
    hold_signals(held, before);
    for (int i = 0; good && !stopped && i < outputs; i++)
        good = write_output(output[i], s, a, f, sets, e);
    for (int k = 0; k < 2; k++)
        sigaction(held[k], &before[k], NULL);
    free(sets);
    if (stopped)
        raise(stopped);
    return good;
}

static int render_outputs(const scene *s, const arguments *a, const char *const *output, int outputs)
{
    errors e = {0};
    window part = a->crop.x1 ? a->crop : (window){0, 0, s->width, s->height};
    if (part.x1 > s->width || part.y1 > s->height) {
        usage_error("--crop %d,%d,%d,%d: the picture is %d x %d pixels", part.x0, part.y0, part.x1, part.y1, s->width,
                    s->height);
        return EXIT_INPUT;
    }
    bool layers = false;
    for (int k = 0; k < outputs; k++)
        layers |= strcmp(output[k] + strlen(output[k]) - 4, ".exr") == 0;
    if (a->layers && !layers) {
        usage_error("--layers %s: only an EXR has layers, expected -o with a name that ends in .exr", a->layers);
        return EXIT_INPUT;
    }
    film *f = film_new(s, part, layers, &e);
    if (!f)
        return command_fail(&e, EXIT_OUTPUT);
    if (layers && !check_layers(a->layers, f)) {
        film_free(f);
        return EXIT_INPUT;
    }

    stats t;
    progress_bar p;
    tracer k = {.scene = s,
                .shadow = s->shadow,
                .guard = s->guard,
                .layers = layers,
                .displaced = s->displaced,
                .self_shadow = s->self_shadow};
    progress_bar_start(&p, a->quiet, base_name(s->path), (long)(part.x1 - part.x0) * (part.y1 - part.y0));
    render_options o = {s->aa, s->aa_threshold, a->threads, a->stats, p.on ? progress_bar_show : NULL, &p};
    double start = stats_clock();
    bool good = render(&k, &o, f, &t, &e);
    double rendered = stats_clock();
    progress_bar_end(&p);
    good = good && write_outputs(s, a, output, outputs, f, &e);
    double written = stats_clock();
    film_free(f);
    if (!good)
        return command_fail(&e, EXIT_OUTPUT);
    if (p.on) {
        fprintf(stderr, "%s: %.2f s", base_name(s->path), rendered - start);
        for (int i = 0; i < outputs; i++)
            fprintf(stderr, "%s %s", i ? "," : ";", output[i]);
        fprintf(stderr, "\n");
    }
    if (t.displaced.uncertain && !a->quiet)
        fprintf(stderr, "%s: %ld hits of displaced surfaces are not confirmed to the last digits\n", base_name(s->path),
                t.displaced.uncertain);
    if (a->stats)
        print_stats(&t, s, rendered - start, written - rendered);
    return 0;
}

int command_render(const arguments *a)
{
    scene *s = command_scene(a);
    if (!s)
        return EXIT_INPUT;
    char *fallback = a->outputs ? NULL : default_output(s->path);
    const char *one[] = {fallback};
    const char *const *output = a->outputs ? a->output : one;
    const int outputs = a->outputs ? a->outputs : 1;
    int status = EXIT_OUTPUT;
    if (!a->outputs && !fallback)
        usage_error("out of memory");
    else if (!outputs_spare_inputs(s, output, outputs) ||
             (fallback && !a->overwrite && !output_is_replaceable(fallback)))
        status = EXIT_INPUT;
    else
        status = render_outputs(s, a, output, outputs);
    free(fallback);
    scene_free(s);
    return status;
}
