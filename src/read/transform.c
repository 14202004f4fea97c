/* The scene reader's transforms, as POV-Ray has them: one step after the other, about the scene's origin and axes. */
#include "math/kmath.h"
#include "mesh/mesh.h"
#include "patch/surface.h"
#include "read/reader.h"

#define STRETCH 1e4 /* one way more than another: float has 7 digits, and needs some for itself */

#define PLACE "[x, y, z]"
#define SCALE "a factor or [x, y, z], each 1e-6 to 1e6 or -1e6 to -1e-6"

/* Cosine and sine of an angle in degrees, exact for right angles. */
static void circle(double degrees, double *c, double *s)
{
    const double quarter = km_floor(degrees / 90 + 0.5), rest = (degrees - 90 * quarter) * (KM_PI / 180);
    const int k = (int)(quarter - 4 * km_floor(quarter / 4));
    const double x = km_cos(rest), y = km_sin(rest);
    *c = k == 0 ? x : k == 1 ? -y : k == 2 ? -x : y;
    *s = k == 0 ? y : k == 1 ? x : k == 2 ? -y : -x;
}

/* About x, then y, then z; the left hand's thumb along the axis, its fingers show the way. */
static bool rotate(reader *r, node *at, affine *m)
{
    double a[3], c[3], s[3];
    if (!yaml_numbers(r->y, at, 3, -BIG, BIG, "angles in degrees about the axes, " PLACE, a))
        return false;
    for (int k = 0; k < 3; k++)
        circle(a[k], &c[k], &s[k]);
    const affine x = {{1, 0, 0}, {0, c[0], s[0]}, {0, -s[0], c[0]}, {0, 0, 0}};
    const affine y = {{c[1], 0, -s[1]}, {0, 1, 0}, {s[1], 0, c[1]}, {0, 0, 0}};
    const affine z = {{c[2], s[2], 0}, {-s[2], c[2], 0}, {0, 0, 1}, {0, 0, 0}};
    const affine xy = affine_then(&x, &y);
    *m = affine_then(&xy, &z);
    return true;
}

static bool translate(reader *r, node *at, affine *m)
{
    double v[3];
    *m = affine_identity();
    if (!yaml_numbers(r->y, at, 3, -BIG, BIG, "how far along x, y and z, " PLACE, v))
        return false;
    m->o = (vec3){v[0], v[1], v[2]};
    return true;
}

/* One number for all three, or three. */
static bool scale(reader *r, node *at, affine *m)
{
    const bool three = yaml_is_list(at);
    double v[3];
    if (three ? !yaml_numbers(r->y, at, 3, -BIG, BIG, SCALE, v) : !yaml_number(r->y, at, -BIG, false, BIG, SCALE, v))
        return false;
    for (int k = 0; k < (three ? 3 : 1); k++)
        if (fabs(v[k]) < SMALL)
            return yaml_error(r->y, three ? yaml_item(at, k) : at, "a scale of %g leaves nothing, expected " SCALE,
                              v[k]);
    if (!three)
        v[1] = v[2] = v[0];
    *m = (affine){{v[0], 0, 0}, {0, v[1], 0}, {0, 0, v[2]}, {0, 0, 0}};
    return true;
}

/* As a camera stands: the origin goes to `from`, +z towards `at`, +y as far up as it can. */
static bool look(reader *r, node *at, affine *m)
{
    vec3 from = {0, 0, 0}, to = {0, 0, 0}, up = {0, 1, 0};
    if (!yaml_map(r->y, at, "look", "from at up"))
        return false;
    bool good = yaml_need(r->y, at, "from", "look") && yaml_need(r->y, at, "at", "look");
    good = reader_vector(r, at, "from", "where the origin goes " PLACE, &from) && good;
    good = reader_vector(r, at, "at", "the place looked at " PLACE, &to) && good;
    good = reader_vector(r, at, "up", "a direction " PLACE, &up) && good;
    if (!good)
        return false;
    node *said = yaml_get(at, "up");
    const vec3 way = vec3_sub(to, from);
    if (vec3_length(way) < SMALL)
        return yaml_error(r->y, yaml_get(at, "at"), "it looks at its own place, expected 'at' apart from 'from'");
    if (vec3_length(up) < SMALL)
        return yaml_error(r->y, said, "no direction, expected a vector with a length");
    const vec3 z = vec3_unit(way), x = vec3_cross(vec3_unit(up), z);
    if (vec3_length(x) < SMALL)
        return yaml_error(r->y, said ? said : at, "'up' is along the view, expected a direction across it%s",
                          said ? "" : " (it is [0, 1, 0])");
    *m = (affine){vec3_unit(x), vec3_cross(z, vec3_unit(x)), z, from};
    return true;
}

bool reader_transform(reader *r, node *at, affine *m)
{
    static const struct {
        const char *name;
        bool (*read)(reader *r, node *at, affine *m);
    } steps[] = {{"translate", translate}, {"rotate", rotate}, {"scale", scale}, {"look", look}};
    const int n = yaml_list(r->y, at, "a list of steps, such as [{rotate: [0, 45, 0]}, {translate: [1, 0, 0]}]");
    bool good = n >= 0;
    for (int i = 0; i < n; i++) {
        node *step = yaml_item(at, i);
        if (!yaml_map(r->y, step, "a step", "translate rotate scale look")) {
            good = false;
            continue;
        }
        if (yaml_size(step) != 1) {
            good = yaml_error(r->y, step, "a step with %d keys, expected one: which is first matters", yaml_size(step));
            continue;
        }
        for (int k = 0; k < (int)(sizeof steps / sizeof *steps); k++) {
            node *v = yaml_get(step, steps[k].name);
            affine next;
            if (!v)
                continue;
            if (steps[k].read(r, v, &next))
                *m = affine_then(m, &next);
            else
                good = false;
        }
    }
    return good;
}

static double length(const vec3s *v) { return vec3_length((vec3){(double)v->x[0], (double)v->y[0], (double)v->z[0]}); }

/* The lengths of Qu and Qw in the middle of each part, within what a shape's own keys allow. */
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
        const double l[2] = {length(&q.Qu), length(&q.Qw)};
        for (int k = 0; k < 2; k++)
            if (!(l[k] >= SMALL / 4 && l[k] <= BIG * 4)) {
                *wrong = l[k];
                return false;
            }
    }
    return true;
}

/* The shape about the origin, and where its middle is said to be. So its own space is never far from where it is, which
 * float would not bear, however far the transform brings it. NULL: out of memory. */
static surface *centred(const shape_spec *f, vec3 *middle)
{
    const bool two = f->kind == SHAPE_BOX || f->kind == SHAPE_CYLINDER || f->kind == SHAPE_CONE;
    *middle = two ? vec3_scale(vec3_add(f->a, f->u), 0.5) : f->a;
    const vec3 half = vec3_scale(vec3_sub(f->u, f->a), 0.5), other = vec3_scale(half, -1), here = {0, 0, 0};
    switch (f->kind) {
    case SHAPE_PLANE:
    case SHAPE_RECTANGLE:
        return plane_new(here, f->u, f->w, f->kind == SHAPE_RECTANGLE);
    case SHAPE_DISC:
        return disc_new(here, f->u, f->radius[0]);
    case SHAPE_BOX:
        return box_new(other, half);
    case SHAPE_SPHERE:
        return sphere_new(here, f->radius[0]);
    case SHAPE_CYLINDER:
        return cone_new(other, f->radius[0], half, f->radius[0], f->open);
    case SHAPE_CONE:
        return cone_new(other, f->radius[0], half, f->radius[1], f->open);
    case SHAPE_TORUS:
        return torus_new(here, f->u, f->radius[0], f->radius[1]);
    case SHAPE_PATCH: /* in double anyway */
    case SHAPE_MESH:
        break;
    }
    return NULL;
}

static bool wants_truth(const reader *r, const object *o) { return o->bump && scene_wants_truth(r->s); }

/* An image with all that the original has, where true displacement needs that. */
static surface *image_of(const reader *r, object *o, const surface *from, const affine *m)
{
    const bool truth = wants_truth(r, o);
    if (truth && o->shape_spec.kind == SHAPE_MESH)
        return mesh_moved(from, m);
    if (truth && o->shape_spec.kind == SHAPE_PATCH)
        return patch_surface_affine(from, m);
    surface *f = surface_transformed(from, m),
            *turned = f && truth && !f->ops->foot ? reader_revolution(&o->shape_spec) : NULL;
    if (!turned)
        return f;
    surface_free(f);
    surface_free(o->centred);
    o->centred = turned;
    return patch_surface_affine(turned, m);
}

/* A mesh has no edges of its own: its size is that of the sphere around it. */
static bool is_mesh_sized(const surface *f, const affine *m, double *wrong)
{
    const double longest = fmax(vec3_length(m->x), fmax(vec3_length(m->y), vec3_length(m->z)));
    *wrong = longest * ((const mesh *)f)->space.radius;
    return *wrong >= SMALL / 4 && *wrong <= BIG * 4;
}

bool reader_place(reader *r, node *at, object *o)
{
    const affine *m = &o->placed, back = affine_back(m);
    const double there = vec3_dot(m->x, m->x) + vec3_dot(m->y, m->y) + vec3_dot(m->z, m->z);
    const double here = vec3_dot(back.x, back.x) + vec3_dot(back.y, back.y) + vec3_dot(back.z, back.z);
    affine whole = affine_identity();
    double wrong = 0;
    const surface *from = o->own;
    const bool is_mesh = o->shape_spec.kind == SHAPE_MESH;
    if (o->shape_spec.kind != SHAPE_PATCH && !is_mesh)
        from = o->centred = centred(&o->shape_spec, &whole.o);
    const vec3 to = affine_point(m, is_mesh ? ((const mesh *)from)->space.centre : whole.o);
    const double far = fmax(fabs(to.x), fmax(fabs(to.y), fabs(to.z)));
    if (!(far <= BIG))
        return yaml_error(r->y, at, "it goes %.4g scene units away, expected 1000000 at most", far);
    if (!(there * here <= STRETCH * STRETCH))
        return yaml_error(r->y, at, "one way is stretched more than %g times as much as another, expected less",
                          STRETCH);
    whole = affine_then(&whole, m);
    surface *f = from ? image_of(r, o, from, &whole) : NULL;
    if (!f)
        return errors_add(r->e, "out of memory");
    o->shape = f;
    return (is_mesh ? is_mesh_sized(from, m, &wrong) : is_sized(f, &wrong)) ||
           yaml_error(r->y, at, "an edge or a radius of %.4g scene units comes from this, expected 1e-6 to 1e6", wrong);
}
