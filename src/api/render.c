/* kage_render and kage_render_file: check the options, apply them to a copy of the scene's settings, render a film or
 * band by band, and report the counts. */
#include "api/api.h"

#include "base/threads.h"
#include "film/render.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What to render: the scene with the caller's options applied. `view` is a shallow copy and owns nothing. */
typedef struct job {
    scene view;
    window part;
    bool layers;
} job;

static bool chosen(kage_choice c, bool scene_says) { return c == KAGE_AS_SCENE ? scene_says : c == KAGE_YES; }

static bool is_choice(kage_choice c) { return c == KAGE_AS_SCENE || c == KAGE_YES || c == KAGE_NO; }

/* Each option by itself. False: an error is in *e. */
static bool options_are_good(const kage_render_options *o, errors *e)
{
    method m;
    bump_shadow b;
    bool good = true;
    if (o->method && !method_parse(o->method, &m))
        good = errors_add(e, "'%.60s' is no method, expected %s", o->method, method_expected);
    if (o->bump_shadow && !bump_shadow_parse(o->bump_shadow, &b))
        good = errors_add(e, "'%.60s' is no shadow of bumps, expected %s", o->bump_shadow, bump_shadow_expected);
    if (!is_choice(o->guard) || !is_choice(o->displaced) || !is_choice(o->self_shadow) || !is_choice(o->shifted))
        good = errors_add(e, "no choice, expected KAGE_AS_SCENE, KAGE_YES or KAGE_NO");
    if ((o->width != 0 || o->height != 0) &&
        (o->width < 1 || o->height < 1 || o->width > KAGE_MAX_SIDE || o->height > KAGE_MAX_SIDE))
        good = errors_add(e, "a picture of %d x %d pixels, expected 1 to %d each", o->width, o->height, KAGE_MAX_SIDE);
    if (o->aa < 0 || o->aa > KAGE_MAX_AA)
        good = errors_add(e, "%d samples along a pixel's side, expected 1 to %d", o->aa, KAGE_MAX_AA);
    if (!(o->aa_threshold >= 0 && o->aa_threshold <= 3))
        good = errors_add(e, "a threshold of %g, expected 0 to 3", o->aa_threshold);
    if (o->threads < 0 || o->threads > KAGE_MAX_THREADS)
        good = errors_add(e, "%d threads, expected 0 to %d", o->threads, KAGE_MAX_THREADS);
    return good;
}

/* The scene's camera for another size. */
static void resize(scene *s, int width, int height)
{
    const camera_view *v = &s->view;
    s->width = width;
    s->height = height;
    if (s->camera.orthographic)
        camera_orthographic(&s->camera, s->camera.from, v->at, v->up, v->width, width, height);
    else
        camera_look(&s->camera, s->camera.from, v->at, v->up, v->fov, width, height);
}

static bool set_crop(const int crop[4], job *j, errors *e)
{
    static const int none[4] = {0};
    const int width = j->view.width, height = j->view.height;
    j->part = (window){0, 0, width, height};
    if (memcmp(crop, none, sizeof none) == 0)
        return true;
    j->part = (window){crop[0], crop[1], crop[2], crop[3]};
    if (crop[0] < 0 || crop[1] < 0 || crop[0] >= crop[2] || crop[1] >= crop[3] || crop[2] > width || crop[3] > height)
        return errors_add(e, "crop %d,%d,%d,%d: expected a part of the picture, which has %d x %d pixels", crop[0],
                          crop[1], crop[2], crop[3], width, height);
    return true;
}

/* Apply the options. Not KAGE_OK: an error is in *e. */
static kage_status settle(kage_scene *k, const kage_render_options *o, job *j, const progress *p, errors *e)
{
    const scene *first = k->first;
    reading r = {chosen(o->displaced, first->displaced), first->shadow, first->bump_shadow};
    if (!options_are_good(o, e) || !limits_are_good(o->limits, e))
        return KAGE_BAD_OPTION;
    if (o->method)
        method_parse(o->method, &r.shadow);
    if (o->bump_shadow)
        bump_shadow_parse(o->bump_shadow, &r.bump_shadow);
    const scene *s = scene_reading(k, r, p, e);
    if (!s)
        return KAGE_BAD_INPUT;
    j->view = *s;
    j->view.shadow = r.shadow;
    j->view.bump_shadow = r.bump_shadow;
    j->view.shifted = chosen(o->shifted, s->shifted);
    j->view.guard = chosen(o->guard, s->guard);
    j->view.self_shadow = chosen(o->self_shadow, s->self_shadow);
    if (o->aa)
        j->view.aa = o->aa;
    if (o->aa_threshold > 0)
        j->view.aa_threshold = o->aa_threshold;
    if (o->width)
        resize(&j->view, o->width, o->height);
    j->layers = o->layers != 0;
    return set_crop(o->crop, j, e) ? KAGE_OK : KAGE_BAD_OPTION;
}

/* ---- what a picture is made from ---- */

/* Append a line to *text, which is freed and NULL once there is no memory. */
static void add_line(char **text, const char *fmt, ...) KAGE_PRINTF(2, 3);
static void add_line(char **text, const char *fmt, ...)
{
    char line[128];
    va_list args;
    va_start(args, fmt);
    vsnprintf(line, sizeof line, fmt, args);
    va_end(args);
    const size_t n = *text ? strlen(*text) : 0;
    char *more = *text ? realloc(*text, n + strlen(line) + 2) : NULL;
    if (more)
        sprintf(more + n, "%s%s", n ? "\n" : "", line);
    else
        free(*text);
    *text = more;
}

static const char *yes(bool x) { return x ? "true" : "false"; }

/* All changes of the scene, a line each: those it was read with, then the options. NULL: out of memory. */
static char *sets_of(const kage_scene *k, const kage_render_options *o, const scene *view)
{
    char name[METHOD_NAME_SIZE];
    size_t size = 1;
    for (int i = 0; i < k->sets; i++)
        size += strlen(k->set[i]) + 1;
    char *text = calloc(1, size);
    for (int i = 0; text && i < k->sets; i++)
        strcat(strcat(text, i ? "\n" : ""), k->set[i]);
    method_name(view->shadow, name);
    if (o->method)
        add_line(&text, "render.shadow=%s", name);
    if (o->shifted)
        add_line(&text, "render.shade=%s", view->shifted ? "shifted" : "smooth");
    bump_shadow_name(view->bump_shadow, name);
    if (o->bump_shadow)
        add_line(&text, "render.bump_shadow=%s", name);
    if (o->displaced)
        add_line(&text, "render.surface=%s", view->displaced ? "displaced" : "smooth");
    if (o->guard)
        add_line(&text, "render.guard=%s", yes(view->guard));
    if (o->self_shadow)
        add_line(&text, "render.self_shadow=%s", yes(view->self_shadow));
    if (o->width)
        add_line(&text, "image.size=[%d, %d]", view->width, view->height);
    if (o->aa)
        add_line(&text, "render.aa=%d", view->aa);
    if (o->aa_threshold > 0)
        add_line(&text, "render.aa_threshold=%.17g", view->aa_threshold);
    return text;
}

/* An empty film. NULL: an error is in *e. */
static kage_film *new_film(const kage_scene *k, const kage_render_options *o, const job *j, memory *m, errors *e)
{
    const char *slash = strrchr(k->first->path, '/');
    kage_film *f = calloc(1, sizeof *f);
    if (f) {
        f->file = strdup(slash ? slash + 1 : k->first->path);
        f->source = strdup(k->first->source);
        f->sets = sets_of(k, o, &j->view);
        f->stages = calloc(STAGES, sizeof *f->stages);
        method_name(j->view.shadow, f->method);
        f->guard = j->view.guard;
        f->allowed = (allowance){.budget = budget_share(k->allowed.budget), .most = k->allowed.most};
    }
    if (!f || !f->file || !f->source || !f->sets || !f->stages)
        errors_add(e, "out of memory");
    else if ((f->film = film_new(&j->view, j->part, j->layers, o->threads, o->reuse ? o->reuse->film : NULL, m, e)))
        return f;
    kage_film_free(f);
    return NULL;
}

static void set_stats(kage_film *f, const stats *t, double seconds)
{
    for (int k = 0; k < STAGES; k++)
        f->stages[k] = (kage_stage){stage_names[k], t->seconds[k]};
    for (int k = 0; k < ORDER_CODES; k++)
        f->orders[k] = (kage_order_count){method_code_name(k - 1), t->orders[k]};
    f->stats = (kage_stats){
        .seconds = seconds,
        .method = f->method,
        .camera_rays = t->rays,
        .shadow_rays = t->shadow_rays,
        .secondary_rays = t->secondary_rays,
        .height_lookups = t->evaluations + t->displaced.evaluations,
        .bumped = t->bumped,
        .fell_back = t->fell_back,
        .unconfirmed = t->displaced.uncertain + t->patches.unsure,
        .stage_count = STAGES,
        .order_count = ORDER_CODES,
        .stages = f->stages,
        .orders = f->orders,
        .undefined = t->undefined,
        .undefined_object = t->undefined_object - 1,
        .memory = budget_peak(f->allowed.budget),
    };
}

/* Render the film's window, and add to the counts and the time. */
static bool fill(kage_film *f, const job *j, const kage_render_options *o, const progress *p, stats *sum,
                 double *seconds, errors *e)
{
    const scene *s = &j->view;
    const tracer k = {.scene = s,
                      .shadow = s->shadow,
                      .guard = s->guard,
                      .shifted = s->shifted,
                      .bump_shadow = s->bump_shadow,
                      .layers = j->layers,
                      .displaced = s->displaced,
                      .self_shadow = s->self_shadow};
    const render_options how = {s->aa, s->aa_threshold, o->threads, o->timing != 0, p};
    stats t;
    const double start = clock_seconds();
    const bool good = render(&k, &how, f->film, &t, e);
    picture_crop(f->film->part, f->crop);
    stats_add(sum, &t);
    *seconds += clock_seconds() - start;
    set_stats(f, sum, *seconds);
    return good;
}

/* A picture of this part is not too large for a film. */
static bool fits_film(window w, errors *e)
{
    const long pixels = (long)(w.x1 - w.x0) * (w.y1 - w.y0);
    return pixels <= IMAGE_MAX_PIXELS ||
           errors_add(e, "a film of %ld pixels, expected at most %ld, or to be written in bands (kage_render_file)",
                      pixels, IMAGE_MAX_PIXELS);
}

kage_status kage_render(kage_scene *k, const kage_render_options *given, kage_film **out, kage_errors **to)
{
    const kage_render_options o = given ? *given : (kage_render_options){0};
    errors e = {0};
    job j;
    stats t = {0};
    double seconds = 0;
    c_locale l = c_locale_begin();
    watch w;
    const progress p = watch_begin(&w, o.progress, o.user, &l, o.limits, &k->allowed);
    kage_status status = settle(k, &o, &j, &p, &e);
    if (status == KAGE_OK && !fits_film(j.part, &e))
        status = KAGE_BAD_OPTION;
    if (status == KAGE_OK)
        progress_show(&p, "rendering", 0); /* a large film takes its time */
    kage_film *f = status == KAGE_OK && !watch_stopped(&w) ? new_film(k, &o, &j, &w.memory, &e) : NULL;
    kage_film_free(o.reuse);
    const bool good = f && fill(f, &j, &o, &p, &t, &seconds, &e) && !watch_stopped(&w);
    c_locale_end(&l);
    if (!good) {
        kage_film_free(f);
        status = status == KAGE_OK ? KAGE_NO_MEMORY : status;
    }
    *out = good ? f : NULL;
    return errors_give(&e, status, &w, to);
}

/* ---- in bands ---- */

/* The rows of a band: 64 MiB of film, or more where many threads share them, but not above 1 GiB. */
static int band_rows(const job *j, int threads)
{
    enum { MIB = 1 << 20, LEAST = 64, MOST = 1024, CHUNKS = 2 };
    const long planes = j->layers ? FILM_LIGHTS + j->view.lights : FILM_PICTURE;
    const long row = planes * (j->part.x1 - j->part.x0) * (long)sizeof(float);
    const long busy = (long)CHUNKS * threads_of(threads) * IMAGE_ROWS, most = (long)MOST * MIB / row;
    long rows = (long)LEAST * MIB / row;
    rows = rows < busy ? busy : rows;
    rows = rows > most ? most : rows;
    return rows > IMAGE_ROWS ? (int)(rows - rows % IMAGE_ROWS) : IMAGE_ROWS;
}

/* Render and write the rows that are not in the file yet. */
static bool fill_bands(kage_film *f, const job *j, const kage_render_options *o, int rows, picture *to,
                       const progress *p, errors *e)
{
    const window part = j->part;
    const double all = part.y1 - part.y0;
    stats t = {0};
    double seconds = 0;
    bool good = true;
    for (int y = part.y0 + image_writer_rows(to->writer), next; good && y < part.y1; y = next) {
        next = part.y1 - y < rows ? part.y1 : y + rows;
        const double from = (y - part.y0) / all, end = (next - part.y0) / all, half = (from + end) / 2;
        progress_part first = {p, "rendering", from, half}, second = {p, "rendering", half, end};
        const progress rendering = progress_of_part(&first), writing = progress_of_part(&second);
        film_move(f->film, y, next);
        good = fill(f, j, o, &rendering, &t, &seconds, e) && picture_add(to, f->film, &writing);
    }
    return good;
}

static kage_film *new_band(const kage_scene *k, const kage_render_options *o, const job *j, int rows, memory *m,
                           errors *e)
{
    job band = *j;
    if (j->part.y1 - j->part.y0 > rows)
        band.part.y1 = j->part.y0 + rows;
    return new_film(k, o, &band, m, e);
}

kage_status kage_render_file(kage_scene *k, const kage_render_options *given, const char *path,
                             const kage_write_options *how, kage_film **out, kage_errors **to)
{
    const kage_render_options o = given ? *given : (kage_render_options){0};
    const kage_write_options write = how ? *how : (kage_write_options){0};
    errors e = {0};
    job j;
    picture file;
    c_locale l = c_locale_begin();
    watch w;
    const progress p = watch_begin(&w, o.progress, o.user, &l, o.limits, &k->allowed);
    kage_status status = settle(k, &o, &j, &p, &e);
    if (status == KAGE_OK && (write.band < 0 || write.band % IMAGE_ROWS != 0)) {
        errors_add(&e, "a band of %d rows, expected a multiple of %d", write.band, IMAGE_ROWS);
        status = KAGE_BAD_OPTION;
    }
    const int rows = status != KAGE_OK ? 0 : write.band ? write.band : band_rows(&j, o.threads);
    kage_film *f = status == KAGE_OK ? new_band(k, &o, &j, rows, &w.memory, &e) : NULL;
    kage_film_free(o.reuse);
    if (status == KAGE_OK)
        status = f ? picture_begin(&file, f, j.part, path, &write, &e) : KAGE_NO_MEMORY;
    if (status == KAGE_OK) {
        const bool good = fill_bands(f, &j, &o, rows, &file, &p, &e) && !watch_stopped(&w);
        status = picture_end(&file, good, &e);
    }
    c_locale_end(&l);
    if (status != KAGE_OK || !out) {
        kage_film_free(f);
        f = NULL;
    }
    if (out)
        *out = f;
    return errors_give(&e, status, &w, to);
}
