/* How much of a displaced plane, which has no end, can matter for the picture. */
#include "povray/flat.h"

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
