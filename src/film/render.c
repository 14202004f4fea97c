/* Tiles of 16 x 8 pixels, which the threads take in order, and a second pass for adaptive samples. */
#include "film/render.h"

#include "base/clock.h"
#include "base/gate.h"
#include "base/threads.h"
#include "film/adaptive.h"
#include "film/stream.h"
#include "film/tile.h"
#include "render/trace.h"

#include <sched.h>
#include <string.h>
#include <time.h>

enum { TIMED_TILES = 8, CHUNK = 4 /* tiles that a thread takes at once */ };

/* Pictures of at most so many tiles may be done before another thread would have started. */
enum { SMALL = 64 };
static const double SECONDS_ALONE = 2e-3;

/* The caller's callback is called at least so often, in seconds, however long a tile takes. */
static const double LONGEST_SILENCE = 0.05;

/* A pass over the film: all pixels with aa x aa samples, or the marked ones again. */
typedef struct pass {
    int aa;
    const unsigned char *marked; /* NULL: all */
    gate gate;                   /* tiles, with those of other passes; shut: the caller has ended the render */
    int ended;                   /* threads that have no more tiles */
} pass;

static gate gate_of(const render_options *o, long done, long all)
{
    return (gate){.to = o->progress, .what = "rendering", .done = done, .all = all};
}

static long tiles(window w)
{
    return (long)((w.x1 - w.x0 + TILE - 1) / TILE) * ((w.y1 - w.y0 + TILE_ROWS - 1) / TILE_ROWS);
}

/* What a thread's waves ask. The caller's thread calls the callback where it has been silent for long. */
typedef struct thread_pulse {
    pulse base;
    pass *p;
    bool callers;
    double shown; /* the clock's time */
} thread_pulse;

static bool beat(void *user)
{
    thread_pulse *k = user;
    const double now = k->callers ? clock_seconds() : 0;
    if (now - k->shown > LONGEST_SILENCE) {
        k->shown = now;
        gate_pass(&k->p->gate, 0);
    }
    return gate_is_open(&k->p->gate);
}

static void pulse_begin(thread_pulse *k, pass *p)
{
    const bool callers = is_callers_thread();
    *k = (thread_pulse){{beat, k}, p, callers, callers ? clock_seconds() : 0};
}

/* In the caller's thread: until all `threads` have ended, the callback goes on. The first wait is as short as can be,
 * as for most pictures it is the only one. */
static void wait_for_others(thread_pulse *k, int threads)
{
    const double SHORT = 1e-3, begin = clock_seconds();
    const struct timespec nap = {0, 1000000};
    for (;;) {
        int ended;
#pragma omp atomic read
        ended = k->p->ended;
        if (ended == threads)
            return;
        if (clock_seconds() - begin < SHORT)
            sched_yield();
        else
            nanosleep(&nap, NULL);
        beat(k);
    }
}

/* Tile n of `count` is done. They are noted by chunks: before an atomic addition the processor waits until all that was
 * stored is in the cache, here the tile's rows. */
static void note_tile(pass *p, long n, long count)
{
    if (n % CHUNK == CHUNK - 1 || n == count - 1)
        gate_pass(&p->gate, n % CHUNK + 1);
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
        v->stats->clock = clock_seconds();
    if (p->marked)
        tile_refine(tr, p->aa, &b, p->marked, f, v);
    else
        tile_render(tr, p->aa, &b, f, v);
    note_tile(p, n, tiles(part));
}

/* k: set here; it must outlive the workspace. */
static workspace *tile_workspace(const tracer *tr, const render_options *o, pass *p, thread_pulse *k)
{
    workspace *v = workspace_new(tr, progress_memory(o->progress));
    pulse_begin(k, p);
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
    const double end = clock_seconds() + SECONDS_ALONE;
    const long count = tiles(f->part);
    thread_pulse k;
    workspace *v = tile_workspace(tr, o, p, &k);
    long n = 0;
    while (v && n < count && gate_is_open(&p->gate) && clock_seconds() < end)
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
        if (v && gate_is_open(&p->gate))
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
    gate_pass(&p->gate, 0); /* here and at the end, as other threads may take all the tiles of a small picture */
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
    if (gate_is_open(&p->gate))
        gate_pass(&p->gate, 0);
    return gate_is_open(&p->gate) || errors_add(e, "cancelled");
}

/* One sample a pixel, then more where neighbours differ. The first pass is one pixel wider than a crop, so that pixels
 * at its edge have their neighbours and do not depend on the crop. */
static bool render_adaptive(const tracer *tr, const render_options *o, film *f, stats *sum, errors *e)
{
    const window part = f->part,
                 wide = {part.x0 - (part.x0 > 0), part.y0 - (part.y0 > 0), part.x1 + (part.x1 < tr->scene->width),
                         part.y1 + (part.y1 < tr->scene->height)};
    const long all = tiles(wide) + tiles(part);
    pass first = {.aa = 1, .gate = gate_of(o, 0, all)}, second = {.aa = o->aa, .gate = gate_of(o, tiles(wide), all)};
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
    pass all = {.aa = o->aa, .gate = gate_of(o, 0, tiles(f->part))};
    *sum = (stats){0};
    return o->aa > 1 && o->threshold >= 0 ? render_adaptive(tr, o, f, sum, e) : run(tr, o, &all, f, sum, e);
}
