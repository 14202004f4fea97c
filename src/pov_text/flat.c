/* Frames of flat parts, and how transforms scale and mirror. */
#include "pov_text/flat.h"

static bool flat_part_of(const shape_spec *f, int part, flat_part *out)
{
    return f->kind == SHAPE_CLOSED && f->form->flat && f->form->flat(&f->values, part, out);
}

bool pov_is_flat(const shape_spec *f, int part)
{
    flat_part p;
    return flat_part_of(f, part, &p);
}

double pov_rim(const shape_spec *f, int part)
{
    flat_part p;
    return flat_part_of(f, part, &p) ? p.rim : -1;
}

void pov_levels(const object *o, double y[2])
{
    double air = 1e-3 * ((double)o->bump->Pmax - (double)o->bump->Pmin) + 1e-6;
    y[0] = (double)o->bump->Pmin - air;
    y[1] = (double)o->bump->Pmax + air;
}

void pov_clip_rim(pov_text *t, const object *o, int part)
{
    const pov_flat p = pov_flat_of(o, part);
    double y[2];
    pov_levels(o, y);
    pov_print(t, "  clipped_by { cylinder { <0, %g, 0>, <0, %g, 0>, %g\n  ", y[0], y[1], pov_rim(&o->shape_spec, part));
    pov_matrix(t, p.U, p.y, p.W, p.O, " } }\n");
}

double pov_scale(const object *o) { return o->moved ? affine_scale(&o->placed) : 1; }

bool pov_mirrored(const object *o) { return o->moved && affine_volume(&o->placed) < 0; }

const char *pov_around(const object *o) { return pov_mirrored(o) ? "atan2(-z, x)" : "atan2(z, x)"; }

shape_values pov_sized(const object *o)
{
    const double k = pov_scale(o);
    shape_values v = o->shape_spec.values;
    for (size_t i = 0; i < sizeof v.v / sizeof *v.v; i++)
        v.v[i] = vec3_scale(v.v[i], k);
    for (size_t i = 0; i < sizeof v.r / sizeof *v.r; i++)
        v.r[i] *= k;
    return v;
}

/* A transform that mirrors reverses u within its range. */
static void mirror(const object *o, int part, flat_part *p)
{
    double u[2], w[2];
    o->own->ops->extent(o->own, part, u, w);
    if (u[1] < HUGE_VAL)
        p->O = vec3_add(p->O, vec3_scale(p->U, u[0] + u[1]));
    p->U = vec3_scale(p->U, -1);
}

pov_flat pov_flat_of(const object *o, int part)
{
    flat_part f = {.rim = -1};
    flat_part_of(&o->shape_spec, part, &f);
    if (pov_mirrored(o))
        mirror(o, part, &f);
    if (o->moved)
        f = (flat_part){affine_point(&o->placed, f.O), affine_vector(&o->placed, f.U), affine_vector(&o->placed, f.W),
                        f.rim};
    return (pov_flat){f.O, f.U, f.W, vec3_unit(f.U), vec3_unit(vec3_cross(f.U, f.W)), vec3_unit(f.W)};
}
