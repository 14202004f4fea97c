/* Tiles of 16 x 8 pixels, which the threads take in order, and a second pass for adaptive samples. */
#include "film/render.h"

#include "base/pulse.h"
#include "base/threads.h"
#include "film/adaptive.h"
#include "film/stream.h"
#include "render/trace.h"

#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { TILE = 16, TILE_ROWS = LANES / TILE, TIMED_TILES = 8, CHUNK = 4 /* tiles that a thread takes at once */ };

/* Pictures of at most so many tiles may be done before another thread would have started. */
enum { SMALL = 64 };
static const double SECONDS_ALONE = 2e-3;

/* The caller's callback is called at least so often, in seconds, however long a tile takes. */
static const double LONGEST_SILENCE = 0.05;

/* A tile of the picture. */
typedef struct tile {
    int x0, y0, width, height;
} tile;

/* -1..1 over the picture, of n pixels in a row or column from `first` on, each at `offset` of it. */
STAGE static void screen(int n, int first, double offset, int size, real *restrict to)
{
    for (int k = 0; k < n; k++)
        to[k] = camera_screen(first + k + offset, size);
}

static inline void spread_rows(int width, int height, const real *restrict column, const real *restrict row,
                               real *restrict x, real *restrict y)
{
    for (int k = 0; k < height; k++)
        for (int c = 0; c < width; c++) {
            x[k * width + c] = column[c];
            y[k * width + c] = -row[k];
        }
}

/* Most tiles have the constant width, whose rows are a few vectors. */
STAGE static void spread(int width, int height, const real *column, const real *row, real *x, real *y)
{
    if (width == TILE)
        spread_rows(TILE, height, column, row, x, y);
    else
        spread_rows(width, height, column, row, x, y);
}

static void tile_rays(const scene *s, const tile *b, int aa, int i, int j, workspace *v)
{
    real x[LANES], y[LANES], column[TILE], row[TILE_ROWS];
    screen(b->width, b->x0, (i + 0.5) / aa, s->width, column);
    screen(b->height, b->y0, (j + 0.5) / aa, s->height, row);
    spread(b->width, b->height, column, row, x, y);
    camera_rays(&s->camera, b->width * b->height, x, y, &v->x);
}

/* Store the values of a tile's lanes in a plane, or add them. */
static inline void lay_rows(float *restrict to, size_t stride, int width, int height, const real *restrict v,
                            float weight, bool add)
{
    for (int k = 0; k < height; k++)
#pragma omp simd
        for (int c = 0; c < width; c++) {
            float x = (float)v[k * width + c] * weight, *p = &to[(size_t)k * stride + (size_t)c];
            *p = add ? *p + x : x;
        }
}

STAGE static void lay_first(float *restrict to, size_t stride, int width, int height, const real *restrict v,
                            float weight)
{
    if (width == TILE)
        lay_rows(to, stride, TILE, height, v, weight, false);
    else
        lay_rows(to, stride, width, height, v, weight, false);
}

STAGE static void lay_more(float *restrict to, size_t stride, int width, int height, const real *restrict v,
                           float weight)
{
    lay_rows(to, stride, width, height, v, weight, true);
}

static void lay(film *f, int plane, const tile *b, const real *v, float weight, bool add)
{
    float *to = f->plane[plane] + film_index(f, b->x0, b->y0);
    const size_t stride = film_width(f);
    if (weight == 1 && !add && b->width == STREAM_ROW && stream_fits(to, stride))
        stream_rows(to, stride, b->height, v); /* nothing is added later */
    else
        (add ? lay_more : lay_first)(to, stride, b->width, b->height, v, weight);
}

static void lay_layers(film *f, const tile *b, const workspace *v)
{
    const samples *o = &v->out;
    const real *const plane[] = {o->depth,    o->position.x, o->position.y, o->position.z, o->normal.x, o->normal.y,
                                 o->normal.z, o->u,          o->w,          o->height,     o->tau};
    for (int k = FILM_Z; k < FILM_ORDER; k++)
        lay(f, k, b, plane[k - FILM_Z], 1, false);
    real order[LANES];
    for (int i = 0; i < b->width * b->height; i++)
        order[i] = (real)o->order[i];
    lay(f, FILM_ORDER, b, order, 1, false);
}

static void render_tile(const tracer *tr, int aa, const tile *b, film *f, workspace *v)
{
    const float weight = 1.0f / (float)(aa * aa);
    for (int j = 0; j < aa; j++)
        for (int i = 0; i < aa; i++) {
            const bool add = i + j > 0;
            if (add && !pulse_beats(v->pulse))
                return;
            tile_rays(tr->scene, b, aa, i, j, v);
            stats_stage(v->stats, STAGE_CAMERA);
            trace(tr, b->width * b->height, v);
            lay(f, FILM_R, b, v->out.rgb.x, weight, add);
            lay(f, FILM_G, b, v->out.rgb.y, weight, add);
            lay(f, FILM_B, b, v->out.rgb.z, weight, add);
            if (tr->layers) {
                for (int l = 0; l < tr->scene->lights; l++)
                    lay(f, FILM_LIGHTS + l, b, v->visibility[l], weight, add);
                if (i == aa / 2 && j == aa / 2)
                    lay_layers(f, b, v);
            }
            stats_stage(v->stats, STAGE_FILM);
        }
}

/* The marked pixels of a tile. */
typedef struct selection {
    int count, x[LANES], y[LANES];
    size_t place[LANES]; /* film_index */
} selection;

static void select_marked(const tile *b, const film *f, const unsigned char *marked, selection *p)
{
    p->count = 0;
    for (int y = b->y0; y < b->y0 + b->height; y++)
        for (int x = b->x0; x < b->x0 + b->width; x++) {
            const size_t at = film_index(f, x, y);
            p->x[p->count] = x;
            p->y[p->count] = y;
            p->place[p->count] = at;
            p->count += marked[at];
        }
}

/* Add a wave's n samples to the pixels; pixel k has samples k * each and so on, the wave begins with sample `first`. */
static void add_samples(film *f, const selection *p, int each, int first, int n, int plane, const real *v)
{
    const float weight = 1.0f / (float)each;
    for (int i = 0; i < n; i++) {
        float *to = &f->plane[plane][p->place[(first + i) / each]], x = (float)v[i] * weight;
        *to = (first + i) % each > 0 ? *to + x : x;
    }
}

/* Render the marked pixels again with aa x aa samples each, which fill waves pixel by pixel. A pixel adds its samples
 * in the same order as in render_tile, so the result has the same bytes. */
static void refine_tile(const tracer *tr, int aa, const tile *b, const unsigned char *marked, film *f, workspace *v)
{
    const scene *s = tr->scene;
    const int each = aa * aa;
    selection p;
    select_marked(b, f, marked, &p);
    for (int first = 0; first < p.count * each && (first == 0 || pulse_beats(v->pulse)); first += LANES) {
        const int n = p.count * each - first < LANES ? p.count * each - first : LANES;
        real x[LANES], y[LANES];
        for (int i = 0; i < n; i++) {
            const int pixel = (first + i) / each, sample = (first + i) % each;
            x[i] = camera_screen(p.x[pixel] + (sample % aa + 0.5) / aa, s->width);
            y[i] = -camera_screen(p.y[pixel] + (sample / aa + 0.5) / aa, s->height);
        }
        camera_rays(&s->camera, n, x, y, &v->x);
        stats_stage(v->stats, STAGE_CAMERA);
        trace(tr, n, v);
        add_samples(f, &p, each, first, n, FILM_R, v->out.rgb.x);
        add_samples(f, &p, each, first, n, FILM_G, v->out.rgb.y);
        add_samples(f, &p, each, first, n, FILM_B, v->out.rgb.z);
        for (int l = 0; tr->layers && l < s->lights; l++)
            add_samples(f, &p, each, first, n, FILM_LIGHTS + l, v->visibility[l]);
        stats_stage(v->stats, STAGE_FILM);
    }
}

/* A pass over the film: all pixels with aa x aa samples, or the marked ones again. */
typedef struct pass {
    int aa;
    const unsigned char *marked; /* NULL: all */
    long done, all;              /* tiles, with those of other passes */
    bool stop;                   /* the caller has ended the render */
    int ended;                   /* threads that have no more tiles */
} pass;

static long tiles(window w)
{
    return (long)((w.x1 - w.x0 + TILE - 1) / TILE) * ((w.y1 - w.y0 + TILE_ROWS - 1) / TILE_ROWS);
}

/* Only the caller's thread shows progress, so a callback needs no lock. */
static void show(const render_options *o, pass *p, long done)
{
    if (is_callers_thread() && !progress_show(o->progress, "rendering", (double)done / (double)p->all)) {
#pragma omp atomic write
        p->stop = true;
    }
}

static bool is_stopped(const pass *p)
{
    bool stop;
#pragma omp atomic read
    stop = p->stop;
    return stop;
}

/* What a thread's waves ask. The caller's thread calls the callback where it has been silent for long. */
typedef struct thread_pulse {
    pulse base;
    const render_options *o;
    pass *p;
    bool callers;
    double shown; /* the clock's time */
} thread_pulse;

static bool beat(void *user)
{
    thread_pulse *k = user;
    const double now = k->callers ? stats_clock() : 0;
    if (now - k->shown > LONGEST_SILENCE) {
        long done;
#pragma omp atomic read
        done = k->p->done;
        k->shown = now;
        show(k->o, k->p, done);
    }
    return !is_stopped(k->p);
}

static void pulse_begin(thread_pulse *k, const render_options *o, pass *p)
{
    const bool callers = is_callers_thread();
    *k = (thread_pulse){{beat, k}, o, p, callers, callers ? stats_clock() : 0};
}

/* In the caller's thread: until all `threads` have ended, the callback goes on. The first wait is as short as can be,
 * as for most pictures it is the only one. */
static void wait_for_others(thread_pulse *k, int threads)
{
    const double SHORT = 1e-3, begin = stats_clock();
    const struct timespec nap = {0, 1000000};
    for (;;) {
        int ended;
#pragma omp atomic read
        ended = k->p->ended;
        if (ended == threads)
            return;
        if (stats_clock() - begin < SHORT)
            sched_yield();
        else
            nanosleep(&nap, NULL);
        beat(k);
    }
}

/* Tile n of `count` is done. They are noted by chunks: before an atomic addition the processor waits until all that was
 * stored is in the cache, here the tile's rows. */
static void note_tile(const render_options *o, pass *p, long n, long count)
{
    long done;
    if (n % CHUNK < CHUNK - 1 && n < count - 1)
        return;
#pragma omp atomic capture
    done = p->done += n % CHUNK + 1;
    show(o, p, done);
}

static void render_nth(const tracer *tr, const render_options *o, pass *p, film *f, long n, workspace *v)
{
    const window part = f->part;
    const int columns = (part.x1 - part.x0 + TILE - 1) / TILE;
    tile b = {part.x0 + (int)(n % columns) * TILE, part.y0 + (int)(n / columns) * TILE_ROWS, TILE, TILE_ROWS};
    b.width = b.x0 + TILE > part.x1 ? part.x1 - b.x0 : TILE;
    b.height = b.y0 + TILE_ROWS > part.y1 ? part.y1 - b.y0 : TILE_ROWS;
    v->stats->timing = o->timing && n % TIMED_TILES == 0;
    if (v->stats->timing)
        v->stats->clock = stats_clock();
    if (p->marked)
        refine_tile(tr, p->aa, &b, p->marked, f, v);
    else
        render_tile(tr, p->aa, &b, f, v);
    note_tile(o, p, n, tiles(part));
}

/* k: set here; it must outlive the workspace. */
static workspace *tile_workspace(const tracer *tr, const render_options *o, pass *p, thread_pulse *k)
{
    workspace *v = workspace_new(tr, progress_memory(o->progress));
    pulse_begin(k, o, p);
    if (v)
        workspace_ask(v, &k->base, tr->scene->objects);
    if (v)
        camera_common(&tr->scene->camera, LANES, &v->x); /* once, as no stage changes it */
    return v;
}

/* The caller's thread renders the first tiles by itself, for at most SECONDS_ALONE. Returns how many. To start and end
 * another thread takes longer than a small picture: up to 15 ms on a virtual machine. */
static long run_alone(const tracer *tr, const render_options *o, pass *p, film *f, stats *sum)
{
    const double end = stats_clock() + SECONDS_ALONE;
    const long count = tiles(f->part);
    thread_pulse k;
    workspace *v = tile_workspace(tr, o, p, &k);
    long n = 0;
    while (v && n < count && !p->stop && stats_clock() < end)
        render_nth(tr, o, p, f, n++, v);
    stream_end();
    if (v)
        stats_add(sum, v->stats);
    workspace_free(v);
    return n;
}

/* A thread's share of the tiles from `first` on. False: out of memory. */
static bool run_thread(const tracer *tr, const render_options *o, pass *p, film *f, long first, stats *sum)
{
    const long count = tiles(f->part);
    thread_pulse k;
    workspace *v = tile_workspace(tr, o, p, &k);
#pragma omp for schedule(dynamic, CHUNK) nowait
    for (long n = first; n < count; n++)
        if (v && !is_stopped(p))
            render_nth(tr, o, p, f, n, v);
    stream_end();
    if (v) {
#pragma omp critical /* without a name, which would be a global variable */
        stats_add(sum, v->stats);
    }
    workspace_free(v);
#pragma omp atomic update
    p->ended++;
    if (k.callers)
        wait_for_others(&k, threads_here());
    return v;
}

static bool run(const tracer *tr, const render_options *o, pass *p, film *f, stats *sum, errors *e)
{
    const long count = tiles(f->part);
    bool good = true;
    const int threads = threads_of(o->threads);
    show(o, p, p->done); /* here and at the end, as other threads may take all the tiles of a small picture */
    const long first = threads > 1 && count <= SMALL ? run_alone(tr, o, p, f, sum) : 0;
    const bool left = first < count;
#pragma omp parallel num_threads(threads) if (left)
    if (left && !run_thread(tr, o, p, f, first, sum)) {
#pragma omp atomic write
        good = false;
    }
    if (!good) {
        char words[MEMORY_WORDS];
        return errors_add(e, "the threads' waves: %s", memory_words(progress_memory(o->progress), words));
    }
    if (!p->stop)
        show(o, p, p->done);
    return !p->stop || errors_add(e, "cancelled");
}

/* One sample a pixel, then more where neighbours differ. The first pass is one pixel wider than a crop, so that pixels
 * at its edge have their neighbours and do not depend on the crop. */
static bool render_adaptive(const tracer *tr, const render_options *o, film *f, stats *sum, errors *e)
{
    const window part = f->part,
                 wide = {part.x0 - (part.x0 > 0), part.y0 - (part.y0 > 0), part.x1 + (part.x1 < tr->scene->width),
                         part.y1 + (part.y1 < tr->scene->height)};
    pass first = {.aa = 1, .all = tiles(wide) + tiles(part)},
         second = {.aa = o->aa, .done = tiles(wide), .all = first.all};
    film *margin = memcmp(&wide, &part, sizeof wide)
                       ? film_new(tr->scene, wide, tr->layers, o->threads, NULL, progress_memory(o->progress), e)
                       : f;
    bool good = margin && run(tr, o, &first, margin, sum, e);
    if (good && margin != f)
        film_copy(f, margin);
    unsigned char *marked =
        good ? adaptive_find(margin, part, o->threshold, o->threads, progress_memory(o->progress), e) : NULL;
    second.marked = marked;
    good = marked && run(tr, o, &second, f, sum, e);
    memory_free(marked);
    if (margin != f)
        film_free(margin);
    return good;
}

bool render(const tracer *tr, const render_options *o, film *f, stats *sum, errors *e)
{
    pass all = {.aa = o->aa, .all = tiles(f->part)};
    *sum = (stats){0};
    return o->aa > 1 && o->threshold >= 0 ? render_adaptive(tr, o, f, sum, e) : run(tr, o, &all, f, sum, e);
}
