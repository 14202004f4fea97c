/* The scene reader: docs/scene.md, from YAML to a scene. Every value is checked here, with the place of what is wrong;
 * what comes after can rely on it.
 */
#include "read/reader.h"

#include "scene/object_bvh.h"

#include "image/image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- pieces ---- */

char *reader_copy(reader *r, const char *text)
{
    char *c = text ? strdup(text) : NULL;
    if (text && !c)
        errors_add(r->e, "out of memory");
    return c;
}

bool reader_vector(reader *r, node *map, const char *key, const char *what, vec3 *v)
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

bool reader_color(reader *r, node *map, const char *key, vec3 *v)
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

bool reader_number(reader *r, node *map, const char *key, double lo, bool open, double hi, const char *what, double *x)
{
    node *at = yaml_get(map, key);
    return !at || yaml_number(r->y, at, lo, open, hi, what, x);
}

char *reader_beside(reader *r, const char *file)
{
    const char *slash = strrchr(r->s->path, '/');
    int folder = slash && *file != '/' ? (int)(slash - r->s->path) + 1 : 0;
    size_t size = (size_t)folder + strlen(file) + 1;
    char *path = malloc(size);
    if (path)
        snprintf(path, size, "%.*s%s", folder, r->s->path, file);
    if (!path || !files_add_path(&r->s->made_from, path))
        errors_add(r->e, "out of memory");
    return path;
}

/* The letters are few: names are used in --set and as layers of the image. */
char *reader_name(reader *r, node *map, node *key)
{
    const char *name = yaml_text(r->y, key, "a name");
    if (!name)
        return NULL;
    if (strlen(name) > 59 || name[strspn(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-")])
        yaml_error(r->y, key, "'%.60s' can't be a name, expected up to 59 letters, digits, _ and -", name);
    else if (yaml_first(map, name) != key)
        yaml_error(r->y, key, "a second '%s', expected each name once", name);
    else
        return reader_copy(r, name);
    return NULL;
}

node *reader_named(reader *r, const char *key, const char *what, bool need, size_t size, void *array, int *count)
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
    reader_color(r, at, "background", &s->background);
}

static void read_camera(reader *r)
{
    node *at = yaml_need(r->y, yaml_root(r->y), "camera", "the scene");
    if (!at || !yaml_map(r->y, at, "camera", "from at up fov width"))
        return;
    vec3 from = {0, 0, 0}, to = {0, 0, 0}, up = {0, 1, 0};
    double fov = 40, width = 0;
    node *across = yaml_get(at, "width");
    bool good = yaml_need(r->y, at, "from", "camera") && yaml_need(r->y, at, "at", "camera");
    good = reader_vector(r, at, "from", "the eye's place [x, y, z]", &from) && good;
    good = reader_vector(r, at, "at", "the place looked at [x, y, z]", &to) && good;
    good = reader_vector(r, at, "up", "a direction [x, y, z]", &up) && good;
    good = reader_number(r, at, "fov", 0, true, 175, "the horizontal angle in degrees, above 0 and up to 175", &fov) &&
           good;
    good = reader_number(r, at, "width", SMALL, false, BIG,
                         "the width of an orthographic picture in scene units, from 1e-6 to 1e6", &width) &&
           good;
    if (across && yaml_get(at, "fov"))
        good = yaml_error(
            r->y, across,
            "both 'width' and 'fov', expected the one for an orthographic camera or the other for a pinhole");
    if (!good)
        return;
    camera *c = &r->s->camera;
    const int columns = r->s->width, rows = r->s->height;
    r->s->view = (camera_view){to, up, fov, width};
    if (vec3_length(vec3_sub(to, from)) < SMALL)
        yaml_error(r->y, yaml_get(at, "at"), "the camera looks at its own place, expected 'at' apart from 'from'");
    else if (vec3_length(up) < SMALL)
        yaml_error(r->y, yaml_get(at, "up"), "no direction, expected a vector with a length");
    else if (across ? !camera_orthographic(c, from, to, up, width, columns, rows)
                    : !camera_look(c, from, to, up, fov, columns, rows))
        yaml_error(r->y, yaml_get(at, "up") ? yaml_get(at, "up") : at,
                   "'up' is along the view, expected a direction across it%s",
                   yaml_get(at, "up") ? "" : " (it is [0, 1, 0])");
}

static void read_render(reader *r)
{
    scene *s = r->s;
    node *at = yaml_get(yaml_root(r->y), "render"), *k;
    s->shadow = (method){METHOD_ORDER, 0};
    s->guard = true;
    s->aa = 1;
    s->aa_threshold = -1;
    s->depth = 5;
    s->self_shadow = true;
    if (!at || !yaml_map(r->y, at, "render", "shadow guard aa aa_threshold depth surface self_shadow"))
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
    reader_number(r, at, "aa_threshold", 0, false, 3,
                  "how much two pixels may differ, red, green and blue together, 0 to 3", &s->aa_threshold);
    if ((k = yaml_get(at, "depth")))
        yaml_whole(r->y, k, 1, SCENE_MAX_DEPTH, "how many rays follow one another, 1 to 32", &s->depth);
    if ((k = yaml_get(at, "surface")))
        s->displaced = yaml_word(r->y, k, "smooth displaced", "smooth or displaced") == 1;
    if ((k = yaml_get(at, "self_shadow")))
        yaml_bool(r->y, k, "true or false", &s->self_shadow);
}

/* ---- the whole ---- */

/* Once all objects are good: each has a material. */
static void note_secondary(scene *s)
{
    for (int k = 0; k < s->objects; k++) {
        const material *m = &s->material[s->object[k].material];
        s->sends |= material_sends(m);
        s->clear |= material_clear(m);
    }
}

/* Likewise. */
static void note_crowd(reader *r)
{
    bool good = true;
    r->s->object_bvh = object_bvh_new(r->s, &good);
    if (!good)
        errors_add(r->e, "out of memory");
}

scene *scene_read(const char *path, int sets, char *const *set, const progress *w, errors *e)
{
    reader r = {.e = e, .progress = w, .s = calloc(1, sizeof *r.s)};
    int before = e->count;
    r.y = r.s ? yaml_open(path, sets, set, "image render", e) : NULL;
    if (r.y) {
        r.s->path = reader_copy(&r, path);
        if (!files_add_path(&r.s->made_from, path))
            errors_add(e, "out of memory");
        r.s->source = reader_copy(&r, yaml_source(r.y));
        if (r.s->path) {
            yaml_map(r.y, yaml_root(r.y), "the scene", "camera image render lights materials objects");
            read_image(&r);
            read_camera(&r);
            read_render(&r);
            reader_lights(&r);
            reader_materials(&r);
            reader_objects(&r);
            if (e->count == before) {
                note_secondary(r.s);
                note_crowd(&r);
            }
        }
        yaml_close(r.y);
    }
    if (!r.y && e->count == before)
        errors_add(e, "%s: out of memory", path);
    if (e->count == before)
        return r.s;
    scene_free(r.s);
    return NULL;
}

void scene_free(scene *s)
{
    if (!s)
        return;
    object_bvh_free(s->object_bvh);
    for (int i = 0; i < s->lights; i++)
        free(s->light[i].name);
    for (int i = 0; i < s->materials; i++) {
        free(s->material[i].name);
        free(s->material[i].file);
        texels_free(s->material[i].texels);
    }
    for (int i = 0; i < s->objects; i++) {
        object *o = &s->object[i];
        free(o->name);
        surface_free(o->displaced);
        if (o->shape != o->own)
            surface_free(o->shape);
        surface_free(o->centred);
        if (!o->copy_of) {
            surface_free(o->own);
            free(o->shape_spec.file);
        }
        color_texture_free(o->color);
        if (o->shares_bump)
            continue;
        bump_free(o->bump);
        free(o->bump_spec.function);
        free(o->map.file);
    }
    free(s->light);
    free(s->material);
    free(s->object);
    files_free(&s->made_from);
    free(s->path);
    free(s->source);
    free(s);
}
