/* Displaced objects as isosurfaces of (height over the smooth surface) - P.
 *
 * max_gradient is a proven bound: from P's Lipschitz constants, on a sphere by interval arithmetic. A value that is too
 * low makes holes, because POV-Ray skips intervals of a ray where by this bound the function can't reach 0.
 */
#include "math/kmath.h"
#include "pov_text/flat.h"
#include "povray/parts.h"

#include <stdlib.h>

#define STEEPEST 30.0 /* with a bound above this an isosurface is slower than a mesh */

bool pov_function(pov_text *t, const object *o, const char *name)
{
    expr_error wrong;
    expr *e = expr_parse(o->bump_spec.function, &wrong);
    char *text = e ? expr_pov(e) : NULL;
    expr_free(e);
    if (text && o->bump_spec.scale == 1)
        pov_print(t, "#declare %s = function(u, w) { %s }\n", name, text);
    else if (text)
        pov_print(t, "#declare %s = function(u, w) { %s*(%s) }\n", name, pov_exact(o->bump_spec.scale).text, text);
    free(text);
    return text;
}

/* ---- the bound of the gradient ---- */

/* Of height - P where the directions of height, u and w are at right angles; u and w: bounds of P's partials. */
static double gradient(double u, double w) { return sqrt(1 + u * u + w * w); }

static double of_flat(const object *o, int part)
{
    const pov_flat p = pov_flat_of(o, part);
    return gradient((double)o->bump->Pu_max / vec3_length(p.U), (double)o->bump->Pw_max / vec3_length(p.W));
}

/* The bound between two latitudes: |grad u| = 1/(r sin w), |grad w| = 1/r. */
static double of_zone(const expr *e, double scale, double r, double w0, double w1)
{
    enum { CELLS = 64 };
    const double sine = fmin(sin(w0), sin(w1));
    double worst = 0;
    for (int i = 0; i < CELLS; i++) {
        expr_bounds b;
        expr_bound_gradient(e, KM_PI * (2.0 * i / CELLS - 1), KM_PI * (2.0 * (i + 1) / CELLS - 1), w0, w1, &b);
        double x = fmax(fabs(b.u[0]), fabs(b.u[1])) / (r * sine), z = fmax(fabs(b.w[0]), fabs(b.w[1])) / r;
        worst = fmax(worst, sqrt(1 + scale * scale * (x * x + z * z)));
    }
    return worst;
}

/* Near an axis or a centre angles change without bound. Rays do pass there, in glass or through a torus's hole. So the
 * function of a round shape is constant within this share of the distance from there to the displaced surface. */
#define LEVEL 0.25

/* The least distance of the displaced surface from a sphere's centre, a cylinder's axis, or the circle in the middle of
 * a torus's tube. least_hole: from a torus's axis. */
static double least_within(const object *o)
{
    const shape_values f = pov_sized(o);
    return f.r[o->shape_spec.form == &form_torus] + (double)o->bump->Pmin;
}

static double least_hole(const object *o)
{
    const shape_values f = pov_sized(o);
    return f.r[0] - f.r[1] - (double)o->bump->Pmax;
}

/* If P depends on u, the gradient has no bound at a pole. So the bound is over zones that narrow towards the poles, and
 * leaves out CAP radians there, which are less than a pixel. */
static double of_sphere(const object *o)
{
    const double CAP = 1e-3, GROWTH = 1.05, WIDEST = 0.05, half = KM_PI / 2;
    const double r = (1 - LEVEL) * least_within(o), scale = fabs(o->bump_spec.scale);
    double worst = 0;
    expr_error wrong;
    expr *e = r > 0 ? expr_parse(o->bump_spec.function, &wrong) : NULL;
    if (!e)
        return HUGE_VAL;
    for (double w = CAP; w < half && worst < STEEPEST;) {
        double next = fmin(fmin(w * GROWTH, w + WIDEST), half);
        worst = fmax(worst, fmax(of_zone(e, scale, r, w, next), of_zone(e, scale, r, 2 * half - next, 2 * half - w)));
        w = next;
    }
    expr_free(e);
    return worst;
}

/* A bound of P's change in scene units, where P changes by `slope` a radian about an axis or centre at distance r. */
static double turning(double slope, double r) { return r > 0 ? slope / ((1 - LEVEL) * r) : HUGE_VAL; }

static double of_part(const object *o, int part)
{
    const shape_spec *f = &o->shape_spec;
    const double u = (double)o->bump->Pu_max, w = (double)o->bump->Pw_max;
    if (pov_is_flat(f, part))
        return of_flat(o, part);
    if (f->form == &form_sphere)
        return of_sphere(o);
    if (f->form == &form_torus)
        return gradient(turning(u, least_hole(o)), turning(w, least_within(o)));
    if (f->values.r[0] != pov_rim(f, 1))
        return HUGE_VAL; /* a displaced cone's side ends on cones, and containers are boxes or spheres */
    return gradient(turning(u, least_within(o)), w / pov_scale(o));
}

double pov_isosurface_gradient(const object *o, int part)
{
    if (!o->bump_spec.function)
        return HUGE_VAL;
    double g = of_part(o, part);
    return g < STEEPEST ? g * (1 + 1e-6) : HUGE_VAL;
}

/* ---- writing ---- */

/* The isosurface's accuracy in scene units. Mirrors and glass multiply the error of a hit. */
static double accuracy(const scene *s, const object *o)
{
    return (material_sends(&s->material[o->material]) ? 2e-9 : 1e-7) *
           vec3_length(vec3_sub(s->view.at, s->camera.from));
}

/* By itself POV-Ray looks for one intersection, and that of a shadow ray is where it starts. */
static void put_limits(pov_text *t, const scene *s, const object *o, int part, const char *note)
{
    pov_print(t, "  all_intersections\n  accuracy %g\n  max_gradient %g // a bound%s\n", accuracy(s, o),
              pov_isosurface_gradient(o, part), note);
}

static void put_over(pov_text *t, const char *x, double length)
{
    pov_print(t, length == 1 ? "%s" : "%s/%s", x, pov_exact(length).text);
}

static void put_flat(pov_text *t, const scene *s, const object *o, int part, const char *name)
{
    const pov_flat p = pov_flat_of(o, part);
    const double lu = vec3_length(p.U), lw = vec3_length(p.W);
    double u[2] = {0, 1}, w[2] = {0, 1}, y[2];
    pov_levels(o, y);
    const double rim = pov_rim(&o->shape_spec, part);
    if (rim >= 0) {
        u[0] = w[0] = -rim;
        u[1] = w[1] = rim;
    }
    if (o->shape_spec.form == &form_plane) {
        pov_plane_region(s, o, u, w);
        pov_print(t, "// The plane has no end; here it is cut to what the camera sees and what can shade that.\n");
    }
    pov_print(t, "isosurface {\n  function { y - %s(", name);
    put_over(t, "x", lu);
    pov_print(t, ", ");
    put_over(t, "z", lw);
    pov_print(t, ") }\n  contained_by { box { <%g, %g, %g>, <%g, %g, %g> } }\n  open\n", u[0] * lu, y[0], w[0] * lw,
              u[1] * lu, y[1], w[1] * lw);
    put_limits(t, s, o, part, ": none is steeper");
    pov_matrix(t, p.x, p.y, p.z, p.O, " // x along u, y the height, z along w, origin\n");
    if (rim >= 0)
        pov_clip_rim(t, o, part);
}

/* The object's transform without its scale, which is in the shape (pov_sized). */
static void put_motion(pov_text *t, const object *o)
{
    const double k = 1 / pov_scale(o);
    if (o->moved)
        pov_matrix(t, vec3_scale(o->placed.x, k), vec3_scale(o->placed.y, k), vec3_scale(o->placed.z, k), o->placed.o,
                   " // the object's transform\n");
}

/* The beginning and the end of a round shape's function, with the values near an axis or a centre (LEVEL). */
static void begin_function(pov_text *t, const object *o)
{
    pov_print(t, "isosurface {\n  function {\n    %smax(", o->shape_spec.form == &form_torus ? "min(" : "");
}

static void end_function(pov_text *t, const object *o)
{
    pov_print(t, ", -%s)", pov_exact(LEVEL * least_within(o)).text);
    if (o->shape_spec.form == &form_torus)
        pov_print(t, ", %s)", pov_exact(LEVEL * least_hole(o)).text);
    pov_print(t, "\n  }\n");
}

static void put_sphere(pov_text *t, const scene *s, const object *o, const char *name)
{
    const shape_values f = pov_sized(o);
    double y[2], radius = f.r[0];
    pov_levels(o, y);
    begin_function(t, o);
    pov_print(t, "sqrt(x*x + y*y + z*z) - %s\n    - %s(%s, atan2(sqrt(x*x + z*z), y))", pov_exact(radius).text, name,
              pov_around(o));
    end_function(t, o);
    pov_print(t, "  contained_by { sphere { 0, %g } }\n", radius + y[1]);
    put_limits(t, s, o, 0, " but for 0.001 radians around the poles");
    pov_print(t, "  translate %v\n", f.v[0]);
    put_motion(t, o);
}

/* The side of a cylinder; y is its axis. */
static void put_side(pov_text *t, const scene *s, const object *o, const char *name)
{
    const shape_values f = pov_sized(o);
    const vec3 axis = vec3_sub(f.v[1], f.v[0]);
    const frame a = frame_about(axis);
    double y[2], radius = f.r[0], length = vec3_length(axis);
    pov_levels(o, y);
    begin_function(t, o);
    pov_print(t, "sqrt(x*x + z*z) - %s\n    - %s(%s, ", pov_exact(radius).text, name, pov_around(o));
    pov_print(t, pov_scale(o) == 1 ? "%s - y" : "(%s - y)", pov_exact(length).text);
    put_over(t, "", pov_scale(o));
    pov_print(t, ")");
    end_function(t, o);
    pov_print(t, "  contained_by { box { <%g, 0, %g>, <%g, %g, %g> } }\n  open\n", -radius - y[1], -radius - y[1],
              radius + y[1], length, radius + y[1]);
    put_limits(t, s, o, 0, ": none is steeper");
    pov_matrix(t, a.x, a.y, a.z, f.v[0], " // y is the axis\n");
    put_motion(t, o);
}

static void put_torus(pov_text *t, const scene *s, const object *o, const char *name)
{
    const shape_values f = pov_sized(o);
    const frame a = frame_about(f.v[1]);
    double y[2];
    pov_levels(o, y);
    const double wide = f.r[0] + f.r[1] + y[1], high = f.r[1] + y[1];
    const pov_digits major = pov_exact(f.r[0]);
    begin_function(t, o);
    pov_print(t, "sqrt(pow(sqrt(x*x + z*z) - %s, 2) + y*y) - %s\n", major.text, pov_exact(f.r[1]).text);
    pov_print(t, "    - %s(%s, atan2(-y, sqrt(x*x + z*z) - %s))", name, pov_around(o), major.text);
    end_function(t, o);
    pov_print(t, "  contained_by { box { <%g, %g, %g>, <%g, %g, %g> } }\n", -wide, -high, -wide, wide, high, wide);
    put_limits(t, s, o, 0, ": none is steeper");
    pov_matrix(t, a.x, a.y, a.z, f.v[0], " // y is the axis\n");
    put_motion(t, o);
}

static void put_part(pov_text *t, const scene *s, const object *o, int part, const char *name)
{
    const closed_form *form = o->shape_spec.form;
    if (pov_is_flat(&o->shape_spec, part))
        put_flat(t, s, o, part, name);
    else
        (form == &form_sphere ? put_sphere : form == &form_torus ? put_torus : put_side)(t, s, o, name);
}

void pov_isosurface(pov_text *t, const scene *s, const object *o, const char *name)
{
    const int parts = o->shape->ops->parts;
    if (parts > 1)
        pov_print(t, "union {\n");
    for (int part = 0; part < parts; part++) {
        put_part(t, s, o, part, name);
        if (pov_by_parts(s, o))
            pov_texture(t, s, o, part);
        if (parts > 1)
            pov_print(t, "}\n");
    }
}
