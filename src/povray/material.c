/* Materials for POV-Ray. A pattern becomes a pigment in the surface's (u,w): on a flat part in its frame; on a round
 * one by a POV-Ray warp about y, with u/2pi as x; on a mesh by the (u,w) of its vertices.
 */
#include "patch/surface.h"
#include "pov_text/flat.h"
#include "povray/parts.h"

#include <stdio.h>
#include <string.h>

#define PI 3.14159265358979323846

/* ---- what POV-Ray lacks ---- */

/* Whether the image covers all of the surface. */
static bool covers(const object *o)
{
    double u[2], w[2];
    const map_layout *l = &o->color_layout;
    o->shape->ops->extent(o->shape, 0, u, w);
    return l->offset[0] <= u[0] && l->offset[0] + l->size[0] >= u[1] && l->offset[1] <= w[0] &&
           l->offset[1] + l->size[1] >= w[1];
}

bool pov_possible(const scene *s, errors *e)
{
    bool good = true;
    for (int k = 0; k < s->objects; k++) {
        const object *o = &s->object[k];
        const material *m = &s->material[o->material];
        if (m->pattern == PATTERN_IMAGE && m->layout.wrap != MAP_REPEAT &&
            !(m->layout.wrap == MAP_CLAMP && m->nearest && covers(o)))
            good = errors_add(
                e,
                "%s: object %s: POV-Ray's images repeat and do nothing else, expected 'wrap: repeat' in material %s%s",
                s->path, o->name, m->name,
                m->layout.wrap == MAP_CLAMP ? ", or 'interpolation: nearest' on an image as large as the surface" : "");
        if (m->pattern == PATTERN_IMAGE && strncmp(m->file, ARRAY_PREFIX, strlen(ARRAY_PREFIX)) == 0)
            good = errors_add(e,
                              "%s: object %s: the image of material %s is %s, in memory alone, expected a file, "
                              "which POV-Ray can read",
                              s->path, o->name, m->name, m->file);
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

static void put_finish(pov_text *t, const material *m)
{
    pov_print(t,
              "  finish {\n    ambient %g\n    diffuse %g\n    phong %g phong_size %g\n    specular %g roughness %g\n",
              m->ambient, m->diffuse, m->phong, m->phong_size, m->specular, m->roughness);
    if (material_mirrors(m))
        pov_print(t, "    reflection { rgb %v }\n", m->reflection);
    pov_print(t, "  }\n");
}

void pov_materials(pov_text *t, const scene *s)
{
    bool checkers = false;
    for (int k = 0; k < s->materials; k++) {
        const material *m = &s->material[k];
        checkers |= m->pattern == PATTERN_CHECKER;
        if (m->pattern)
            pov_print(t, "#declare %s =\n", pov_identify("Finish", m->name, k).text);
        else {
            pov_print(t, "#declare %s = texture {\n  pigment { ", pov_identify("Material", m->name, k).text);
            put_color(t, m, m->color);
            pov_print(t, " }\n");
        }
        put_finish(t, m);
        pov_print(t, m->pattern ? "\n" : "}\n\n");
    }
    if (checkers)
        pov_print(
            t,
            "// 0 on the even fields, 1/2 on the odd ones\n"
            "#declare Checker = function(u, w) { 0.5*(floor(u) + floor(w)) - floor(0.5*(floor(u) + floor(w))) }\n\n");
}

/* ---- (u,w) on round surfaces ---- */

/* (u,w) on a round surface about y: u is an angle from x to z, or from z to x if a transform mirrors. */
typedef struct winding {
    char w[160]; /* a function of x, y and z */
    char warp[80];
    double low, rate; /* the warp's y is low + rate w */
    frame axes;
} winding;

/* Of a sphere, a torus, or the side of a cylinder or cone. */
static winding winding_of(const object *o)
{
    const closed_form *form = o->shape_spec.form;
    const shape_values *v = &o->shape_spec.values;
    const vec3 up = {0, 1, 0};
    winding a;
    if (form == &form_sphere) {
        snprintf(a.w, sizeof a.w, "atan2(sqrt(x*x + z*z), y)");
        snprintf(a.warp, sizeof a.warp, "spherical");
        a.low = 1;
        a.rate = -1 / PI;
        a.axes = frame_about(up);
    } else if (form == &form_torus) {
        const pov_digits major = pov_exact(v->r[0]);
        snprintf(a.w, sizeof a.w, "atan2(-y, sqrt(x*x + z*z) - %s)", major.text);
        snprintf(a.warp, sizeof a.warp, "toroidal major_radius %s", major.text);
        a.low = 0.5;
        a.rate = -0.5 / PI;
        a.axes = frame_about(v->v[1]);
    } else { /* w is the way down the side */
        const vec3 axis = vec3_sub(v->v[1], v->v[0]);
        const double high = vec3_length(axis), slant = hypot(high, pov_rim(&o->shape_spec, 1) - v->r[0]) / high;
        if (slant > 1)
            snprintf(a.w, sizeof a.w, "%s*(%s - y)", pov_exact(slant).text, pov_exact(high).text);
        else
            snprintf(a.w, sizeof a.w, "%s - y", pov_exact(high).text);
        snprintf(a.warp, sizeof a.warp, "cylindrical");
        a.low = high;
        a.rate = -1 / slant;
        a.axes = frame_about(axis);
    }
    return a;
}

/* ---- pigments ---- */

static void put_checker(pov_text *t, const material *m, const map_layout *l, const char *u, const char *w)
{
    pov_print(t, "    function { Checker((%s - %s)/%s, ", u, pov_exact(l->offset[0]).text, pov_exact(l->size[0]).text);
    pov_print(t, "(%s - %s)/%s) }\n", w, pov_exact(l->offset[1]).text, pov_exact(l->size[1]).text);
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

/* `turns`: added to u/2pi. */
static void put_wound_image(pov_text *t, const object *o, const material *m, const winding *a, int turns)
{
    const map_layout *l = &o->color_layout;
    const double around = (pov_mirrored(o) ? -0.5 : 0.5) / PI;
    put_image_map(t, m);
    pov_print(t, "\n      scale <%g, %g, 1> translate <%g, %g, 0> warp { %s orientation z dist_exp 0 }\n",
              l->size[0] * around, -l->size[1] * a->rate, l->offset[0] * around + turns,
              a->low + a->rate * (l->offset[1] + l->size[1]), a->warp);
}

/* An image that does not repeat a whole number of times has its seam at u = pi, where z changes its sign. */
static void put_round_image(pov_text *t, const object *o, const material *m, const winding *a)
{
    const double times = 2 * PI / o->color_layout.size[0];
    if (fabs(times - floor(times + 0.5)) < 1e-9) {
        pov_print(t, "      ");
        put_wound_image(t, o, m, a, 0);
        return;
    }
    pov_print(t, "    function { select(z, 0, 1) }\n    pigment_map {\n      [0.5 ");
    put_wound_image(t, o, m, a, 1);
    pov_print(t, "      ]\n      [0.5 ");
    put_wound_image(t, o, m, a, 0);
    pov_print(t, "      ]\n    }\n");
}

/* In a frame where x is u and y is w. In POV-Ray an image's lower left corner is at the origin. */
static void put_plane_pigment(pov_text *t, const object *o, const material *m)
{
    const map_layout *l = &o->color_layout;
    if (m->pattern == PATTERN_CHECKER) {
        put_checker(t, m, l, "x", "y");
        return;
    }
    pov_print(t, "    ");
    put_image_map(t, m);
    pov_print(t, "\n    scale <1, -1, 1> translate y // its first row at the lowest w\n");
    pov_print(t, "    scale <%g, %g, 1> translate <%g, %g, 0>\n", l->size[0], l->size[1], l->offset[0], l->offset[1]);
}

static void put_round_pigment(pov_text *t, const object *o, const material *m)
{
    const winding a = winding_of(o);
    if (m->pattern == PATTERN_CHECKER)
        put_checker(t, m, &o->color_layout, pov_around(o), a.w);
    else
        put_round_image(t, o, m, &a);
    pov_print(t, "  ");
    pov_matrix(t, a.axes.x, a.axes.y, a.axes.z, o->shape_spec.values.v[0], " // y is the axis\n");
    if (o->moved) {
        pov_print(t, "  ");
        pov_matrix(t, o->placed.x, o->placed.y, o->placed.z, o->placed.o, "\n");
    }
}

void pov_texture(pov_text *t, const scene *s, const object *o, int part)
{
    const material *m = &s->material[o->material];
    if (!m->pattern) {
        pov_print(t, "  texture { %s }\n", pov_identify("Material", m->name, o->material).text);
        return;
    }
    /* POV-Ray ignores uv_mapping in the pigment for shadow rays */
    pov_print(t, "  texture {\n%s    pigment { // in (u, w)\n", pov_by_uv(s, o) ? "    uv_mapping\n" : "");
    const bool flat = pov_is_flat(&o->shape_spec, part), by_uv = pov_by_uv(s, o);
    if (flat || by_uv)
        put_plane_pigment(t, o, m);
    else
        put_round_pigment(t, o, m);
    if (flat && !by_uv) {
        const pov_flat p = pov_flat_of(o, part);
        pov_print(t, "  ");
        pov_matrix(t, p.U, p.W, p.y, p.O, "\n");
    }
    pov_print(t, "    }\n    finish { %s }\n  }\n", pov_identify("Finish", m->name, o->material).text);
}

bool pov_is_patch(const scene *s, const object *o)
{
    const shape_spec *f = &o->shape_spec;
    if (f->kind == SHAPE_MESH)
        return false;
    return f->kind == SHAPE_PATCH || !f->form->povray || (s->displaced && patch_surface_is(o->shape)) ||
           (s->material[o->material].pattern && !f->form->flat && f->form != &form_sphere && f->form != &form_torus);
}

bool pov_by_uv(const scene *s, const object *o)
{
    /* no warp gives w on a displaced cone, which is w at the closest point of the smooth one */
    const bool cone = o->shape_spec.form == &form_cone && s->displaced && o->bump;
    return s->material[o->material].pattern && (cone || pov_is_patch(s, o) || o->shape_spec.kind == SHAPE_MESH);
}

bool pov_by_parts(const scene *s, const object *o)
{
    return s->material[o->material].pattern && o->shape->ops->parts > 1 && !pov_by_uv(s, o);
}
