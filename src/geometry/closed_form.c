/* The table of closed forms, and moving them to the origin. */
#include "geometry/closed_form.h"

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
