/* The scene reader's bumps: height maps and functions. */
#include "image/image.h"
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
    bool good = path && image_read(path, layer, out, &e);
    if (!good && path)
        yaml_error(r->y, file, "'%s' can't be used: %.*s", name, e.size ? (int)e.size - 1 : 0, e.text ? e.text : "");
    if (good && (out->width < 2 || out->height < 2)) {
        good =
            yaml_error(r->y, file, "'%s' has %d x %d samples, expected at least 2 x 2", name, out->width, out->height);
        free(out->v);
        *out = (image){0};
    }
    if (good) {
        *note = (map_note){reader_copy(r, name), out->width, out->height, HUGE_VAL, -HUGE_VAL};
        for (size_t k = 0; k < (size_t)out->width * (size_t)out->height; k++) {
            note->low = fmin(note->low, (double)out->v[k]);
            note->high = fmax(note->high, (double)out->v[k]);
        }
    }
    errors_free(&e);
    free(path);
    return good;
}

/* Scale, zero level and sign have no default: samples are not heights without them. */
static bump *read_map(reader *r, node *at, const double u[2], const double w[2], map_note *note, bump_spec *spec)
{
    image samples = {0};
    map_layout l = {.size = {1, 1}};
    bool good = yaml_map(r->y, at, "a bump with a map", "map scale zero sign size repeat offset wrap samples");
    node *scale = yaml_need(r->y, at, "scale", "a bump with a map"),
         *zero = yaml_need(r->y, at, "zero", "a bump with a map");
    node *sign = yaml_need(r->y, at, "sign", "a bump with a map");
    good = scale &&
           yaml_number(r->y, scale, 0, false, BIG, "scene units for one unit of the map, 0 or more", &l.scale) && good;
    good = zero && yaml_number(r->y, zero, -BIG, false, BIG, "the map's value whose height is 0", &l.zero) && good;
    int up = sign ? yaml_word(r->y, sign, "up down", "up (higher values are higher) or down") : -1;
    good = reader_layout(r, at, u, w, &l) && up >= 0 && good;
    good = read_samples(r, yaml_get(at, "map"), &samples, note) && good;
    if (!note->file) {
        free(samples.v);
        return NULL;
    }
    l.scale = up == 1 ? -l.scale : l.scale;
    const double low = l.scale * (note->low - l.zero), high = l.scale * (note->high - l.zero);
    if (good && fmax(fabs(low), fabs(high)) > BIG)
        good = yaml_error(r->y, scale, "heights from %.4g to %.4g, expected them within 1000000 scene units",
                          fmin(low, high), fmax(low, high));
    spec->layout = l;
    bump *p = good ? bump_map_new(&samples, &l) : NULL;
    if (good && !p)
        errors_add(r->e, "out of memory");
    free(samples.v);
    return p;
}

/* The range of (u,w) over all parts of a surface: a function needs its bounds there. */
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
    bump *p = bump_function_new(e, scale, u, w);
    if (!p)
        errors_add(r->e, "out of memory");
    return p;
}

bump *reader_bump(reader *r, node *at, object *o)
{
    const surface *f = o->own;
    double u[2], w[2];
    if (!yaml_map(r->y, at, "bump", NULL))
        return NULL;
    node *map = yaml_get(at, "map"), *function = yaml_get(at, "function");
    if (!map == !function) {
        yaml_error(r->y, at, "a bump with %s, expected either 'map' or 'function'",
                   map ? "both map and function" : "neither map nor function");
        return NULL;
    }
    if (!reader_textured(r, at, o))
        return NULL;
    reader_extent(f, &o->shape_spec, u, w);
    return reader_mirror_bump(
        r, o, map ? read_map(r, at, u, w, &o->map, &o->bump_spec) : read_function(r, at, f, &o->bump_spec));
}
