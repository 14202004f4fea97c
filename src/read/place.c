/* The object's shape after its transform; errors if float has too few digits for its size or place.
 *
 * True displacement needs closest points in closed form, or a patch. A shape that lacks the first but has a formula
 * becomes a patch.
 */
#include "displaced/displaced.h"
#include "mesh/mesh.h"
#include "patch/surface.h"
#include "read/parts.h"

/* The largest ratio of the scales of two directions: float has 7 digits, and hits need 3 of them. */
#define STRETCH 1e4

/* By this factor a transformed length may pass the limits for keys, 1e-6 and 1e6. */
#define ROUNDED 4

static bool is_size(double x) { return x >= SMALL / ROUNDED && x <= BIG * ROUNDED; }

/* Whether Qu and Qw in the middle of each part have lengths that keys may have; otherwise *wrong is one that has not.
 */
static bool is_sized(const surface *f, double *wrong)
{
    for (int32_t part = 0; part < f->ops->parts; part++) {
        double U[2], W[2];
        partials q;
        f->ops->extent(f, part, U, W);
        if (!(U[0] < U[1])) /* a cap of a cone that ends in a point */
            continue;
        const real u = U[1] < HUGE_VAL ? (real)(0.5 * (U[0] + U[1])) : 0,
                   w = W[1] < HUGE_VAL ? (real)(0.5 * (W[0] + W[1])) : 0;
        f->ops->eval(f, 1, &part, &u, &w, 1, &q);
        const double l[2] = {vec3_length(vec3s_get(&q.Qu, 0)), vec3_length(vec3s_get(&q.Qw, 0))};
        for (int k = 0; k < 2; k++)
            if (!is_size(l[k])) {
                *wrong = l[k];
                return false;
            }
    }
    return true;
}

/* The same for a mesh, by the radius of its bounding sphere. */
static bool is_mesh_sized(const surface *f, const affine *m, double *wrong)
{
    const double longest = fmax(vec3_length(m->x), fmax(vec3_length(m->y), vec3_length(m->z)));
    *wrong = longest * ((const mesh *)f)->space.radius;
    return is_size(*wrong);
}

/* A closed form with these values, which are about the origin, mapped by m. NULL: out of memory. */
static surface *image_of_closed(reader *r, object *o, const shape_values *values, const affine *m, bool truth)
{
    form_fault fault;
    form_formula formula;
    const closed_form *form = o->shape_spec.form;
    o->centred = form->make(values, &fault);
    surface *f = o->centred ? surface_transformed(o->centred, m) : NULL;
    if (!f || !truth || displaced_has_form(f) || !form->formula || !form->formula(&o->shape_spec.values, &formula))
        return f;
    surface *searched = patch_surface_formula(form->name, &formula, r->from->threads, r->from->progress);
    if (!searched)
        return f;
    surface_free(f);
    surface_free(o->centred);
    o->centred = searched;
    return patch_surface_affine(searched, m, r->from->progress);
}

/* The object's own shape mapped by m; of a closed form, the one with `values`. NULL: out of memory. */
static surface *image_of(reader *r, object *o, const shape_values *values, const affine *m, bool truth)
{
    if (o->shape_spec.kind == SHAPE_CLOSED)
        return image_of_closed(r, o, values, m, truth);
    return truth ? reader_moved(r, o, m) : surface_transformed(o->own, m);
}

static double square(const affine *m) { return vec3_dot(m->x, m->x) + vec3_dot(m->y, m->y) + vec3_dot(m->z, m->z); }

bool reader_place(reader *r, node *at, object *o)
{
    const affine *m = &o->placed, back = affine_back(m);
    const bool is_mesh = o->shape_spec.kind == SHAPE_MESH, truth = o->bump && scene_wants_truth(r->s);
    affine whole = affine_identity();
    shape_values values = {.open = false};
    double wrong = 0;
    /* far from the origin float would lose digits before the transform */
    if (o->shape_spec.kind == SHAPE_CLOSED)
        values = shape_centred(o->shape_spec.form, &o->shape_spec.values, &whole.o);
    const vec3 to = affine_point(m, is_mesh ? ((const mesh *)o->own)->space.centre : whole.o);
    const double far = fmax(fabs(to.x), fmax(fabs(to.y), fabs(to.z)));
    if (!(far <= BIG))
        return yaml_error(r->y, at, "a coordinate of %.4g scene units after the transform, expected at most 1000000",
                          far);
    if (!(square(m) * square(&back) <= STRETCH * STRETCH))
        return yaml_error(r->y, at, "one direction is scaled more than %g times as much as another, expected less",
                          STRETCH);
    whole = affine_then(&whole, m);
    if (!(o->shape = reader_made(r, image_of(r, o, &values, &whole, truth))))
        return false;
    const bool sized = is_mesh ? is_mesh_sized(o->own, m, &wrong) : is_sized(o->shape, &wrong);
    if (!sized && isnan(wrong))
        return yaml_error(r->y, at,
                          "the surface is a line or a point, or has no value in the middle of its range of u "
                          "and w; expected one with an area there, to transform it");
    if (!sized)
        return yaml_error(r->y, at, "an edge or a radius of %.4g scene units after the transform, expected 1e-6 to 1e6",
                          wrong);
    if (truth && !displaced_has_form(o->shape))
        return yaml_error(r->y, at,
                          "a %s with caps and a bump is scaled differently along its axes, expected equal scales, or "
                          "'open: true', for %s",
                          o->shape->ops->kind, scene_truth_name(r->s));
    return true;
}
