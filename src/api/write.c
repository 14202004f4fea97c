/* Films to files: PNG and OpenEXR, whole or band by band. */
#include "api/api.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* ---- the options ---- */

/* The word after this one in a list with commas, or NULL. */
static const char *next_word(const char *word)
{
    const char *comma = strchr(word, ',');
    return comma ? comma + 1 : NULL;
}

static bool is_wanted(const char *layers, const char *plane)
{
    const char *word = layers;
    while (word && !film_names_plane(word, strcspn(word, ","), plane))
        word = next_word(word);
    return !layers || word;
}

bool path_ends_in(const char *path, const char *ending)
{
    const size_t n = strlen(path), m = strlen(ending);
    return n > m && strcasecmp(path + n - m, ending) == 0;
}

/* Whether the file is a PNG, otherwise an EXR; or neither. */
static bool is_kind(const char *path, const kage_write_options *o, const char *ending)
{
    return o->format ? strcmp(o->format, ending + 1) == 0 : path_ends_in(path, ending);
}

/* False: an error is in *e. */
static bool options_are_good(const char *path, const kage_write_options *o, const film *f, errors *e)
{
    const bool png = is_kind(path, o, ".png");
    bool good = true;
    if (!png && !is_kind(path, o, ".exr"))
        good = o->format
                   ? errors_add(e, "%s: no such format, expected png or exr", o->format)
                   : errors_add(e, "%s: no such kind of picture, expected a name that ends in .png or .exr", path);
    if (o->bits != 0 && o->bits != 8 && o->bits != 16)
        good = errors_add(e, "%d bits, expected 8 or 16", o->bits);
    good = limits_are_good(o->limits, e) && good;
    if (o->threads < 0 || o->threads > KAGE_MAX_THREADS)
        good = errors_add(e, "%d threads, expected 0 to %d", o->threads, KAGE_MAX_THREADS);
    if (png && o->resume)
        good = errors_add(e, "%s: only an EXR can be resumed, expected a name that ends in .exr", path);
    for (const char *word = png ? NULL : o->layers; word; word = next_word(word))
        if (!film_has_layer(f, word, strcspn(word, ",")))
            good = errors_add(e, "%.*s: no such layer, expected the name of a plane of the film",
                              (int)strcspn(word, ","), word);
    return good;
}

/* ---- writing ---- */

static image_writer *begin(const picture *p, const film *f, const image_form *form, const char *path, bool png,
                           errors *e)
{
    if (png)
        return image_writer_png(path, form, e);
    const char **name = malloc((size_t)p->planes * sizeof *name);
    image_form named = *form;
    for (int k = 0; name && k < p->planes; k++)
        name[k] = f->name[p->plane[k]];
    named.name = name;
    image_writer *w = name ? image_writer_exr(path, &named, e) : NULL;
    if (!name)
        errors_add(e, "out of memory");
    free(name);
    return w;
}

static void forget(picture *p)
{
    free(p->plane);
    free(p->row);
}

kage_status picture_begin(picture *p, const kage_film *f, window part, const char *path, const kage_write_options *o,
                          errors *e)
{
    const film *planes = f->film;
    const bool png = is_kind(path, o, ".png");
    const char *layers = png ? "color" : o->layers;
    image_text text[PICTURE_TEXTS];
    char crop[PICTURE_CROP_SIZE];
    *p = (picture){0};
    if (!options_are_good(path, o, planes, e))
        return KAGE_BAD_OPTION;
    p->plane = malloc((size_t)planes->planes * sizeof *p->plane);
    p->row = malloc((size_t)planes->planes * sizeof *p->row);
    if (!p->plane || !p->row) {
        forget(p);
        errors_add(e, "out of memory");
        return KAGE_NO_MEMORY;
    }
    for (int k = 0; k < planes->planes; k++)
        if (is_wanted(layers, planes->name[k]))
            p->plane[p->planes++] = k;
    picture_crop(part, crop);
    picture_texts(f, crop, text);
    const image_form form = {.width = part.x1 - part.x0,
                             .height = part.y1 - part.y0,
                             .channels = p->planes,
                             .texts = PICTURE_TEXTS,
                             .text = text,
                             .bits = o->bits ? o->bits : 8,
                             .threads = o->threads,
                             .keep = o->keep != 0,
                             .resume = o->resume != 0};
    p->writer = begin(p, planes, &form, path, png, e);
    if (p->writer)
        return KAGE_OK;
    forget(p);
    return KAGE_NOT_WRITTEN;
}

bool picture_add(picture *p, const film *f, const progress *show)
{
    for (int k = 0; k < p->planes; k++)
        p->row[k] = f->plane[p->plane[k]];
    return image_writer_add(p->writer, f->part.y1 - f->part.y0, p->row, show);
}

kage_status picture_end(picture *p, bool whole, errors *e)
{
    const bool good = image_writer_close(p->writer, whole, e);
    forget(p);
    return good ? KAGE_OK : KAGE_NOT_WRITTEN;
}

kage_status kage_film_write(const kage_film *f, const char *path, const kage_write_options *given, kage_errors **to)
{
    kage_write_options o = given ? *given : (kage_write_options){0};
    o.keep = o.resume = 0; /* of kage_render_file alone */
    errors e = {0};
    c_locale l = c_locale_begin();
    watch w;
    const progress show = watch_begin(&w, o.progress, o.user, &l, o.limits, &f->allowed);
    picture p;
    kage_status status = picture_begin(&p, f, f->film->part, path, &o, &e);
    if (status == KAGE_OK) {
        picture_add(&p, f->film, &show);
        status = picture_end(&p, !watch_stopped(&w), &e);
    }
    c_locale_end(&l);
    return errors_give(&e, status, &w, to);
}
