/* Bumps: height maps and functions. */
#include "read/parts.h"

#include <stdlib.h>

static bool read_samples(reader *r, node *at, image *out, map_note *note)
{
    if (!yaml_map(r->y, at, "map", "file channel"))
        return false;
    node *file = yaml_need(r->y, at, "file", "map"), *channel = yaml_get(at, "channel");
    const char *name = file ? yaml_text(r->y, file, "the file of a height map") : NULL;
    const char *layer = channel ? yaml_text(r->y, channel, "the name of a channel") : NULL;
    if (!name || (channel && !layer))
        return false;
    char *path = reader_beside(r, name);
    errors e = {0};
    const bool good = path && reader_usable(r, file, name, image_read(path, layer, out, &e), out, "samples", &e);
    if (good) {
        *note = (map_note){reader_copy(r, name), out->width, out->height, HUGE_VAL, -HUGE_VAL};
        for (size_t k = 0; k < (size_t)out->width * (size_t)out->height; k++) {
            note->low = fmin(note->low, (double)out->v[k]);
            note->high = fmax(note->high, (double)out->v[k]);
        }
    }
    free(path);
    return good;
}

/* Scale, zero and sign have no defaults: without them samples are no heights. */
static bump *read_map(reader *r, node *at, const double u[2], const double w[2], map_note *note, bump_spec *spec)
{
    image samples = {0};
    map_layout l = {.size = {1, 1}};
    bool good = yaml_map(r->y, at, "a bump with a map", "map scale zero sign size repeat offset wrap samples");
    good = reader_need_all(r, at, "scale zero sign", "a bump with a map") && good;
    good = reader_number(r, at, "scale", 0, false, BIG, "scene units for one unit of the map, 0 or more", &l.scale) &&
           good;
    good = reader_number(r, at, "zero", -BIG, false, BIG, "the map's value whose height is 0", &l.zero) && good;
    const int up = reader_word(r, at, "sign", "up down", "up (higher values are higher) or down");
    good = reader_layout(r, at, u, w, &l) && up >= 0 && good;
    good = read_samples(r, yaml_get(at, "map"), &samples, note) && good;
    if (!note->file) {
        free(samples.v);
        return NULL;
    }
    l.scale = up == 1 ? -l.scale : l.scale;
    const double low = l.scale * (note->low - l.zero), high = l.scale * (note->high - l.zero);
    if (good && fmax(fabs(low), fabs(high)) > BIG)
        good = yaml_error(r->y, yaml_get(at, "scale"),
                          "heights from %.4g to %.4g, expected them within 1000000 scene units", fmin(low, high),
                          fmax(low, high));
    spec->layout = l;
    bump *p = good ? reader_made(r, bump_map_new(&samples, &l)) : NULL;
    free(samples.v);
    return p;
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
