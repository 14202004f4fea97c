/* Lists of copies: the shape with its texture is declared once, and a union has it under each copy's matrix. */
#include "povray/parts.h"

object pov_original(const object *o)
{
    object one = *o;
    one.crowd = NULL;
    one.moved = false;
    one.placed = affine_identity();
    one.shape = (surface *)o->crowd->from; /* which is only read */
    if (one.shape_spec.kind == SHAPE_CLOSED) {
        vec3 middle; /* the copies' maps have it */
        one.shape_spec.values = shape_centred(one.shape_spec.form, &one.shape_spec.values, &middle);
    }
    return one;
}

void pov_copies(pov_text *t, const object *o, int kind, const char *name)
{
    const crowd *f = o->crowd;
    pov_print(t, "union {\n");
    for (int32_t k = 0; k < f->n; k++) {
        if (f->copy[k].kind != kind)
            continue;
        const affine m = crowd_map(f, k);
        pov_print(t, "object {\n  %s\n", name);
        pov_matrix(t, m.x, m.y, m.z, m.o, "\n");
        pov_print(t, "}\n");
    }
    pov_print(t, "}\n\n");
}
