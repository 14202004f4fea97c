/* Films: their planes, their layers by name, and writing them as PNG and OpenEXR. */
#include "api/api.h"

#include "image/image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The text `Software` in a picture begins with this; the version follows. */
#define SOFTWARE "kage"

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

void kage_film_free(kage_film *f)
{
    if (!f)
        return;
    film_free(f->film);
    free(f->file);
    free(f->source);
    free(f->sets);
    free(f->stages);
    free(f);
}

/* ---- layers ---- */

/* Whether a word of n letters names a plane: its whole name, the part before the dot (N for N.X), or `color` for R, G
 * and B. */
static bool names_plane(const char *word, size_t n, const char *plane)
{
    if (n == 5 && strncmp(word, "color", n) == 0)
        return strlen(plane) == 1 && strchr("RGB", *plane);
    return n > 0 && strncmp(word, plane, n) == 0 && (!plane[n] || plane[n] == '.');
}

static bool has_layer(const film *f, const char *word, size_t n)
{
    for (int k = 0; k < f->planes; k++)
        if (names_plane(word, n, f->name[k]))
            return true;
    return false;
}

int kage_scene_has_layer(const kage_scene *k, const char *word)
{
    errors e = {0};
    film *f = film_new(k->first, (window){0, 0, 1, 1}, true, &e);
    const bool found = f && has_layer(f, word, strlen(word));
    film_free(f);
    errors_free(&e);
    return found;
}

/* The word after this one in a list with commas, or NULL. */
static const char *next_word(const char *word)
{
    const char *comma = strchr(word, ',');
    return comma ? comma + 1 : NULL;
}

static bool is_wanted(const char *layers, const char *plane)
{
    const char *word = layers;
    while (word && !names_plane(word, strcspn(word, ","), plane))
        word = next_word(word);
    return !layers || word;
}

/* ---- files ---- */

enum { TEXTS = 7 };
typedef struct picture_texts {
    image_text text[TEXTS];
    char crop[64];
} picture_texts;

/* What the picture is made from, except for maps, so that it can be rendered again. No clock, path or number of
 * threads: the same picture has the same bytes. */
static void texts_of(const kage_film *f, picture_texts *t)
{
    const window w = f->film->part;
    snprintf(t->crop, sizeof t->crop, "%d,%d,%d,%d", w.x0, w.y0, w.x1, w.y1);
    const image_text text[TEXTS] = {
        {"Software", SOFTWARE " " KAGE_VERSION " " REAL_NAME},
        {"kage:file", f->file},
        {"kage:scene", f->source},
        {"kage:set", f->sets},
        {"kage:crop", t->crop},
        {"kage:shadow", f->method},
        {"kage:guard", f->guard ? "yes" : "no"},
    };
    memcpy(t->text, text, sizeof text);
}

kage_status kage_film_write_png(const kage_film *f, const char *path, int bits, kage_errors **to)
{
    errors e = {0};
    picture_texts t;
    float *const *plane = f->film->plane;
    if (bits != 0 && bits != 8 && bits != 16)
        return error_give(KAGE_BAD_OPTION, to, "%d bits, expected 8 or 16", bits);
    texts_of(f, &t);
    const bool good = image_write_png(path, kage_film_width(f), kage_film_height(f), bits ? bits : 8, plane[FILM_R],
                                      plane[FILM_G], plane[FILM_B], TEXTS, t.text, &e);
    return errors_give(&e, good ? KAGE_OK : KAGE_NOT_WRITTEN, NULL, to);
}

kage_status kage_film_write_exr(const kage_film *f, const char *path, const char *layers, int threads, kage_errors **to)
{
    errors e = {0};
    picture_texts t;
    int channels = 0;
    if (threads < 0 || threads > KAGE_MAX_THREADS)
        return error_give(KAGE_BAD_OPTION, to, "%d threads, expected 0 to %d", threads, KAGE_MAX_THREADS);
    for (const char *word = layers; word; word = next_word(word))
        if (!has_layer(f->film, word, strcspn(word, ",")))
            return error_give(KAGE_BAD_OPTION, to, "%.*s: no such layer, expected the name of a plane of the film",
                              (int)strcspn(word, ","), word);
    image_channel *channel = malloc((size_t)f->film->planes * sizeof *channel);
    if (!channel)
        return error_give(KAGE_NO_MEMORY, to, "out of memory");
    for (int k = 0; k < f->film->planes; k++)
        if (is_wanted(layers, f->film->name[k]))
            channel[channels++] = (image_channel){f->film->name[k], f->film->plane[k]};
    texts_of(f, &t);
    const bool good =
        image_write_exr(path, threads, kage_film_width(f), kage_film_height(f), channels, channel, TEXTS, t.text, &e);
    free(channel);
    return errors_give(&e, good ? KAGE_OK : KAGE_NOT_WRITTEN, NULL, to);
}

int kage_file_is_picture(const char *path) { return image_png_is_from(path, SOFTWARE); }
