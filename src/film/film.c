/* A film is planes of float, one for each colour and layer. */
#include "film/film.h"

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

/* Rows that begin with a cache line, where the width allows it, as tiles are written by lines; touched here, so that
 * rendering does not wait for the system to hand out each page. */
static float *new_plane(size_t bytes)
{
    void *p;
    if (posix_memalign(&p, 64, bytes) != 0)
        return NULL;
    return memset(p, 0, bytes);
}

film *film_new(const scene *s, window part, bool layers, errors *e)
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
    for (int k = 0; good && k < f->planes; k++) {
        f->plane[k] = new_plane(pixels * sizeof **f->plane);
        f->name[k] = plane_name(s, k);
        good = f->plane[k] && f->name[k];
    }
    if (good)
        return f;
    film_free(f);
    errors_add(e, "out of memory for a picture of %d x %d pixels", part.x1 - part.x0, part.y1 - part.y0);
    return NULL;
}

void film_copy(film *f, const film *from)
{
    const window w = f->part;
    const size_t width = (size_t)(w.x1 - w.x0), stride = (size_t)(from->part.x1 - from->part.x0);
    for (int k = 0; k < f->planes; k++)
        for (int y = w.y0; y < w.y1; y++)
            memcpy(f->plane[k] + (size_t)(y - w.y0) * width,
                   from->plane[k] + (size_t)(y - from->part.y0) * stride + (size_t)(w.x0 - from->part.x0),
                   width * sizeof **f->plane);
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
