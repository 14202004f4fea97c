/* The scene reader: docs/scene.md, from YAML to a scene. Every value is checked here, with the place of what is wrong;
 * what comes after can rely on it.
 */
#include "scene.h"

#include "image.h"
#include "yaml.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Numbers of a scene: within these, no product of a few overflows float, and no square vanishes. */
#define BIG 1e6
#define SMALL 1e-6

typedef struct reader {
    yaml *y;
    scene *s;
    errors *e;
} reader;

/* ---- pieces ---- */

static char *copy(reader *r, const char *text)
{
    char *c = text ? strdup(text) : NULL;
    if (text && !c)
        errors_add(r->e, "out of memory");
    return c;
}

/* Three numbers, each within BIG. An absent key leaves *v and is no error here. */
static bool vector(reader *r, node *map, const char *key, const char *what, vec3 *v)
{
    double x[3];
    node *at = yaml_get(map, key);
    if (!at)
        return true;
    if (!yaml_numbers(r->y, at, 3, -BIG, BIG, what, x))
        return false;
    *v = (vec3){x[0], x[1], x[2]};
    return true;
}

static bool color(reader *r, node *map, const char *key, vec3 *v)
{
    double x[3];
    node *at = yaml_get(map, key);
    if (!at)
        return true;
    if (!yaml_numbers(r->y, at, 3, 0, BIG, "a linear colour [red, green, blue], 0 or more each", x))
        return false;
    *v = (vec3){x[0], x[1], x[2]};
    return true;
}

static bool number(reader *r, node *map, const char *key, double lo, bool open, double hi, const char *what, double *x)
{
    node *at = yaml_get(map, key);
    return !at || yaml_number(r->y, at, lo, open, hi, what, x);
}

/* A name in a map of named things; owned. NULL: an error is told. Names are used in --set and as layers of the
 * image. */
static char *name_of(reader *r, node *map, node *key)
{
    const char *name = yaml_text(r->y, key, "a name");
    if (!name)
        return NULL;
    if (strlen(name) > 59 || name[strspn(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-")])
        yaml_error(r->y, key, "'%.60s' can't be a name, expected up to 59 letters, digits, _ and -", name);
    else if (yaml_first(map, name) != key)
        yaml_error(r->y, key, "a second '%s', expected each name once", name);
    else
        return copy(r, name);
    return NULL;
}

/* A map of named things: makes room for them. Returns their map, NULL where there is none or it is wrong. */
static node *named(reader *r, const char *key, const char *what, bool need, size_t size, void *array, int *count)
{
    node *root = yaml_root(r->y), *at = need ? yaml_need(r->y, root, key, "the scene") : yaml_get(root, key);
    if (!at || !yaml_map(r->y, at, what, NULL))
        return NULL;
    int n = yaml_size(at);
    if (n > SCENE_MAX_ITEMS) {
        yaml_error(r->y, at, "%d %s, expected at most %d", n, key, SCENE_MAX_ITEMS);
        return NULL;
    }
    void *items = calloc((size_t)(n ? n : 1), size);
    if (!items) {
        errors_add(r->e, "out of memory");
        return NULL;
    }
    memcpy(array, &items, sizeof items);
    *count = n;
    return at;
}

/* ---- camera, image, render ---- */

static void read_image(reader *r)
{
    scene *s = r->s;
    node *at = yaml_get(yaml_root(r->y), "image");
    double size[2];
    s->width = 640;
    s->height = 480;
    if (!at || !yaml_map(r->y, at, "image", "size background"))
        return;
    node *k = yaml_get(at, "size");
    if (k && yaml_numbers(r->y, k, 2, 1, SCENE_MAX_SIDE, "[width, height] in pixels, from 1 to 32768", size)) {
        if (size[0] != floor(size[0]) || size[1] != floor(size[1]))
            yaml_error(r->y, k, "no whole numbers, expected [width, height] in pixels");
        if (size[0] * size[1] > (double)IMAGE_MAX_PIXELS)
            yaml_error(r->y, k, "%.0f pixels, expected at most %ld", size[0] * size[1], IMAGE_MAX_PIXELS);
        s->width = (int)size[0];
        s->height = (int)size[1];
    }
    color(r, at, "background", &s->background);
}

static void read_camera(reader *r)
{
    node *at = yaml_need(r->y, yaml_root(r->y), "camera", "the scene");
    if (!at || !yaml_map(r->y, at, "camera", "from at up fov"))
        return;
    vec3 from = {0, 0, 0}, to = {0, 0, 0}, up = {0, 1, 0};
    double fov = 40;
    bool good = yaml_need(r->y, at, "from", "camera") && yaml_need(r->y, at, "at", "camera");
    good = vector(r, at, "from", "the eye's place [x, y, z]", &from) && good;
    good = vector(r, at, "at", "the place looked at [x, y, z]", &to) && good;
    good = vector(r, at, "up", "a direction [x, y, z]", &up) && good;
    good = number(r, at, "fov", 0, true, 175, "the horizontal angle in degrees, above 0 and up to 175", &fov) && good;
    if (!good)
        return;
    if (vec3_length(vec3_sub(to, from)) < SMALL)
        yaml_error(r->y, yaml_get(at, "at"), "the camera looks at its own place, expected 'at' apart from 'from'");
    else if (vec3_length(up) < SMALL)
        yaml_error(r->y, yaml_get(at, "up"), "no direction, expected a vector with a length");
    else if (!camera_look(&r->s->camera, from, to, up, fov, r->s->width, r->s->height))
        yaml_error(r->y, yaml_get(at, "up") ? yaml_get(at, "up") : at,
                   "'up' is along the view, expected a direction across it%s", yaml_get(at, "up") ? "" : " (it is [0, 1, 0])");
}

static void read_render(reader *r)
{
    scene *s = r->s;
    node *at = yaml_get(yaml_root(r->y), "render"), *k;
    s->shadow = (method){METHOD_ORDER, 0};
    s->guard = true;
    s->aa = 1;
    if (!at || !yaml_map(r->y, at, "render", "shadow guard aa"))
        return;
    if ((k = yaml_get(at, "shadow"))) {
        const char *text = yaml_text(r->y, k, method_expected);
        if (text && !method_parse(text, &s->shadow))
            yaml_error(r->y, k, "'%.60s' is no method, expected %s", text, method_expected);
    }
    if ((k = yaml_get(at, "guard")))
        yaml_bool(r->y, k, "true or false", &s->guard);
    if ((k = yaml_get(at, "aa")))
        yaml_whole(r->y, k, 1, SCENE_MAX_AA, "samples along a pixel's side, 1 to 16", &s->aa);
}

/* ---- lights and materials ---- */

static void read_lights(reader *r)
{
    scene *s = r->s;
    node *at = named(r, "lights", "lights", true, sizeof *s->light, &s->light, &s->lights), *key;
    for (int i = 0; at && i < s->lights; i++) {
        node *v = yaml_pair(at, i, &key);
        light *l = &s->light[i];
        l->color = (vec3){1, 1, 1};
        l->name = name_of(r, at, key);
        if (!yaml_map(r->y, v, "a light", "at color"))
            continue;
        if (yaml_need(r->y, v, "at", "a light"))
            vector(r, v, "at", "the light's place [x, y, z]", &l->at);
        color(r, v, "color", &l->color);
    }
}

static void read_materials(reader *r)
{
    scene *s = r->s;
    node *at = named(r, "materials", "materials", true, sizeof *s->material, &s->material, &s->materials), *key;
    for (int i = 0; at && i < s->materials; i++) {
        node *v = yaml_pair(at, i, &key);
        material *m = &s->material[i];
        *m = (material){.color = {1, 1, 1}, .ambient = 0.1, .diffuse = 0.6, .phong_size = 40, .roughness = 0.05};
        m->name = name_of(r, at, key);
        if (!yaml_map(r->y, v, "a material", "color ambient diffuse phong phong_size specular roughness"))
            continue;
        color(r, v, "color", &m->color);
        number(r, v, "ambient", 0, false, BIG, "a share of light, 0 or more", &m->ambient);
        number(r, v, "diffuse", 0, false, BIG, "a share of light, 0 or more", &m->diffuse);
        number(r, v, "phong", 0, false, BIG, "a share of light, 0 or more", &m->phong);
        number(r, v, "phong_size", 0, true, BIG, "an exponent above 0", &m->phong_size);
        number(r, v, "specular", 0, false, BIG, "a share of light, 0 or more", &m->specular);
        number(r, v, "roughness", 0, true, BIG, "a number above 0; small is sharp", &m->roughness);
    }
}

static int find_material(reader *r, node *at)
{
    const char *name = yaml_text(r->y, at, "the name of a material");
    char near[64], *names = NULL;
    size_t size = 1;
    if (!name || !r->s->material) /* without materials that alone is told */
        return 0;
    for (int i = 0; i < r->s->materials; i++) {
        if (r->s->material[i].name && strcmp(name, r->s->material[i].name) == 0)
            return i;
        size += r->s->material[i].name ? strlen(r->s->material[i].name) + 1 : 0;
    }
    if ((names = calloc(1, size)))
        for (int i = 0; i < r->s->materials; i++)
            if (r->s->material[i].name)
                strcat(strcat(names, i ? " " : ""), r->s->material[i].name);
    yaml_nearest(name, names ? names : "", near, sizeof near);
    yaml_error(r->y, at, "no material '%.60s'%s%s%s", name, *near ? ", did you mean '" : ", expected one of those under 'materials'",
               near, *near ? "'?" : "");
    free(names);
    return 0;
}

/* ---- surfaces ---- */

static surface *read_plane(reader *r, node *at, const char *kind, bool bounded)
{
    vec3 O = {0, 0, 0}, U = {0, 0, 0}, W = {0, 0, 0};
    if (!yaml_map(r->y, at, kind, "origin u w"))
        return NULL;
    bool good = yaml_need(r->y, at, "origin", kind) && yaml_need(r->y, at, "u", kind) && yaml_need(r->y, at, "w", kind);
    good = vector(r, at, "origin", "the place of u = w = 0, [x, y, z]", &O) && good;
    good = vector(r, at, "u", "the edge along u, [x, y, z]", &U) && good;
    good = vector(r, at, "w", "the edge along w, [x, y, z]", &W) && good;
    if (!good)
        return NULL;
    if (vec3_length(U) < SMALL || vec3_length(W) < SMALL) {
        yaml_error(r->y, yaml_get(at, vec3_length(U) < SMALL ? "u" : "w"), "no direction, expected an edge with a length");
        return NULL;
    }
    surface *f = plane_new(O, U, W, bounded);
    if (!f)
        yaml_error(r->y, at, "u and w are parallel, expected two directions");
    return f;
}

static surface *read_box(reader *r, node *at)
{
    vec3 from = {0, 0, 0}, to = {0, 0, 0};
    if (!yaml_map(r->y, at, "box", "from to"))
        return NULL;
    bool good = yaml_need(r->y, at, "from", "box") && yaml_need(r->y, at, "to", "box");
    good = vector(r, at, "from", "a corner [x, y, z]", &from) && good;
    good = vector(r, at, "to", "the opposite corner [x, y, z]", &to) && good;
    surface *f = good ? box_new(from, to) : NULL;
    if (good && !f)
        yaml_error(r->y, yaml_get(at, "to"), "a box without thickness, expected 'to' apart from 'from' along x, y and z");
    return f;
}

static surface *read_sphere(reader *r, node *at)
{
    vec3 c = {0, 0, 0};
    double radius = 1;
    if (!yaml_map(r->y, at, "sphere", "center radius"))
        return NULL;
    bool good = yaml_need(r->y, at, "center", "sphere") && yaml_need(r->y, at, "radius", "sphere");
    good = vector(r, at, "center", "a place [x, y, z]", &c) && good;
    good = number(r, at, "radius", SMALL, false, BIG, "a length from 1e-6 to 1e6", &radius) && good;
    return good ? sphere_new(c, radius) : NULL;
}

static surface *read_surface(reader *r, node *at)
{
    static const char *const kinds[] = {"plane", "rectangle", "box", "sphere"};
    node *shape = NULL;
    int kind = -1;
    for (int k = 0; k < 4; k++) {
        node *v = yaml_get(at, kinds[k]);
        if (v && shape) {
            yaml_error(r->y, v, "a second shape, '%s' beside '%s', expected one", kinds[k], kinds[kind]);
            return NULL;
        }
        if (v) {
            shape = v;
            kind = k;
        }
    }
    if (!shape) {
        yaml_error(r->y, at, "an object lacks its shape, expected one of: plane rectangle box sphere");
        return NULL;
    }
    return kind < 2 ? read_plane(r, shape, kinds[kind], kind == 1) : kind == 2 ? read_box(r, shape) : read_sphere(r, shape);
}

/* ---- bumps ---- */

/* The file beside the scene, so that a scene finds its maps from any working directory. */
static char *beside(reader *r, const char *file)
{
    const char *slash = strrchr(r->s->path, '/');
    int folder = slash && *file != '/' ? (int)(slash - r->s->path) + 1 : 0;
    size_t size = (size_t)folder + strlen(file) + 1;
    char *path = malloc(size);
    if (path)
        snprintf(path, size, "%.*s%s", folder, r->s->path, file);
    else
        errors_add(r->e, "out of memory");
    return path;
}

/* Where the map lies: by its size in (u,w), or by how often it goes into the surface's extent. */
static bool read_layout(reader *r, node *at, const double u[2], const double w[2], map_layout *l)
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
            good = yaml_numbers(r->y, repeat, 2, SMALL, BIG, "how often the map goes into the surface [in u, in w], 1e-6 or more", n);
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
    char *path = beside(r, name);
    errors e = {0};
    bool good = path && image_read(path, layer, out, &e);
    if (!good && path)
        yaml_error(r->y, file, "'%s' can't be used: %.*s", name, e.size ? (int)e.size - 1 : 0, e.text ? e.text : "");
    if (good && (out->width < 2 || out->height < 2)) {
        free(out->v);
        good = yaml_error(r->y, file, "'%s' has %d x %d samples, expected at least 2 x 2", name, out->width, out->height);
    }
    if (good) {
        *note = (map_note){copy(r, name), out->width, out->height, HUGE_VAL, -HUGE_VAL};
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
static perturb *read_map(reader *r, node *at, const double u[2], const double w[2], map_note *note)
{
    image samples;
    map_layout l = {.size = {1, 1}};
    bool good = yaml_map(r->y, at, "a bump with a map", "map scale zero sign size repeat offset wrap samples");
    node *scale = yaml_need(r->y, at, "scale", "a bump with a map"), *zero = yaml_need(r->y, at, "zero", "a bump with a map");
    node *sign = yaml_need(r->y, at, "sign", "a bump with a map");
    good = scale && yaml_number(r->y, scale, 0, false, BIG, "scene units for one unit of the map, 0 or more", &l.scale) && good;
    good = zero && yaml_number(r->y, zero, -BIG, false, BIG, "the map's value whose height is 0", &l.zero) && good;
    int up = sign ? yaml_word(r->y, sign, "up down", "up (higher values are higher) or down") : -1;
    good = read_layout(r, at, u, w, &l) && up >= 0 && good;
    good = read_samples(r, yaml_get(at, "map"), &samples, note) && good;
    if (!note->file) /* there are no samples */
        return NULL;
    l.scale = up == 1 ? -l.scale : l.scale;
    const double low = l.scale * (note->low - l.zero), high = l.scale * (note->high - l.zero);
    if (good && fmax(fabs(low), fabs(high)) > BIG)
        good = yaml_error(r->y, scale, "heights from %.4g to %.4g, expected them within 1000000 scene units", fmin(low, high),
                          fmax(low, high));
    perturb *p = good ? perturb_map(&samples, &l) : NULL;
    if (good && !p)
        errors_add(r->e, "out of memory");
    free(samples.v);
    return p;
}

static perturb *read_function(reader *r, node *at, const double u[2], const double w[2])
{
    double scale = 1;
    bool good = yaml_map(r->y, at, "a bump with a function", "function scale");
    good = number(r, at, "scale", -BIG, false, BIG, "a factor", &scale) && good;
    node *f = yaml_get(at, "function");
    const char *text = yaml_text(r->y, f, "a function of u and w");
    expr_error wrong;
    expr *e = text ? expr_parse(text, &wrong) : NULL;
    if (text && !e)
        yaml_error_in(r->y, f, wrong.offset, "%s", wrong.message);
    if (!good || !e) {
        expr_free(e);
        return NULL;
    }
    perturb *p = perturb_function(e, scale, u, w);
    if (!p)
        errors_add(r->e, "out of memory");
    return p;
}

static perturb *read_bump(reader *r, node *at, const surface *f, map_note *note)
{
    double u[2], w[2];
    if (!yaml_map(r->y, at, "bump", NULL))
        return NULL;
    node *map = yaml_get(at, "map"), *function = yaml_get(at, "function");
    if (!map == !function) {
        yaml_error(r->y, at, "a bump with %s, expected either 'map' or 'function'", map ? "both map and function" : "neither map nor function");
        return NULL;
    }
    f->is->extent(f, u, w);
    return map ? read_map(r, at, u, w, note) : read_function(r, at, u, w);
}

static void read_objects(reader *r)
{
    scene *s = r->s;
    node *at = named(r, "objects", "objects", true, sizeof *s->object, &s->object, &s->objects), *key;
    for (int i = 0; at && i < s->objects; i++) {
        node *v = yaml_pair(at, i, &key), *m, *bump;
        object *o = &s->object[i];
        o->name = name_of(r, at, key);
        if (!yaml_map(r->y, v, "an object", "plane rectangle box sphere material bump"))
            continue;
        o->shape = read_surface(r, v);
        if ((m = yaml_need(r->y, v, "material", "an object")))
            o->material = find_material(r, m);
        if ((bump = yaml_get(v, "bump")) && o->shape)
            o->bump = read_bump(r, bump, o->shape, &o->map);
    }
}

/* ---- the whole ---- */

scene *scene_read(const char *path, int sets, char *const *set, errors *e)
{
    reader r = {.e = e, .s = calloc(1, sizeof *r.s)};
    int before = e->count;
    r.y = r.s ? yaml_open(path, sets, set, "image render", e) : NULL;
    if (r.y) {
        r.s->path = copy(&r, path);
        r.s->source = copy(&r, yaml_source(r.y));
        if (r.s->path) {
            yaml_map(r.y, yaml_root(r.y), "the scene", "camera image render lights materials objects");
            read_image(&r);
            read_camera(&r);
            read_render(&r);
            read_lights(&r);
            read_materials(&r);
            read_objects(&r);
        }
        yaml_close(r.y);
    }
    if (!r.s)
        errors_add(e, "out of memory");
    if (e->count == before)
        return r.s;
    scene_free(r.s);
    return NULL;
}

void scene_free(scene *s)
{
    if (!s)
        return;
    for (int i = 0; i < s->lights; i++)
        free(s->light[i].name);
    for (int i = 0; i < s->materials; i++)
        free(s->material[i].name);
    for (int i = 0; i < s->objects; i++) {
        object *o = &s->object[i];
        free(o->name);
        surface_free(o->shape);
        perturb_free(o->bump);
        free(o->map.file);
    }
    free(s->light);
    free(s->material);
    free(s->object);
    free(s->path);
    free(s->source);
    free(s);
}
