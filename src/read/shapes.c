/* Shapes: closed forms by the parameters that geometry/closed_form.h lists; the others by readers of their own. */
#include "read/parts.h"

#include <string.h>

static const struct {
    const char *name;
    surface *(*read)(reader *r, node *at, shape_spec *spec);
} others[] = {{"parametric", reader_parametric}, {"patches", reader_patches}, {"mesh", reader_mesh}};
enum { SHAPES = CLOSED_FORM_COUNT + (int)(sizeof others / sizeof *others) };

static const char *name_of(int shape)
{
    return shape < CLOSED_FORM_COUNT ? closed_forms[shape]->name : others[shape - CLOSED_FORM_COUNT].name;
}

/* The first shape of the object from shape k on; SHAPES: none. */
static int next_shape(node *at, int k)
{
    while (k < SHAPES && !yaml_get(at, name_of(k)))
        k++;
    return k;
}

static bool read_parameter(reader *r, node *at, const form_parameter *p, shape_values *v)
{
    switch (p->type) {
    case FORM_PLACE:
    case FORM_VECTOR:
        return reader_vector(r, at, p->key, p->expected, &v->v[p->slot]);
    case FORM_DIRECTION:
    case FORM_EDGE:
        return reader_vector(r, at, p->key, p->expected, &v->v[p->slot]) &&
               reader_has_length(r, at, p->key, p->type == FORM_EDGE ? "an edge" : "a vector", v->v[p->slot]);
    case FORM_LENGTH:
        return reader_number(r, at, p->key, 0, false, BIG, "a length from 0 to 1e6", &v->r[p->slot]);
    case FORM_POSITIVE:
        return reader_number(r, at, p->key, SMALL, false, BIG, "a length from 1e-6 to 1e6", &v->r[p->slot]);
    case FORM_OPEN:
        break;
    }
    node *open = yaml_get(at, p->key);
    return !open || yaml_bool(r->y, open, "true or false", &v->open);
}

static surface *read_closed(reader *r, node *at, const closed_form *form, shape_spec *spec)
{
    char keys[128] = "";
    bool good = true;
    *spec = (shape_spec){.kind = SHAPE_CLOSED, .form = form};
    for (const form_parameter *p = form->parameters; p->key; p++) {
        strncat(keys, *keys ? " " : "", sizeof keys - strlen(keys) - 1);
        strncat(keys, p->key, sizeof keys - strlen(keys) - 1);
    }
    if (!yaml_map(r->y, at, form->name, keys))
        return NULL;
    for (const form_parameter *p = form->parameters; p->key; p++)
        good = (p->type == FORM_OPEN || yaml_need(r->y, at, p->key, form->name)) && good;
    for (const form_parameter *p = form->parameters; p->key; p++)
        good = (!yaml_get(at, p->key) || read_parameter(r, at, p, &spec->values)) && good;
    if (!good)
        return NULL;
    form_fault fault = {NULL, NULL};
    surface *f = form->make(&spec->values, &fault);
    if (!f && fault.message)
        yaml_error(r->y, fault.key ? yaml_get(at, fault.key) : at, "%s", fault.message);
    else if (!f)
        reader_made(r, NULL);
    return f;
}

surface *reader_shape(reader *r, node *at, shape_spec *spec)
{
    const int shape = next_shape(at, 0), second = next_shape(at, shape + 1);
    if (shape == SHAPES)
        yaml_error(r->y, at, "an object lacks its shape, expected one of: " READER_SHAPES);
    else if (second < SHAPES)
        yaml_error(r->y, yaml_get(at, name_of(second)), "a second shape, '%s' beside '%s', expected one",
                   name_of(second), name_of(shape));
    if (shape == SHAPES || second < SHAPES)
        return NULL;
    node *there = yaml_get(at, name_of(shape));
    return shape < CLOSED_FORM_COUNT ? read_closed(r, there, closed_forms[shape], spec)
                                     : others[shape - CLOSED_FORM_COUNT].read(r, there, spec);
}

bool reader_no_shape(reader *r, node *at)
{
    const int k = next_shape(at, 0);
    return k == SHAPES || yaml_error(r->y, yaml_get(at, name_of(k)), "a shape, '%s', beside '%s', expected one of them",
                                     name_of(k), yaml_get(at, "copy") ? "copy" : "copies");
}
