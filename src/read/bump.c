/* Bumps: height maps and functions. */
#include "read/parts.h"

#include <stdlib.h>

/* The samples on their way from the file into the table. */
typedef struct map_reading {
    const map_layout *layout; /* NULL: it is wrong; the file is read for its own errors */
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
    m->p = bump_map_new(width, height, m->layout);
    return m->p ? NULL : "there is not enough memory for the map, or the map has more than 2^29 samples";
}

static void take_samples(void *user, int x, int y, int n, const float *v)
{
    map_reading *m = user;
    if (m->p)
        bump_map_put(m->p, x, y, n, v);
}

static bool read_samples(reader *r, node *at, map_reading *m, map_note *note)
{
    if (!yaml_map(r->y, at, "map", "file channel"))
        return false;
    node *file = yaml_need(r->y, at, "file", "map"), *channel = yaml_get(at, "channel");
    const char *name = file ? yaml_text(r->y, file, "the file of a height map") : NULL;
    const char *layer = channel ? yaml_text(r->y, channel, "the name of a channel") : NULL;
    if (!name || (channel && !layer))
        return false;
    char *path = reader_beside(r, name);
    const image_taker to = {m, begin_samples, take_samples};
    float range[2];
    errors e = {0};
    const bool was_read = path && image_read(path, layer, r->from->threads, &to, range, &e);
    const bool good = path && reader_usable(r, file, name, was_read, m->width, m->height, "samples", &e);
    if (good)
        *note = (map_note){reader_copy(r, name), m->width, m->height, (double)range[0], (double)range[1]};
    free(path);
    return good;
}

/* Whether the heights are not too large. low, high: of the samples. */
static bool check_heights(reader *r, node *at, const map_layout *l, double low, double high)
{
    const double a = l->scale * (low - l->zero), b = l->scale * (high - l->zero);
    return fmax(fabs(a), fabs(b)) <= BIG ||
           yaml_error(r->y, yaml_get(at, "scale"),
                      "heights from %.4g to %.4g, expected them within 1000000 scene units", fmin(a, b), fmax(a, b));
}

/* Scale, zero and sign have no defaults: without them samples are no heights. */
static bump *read_map(reader *r, node *at, const double u[2], const double w[2], map_note *note, bump_spec *spec)
{
    map_layout l = {.size = {1, 1}};
    bool good = yaml_map(r->y, at, "a bump with a map", "map scale zero sign size repeat offset wrap samples");
    good = reader_need_all(r, at, "scale zero sign", "a bump with a map") && good;
    good = reader_number(r, at, "scale", 0, false, BIG, "scene units for one unit of the map, 0 or more", &l.scale) &&
           good;
    good = reader_number(r, at, "zero", -BIG, false, BIG, "the map's value whose height is 0", &l.zero) && good;
    const int up = reader_word(r, at, "sign", "up down", "up (higher values are higher) or down");
    good = reader_layout(r, at, u, w, &l) && up >= 0 && good;
    l.scale = up == 1 ? -l.scale : l.scale;
    map_reading m = {.layout = good ? &l : NULL};
    const bool was_read = read_samples(r, yaml_get(at, "map"), &m, note);
    good = was_read && good && note->file && check_heights(r, at, &l, note->low, note->high);
    spec->layout = l;
    if (good) {
        bump_map_end(m.p, r->from->threads);
        return m.p;
    }
    bump_free(m.p);
    return NULL;
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
    spec->function = reader_copy(r, yaml_text(r->y, function, "a function of u and w"));
    spec->scale = scale;
    widest_extent(f, u, w);
    return reader_made(r, bump_function_new(e, scale, u, w));
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
