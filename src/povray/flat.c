/* Flat surfaces for the POV-Ray writer: their frames, and how much of an unbounded one is needed. */
#include "povray/parts.h"

#include "base/frame.h"

bool pov_is_flat(const shape_spec *f, int part)
{
    bool round = f->kind == SHAPE_SPHERE || f->kind == SHAPE_TORUS,
         side = f->kind == SHAPE_CYLINDER || f->kind == SHAPE_CONE;
    return !round && !(side && part == 0);
}

double pov_rim(const shape_spec *f, int part)
{
    if (f->kind == SHAPE_DISC)
        return f->radius[0];
    if (part > 0 && (f->kind == SHAPE_CYLINDER || f->kind == SHAPE_CONE))
        return f->radius[part == 1];
    return -1;
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
    pov_matrix(t, p.U, p.y, p.W, p.O);
    pov_print(t, " } }\n");
}

static double *axis(vec3 *v, int k) { return k == 0 ? &v->x : k == 1 ? &v->y : &v->z; }

/* The faces of a box as surface.h numbers them: u and w go along the two next axes on the high side, swapped on the low
 * one. */
static pov_flat box_face(const shape_spec *f, int part)
{
    const int k = part >> 1, high = part & 1, a = (k + (high ? 1 : 2)) % 3, b = (k + (high ? 2 : 1)) % 3;
    vec3 lo = {fmin(f->a.x, f->u.x), fmin(f->a.y, f->u.y), fmin(f->a.z, f->u.z)};
    vec3 hi = {fmax(f->a.x, f->u.x), fmax(f->a.y, f->u.y), fmax(f->a.z, f->u.z)};
    pov_flat p = {.O = lo};
    if (high)
        *axis(&p.O, k) = *axis(&hi, k);
    *axis(&p.U, a) = *axis(&hi, a) - *axis(&lo, a);
    *axis(&p.W, b) = *axis(&hi, b) - *axis(&lo, b);
    return p;
}

/* A disc, or a cap of a cylinder or cone: part 1 is at its upper end, where the axis is n. */
static pov_flat disc(const shape_spec *f, int part)
{
    if (f->kind == SHAPE_DISC) {
        const frame a = frame_about(f->u);
        return (pov_flat){.O = f->a, .U = a.x, .W = vec3_scale(a.z, -1)};
    }
    const frame a = frame_about(vec3_sub(f->u, f->a));
    return part == 1 ? (pov_flat){.O = f->u, .U = a.x, .W = vec3_scale(a.z, -1)}
                     : (pov_flat){.O = f->a, .U = a.x, .W = a.z};
}

double pov_scale(const object *o) { return o->moved ? affine_scale(&o->placed) : 1; }

bool pov_mirrored(const object *o) { return o->moved && affine_volume(&o->placed) < 0; }

const char *pov_around(const object *o) { return pov_mirrored(o) ? "atan2(-z, x)" : "atan2(z, x)"; }

shape_spec pov_sized(const object *o)
{
    const double k = pov_scale(o);
    shape_spec f = o->shape_spec;
    f.a = vec3_scale(f.a, k);
    f.u = vec3_scale(f.u, k);
    f.radius[0] *= k;
    f.radius[1] *= k;
    return f;
}

pov_flat pov_flat_of(const object *o, int part)
{
    const shape_spec *f = &o->shape_spec;
    pov_flat p = f->kind == SHAPE_BOX    ? box_face(f, part)
                 : pov_rim(f, part) >= 0 ? disc(f, part)
                                         : (pov_flat){.O = f->a, .U = f->u, .W = f->w};
    if (o->moved) {
        const bool turned = pov_mirrored(o);
        if (turned && (f->kind == SHAPE_BOX || f->kind == SHAPE_RECTANGLE))
            p.O = vec3_add(p.O, p.U);
        p.O = affine_point(&o->placed, p.O);
        p.U = vec3_scale(affine_vector(&o->placed, p.U), turned ? -1 : 1);
        p.W = affine_vector(&o->placed, p.W);
    }
    p.x = vec3_unit(p.U);
    p.y = vec3_unit(vec3_cross(p.U, p.W));
    p.z = vec3_unit(p.W);
    return p;
}

/* ---- an unbounded plane ---- */

typedef struct region {
    vec3 O, Du, Dw; /* u = Du.(p - O) */
    double u[2], w[2];
} region;

static void hold(region *r, double u, double w)
{
    r->u[0] = fmin(r->u[0], u);
    r->u[1] = fmax(r->u[1], u);
    r->w[0] = fmin(r->w[0], w);
    r->w[1] = fmax(r->w[1], w);
}

static void hold_place(region *r, vec3 p)
{
    vec3 d = vec3_sub(p, r->O);
    hold(r, vec3_dot(r->Du, d), vec3_dot(r->Dw, d));
}

/* What casts a shadow onto the range lies towards the light, as far as the relief is high against the light over it. */
static void hold_casters(region *r, double u, double w, double share)
{
    const double u0 = r->u[0], u1 = r->u[1], w0 = r->w[0], w1 = r->w[1];
    hold(r, u0 + share * (u - u0), w0 + share * (w - w0));
    hold(r, u1 + share * (u - u1), w1 + share * (w - w1));
}

/* Where an orthographic camera's ray meets the ground; not before the ray begins, and not beyond all measure where it
 * runs along. */
static double meet(const scene *s, double t)
{
    double end = 100 * (s->view.width + vec3_length(vec3_sub(s->view.at, s->camera.from)));
    return t > 0 ? fmin(t, end) : 0;
}

/* The edge of what is seen runs along rays through the picture's edge: where they meet the planes at Pmin and Pmax.
 * Those that do not are followed to where the ground is within half a pixel of the horizon. */
void pov_plane_region(const scene *s, const object *o, double u[2], double w[2])
{
    enum { STEPS = 32 };
    const camera *c = &s->camera;
    const pov_flat f = pov_flat_of(o, 0);
    const double level[2] = {(double)o->bump->Pmin, (double)o->bump->Pmax};
    vec3 N = vec3_cross(f.U, f.W), n = vec3_unit(N);
    double n2 = vec3_dot(N, N);
    region r = {.O = f.O,
                .Du = vec3_scale(vec3_cross(f.W, N), 1 / n2),
                .Dw = vec3_scale(vec3_cross(N, f.U), 1 / n2),
                .u = {HUGE_VAL, -HUGE_VAL},
                .w = {HUGE_VAL, -HUGE_VAL}};
    double eye = vec3_dot(n, vec3_sub(c->from, f.O));
    double far = fmax(fabs(eye - level[0]), fabs(eye - level[1])) * s->height / vec3_length(c->up);
    if (eye >= level[0] && eye <= level[1])
        hold_place(&r, c->from);
    for (int side = 0; side < 4; side++)
        for (int i = 0; i <= STEPS; i++) {
            double x = side < 2    ? 2.0 * i / STEPS - 1
                       : side == 2 ? -1
                                   : 1,
                   y = side < 2 ? 2 * side - 1 : 2.0 * i / STEPS - 1;
            vec3 off = vec3_add(vec3_scale(c->right, x), vec3_scale(c->up, y));
            vec3 ray = c->orthographic ? c->forward : vec3_add(c->forward, off);
            vec3 start = c->orthographic ? vec3_add(c->from, off) : c->from;
            double slope = vec3_dot(n, ray);
            vec3 along = vec3_sub(ray, vec3_scale(n, slope));
            double t_far = far / fmax(vec3_length(along), 1e-9);
            for (int k = 0; k < 2; k++) {
                double t = (level[k] - vec3_dot(n, vec3_sub(start, f.O))) / slope;
                if (c->orthographic) {
                    hold_place(&r, vec3_add(start, vec3_scale(along, meet(s, t))));
                    continue;
                }
                t = t > 0 && t < t_far ? t : t_far;
                /* up and away from the plane nothing is seen */
                if (t == t_far && ((eye > level[1] && slope > 0) || (eye < level[0] && slope < 0)) &&
                    t_far * fabs(slope) > far)
                    continue;
                hold_place(&r, vec3_add(c->from, vec3_scale(along, t)));
            }
        }
    if (r.u[0] > r.u[1]) /* nothing is seen */
        hold_place(&r, c->from);
    for (int k = 0; k < s->lights && s->self_shadow; k++)
        for (int j = 0; j < light_corners(&s->light[k]); j++) {
            vec3 d = vec3_sub(light_corner(&s->light[k], j, f.O), f.O);
            double height = vec3_dot(n, d) - level[0];
            hold_casters(&r, vec3_dot(r.Du, d), vec3_dot(r.Dw, d),
                         height > level[1] - level[0] ? (level[1] - level[0]) / height : 0);
        }
    double mu = 0.01 * (r.u[1] - r.u[0]) + 1e-3 / vec3_length(f.U),
           mw = 0.01 * (r.w[1] - r.w[0]) + 1e-3 / vec3_length(f.W);
    u[0] = r.u[0] - mu;
    u[1] = r.u[1] + mu;
    w[0] = r.w[0] - mw;
    w[1] = r.w[1] + mw;
}
