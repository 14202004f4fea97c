/* Materials, and the color texture of an object, which depends on its surface. */
#include "read/parts.h"

#include <math.h>
#include <stdlib.h>

static void read_checker(reader *r, node *at, material *m)
{
    m->pattern = PATTERN_CHECKER;
    m->layout.size[0] = m->layout.size[1] = 1;
    if (!yaml_map(r->y, at, "checker", "even odd size offset"))
        return;
    reader_need_all(r, at, "even odd", "checker");
    reader_color(r, at, "even", &m->field[0]);
    reader_color(r, at, "odd", &m->field[1]);
    reader_pair(r, at, "size", SMALL, "the size of a field [in u, in w], 1e-6 or more", m->layout.size);
    reader_pair(r, at, "offset", -BIG, "where a field begins [in u, in w]", m->layout.offset);
}

/* What other scenes may use. */
typedef struct made_image {
    texels *texels;
    bool linear; /* in any case, as an EXR is */
} made_image;

static void free_made(void *thing)
{
    texels_free(((made_image *)thing)->texels);
    free(thing);
}

/* NULL with an error. */
static made_image *make_image(reader *r, node *file, const source *from, image_encoding encoding, const map_layout *l)
{
    const progress *w = r->from->progress;
    image pixels = {0};
    errors e = {0};
    bool linear = false;
    const bool was_read = from->array
                              ? image_array_read_color(&from->array->image, encoding, w, &pixels, &linear, &e)
                              : image_read_color(from->path, encoding, r->from->threads, w, &pixels, &linear, &e);
    texels *t = NULL;
    if (reader_usable(r, file, from->name, was_read, pixels.width, pixels.height, "pixels", &e))
        t = reader_made(r, texels_new(&pixels, l, w));
    memory_free(pixels.v);
    made_image *made = t ? reader_made(r, malloc(sizeof *made)) : NULL;
    if (made)
        *made = (made_image){t, linear};
    else
        texels_free(t);
    return made;
}

static void read_pixels(reader *r, node *file, image_encoding encoding, material *m)
{
    source from;
    if (!reader_source(r, file, false, "the file of an image", &from))
        return;
    char *key = !*from.id ? NULL
                          : reader_key(r, "image %s %d %d %d", from.id, (int)encoding, (int)m->layout.wrap,
                                       (int)m->layout.corners);
    made_image *made = reader_found(r, key);
    const bool found = made;
    if (!found)
        made = make_image(r, file, &from, encoding, &m->layout);
    m->file = reader_copy(r, from.name);
    if (made) {
        m->texels = texels_share(made->texels);
        m->exr = made->linear;
    }
    if (made && !found)
        reader_keep(r, key, made, free_made);
    free(key);
    source_free(&from);
}

/* Checks the layout once, on a bounded surface. lay_image() checks the size for each object. */
static void read_image(reader *r, node *at, material *m)
{
    const double whole[2] = {0, 1};
    m->pattern = PATTERN_IMAGE;
    if (!yaml_map(r->y, at, "image", "file encoding size repeat offset wrap interpolation"))
        return;
    const bool good = reader_layout(r, at, whole, whole, &m->layout);
    const int word = reader_word(r, at, "encoding", "srgb linear", "srgb or linear");
    m->linear = word == 1;
    m->nearest = reader_word(r, at, "interpolation", "bilinear nearest", "bilinear or nearest") == 1;
    node *file = yaml_need(r->y, at, "file", "image");
    if (file && word >= 0 && good)
        read_pixels(r, file, !yaml_get(at, "encoding") ? IMAGE_BY_KIND : m->linear ? IMAGE_LINEAR : IMAGE_SRGB, m);
}

static void read_color(reader *r, node *material_node, material *m)
{
    node *at = yaml_get(material_node, "color");
    if (!at || !yaml_is_map(at)) {
        reader_color(r, material_node, "color", &m->color);
        return;
    }
    if (!yaml_map(r->y, at, "color", "checker image") || !reader_either(r, at, "a color", "checker", "image"))
        return;
    if (yaml_get(at, "checker"))
        read_checker(r, yaml_get(at, "checker"), m);
    else
        read_image(r, yaml_get(at, "image"), m);
}

static void read_reflection(reader *r, node *at, material *m)
{
    static const char *const what = "a share of light, or one each of red, green and blue, 0 to 1";
    double x[3];
    if (yaml_is_list(at) ? yaml_numbers(r->y, at, 3, 0, 1, what, x) : yaml_number(r->y, at, 0, false, 1, what, x))
        m->reflection = yaml_is_list(at) ? (vec3){x[0], x[1], x[2]} : (vec3){x[0], x[0], x[0]};
}

static void read_transparency(reader *r, node *v, material *m)
{
    bool good = reader_number(r, v, "filter", 0, false, 1,
                              "the share of light that it lets through in its colour, 0 to 1", &m->filter);
    good = reader_number(r, v, "transmit", 0, false, 1, "the share of light that it lets through unchanged, 0 to 1",
                         &m->transmit) &&
           good;
    if (good && m->filter + m->transmit > 1)
        yaml_error(r->y, yaml_get(v, "transmit"),
                   "a filter of %g and a transmit of %g, expected no more than 1 together", m->filter, m->transmit);
    reader_number(r, v, "ior", 0, true, 100, "an index of refraction above 0, at most 100", &m->ior);
}

void reader_materials(reader *r)
{
    node *k;
    scene *s = r->s;
    node *at =
             reader_named(r, "materials", (cap){SCENE_MAX_ITEMS, ""}, sizeof *s->material, &s->material, &s->materials),
         *key;
    for (int i = 0; at && i < s->materials; i++) {
        node *v = yaml_pair(at, i, &key);
        material *m = &s->material[i];
        *m = (material){
            .color = {1, 1, 1}, .ambient = 0.1, .diffuse = 0.6, .phong_size = 40, .roughness = 0.05, .ior = 1};
        m->name = reader_name(r, at, key);
        if (!yaml_map(r->y, v, "a material",
                      "color ambient diffuse phong phong_size specular roughness reflection filter transmit ior"))
            continue;
        read_color(r, v, m);
        reader_number(r, v, "ambient", 0, false, BIG, "a share of light, 0 or more", &m->ambient);
        reader_number(r, v, "diffuse", 0, false, BIG, "a share of light, 0 or more", &m->diffuse);
        reader_number(r, v, "phong", 0, false, BIG, "a share of light, 0 or more", &m->phong);
        reader_number(r, v, "phong_size", 0, true, BIG, "an exponent above 0", &m->phong_size);
        reader_number(r, v, "specular", 0, false, BIG, "a share of light, 0 or more", &m->specular);
        /* from 1e-6 on, a cosine a few ulp above 1 has a finite power in float */
        reader_number(r, v, "roughness", SMALL, false, BIG, "a number of 1e-6 or more; small is sharp", &m->roughness);
        if ((k = yaml_get(v, "reflection")))
            read_reflection(r, k, m);
        read_transparency(r, v, m);
    }
}

/* ---- on an object ---- */

/* The layout of the material's image on the object's surface. */
static bool lay_image(reader *r, node *at, const material *m, const object *o, map_layout *l)
{
    double u[2], w[2];
    node *layout = yaml_get(yaml_get(yaml_get(yaml_get(yaml_root(r->y), "materials"), m->name), "color"), "image");
    reader_extent(o->shape, &o->shape_spec, u, w);
    if (!yaml_get(layout, "size") && !(u[1] - u[0] < HUGE_VAL && w[1] - w[0] < HUGE_VAL))
        return yaml_error(r->y, at, "the image of '%s' has no 'size', expected one for a surface without ends",
                          m->name);
    *l = (map_layout){.size = {1, 1}};
    return reader_layout(r, layout, u, w, l);
}

void reader_color_texture(reader *r, node *at, object *o)
{
    const material *m = &r->s->material[o->material];
    o->color_layout = m->layout;
    if (m->pattern && !reader_textured(r, at, o))
        return;
    if (m->pattern == PATTERN_CHECKER)
        o->color = color_checker_new(m->field, m->layout.size, m->layout.offset);
    else if (m->pattern == PATTERN_IMAGE && m->texels && m->name && lay_image(r, at, m, o, &o->color_layout))
        o->color = color_image_new(m->texels, &o->color_layout, m->nearest);
    else
        return;
    o->color = reader_mirror_color(r, o, reader_made(r, o->color));
}
