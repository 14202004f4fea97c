/* Closed forms as patches, for the true displacement of shapes of which no foot is known: ellipsoids, also those that a
 * transform makes of round shapes. A patch's offset surface needs no foot.
 */
#include "patch/surface.h"

surface *patch_surface_formula(const char *kind, const form_formula *f, int threads)
{
    expr *e[3] = {NULL, NULL, NULL};
    bool good = true;
    for (int k = 0; k < 3; k++) {
        expr_error wrong;
        e[k] = expr_parse(f->xyz[k], &wrong);
        good = good && e[k];
    }
    if (!good) {
        for (int k = 0; k < 3; k++)
            expr_free(e[k]);
        return NULL;
    }
    patch *q = patch_function_new(kind, e, f->u, f->w);
    if (q)
        q->threads = threads;
    return q ? patch_surface_new(q) : NULL;
}
