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

/* Aligned to cache lines, in which tiles are written. */
static float *new_plane(size_t bytes)
{
    void *p;
    return posix_memalign(&p, 64, bytes) == 0 ? p : NULL;
}

/* The new memory, of the planes from `first` on, is touched here, so that rendering does not wait for page faults, nor
 * for its threads to start. */
static void clear(film *f, int first, size_t pixels, int threads)
{
    enum { PART = 1 << 18 }; /* values; so few are not worth a thread */
    const long parts = (long)((pixels + PART - 1) / PART), all = parts * f->planes;
    (void)threads; /* without OpenMP */
#pragma omp parallel for num_threads(threads) schedule(static) if (parts > 1)
    for (long k = parts * first; k < all; k++) {
        const size_t from = (size_t)(k % parts) * PART, rest = pixels - from;
        memset(f->plane[k / parts] + from, 0, (rest < PART ? rest : PART) * sizeof **f->plane);
    }
}

/* Take planes from a film that has the room, but no more than a few times of it. Returns how many. */
static int take_planes(film *f, film *spare, size_t pixels)
{
    enum { WASTE = 4 };
    int k = 0;
    if (!spare || spare->room < pixels || spare->room / WASTE > pixels)
        return 0;
    for (; k < f->planes && k < spare->planes; k++) {
        f->plane[k] = spare->plane[k];
        spare->plane[k] = NULL;
    }
    f->room = spare->room;
    return k;
}

film *film_new(const scene *s, window part, bool layers, int threads, film *spare, errors *e)
{
    film *f = calloc(1, sizeof *f);
    size_t pixels = (size_t)(part.x1 - part.x0) * (size_t)(part.y1 - part.y0);
    if (f) {
        f->part = part;
        f->planes = layers ? FILM_LIGHTS + s->lights : FILM_PICTURE;
        f->plane = calloc((size_t)f->planes, sizeof *f->plane);
        f->name = calloc((size_t)f->planes, sizeof *f->name);
    }
    bool good = f && f->plane && f->name;
    if (good)
        f->room = pixels;
    const int taken = good ? take_planes(f, spare, pixels) : 0;
    for (int k = 0; good && k < f->planes; k++) {
        f->plane[k] = k < taken ? f->plane[k] : new_plane(f->room * sizeof **f->plane);
        f->name[k] = plane_name(s, k);
        good = f->plane[k] && f->name[k];
    }
    if (good) {
        clear(f, taken, pixels, threads_of(threads));
        return f;
    }
    film_free(f);
    errors_add(e, "out of memory for a picture of %d x %d pixels", part.x1 - part.x0, part.y1 - part.y0);
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
    for (int k = 0; k < f->planes; k++) {
        if (f->plane)
            free(f->plane[k]);
        if (f->name)
            free(f->name[k]);
    }
    free(f->plane);
    free(f->name);
    free(f);
}
