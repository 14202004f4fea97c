/* The table of closed forms, and what all of them share. */
#include "geometry/closed_form.h"

#include <stdio.h>

#define POINT_TO(NAME) &form_##NAME,
const closed_form *const closed_forms[CLOSED_FORM_COUNT] = {CLOSED_FORMS(POINT_TO)};

shape_values shape_centred(const closed_form *form, const shape_values *v, vec3 *middle)
{
    shape_values c = *v;
    int slot[2] = {0, 0}, places = 0;
    for (const form_parameter *p = form->parameters; p->key; p++)
        if (p->type == FORM_PLACE)
            slot[places++] = p->slot;
    const vec3 from = v->v[slot[0]], to = v->v[slot[1]];
    if (places == 1) {
        *middle = from;
        c.v[slot[0]] = (vec3){0, 0, 0};
    } else {
        *middle = vec3_scale(vec3_add(from, to), 0.5);
        c.v[slot[1]] = vec3_scale(vec3_sub(to, from), 0.5);
        c.v[slot[0]] = vec3_scale(c.v[slot[1]], -1);
    }
    return c;
}

void formula_revolve(form_formula *f, frame axes, const char *rho, const char *y)
{
    const double pi = 3.14159265358979323846;
    const double X[3] = {axes.x.x, axes.x.y, axes.x.z}, Y[3] = {axes.y.x, axes.y.y, axes.y.z};
    const double Z[3] = {axes.z.x, axes.z.y, axes.z.z};
    f->u[0] = -pi;
    f->u[1] = pi;
    for (int k = 0; k < 3; k++)
        snprintf(f->xyz[k], sizeof f->xyz[k], "(%s)*(%.17g*cos(u) + %.17g*sin(u)) + %.17g*(%s)", rho, X[k], Z[k], Y[k],
                 y);
}
