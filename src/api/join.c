/* kage_file_join: check that bands belong together, and copy them into one file. */
#include "api/api.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "image/exr_join.h"

/* A band's file, and its part of the picture. */
typedef struct band {
    const char *path;
    window part;
} band;

static const char *text_of(const image_form *f, const char *key)
{
    for (int k = 0; k < f->texts; k++)
        if (strcmp(f->text[k].key, key) == 0)
            return f->text[k].value;
    return NULL;
}

/* The part that the file says, which must have its size. */
static bool read_part(const image_form *f, band *b, errors *e)
{
    const char *software = text_of(f, PICTURE_SOFTWARE), *crop = text_of(f, PICTURE_CROP);
    window *w = &b->part;
    char rest;
    return (software && strncmp(software, "kage ", 5) == 0 && crop &&
            sscanf(crop, "%d,%d,%d,%d%c", &w->x0, &w->y0, &w->x1, &w->y1, &rest) == 4 && w->x0 >= 0 && w->y0 >= 0 &&
            w->x1 <= KAGE_MAX_SIDE && w->y1 <= KAGE_MAX_SIDE && w->x1 - w->x0 == f->width &&
            w->y1 - w->y0 == f->height) ||
           errors_add(e, "%s: it is no EXR that kage has written, expected a band of a picture", b->path);
}

/* Whether both are of one scene, with the same options and channels. */
static bool belong_together(const image_form *f, const char *path, const image_form *g, const char *other, errors *e)
{
    bool same = f->channels == g->channels;
    for (int c = 0; same && c < f->channels; c++)
        same = strcmp(f->name[c], g->name[c]) == 0;
    if (!same)
        return errors_add(e, "%s: it has other layers than %s", path, other);
    for (int k = 0; k < f->texts; k++) {
        const char *key = f->text[k].key, *value = text_of(g, key);
        if (strcmp(key, PICTURE_CROP) != 0 && (!value || strcmp(value, f->text[k].value) != 0))
            return errors_add(e, "%s: it is of another picture than %s: their texts '%s' differ", path, other, key);
    }
    return f->texts == g->texts || errors_add(e, "%s: it has other texts than %s", path, other);
}

static int compare_tops(const void *a, const void *b)
{
    const band *x = a, *y = b;
    return x->part.y0 != y->part.y0 ? (x->part.y0 > y->part.y0) - (x->part.y0 < y->part.y0)
                                    : (x->part.y1 > y->part.y1) - (x->part.y1 < y->part.y1);
}

/* Sort the bands from the top on: each must begin where the one before it ends, and between two chunks. */
static bool put_in_order(band *b, int count, errors *e)
{
    bool good = true;
    qsort(b, (size_t)count, sizeof *b, compare_tops);
    for (int k = 1; k < count; k++) {
        const window above = b[k - 1].part, w = b[k].part;
        if (w.x0 != above.x0 || w.x1 != above.x1)
            good = errors_add(e, "%s: columns %d to %d, expected %d to %d, as in %s", b[k].path, w.x0, w.x1, above.x0,
                              above.x1, b[k - 1].path);
        else if (w.y0 > above.y1)
            good = errors_add(e, "%s: begins at row %d, and no band has the rows from %d on, where %s ends", b[k].path,
                              w.y0, above.y1, b[k - 1].path);
        else if (w.y0 < above.y1)
            good = errors_add(e, "%s: begins at row %d, expected %d, where %s ends", b[k].path, w.y0, above.y1,
                              b[k - 1].path);
        else if ((above.y1 - above.y0) % IMAGE_ROWS != 0)
            good = errors_add(e, "%s: it has %d rows, expected a multiple of %d, as it is not the last band",
                              b[k - 1].path, above.y1 - above.y0, IMAGE_ROWS);
    }
    return good;
}

/* Read the headers of all bands; each is open only meanwhile, but for the first. */
static bool read_bands(const char *const *path, int count, const exr_band *first, band *b, errors *e)
{
    const image_form *form = exr_band_form(first);
    bool good = true;
    for (int k = 0; k < count; k++) {
        exr_band *file = exr_band_open(path[k], e);
        b[k] = (band){path[k], {0, 0, 0, 0}};
        if (!file || !read_part(exr_band_form(file), &b[k], e) ||
            !belong_together(exr_band_form(file), path[k], form, path[0], e))
            good = false;
        exr_band_close(file);
    }
    return good && put_in_order(b, count, e);
}

/* ---- copying ---- */

static bool copy(const band *b, int count, const image_form *form, image_writer *to, const progress *p, errors *e)
{
    bool good = true;
    for (int k = 0; good && k < count; k++) {
        progress_part part = {p, NULL, (double)k / count, (k + 1.0) / count};
        const progress show = progress_of_part(&part);
        exr_band *file = exr_band_open(b[k].path, e);
        band now = {b[k].path, {0, 0, 0, 0}};
        good = file && read_part(exr_band_form(file), &now, e) &&
               belong_together(exr_band_form(file), b[k].path, form, "what it was before", e);
        if (good && memcmp(&now.part, &b[k].part, sizeof now.part) != 0)
            good = errors_add(e, "%s: it has changed meanwhile", b[k].path);
        good = good && exr_band_copy(file, to, &show, e);
        exr_band_close(file);
    }
    return good;
}

/* The header of the whole picture is that of a band, but for the size and the crop. */
static kage_status join(const band *b, int count, const exr_band *first, const char *path, const progress *p, errors *e)
{
    image_form form = *exr_band_form(first);
    const window whole = {b[0].part.x0, b[0].part.y0, b[0].part.x1, b[count - 1].part.y1};
    char crop[PICTURE_CROP_SIZE];
    image_text *text = malloc(((size_t)form.texts + 1) * sizeof *text);
    picture_crop(whole, crop);
    for (int k = 0; text && k < form.texts; k++)
        text[k] =
            (image_text){form.text[k].key, strcmp(form.text[k].key, PICTURE_CROP) == 0 ? crop : form.text[k].value};
    form.text = text;
    form.height = whole.y1 - whole.y0;
    image_writer *w = text ? image_writer_exr(path, &form, e) : NULL;
    kage_status status = KAGE_NOT_WRITTEN;
    if (!text)
        errors_add(e, "out of memory");
    if (w) {
        const bool good = copy(b, count, exr_band_form(first), w, p, e);
        const bool unread = e->count > 0;
        status = image_writer_close(w, good, e) ? KAGE_OK : unread ? KAGE_BAD_INPUT : KAGE_NOT_WRITTEN;
    }
    free(text);
    return status;
}

static bool options_are_good(int count, const char *path, errors *e)
{
    bool good = true;
    if (count < 1)
        good = errors_add(e, "%d bands, expected one or more", count);
    if (!path_ends_in(path, ".exr"))
        good = errors_add(e, "%s: only an EXR can be joined, expected a name that ends in .exr", path);
    return good;
}

kage_status kage_file_join(const char *const *paths, int count, const char *path, const kage_write_options *given,
                           kage_errors **to)
{
    const kage_write_options o = given ? *given : (kage_write_options){0};
    errors e = {0};
    c_locale l = c_locale_begin();
    watch w;
    const progress p = watch_begin(&w, o.progress, o.user, &l, o.limits, NULL);
    kage_status status = limits_are_good(o.limits, &e) && options_are_good(count, path, &e) ? KAGE_OK : KAGE_BAD_OPTION;
    band *b = status == KAGE_OK ? calloc((size_t)count, sizeof *b) : NULL;
    exr_band *first = b ? exr_band_open(paths[0], &e) : NULL;
    if (status == KAGE_OK && !b) {
        errors_add(&e, "out of memory");
        status = KAGE_NO_MEMORY;
    } else if (status == KAGE_OK)
        status = first && read_bands(paths, count, first, b, &e) ? join(b, count, first, path, &p, &e) : KAGE_BAD_INPUT;
    exr_band_close(first);
    free(b);
    c_locale_end(&l);
    return errors_give(&e, status, &w, to);
}
