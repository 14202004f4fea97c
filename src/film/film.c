/* A film's memory: a plane of float for each colour and layer. */
#include "film/film.h"

#include "base/threads.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const names[FILM_LIGHTS] = {
    "R", "G", "B", "Z", "P.X", "P.Y", "P.Z", "N.X", "N.Y", "N.Z", "uw.u", "uw.w", "height", "tau", "order",
};

static char *plane_name(const scene *s, int k)
{
    const char *lit = k < FILM_LIGHTS ? "" : s->light[k - FILM_LIGHTS].name;
    size_t size = strlen(lit) + 32;
    char *name = malloc(size);
    if (name)
        snprintf(name, size, "%s%s", k < FILM_LIGHTS ? names[k] : "visibility.", lit);
    return name;
}

/* From the start of a plane to that of the next, in values: whole cache lines, in which tiles are written. */
static size_t plane_step(size_t pixels) { return (pixels + 15) / 16 * 16; }

/* New memory is touched here, so that rendering does not wait for page faults, nor for its threads to start. */
static void clear(float *to, size_t values, int threads)
{
    enum { PART = 1 << 18 }; /* values; so few are not worth a thread */
    const long parts = (long)((values + PART - 1) / PART);
    (void)threads; /* without OpenMP */
#pragma omp parallel for num_threads(threads) schedule(static) if (parts > 1)
    for (long k = 0; k < parts; k++) {
        const size_t from = (size_t)k * PART, rest = values - from;
        memset(to + from, 0, (rest < PART ? rest : PART) * sizeof *to);
    }
}

/* Memory for so many values: that of a film that has enough, but not far more (layers may come and go), or new. False:
 * out of memory. */
static bool take_memory(film *f, film *spare, size_t values, int threads, memory *m)
{
    enum { WASTE = 24 };
    if (spare && spare->room >= values && spare->room / WASTE <= values) {
        f->memory = spare->memory;
        f->room = spare->room;
        spare->memory = NULL;
        return true;
    }
    if (!(f->memory = memory_new(m, values * sizeof *f->memory)))
        return false;
    f->room = values;
    clear(f->memory, values, threads_of(threads));
    return true;
}

film *film_new(const scene *s, window part, bool layers, int threads, film *spare, memory *m, errors *e)
{
    film *f = calloc(1, sizeof *f);
    const size_t pixels = (size_t)(part.x1 - part.x0) * (size_t)(part.y1 - part.y0), step = plane_step(pixels);
    if (f) {
        f->part = part;
        f->planes = layers ? FILM_LIGHTS + s->lights : FILM_PICTURE;
        f->plane = calloc((size_t)f->planes, sizeof *f->plane);
        f->name = calloc((size_t)f->planes, sizeof *f->name);
    }
    bool good = f && f->plane && f->name && take_memory(f, spare, step * (size_t)f->planes, threads, m);
    for (int k = 0; good && k < f->planes; k++) {
        f->plane[k] = f->memory + step * (size_t)k;
        f->name[k] = plane_name(s, k);
        good = f->name[k];
    }
    if (good)
        return f;
    film_free(f);
    char words[MEMORY_WORDS];
    errors_add(e, "a picture of %d x %d pixels: %s", part.x1 - part.x0, part.y1 - part.y0, memory_words(m, words));
    return NULL;
}

void film_move(film *f, int y0, int y1)
{
    f->part.y0 = y0;
    f->part.y1 = y1;
}

void film_copy(film *f, const film *from)
{
    const window w = f->part;
    for (int k = 0; k < f->planes; k++)
        for (int y = w.y0; y < w.y1; y++)
            memcpy(f->plane[k] + film_index(f, w.x0, y), from->plane[k] + film_index(from, w.x0, y),
                   film_width(f) * sizeof **f->plane);
}

void film_free(film *f)
{
    if (!f)
        return;
    for (int k = 0; f->name && k < f->planes; k++)
        free(f->name[k]);
    memory_free(f->memory);
    free(f->plane);
    free(f->name);
    free(f);
}
