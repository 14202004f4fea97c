/* Closed forms without bumps, as POV-Ray shapes. */
#include "pov_text/flat.h"
#include "povray/parts.h"

#include <string.h>

/* A parallelogram; the brace stays open. */
static void put_rectangle(pov_text *t, vec3 O, vec3 U, vec3 W)
{
    vec3 n = vec3_unit(vec3_cross(U, W));
    pov_print(t, "polygon {\n  5, <0, 0>, <1, 0>, <1, 1>, <0, 1>, <0, 0>\n");
    pov_matrix(t, U, W, n, O, " // u, w, n, origin\n");
}

static void put_parameter(pov_text *t, const form_parameter *p, const shape_values *v)
{
    if (p->type == FORM_OPEN)
        pov_print(t, "%s", v->open ? " open" : "");
    else if (p->type == FORM_LENGTH || p->type == FORM_POSITIVE)
        pov_print(t, "%g", v->r[p->slot]);
    else
        pov_print(t, "%v", v->v[p->slot]);
}

static void put_axes(pov_text *t, const closed_form *form, const shape_values *v)
{
    vec3 origin = {0, 0, 0}, axis = {0, 1, 0};
    for (const form_parameter *p = form->parameters; p->key; p++) {
        origin = p->type == FORM_PLACE ? v->v[p->slot] : origin;
        axis = p->type == FORM_DIRECTION ? v->v[p->slot] : axis;
    }
    const frame a = frame_about(axis);
    pov_matrix(t, a.x, a.y, a.z, origin, " // y is the axis\n");
}

/* The value of a word of the template, without its $. */
static void put_word(pov_text *t, const closed_form *form, const shape_values *v, const char *word, size_t n)
{
    flat_part f;
    for (const form_parameter *p = form->parameters; p->key; p++)
        if (strlen(p->key) == n && strncmp(p->key, word, n) == 0)
            put_parameter(t, p, v);
    if (strncmp(word, "axes", n) == 0)
        put_axes(t, form, v);
    else if (strncmp(word, "plane", n) == 0 && form->flat(v, 0, &f)) {
        const vec3 normal = vec3_unit(vec3_cross(f.U, f.W));
        pov_print(t, "%v, %g", normal, vec3_dot(normal, f.O));
    } else if (strncmp(word, "rectangle", n) == 0 && form->flat(v, 0, &f))
        put_rectangle(t, f.O, f.U, f.W);
}

static void put_shape(pov_text *t, const object *o, const shape_values *v)
{
    const closed_form *form = o->shape_spec.form;
    for (const char *c = form->povray; *c;) {
        const size_t plain = strcspn(c, "$");
        pov_put(t, c, plain);
        c += plain;
        if (!*c)
            break;
        const size_t n = strspn(++c, "abcdefghijklmnopqrstuvwxyz_");
        put_word(t, form, v, c, n);
        c += n;
    }
    if (o->moved)
        pov_matrix(t, o->placed.x, o->placed.y, o->placed.z, o->placed.o, " // its transform\n");
}

/* A shape whose parts have textures of their own: each flat part where it is in the scene, and the side. */
static void put_parts(pov_text *t, const scene *s, const object *o)
{
    shape_values side = o->shape_spec.values;
    side.open = true;
    pov_print(t, "union {\n");
    for (int part = 0; part < o->shape->ops->parts; part++) {
        const double rim = pov_rim(&o->shape_spec, part);
        if (rim == 0)
            continue;
        const pov_flat p = pov_flat_of(o, part);
        if (!pov_is_flat(&o->shape_spec, part))
            put_shape(t, o, &side);
        else if (rim < 0)
            put_rectangle(t, p.O, p.U, p.W);
        else {
            pov_print(t, "disc {\n  0, z, %g\n", rim);
            pov_matrix(t, p.U, p.W, p.y, p.O, " // u, w, n, origin\n");
        }
        pov_texture(t, s, o, part);
        pov_print(t, "}\n");
    }
}

void pov_smooth(pov_text *t, const scene *s, const object *o)
{
    if (pov_by_parts(s, o))
        put_parts(t, s, o);
    else
        put_shape(t, o, &o->shape_spec.values);
}
