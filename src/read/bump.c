/* Bumps: height maps and functions. */
#include "read/parts.h"

#include <stdlib.h>
#include <string.h>

#define MOST_SMOOTH 32 /* samples */

/* The samples on their way from the file into the table. */
typedef struct map_reading {
    const map_layout *layout; /* NULL: it is wrong; the file is read for its own errors */
    const progress *progress;
    bump *p;
    int width, height;
} map_reading;

static const char *begin_samples(void *user, int width, int height)
{
    map_reading *m = user;
    m->width = width;
    m->height = height;
    if (!m->layout || width < 2 || height < 2) /* reader_usable refuses it */
        return NULL;
    table_grid g;
    if (!table_lay(&g, width, height, m->layout))
        return "the map has more than 2^29 samples, four for each one where both axes are mirrored";
    m->p = bump_map_new(width, height, m->layout, m->progress);
    return m->p ? NULL : "";
}

static void take_samples(void *user, int x, int y, int n, const float *v)
{
    map_reading *m = user;
    if (m->p)
        bump_map_put(m->p, x, y, n, v);
}

/* Whether the heights are not too large. low, high: of the samples. */
static bool check_heights(reader *r, node *at, const map_layout *l, double low, double high)
{
    const double a = l->scale * (low - l->zero), b = l->scale * (high - l->zero);
    return fmax(fabs(a), fabs(b)) <= BIG ||
           yaml_error(r->y, yaml_get(at, "scale"),
                      "heights from %.4g to %.4g, expected them within 1000000 scene units", fmin(a, b), fmax(a, b));
}

/* What other scenes may use: a map's table and its note, without the file's name. */
typedef struct made_map {
    bump *p;
    map_note note;
} made_map;

static void free_made(void *thing)
{
    bump_free(((made_map *)thing)->p);
    free(thing);
}

/* Samples of a file that are kept, for tables of other scales. */
typedef struct kept_samples {
    image_array image;
    float v[];
} kept_samples;

typedef struct keeping {
    kept_samples *k;
    const progress *progress;
} keeping;

/* A file's samples on their way into memory. */
static const char *begin_kept(void *user, int width, int height)
{
    keeping *to = user;
    const size_t n = (size_t)width * (size_t)height;
    kept_samples *k = to->k = memory_new(progress_memory(to->progress), sizeof *k + n * sizeof *k->v);
    if (!k)
        return "";
    k->image = (image_array){width, height, 1, IMAGE_F32, k->v};
    return NULL;
}

static void take_kept(void *user, int x, int y, int n, const float *v)
{
    kept_samples *to = ((keeping *)user)->k;
    memcpy(to->v + (size_t)y * (size_t)to->image.width + (size_t)x, v, (size_t)n * sizeof *v);
}

/* Read the samples of a file, to keep them. NULL: an error is in *e. */
static kept_samples *read_kept(reader *r, const source *from, const char *layer, errors *e)
{
    keeping k = {NULL, r->from->progress};
    const image_taker to = {&k, begin_kept, take_kept};
    float range[2];
    if (image_read(from->path, layer, r->from->threads, k.progress, &to, range, e))
        return k.k;
    memory_free(k.k);
    return NULL;
}

static char *key_of_samples(reader *r, const source *from, const char *layer)
{
    return *from->id ? reader_key(r, "samples %s %s", from->id, layer ? layer : "") : NULL;
}

/* Samples that are kept are so for the next change, too, if this one does not need them. */
static void pass_on(reader *r, const source *from, const char *layer)
{
    char *key = key_of_samples(r, from, layer);
    reader_found(r, key);
    free(key);
}

/* The samples of a file, which are kept once a scene is changed. NULL: they are not, or an error is in *e. */
static const image_array *kept_of(reader *r, const source *from, const char *layer, errors *e)
{
    char *key = key_of_samples(r, from, layer);
    kept_samples *k = reader_found(r, key);
    if (!k && key && r->from->again && (k = read_kept(r, from, layer, e)) && !reader_keep(r, key, k, memory_free))
        k = NULL;
    free(key);
    return k ? &k->image : NULL;
}

static bool read_all(reader *r, const source *from, const char *layer, map_reading *m, float range[2], errors *e)
{
    const image_taker to = {m, begin_samples, take_samples};
    if (from->array)
        return image_array_read(&from->array->image, layer, m->progress, &to, range, e);
    const image_array *kept = kept_of(r, from, layer, e);
    if (kept)
        return image_array_read(kept, NULL, m->progress, &to, range, e);
    return e->count == 0 && image_read(from->path, layer, r->from->threads, m->progress, &to, range, e);
}

/* The bits of a source's samples; 0: floats. */
static int bits_of(const source *from)
{
    if (!from->array)
        return image_png_bits(from->path);
    const image_type type = from->array->image.type;
    return type == IMAGE_U8 ? 8 : type == IMAGE_U16 ? 16 : 0;
}

/* Smooth the heights, by no more than one step of the samples each. False with an error. */
static bool smooth(reader *r, node *at, const map_layout *l, int bits, bump *p)
{
    if (l->smooth <= 0)
        return true;
    if (bits == 0)
        return yaml_error(r->y, yaml_get(at, "smooth"),
                          "the samples are floats, which have no steps to be smoothed, "
                          "expected a PNG");
    const double step = fabs(l->scale) / (double)((1 << bits) - 1);
    return bump_map_smooth(p, l->smooth, step, r->from->threads, r->from->progress) || reader_made(r, NULL);
}

/* The table and its note from a source. NULL with an error. */
static made_map *make_map(reader *r, node *at, node *file, const source *from, const char *layer, const map_layout *l)
{
    map_reading m = {.layout = l, .progress = r->from->progress};
    float range[2];
    errors e = {0};
    const bool was_read = read_all(r, from, layer, &m, range, &e);
    const bool good = reader_usable(r, file, from->name, was_read, m.width, m.height, "samples", &e);
    const int bits = good ? bits_of(from) : 0;
    made_map *made =
        good && l && check_heights(r, at, l, (double)range[0], (double)range[1]) && smooth(r, at, l, bits, m.p)
            ? reader_made(r, calloc(1, sizeof *made))
            : NULL;
    if (!made) {
        bump_free(m.p);
        return NULL;
    }
    bump_map_end(m.p, r->from->threads);
    *made = (made_map){m.p, {NULL, m.width, m.height, (double)range[0], (double)range[1], bits}};
    return made;
}

/* The key of the table. */
static char *key_of(reader *r, const source *from, const char *layer, const map_layout *l)
{
    if (!*from->id || !l)
        return NULL;
    return reader_key(r, "map %s %s %.17g %.17g %.17g %.17g %.17g %.17g %d %d %.17g", from->id, layer ? layer : "",
                      l->scale, l->zero, l->size[0], l->size[1], l->offset[0], l->offset[1], (int)l->wrap,
                      (int)l->corners, l->smooth);
}

/* The map's table, found or made. NULL with an error; l is NULL where it is wrong: the file is then read for its own
 * errors. */
static bump *table_of(reader *r, node *at, node *file, const source *from, const char *layer, const map_layout *l,
                      map_note *note)
{
    char *key = key_of(r, from, layer, l);
    made_map *made = reader_found(r, key);
    const bool found = made;
    if (!found)
        made = make_map(r, at, file, from, layer, l);
    else if (!from->array)
        pass_on(r, from, layer);
    bump *p = made ? bump_share(made->p) : NULL;
    if (made) {
        *note = made->note;
        note->file = reader_copy(r, from->name);
    }
    if (made && !found)
        reader_keep(r, key, made, free_made);
    free(key);
    return p;
}

static bump *read_file(reader *r, node *at, const map_layout *l, map_note *note)
{
    node *map = yaml_get(at, "map");
    source from;
    if (!yaml_map(r->y, map, "map", "file channel"))
        return NULL;
    node *file = yaml_need(r->y, map, "file", "map"), *channel = yaml_get(map, "channel");
    const char *layer = channel ? yaml_text(r->y, channel, "the name of a channel") : NULL;
    if (!file || (channel && !layer) || !reader_source(r, file, false, "the file of a height map", &from))
        return NULL;
    bump *p = table_of(r, at, file, &from, layer, l, note);
    source_free(&from);
    return p;
}

/* Scale, zero and sign have no defaults: without them samples are no heights. */
static bool has_heights(reader *r, node *at)
{
    static const struct {
        const char *key, *advice;
    } needed[] = {{"scale", "the height of white above black in scene units, such as scale: 0.1"},
                  {"zero", "the map's value whose height is 0, such as zero: 0.5"},
                  {"sign", "up (higher values are higher) or down"}};
    bool good = true;
    for (size_t k = 0; k < sizeof needed / sizeof *needed; k++)
        if (!yaml_get(at, needed[k].key))
            good =
                yaml_error(r->y, at, "a bump with a map lacks its '%s', expected %s", needed[k].key, needed[k].advice);
    return good;
}

static bump *read_map(reader *r, node *at, const double u[2], const double w[2], map_note *note, bump_spec *spec)
{
    map_layout l = {.size = {1, 1}};
    bool good = yaml_map(r->y, at, "a bump with a map", "map scale zero sign smooth size repeat offset wrap samples");
    good = has_heights(r, at) && good;
    good = reader_number(r, at, "scale", 0, false, BIG, "scene units for one unit of the map, 0 or more", &l.scale) &&
           good;
    good = reader_number(r, at, "zero", -BIG, false, BIG, "the map's value whose height is 0", &l.zero) && good;
    good = reader_number(r, at, "smooth", 0, false, MOST_SMOOTH, "a radius of 0 to 32 samples", &l.smooth) && good;
    const int up = reader_word(r, at, "sign", "up down", "up (higher values are higher) or down");
    good = reader_layout(r, at, u, w, &l) && up >= 0 && good;
    l.scale = up == 1 ? -l.scale : l.scale;
    spec->layout = l;
    return read_file(r, at, good ? &l : NULL, note);
}

/* The range of (u,w) over all parts of a surface, over which a function needs bounds. */
static void widest_extent(const surface *f, double u[2], double w[2])
{
    f->ops->extent(f, 0, u, w);
    for (int part = 1; part < f->ops->parts; part++) {
        double pu[2], pw[2];
        f->ops->extent(f, part, pu, pw);
        u[0] = fmin(u[0], pu[0]);
        u[1] = fmax(u[1], pu[1]);
        w[0] = fmin(w[0], pw[0]);
        w[1] = fmax(w[1], pw[1]);
    }
}

static bump *read_function(reader *r, node *at, const surface *f, bump_spec *spec)
{
    double scale = 1, u[2], w[2];
    bool good = yaml_map(r->y, at, "a bump with a function", "function scale");
    good = reader_number(r, at, "scale", -BIG, false, BIG, "a factor", &scale) && good;
    node *function = yaml_get(at, "function");
    expr *e = reader_expr(r, function, "a function of u and w");
    if (!good || !e) {
        expr_free(e);
        return NULL;
    }
    const char *text = yaml_text(r->y, function, "a function of u and w");
    spec->function = reader_copy(r, text);
    spec->scale = scale;
    widest_extent(f, u, w);
    char *key =
        text ? reader_key(r, "function %.17g %.17g %.17g %.17g %.17g %s", scale, u[0], u[1], w[0], w[1], text) : NULL;
    bump *p = reader_found_bump(r, key);
    if (p)
        expr_free(e);
    else
        p = reader_keep_bump(r, key, reader_made(r, bump_function_new(e, scale, u, w)));
    free(key);
    return p;
}

bump *reader_bump(reader *r, node *at, object *o)
{
    const surface *f = o->own;
    double u[2], w[2];
    if (!yaml_map(r->y, at, "bump", NULL))
        return NULL;
    if (!reader_either(r, at, "a bump", "map", "function") || !reader_textured(r, at, o))
        return NULL;
    reader_extent(f, &o->shape_spec, u, w);
    return reader_mirror_bump(r, o,
                              yaml_get(at, "map") ? read_map(r, at, u, w, &o->map, &o->bump_spec)
                                                  : read_function(r, at, f, &o->bump_spec));
}
