/* The keys image, camera and render: the picture's size, its view, and how it is rendered. */
#include "read/parts.h"

#include <stdio.h>

static void read_image(reader *r)
{
    scene *s = r->s;
    node *at = yaml_get(yaml_root(r->y), "image");
    int size[2] = {640, 480};
    const cap most = reader_limit(r, LIMIT_PICTURE, SCENE_MAX_SIDE);
    char what[128];
    snprintf(what, sizeof what, "[width, height] in pixels, from 1 to %d%s", (int)most.most, most.by);
    if (at && yaml_map(r->y, at, "image", "size background")) {
        reader_color(r, at, "background", &s->background);
        reader_counts(r, at, "size", (int)most.most, what, size);
    }
    if ((!at || !yaml_get(at, "size")) && most.most < size[0])
        yaml_error(r->y, at ? at : yaml_root(r->y), "no size of the picture, which is then %d x %d pixels, expected %s",
                   size[0], size[1], what);
    s->width = size[0];
    s->height = size[1];
}

static void read_camera(reader *r)
{
    node *at = yaml_need(r->y, yaml_root(r->y), "camera", "the scene");
    if (!at || !yaml_map(r->y, at, "camera", "from at up fov width"))
        return;
    vec3 from = {0, 0, 0}, to = {0, 0, 0}, up = {0, 1, 0};
    double fov = 40, width = 0;
    node *across = yaml_get(at, "width");
    bool good = reader_look(r, at, "the camera", "camera", &from, &to, &up);
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
    if (across ? !camera_orthographic(c, from, to, up, width, columns, rows)
               : !camera_look(c, from, to, up, fov, columns, rows))
        reader_up_along(r, at);
}

static void read_depth(reader *r, node *at)
{
    const cap most = reader_limit(r, LIMIT_DEPTH, SCENE_MAX_DEPTH);
    char what[128];
    snprintf(what, sizeof what, "how many rays follow one another, 1 to %d%s", (int)most.most, most.by);
    yaml_whole(r->y, at, 1, (int)most.most, what, &r->s->depth);
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
    if (!at || !yaml_map(r->y, at, "render",
                         "shadow guard shade bump_shadow aa aa_threshold depth "
                         "surface self_shadow"))
        return;
    if ((k = yaml_get(at, "shadow"))) {
        const char *text = yaml_text(r->y, k, method_expected);
        if (text && !method_parse(text, &s->shadow))
            yaml_error(r->y, k, "'%.60s' is no method, expected %s", text, method_expected);
    }
    if ((k = yaml_get(at, "guard")))
        yaml_bool(r->y, k, "true or false", &s->guard);
    s->shifted = reader_word(r, at, "shade", "smooth shifted", "smooth or shifted") == 1;
    if ((k = yaml_get(at, "bump_shadow"))) {
        const char *text = yaml_text(r->y, k, bump_shadow_expected);
        if (text && !bump_shadow_parse(text, &s->bump_shadow))
            yaml_error(r->y, k, "'%.60s' is unknown, expected %s", text, bump_shadow_expected);
    }
    if ((k = yaml_get(at, "aa")))
        yaml_whole(r->y, k, 1, SCENE_MAX_AA, "samples along a pixel's side, 1 to 16", &s->aa);
    reader_number(r, at, "aa_threshold", 0, false, 3,
                  "how much two pixels may differ, red, green and blue together, 0 to 3", &s->aa_threshold);
    if ((k = yaml_get(at, "depth")))
        read_depth(r, k);
    s->displaced = reader_word(r, at, "surface", "smooth displaced", "smooth or displaced") == 1;
    if ((k = yaml_get(at, "self_shadow")))
        yaml_bool(r->y, k, "true or false", &s->self_shadow);
}

void reader_view(reader *r)
{
    read_image(r);
    read_camera(r);
    read_render(r);
}
