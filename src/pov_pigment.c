/* Materials for the POV-Ray writer. A colour that is not constant becomes a pigment in the surface's own (u,w): on a flat surface in its
 * frame, on a sphere by POV-Ray's spherical warp, whose axis is y and whose x is u/2pi in 0..1.
 */
#include "pov_parts.h"

#include <string.h>

#define PI 3.14159265358979323846

/* ---- what has to do ---- */

/* Whether POV-Ray is told how (u,w) lie on the surface. */
static bool has_uw(const object *o)
{
    const shape_kind kind = o->shape_said.kind;
    return kind != SHAPE_CYLINDER && kind != SHAPE_CONE && kind != SHAPE_TORUS && kind != SHAPE_SEARCHED && !(kind == SHAPE_SPHERE && pov_mirrored(o));
}

/* Whether all of the surface is on the image. */
static bool covers(const object *o)
{
    double u[2], w[2];
    const map_layout *l = &o->color_layout;
    o->shape->is->extent(o->shape, 0, u, w);
    return l->offset[0] <= u[0] && l->offset[0] + l->size[0] >= u[1] && l->offset[1] <= w[0] && l->offset[1] + l->size[1] >= w[1];
}

bool pov_possible(const scene *s, errors *e)
{
    bool good = true;
    for (int k = 0; k < s->objects; k++) {
        const object *o = &s->object[k];
        const material *m = &s->material[o->material];
        if (m->pattern && !has_uw(o))
            good = errors_add(e, "%s: object %s: the colours of material %s can't be laid on a %s%s in POV-Ray, expected a constant color",
                              s->path, o->name, m->name, pov_mirrored(o) ? "mirrored " : "", o->shape->is->kind);
        else if (m->pattern == PATTERN_IMAGE && m->layout.wrap != MAP_REPEAT && !(m->layout.wrap == MAP_CLAMP && m->nearest && covers(o)))
            good = errors_add(e, "%s: object %s: POV-Ray's images repeat and do nothing else, expected 'wrap: repeat' in material %s%s", s->path,
                              o->name, m->name,
                              m->layout.wrap == MAP_CLAMP ? ", or 'interpolation: nearest' on an image as large as the surface" : "");
    }
    return good;
}

/* ---- materials ---- */

static void put_color(pov_text *t, const material *m, vec3 color)
{
    if (material_clear(m))
        pov_print(t, "color rgb %v filter %g transmit %g", color, m->filter, m->transmit);
    else
        pov_print(t, "color rgb %v", color);
}

static void put_finish(pov_text *t, const material *m, const char *in)
{
    pov_print(t, "%sfinish {\n%s  ambient %g\n%s  diffuse %g\n%s  phong %g phong_size %g\n%s  specular %g roughness %g\n", in, in,
              m->ambient, in, m->diffuse, in, m->phong, m->phong_size, in, m->specular, m->roughness);
    if (material_mirrors(m))
        pov_print(t, "%s  reflection { rgb %v }\n", in, m->reflection);
    pov_print(t, "%s}\n", in);
}

static void put_plain(pov_text *t, const material *m, const char *name)
{
    pov_print(t, "#declare %s = texture {\n  pigment { ", name);
    put_color(t, m, m->color);
    pov_print(t, " }\n");
}

void pov_materials(pov_text *t, const scene *s)
{
    bool checkers = false;
    for (int k = 0; k < s->materials; k++) {
        const material *m = &s->material[k];
        checkers |= m->pattern == PATTERN_CHECKER;
        if (m->pattern)
            pov_print(t, "#declare %s =\n", pov_identify("Finish", m->name, k).text);
        else
            put_plain(t, m, pov_identify("Material", m->name, k).text);
        put_finish(t, m, "  ");
        pov_print(t, m->pattern ? "\n" : "}\n\n");
    }
    if (checkers)
        pov_print(t, "// 0 on the even fields, 1/2 on the odd ones\n"
                     "#declare Checker = function(u, w) { 0.5*(floor(u) + floor(w)) - floor(0.5*(floor(u) + floor(w))) }\n\n");
}

static void put_checker(pov_text *t, const object *o, bool flat, const material *m)
{
    const map_layout *l = &o->color_layout;
    pov_print(t, "    function { Checker((%s - %s)/%s, ", flat ? "x" : "atan2(z, x)", pov_exact(l->offset[0]).text,
              pov_exact(l->size[0]).text);
    pov_print(t, "(%s - %s)/%s) }\n", flat ? "y" : "atan2(sqrt(x*x + z*z), y)", pov_exact(l->offset[1]).text, pov_exact(l->size[1]).text);
    pov_print(t, "    color_map { [0.25 ");
    put_color(t, m, m->field[0]);
    pov_print(t, "] [0.25 ");
    put_color(t, m, m->field[1]);
    pov_print(t, "] }\n");
}

static void put_image_map(pov_text *t, const material *m)
{
    pov_print(t, "image_map { %s \"", m->exr ? "exr" : "png");
    for (const char *c = m->file; *c; c++)
        pov_print(t, *c == '"' || *c == '\\' ? "\\%s" : "%s", (char[2]){*c, 0});
    pov_print(t, "\"%s", m->exr ? "" : m->linear ? " gamma 1" : " gamma srgb");
    if (material_clear(m))
        pov_print(t, " filter all %g transmit all %g", m->filter, m->transmit);
    pov_print(t, "%s }", m->nearest ? "" : " interpolate 2");
}

/* In POV-Ray an image's lower left corner is in the origin. */
static void put_flat_image(pov_text *t, const object *o, const material *m)
{
    const map_layout *l = &o->color_layout;
    pov_print(t, "    ");
    put_image_map(t, m);
    pov_print(t, "\n    scale <1, -1, 1> translate y // its first row at the lowest w\n");
    pov_print(t, "    scale <%g, %g, 1> translate <%g, %g, 0>\n", l->size[0], l->size[1], l->offset[0], l->offset[1]);
}

/* `turns`: 1 for u below 0. */
static void put_round_image(pov_text *t, const object *o, const material *m, int turns)
{
    const map_layout *l = &o->color_layout;
    put_image_map(t, m);
    pov_print(t, "\n      scale <%g, %g, 1> translate <%g, %g, 0> warp { spherical orientation z dist_exp 0 }\n", l->size[0] / (2 * PI),
              l->size[1] / PI, l->offset[0] / (2 * PI) + turns, 1 - (l->offset[1] + l->size[1]) / PI);
}

/* An image that does not close around the sphere has its seam at u = pi, where z changes its sign behind the axis. */
static void put_sphere_image(pov_text *t, const object *o, const material *m)
{
    const double times = 2 * PI / o->color_layout.size[0];
    if (fabs(times - floor(times + 0.5)) < 1e-9) {
        pov_print(t, "      ");
        put_round_image(t, o, m, 0);
        return;
    }
    pov_print(t, "    function { select(z, 0, 1) }\n    pigment_map {\n      [0.5 ");
    put_round_image(t, o, m, 1);
    pov_print(t, "      ]\n      [0.5 ");
    put_round_image(t, o, m, 0);
    pov_print(t, "      ]\n    }\n");
}

void pov_texture(pov_text *t, const scene *s, const object *o, int part)
{
    const material *m = &s->material[o->material];
    if (!m->pattern) {
        pov_print(t, "  texture { %s }\n", pov_identify("Material", m->name, o->material).text);
        return;
    }
    const bool vectors = o->shape_said.kind == SHAPE_MESH, flat = vectors || pov_is_flat(&o->shape_said, part); /* x is u, y is w */
    pov_print(t, "  texture {\n    pigment { // in (u, w)\n%s", vectors ? "    uv_mapping\n" : "");
    if (m->pattern == PATTERN_CHECKER)
        put_checker(t, o, flat, m);
    else if (flat)
        put_flat_image(t, o, m);
    else
        put_sphere_image(t, o, m);
    if (vectors) {
        ; /* mesh2 has them for each vertex */
    } else if (pov_is_flat(&o->shape_said, part)) {
        const pov_flat p = pov_flat_of(o, part);
        pov_print(t, "  ");
        pov_matrix(t, p.U, p.W, p.y, p.O);
        pov_print(t, "\n");
    } else {
        pov_print(t, "    translate %v\n", o->shape_said.a);
        if (o->moved) {
            pov_print(t, "  ");
            pov_matrix(t, o->placed.x, o->placed.y, o->placed.z, o->placed.o);
            pov_print(t, "\n");
        }
    }
    pov_print(t, "    }\n    finish { %s }\n  }\n", pov_identify("Finish", m->name, o->material).text);
}

bool pov_by_parts(const scene *s, const object *o) { return s->material[o->material].pattern && o->shape->is->parts > 1; }
