/* The table of closed forms, and functions that several of them use. */
#include "geometry/closed_form.h"
#include "math/kmath.h"

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
    const double X[3] = {axes.x.x, axes.x.y, axes.x.z}, Y[3] = {axes.y.x, axes.y.y, axes.y.z};
    const double Z[3] = {axes.z.x, axes.z.y, axes.z.z};
    f->u[0] = -KM_PI;
    f->u[1] = KM_PI;
    for (int k = 0; k < 3; k++)
        snprintf(f->xyz[k], sizeof f->xyz[k], "(%s)*(%.17g*cos(u) + %.17g*sin(u)) + %.17g*(%s)", rho, X[k], Z[k], Y[k],
                 y);
}

void extent_unit(const surface *f, int part, double u[2], double w[2])
{
    (void)f;
    (void)part;
    u[0] = w[0] = 0;
    u[1] = w[1] = 1;
}

void extent_polar(const surface *f, int part, double u[2], double w[2])
{
    (void)f;
    (void)part;
    u[0] = -KM_PI;
    u[1] = KM_PI;
    w[0] = 0;
    w[1] = KM_PI;
}
