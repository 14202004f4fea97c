/* The part of a displaced, unbounded plane that the picture can show, or that can cast shadows there. */
#include "pov_text/flat.h"

typedef struct region {
    vec3 O, Du, Dw; /* u = Du.(p - O), w = Dw.(p - O) */
    double u[2], w[2];
} region;

/* Extend the region to hold a place. */
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

/* Add what can cast shadows onto the region: it lies towards the light at (u,w), at most `share` of the way. */
static void hold_casters(region *r, double u, double w, double share)
{
    const double u0 = r->u[0], u1 = r->u[1], w0 = r->w[0], w1 = r->w[1];
    hold(r, u0 + share * (u - u0), w0 + share * (w - w0));
    hold(r, u1 + share * (u - u1), w1 + share * (w - w1));
}

/* The camera, and the planes at P's least and greatest value. */
typedef struct view {
    const scene *s;
    vec3 n;          /* unit normal of the plane */
    double eye;      /* the camera's height over it */
    double level[2]; /* Pmin, Pmax */
    double far;      /* a distance along the plane, beyond which all is within half a pixel of the horizon */
} view;

/* The places where the ray through (x,y) of the picture, each in -1..1, meets both planes. */
static void hold_ray(region *r, const view *v, double x, double y)
{
    const camera *c = &v->s->camera;
    const vec3 off = vec3_add(vec3_scale(c->right, x), vec3_scale(c->up, y));
    const vec3 ray = c->orthographic ? c->forward : vec3_add(c->forward, off);
    const vec3 start = c->orthographic ? vec3_add(c->from, off) : c->from;
    const double slope = vec3_dot(v->n, ray);
    const vec3 along = vec3_sub(ray, vec3_scale(v->n, slope));
    const double t_far = v->far / fmax(vec3_length(along), 1e-9);
    for (int k = 0; k < 2; k++) {
        double t = (v->level[k] - vec3_dot(v->n, vec3_sub(start, r->O))) / slope;
        if (c->orthographic) { /* a grazing ray has a limit */
            const camera_view *seen = &v->s->view;
            const double end = 100 * (seen->width + vec3_length(vec3_sub(seen->at, c->from)));
            hold_place(r, vec3_add(start, vec3_scale(along, t > 0 ? fmin(t, end) : 0)));
            continue;
        }
        t = t > 0 && t < t_far ? t : t_far;
        const bool leaves = (v->eye > v->level[1] && slope > 0) || (v->eye < v->level[0] && slope < 0);
        if (t == t_far && leaves && t_far * fabs(slope) > v->far)
            continue; /* up and away from the plane nothing is seen */
        hold_place(r, vec3_add(c->from, vec3_scale(along, t)));
    }
}

/* Add the visible region, by rays through the picture's edge. */
static void hold_view(region *r, const view *v)
{
    enum { STEPS = 32 };
    if (v->eye >= v->level[0] && v->eye <= v->level[1])
        hold_place(r, v->s->camera.from);
    for (int side = 0; side < 4; side++)
        for (int i = 0; i <= STEPS; i++) {
            const double along = 2.0 * i / STEPS - 1, end = side % 2 ? 1 : -1;
            hold_ray(r, v, side < 2 ? along : end, side < 2 ? end : along);
        }
    if (r->u[0] > r->u[1]) /* nothing is seen */
        hold_place(r, v->s->camera.from);
}

static void hold_shadows(region *r, const view *v)
{
    const scene *s = v->s;
    for (int k = 0; k < s->lights && s->self_shadow; k++)
        for (int j = 0; j < light_corners(&s->light[k]); j++) {
            const vec3 d = vec3_sub(light_corner(&s->light[k], j, r->O), r->O);
            const double height = vec3_dot(v->n, d) - v->level[0], relief = v->level[1] - v->level[0];
            hold_casters(r, vec3_dot(r->Du, d), vec3_dot(r->Dw, d), height > relief ? relief / height : 0);
        }
}

void pov_plane_region(const scene *s, const object *o, double u[2], double w[2])
{
    const pov_flat f = pov_flat_of(o, 0);
    const vec3 N = vec3_cross(f.U, f.W);
    const double n2 = vec3_dot(N, N);
    region r = {.O = f.O,
                .Du = vec3_scale(vec3_cross(f.W, N), 1 / n2),
                .Dw = vec3_scale(vec3_cross(N, f.U), 1 / n2),
                .u = {HUGE_VAL, -HUGE_VAL},
                .w = {HUGE_VAL, -HUGE_VAL}};
    view v = {.s = s, .n = vec3_unit(N), .level = {(double)o->bump->Pmin, (double)o->bump->Pmax}};
    v.eye = vec3_dot(v.n, vec3_sub(s->camera.from, f.O));
    v.far = fmax(fabs(v.eye - v.level[0]), fabs(v.eye - v.level[1])) * s->height / vec3_length(s->camera.up);
    hold_view(&r, &v);
    hold_shadows(&r, &v);
    const double margin_u = 0.01 * (r.u[1] - r.u[0]) + 1e-3 / vec3_length(f.U),
                 margin_w = 0.01 * (r.w[1] - r.w[0]) + 1e-3 / vec3_length(f.W);
    u[0] = r.u[0] - margin_u;
    u[1] = r.u[1] + margin_u;
    w[0] = r.w[0] - margin_w;
    w[1] = r.w[1] + margin_w;
}

/* Some corners look down on the plane and some up: how far a ray falls is linear over the picture. */
bool pov_has_horizon(const scene *s, const object *o)
{
    const camera *c = &s->camera;
    double u[2], w[2], least = HUGE_VAL, most = -HUGE_VAL;
    o->shape->ops->extent(o->shape, 0, u, w);
    if (u[1] < HUGE_VAL || c->orthographic)
        return false;
    const pov_flat f = pov_flat_of(o, 0);
    for (int k = 0; k < 4; k++) {
        const vec3 off = vec3_add(vec3_scale(c->right, k & 1 ? 1 : -1), vec3_scale(c->up, k & 2 ? 1 : -1));
        const double rises = vec3_dot(f.y, vec3_add(c->forward, off));
        least = fmin(least, rises);
        most = fmax(most, rises);
    }
    return least <= 0 && most >= 0;
}
