/* Films: their planes, what their files say of them, their bytes for a screen, and their layers by name. */
#include "api/api.h"

#include "base/threads.h"
#include "image/srgb.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int kage_film_width(const kage_film *f) { return f->film->part.x1 - f->film->part.x0; }

int kage_film_height(const kage_film *f) { return f->film->part.y1 - f->film->part.y0; }

void kage_film_crop(const kage_film *f, int crop[4])
{
    memcpy(crop, &f->film->part, sizeof f->film->part); /* x0 y0 x1 y1 */
}

int kage_film_plane_count(const kage_film *f) { return f->film->planes; }

const char *kage_film_plane_name(const kage_film *f, int k)
{
    return k >= 0 && k < f->film->planes ? f->film->name[k] : NULL;
}

const float *kage_film_plane(const kage_film *f, const char *name)
{
    for (int k = 0; k < f->film->planes; k++)
        if (strcmp(f->film->name[k], name) == 0)
            return f->film->plane[k];
    return NULL;
}

const kage_stats *kage_film_get_stats(const kage_film *f) { return &f->stats; }

/* ---- what a picture's file says of it ---- */

void picture_crop(window w, char text[PICTURE_CROP_SIZE])
{
    snprintf(text, PICTURE_CROP_SIZE, "%d,%d,%d,%d", w.x0, w.y0, w.x1, w.y1);
}

/* What the picture is made from, except for maps, so that it can be rendered again. No clock, path or number of
 * threads: the same picture has the same bytes. */
void picture_texts(const kage_film *f, const char *crop, image_text to[PICTURE_TEXTS])
{
    const image_text text[PICTURE_TEXTS] = {
        {PICTURE_SOFTWARE, SOFTWARE " " KAGE_VERSION " " REAL_NAME},
        {"kage:file", f->file},
        {"kage:scene", f->source},
        {"kage:set", f->sets},
        {PICTURE_CROP, crop},
        {"kage:shadow", f->method},
        {"kage:guard", f->guard ? "yes" : "no"},
    };
    memcpy(to, text, sizeof text);
}

int kage_film_metadata_count(const kage_film *f)
{
    (void)f;
    return PICTURE_TEXTS;
}

kage_metadata kage_film_metadata(const kage_film *f, int k)
{
    image_text text[PICTURE_TEXTS];
    picture_texts(f, f->crop, text);
    return k >= 0 && k < PICTURE_TEXTS ? (kage_metadata){text[k].key, text[k].value} : (kage_metadata){NULL, NULL};
}

kage_status kage_film_srgb(const kage_film *f, uint8_t *rgba, size_t row_bytes, int threads)
{
    enum { ALONE = 1 << 15 }; /* pixels: so few are not worth a thread */
    const int width = kage_film_width(f), height = kage_film_height(f);
    const size_t row = row_bytes ? row_bytes : 4 * (size_t)width;
    const float *const *plane = (const float *const *)f->film->plane;
    if (threads < 0 || threads > KAGE_MAX_THREADS || row < 4 * (size_t)width)
        return KAGE_BAD_OPTION;
    srgb *s = srgb_create(8);
    if (!s)
        return KAGE_NO_MEMORY;
#pragma omp parallel for num_threads(threads_of(threads)) schedule(static) if ((long)width * height > ALONE)
    for (int y = 0; y < height; y++) {
        const size_t at = (size_t)y * (size_t)width;
        srgb_encode_rgba(s, width, plane[FILM_R] + at, plane[FILM_G] + at, plane[FILM_B] + at, rgba + (size_t)y * row);
    }
    free(s);
    return KAGE_OK;
}

void kage_film_free(kage_film *f)
{
    if (!f)
        return;
    film_free(f->film);
    free(f->file);
    free(f->source);
    free(f->sets);
    free(f->stages);
    budget_close(f->allowed.budget);
    free(f);
}

/* ---- layers ---- */

bool film_names_plane(const char *word, size_t n, const char *plane)
{
    if (n == 5 && strncmp(word, "color", n) == 0)
        return strlen(plane) == 1 && strchr("RGB", *plane);
    return n > 0 && strncmp(word, plane, n) == 0 && (!plane[n] || plane[n] == '.');
}

bool film_has_layer(const film *f, const char *word, size_t n)
{
    for (int k = 0; k < f->planes; k++)
        if (film_names_plane(word, n, f->name[k]))
            return true;
    return false;
}

int kage_scene_has_layer(const kage_scene *k, const char *word)
{
    errors e = {0};
    film *f = film_new(k->first, (window){0, 0, 1, 1}, true, 1, NULL, NULL, &e);
    const bool found = f && film_has_layer(f, word, strlen(word));
    film_free(f);
    errors_free(&e);
    return found;
}
