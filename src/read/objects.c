/* The scene reader's objects, and the bumps on their surfaces. */
#include "displaced/displaced.h"
#include "read/reader.h"

#include "image/image.h"
#include "base/spelling.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- bumps ---- */

/* Where the map lies: by its size in (u,w), or by how often it goes into the surface's extent. */
bool reader_layout(reader *r, node *at, const double u[2], const double w[2], map_layout *l)
{
    const double extent[2] = {u[1] - u[0], w[1] - w[0]};
    const bool bounded = extent[0] < HUGE_VAL;
    node *size = yaml_get(at, "size"), *repeat = yaml_get(at, "repeat"), *k;
    bool good = true;
    l->offset[0] = bounded ? u[0] : 0;
    l->offset[1] = bounded ? w[0] : 0;
    if (size && repeat)
        good = yaml_error(r->y, repeat, "both 'size' and 'repeat', expected one of them");
    else if (size) {
        good = yaml_numbers(r->y, size, 2, SMALL, BIG, "the size of the map [in u, in w], 1e-6 or more", l->size);
    } else if (!bounded)
        good = yaml_error(r->y, repeat ? repeat : at, "a map on an unbounded surface, expected 'size: [in u, in w]'");
    else {
        double n[2] = {1, 1};
        if (repeat)
            good = yaml_numbers(r->y, repeat, 2, SMALL, BIG,
                                "how often the map goes into the surface [in u, in w], 1e-6 or more", n);
        l->size[0] = extent[0] / n[0];
        l->size[1] = extent[1] / n[1];
    }
    double shift[2] = {0, 0};
    if ((k = yaml_get(at, "offset")))
        good = yaml_numbers(r->y, k, 2, -BIG, BIG, "where the map begins [in u, in w]", shift) && good;
    l->offset[0] += shift[0];
    l->offset[1] += shift[1];
    if ((k = yaml_get(at, "wrap"))) {
        int wrap = yaml_word(r->y, k, "repeat clamp mirror", "repeat, clamp or mirror");
        good = wrap >= 0 && good;
        l->wrap = wrap == 1 ? MAP_CLAMP : wrap == 2 ? MAP_MIRROR : MAP_REPEAT;
    }
    if ((k = yaml_get(at, "samples"))) {
        int samples = yaml_word(r->y, k, "cells corners", "cells or corners");
        good = samples >= 0 && good;
        l->corners = samples == 1;
    }
    return good;
}

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
        free(out->v);
        good =
            yaml_error(r->y, file, "'%s' has %d x %d samples, expected at least 2 x 2", name, out->width, out->height);
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

/* Scale, zero level and sign: without them a map is no height, so none has a default. */
static bump *read_map(reader *r, node *at, const double u[2], const double w[2], map_note *note, bump_spec *said)
{
    image samples;
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
    if (!note->file) /* there are no samples */
        return NULL;
    l.scale = up == 1 ? -l.scale : l.scale;
    const double low = l.scale * (note->low - l.zero), high = l.scale * (note->high - l.zero);
    if (good && fmax(fabs(low), fabs(high)) > BIG)
        good = yaml_error(r->y, scale, "heights from %.4g to %.4g, expected them within 1000000 scene units",
                          fmin(low, high), fmax(low, high));
    said->layout = l;
    bump *p = good ? bump_map_new(&samples, &l) : NULL;
    if (good && !p)
        errors_add(r->e, "out of memory");
    free(samples.v);
    return p;
}

/* All the (u,w) of a surface's parts, on which a function must have its bounds. */
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

static bump *read_function(reader *r, node *at, const surface *f, bump_spec *said)
{
    double scale = 1, u[2], w[2];
    bool good = yaml_map(r->y, at, "a bump with a function", "function scale");
    good = reader_number(r, at, "scale", -BIG, false, BIG, "a factor", &scale) && good;
    node *function = yaml_get(at, "function");
    const char *text = yaml_text(r->y, function, "a function of u and w");
    expr_error wrong;
    expr *e = text ? expr_parse(text, &wrong) : NULL;
    if (text && !e)
        yaml_error_in(r->y, function, wrong.offset, "%s", wrong.message);
    if (!good || !e) {
        expr_free(e);
        return NULL;
    }
    said->function = reader_copy(r, text);
    said->scale = scale;
    widest_extent(f, u, w);
    bump *p = bump_function_new(e, scale, u, w);
    if (!p)
        errors_add(r->e, "out of memory");
    return p;
}

static bump *read_bump(reader *r, node *at, object *o)
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
    return reader_fold_bump(
        r, o, map ? read_map(r, at, u, w, &o->map, &o->bump_spec) : read_function(r, at, f, &o->bump_spec));
}

/* ---- objects ---- */

/* The number of the thing whose name is at the node, of those that begin with their name; -1: an error is told. */
static int find(reader *r, node *at, const char *what, const char *among, const void *things, size_t size, int n)
{
    const char *name = yaml_text(r->y, at, what), *thing = strrchr(what, ' ') + 1;
    char near[64], *names = NULL;
    size_t length = 1;
    for (int i = 0; name && i < n; i++) {
        char *const *its = (char *const *)(const void *)((const char *)things + (size_t)i * size);
        if (*its && strcmp(name, *its) == 0)
            return i;
        length += *its ? strlen(*its) + 1 : 0;
    }
    if (!name)
        return -1;
    if ((names = calloc(1, length)))
        for (int i = 0; i < n; i++) {
            char *const *its = (char *const *)(const void *)((const char *)things + (size_t)i * size);
            if (*its)
                strcat(strcat(names, *names ? " " : ""), *its);
        }
    spelling_nearest(name, names ? names : "", near, sizeof near);
    yaml_error(r->y, at, "no %s '%.60s'%s%s%s%s", thing, name,
               *near ? ", did you mean '" : ", expected one of those under '", *near ? near : among, "'",
               *near ? "?" : "");
    free(names);
    return -1;
}

static int find_material(reader *r, node *at)
{
    const scene *s = r->s;
    /* without materials that alone is told */
    int k = s->material
                ? find(r, at, "the name of a material", "materials", s->material, sizeof *s->material, s->materials)
                : 0;
    return k < 0 ? 0 : k;
}

/* Objects are read in order, but what is copied before its copies. */
typedef struct queue {
    node *at;
    char *state; /* of each object */
} queue;

enum { WAITING, BEGUN, DONE };

static void read_object(reader *r, const queue *q, int i);

/* What object i copies, read; NULL: an error is told. */
static const object *read_original(reader *r, const queue *q, node *copy, int i)
{
    const scene *s = r->s;
    const int k = find(r, copy, "the name of an object", "objects", s->object, sizeof *s->object, s->objects);
    if (k == i)
        yaml_error(r->y, copy, "'%s' copies itself, expected another object", s->object[i].name);
    else if (k >= 0 && q->state[k] == BEGUN)
        yaml_error(r->y, copy, "'%s' is a copy of this one, expected an object that does not lead back here",
                   s->object[k].name);
    if (k < 0 || q->state[k] == BEGUN)
        return NULL;
    if (q->state[k] == WAITING)
        read_object(r, q, k);
    return &s->object[k];
}

/* Shape, material and bump of another object; what it says itself comes on top. */
static void take(object *o, const object *from)
{
    char *name = o->name;
    *o = *from;
    o->name = name;
    o->copy_of = from->copy_of ? from->copy_of : from->name;
    o->shape = from->own;
    o->centred = o->displaced = NULL;
    o->shares_bump = true;
}

/* The shape through its transform. Displaced, it must be one of which feet are known. */
static void place(reader *r, node *v, object *o)
{
    node *transform = yaml_get(v, "transform"), *at = transform ? transform : yaml_get(v, "copy");
    bool good = true;
    if (transform) {
        good = reader_transform(r, transform, &o->placed);
        o->moved = true;
    }
    if (!good || !o->moved || !o->own || !reader_place(r, at, o))
        return;
    if (o->bump && !displaced_has_form(o->shape) && scene_wants_truth(r->s))
        yaml_error(r->y, at,
                   "a %s with caps and a bump is stretched more one way than another, expected the same scale all "
                   "ways, or 'open: true', for %s",
                   o->shape->ops->kind, r->s->displaced ? "surface displaced" : "shadow exact");
}

static void read_object(reader *r, const queue *q, int i)
{
    scene *s = r->s;
    object *o = &s->object[i];
    node *key, *v = yaml_pair(q->at, i, &key), *m, *at_bump, *copy;
    q->state[i] = BEGUN;
    o->placed = affine_identity();
    if (yaml_map(r->y, v, "an object", READER_SHAPES " material bump transform copy")) {
        if ((copy = yaml_get(v, "copy"))) {
            const object *from = reader_no_shape(r, v) ? read_original(r, q, copy, i) : NULL;
            if (from)
                take(o, from);
        } else
            o->shape = o->own = reader_surface(r, v, &o->shape_spec);
        if ((m = copy ? yaml_get(v, "material") : yaml_need(r->y, v, "material", "an object")))
            o->material = find_material(r, m);
        o->color = NULL;
        if ((m || copy) && o->own && s->material)
            reader_color_texture(r, m ? m : copy, o);
        if ((at_bump = yaml_get(v, "bump")) && o->own) {
            o->shares_bump = false;
            o->map = (map_note){0};
            o->bump_spec = (bump_spec){0};
            o->bump = read_bump(r, at_bump, o);
        }
        if (at_bump && o->bump && scene_wants_truth(s) && !displaced_has_bounds(o->bump))
            yaml_error(r->y, at_bump,
                       "no bounds of P or of its slope are known, expected them for %s: a function that is bounded, "
                       "without jumps, over the whole surface",
                       s->displaced ? "surface displaced" : "shadow exact");
        place(r, v, o);
        if (o->shape && o->bump && scene_wants_truth(s) && displaced_has_form(o->shape) &&
            !(o->displaced = displaced_new(o->shape, o->bump)))
            errors_add(r->e, "out of memory");
    }
    q->state[i] = DONE;
}

void reader_objects(reader *r)
{
    scene *s = r->s;
    queue q = {reader_named(r, "objects", "objects", true, sizeof *s->object, &s->object, &s->objects), NULL};
    node *key;
    if (!q.at)
        return;
    if (!(q.state = calloc((size_t)s->objects + 1, 1))) {
        errors_add(r->e, "out of memory");
        return;
    }
    for (int i = 0; i < s->objects; i++) {
        yaml_pair(q.at, i, &key);
        s->object[i].name = reader_name(r, q.at, key);
    }
    for (int i = 0; i < s->objects; i++)
        if (q.state[i] == WAITING)
            read_object(r, &q, i);
    free(q.state);
}
