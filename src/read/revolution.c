/* Round shapes as sheets, for the true displacement of what a transform stretches one way more than another: no foot is
 * known on an ellipsoid, but a sheet needs none. Q = rho(w) (cos u X + sin u Z) + y(w) Y, about the origin.
 */
#include "base/frame.h"
#include "read/reader.h"
#include "patch/surface.h"

#include <stdio.h>

/* What turns: functions of w, and its range. */
typedef struct outline {
    const char *kind;
    frame axes;
    char rho[96], y[96];
    double w[2];
} outline;

static const double pi = 3.14159265358979323846;

/* As surface.h has them. False: it has ends, or is not round. */
static bool outline_of(const shape_spec *f, outline *a)
{
    const vec3 up = {0, 1, 0}, axis = vec3_sub(f->u, f->a);
    const double length = vec3_length(axis), slope = f->radius[0] - f->radius[1],
                 side = sqrt(length * length + slope * slope);
    switch (f->kind) {
    case SHAPE_SPHERE:
        *a = (outline){.kind = "sphere", .axes = frame_about(up), .w = {0, pi}};
        snprintf(a->rho, sizeof a->rho, "%.17g*sin(w)", f->radius[0]);
        snprintf(a->y, sizeof a->y, "%.17g*cos(w)", f->radius[0]);
        return true;
    case SHAPE_TORUS:
        *a = (outline){.kind = "torus", .axes = frame_about(f->u), .w = {-pi, pi}};
        snprintf(a->rho, sizeof a->rho, "%.17g + %.17g*cos(w)", f->radius[0], f->radius[1]);
        snprintf(a->y, sizeof a->y, "-%.17g*sin(w)", f->radius[1]);
        return true;
    case SHAPE_CYLINDER:
    case SHAPE_CONE:
        if (!f->open)
            return false;
        *a = (outline){.kind = f->kind == SHAPE_CONE ? "cone" : "cylinder", .axes = frame_about(axis), .w = {0, side}};
        snprintf(a->rho, sizeof a->rho, "%.17g + %.17g*w", f->radius[1], slope / side);
        snprintf(a->y, sizeof a->y, "%.17g - %.17g*w", 0.5 * length, length / side);
        return true;
    default:
        return false;
    }
}

surface *reader_revolution(const shape_spec *f, int threads)
{
    outline a;
    expr *e[3] = {NULL, NULL, NULL};
    if (!outline_of(f, &a))
        return NULL;
    const double X[3] = {a.axes.x.x, a.axes.x.y, a.axes.x.z}, Y[3] = {a.axes.y.x, a.axes.y.y, a.axes.y.z};
    const double Z[3] = {a.axes.z.x, a.axes.z.y, a.axes.z.z}, u[2] = {-pi, pi};
    bool good = true;
    for (int k = 0; k < 3; k++) {
        char text[384];
        expr_error wrong;
        snprintf(text, sizeof text, "(%s)*(%.17g*cos(u) + %.17g*sin(u)) + %.17g*(%s)", a.rho, X[k], Z[k], Y[k], a.y);
        e[k] = expr_parse(text, &wrong);
        good = good && e[k];
    }
    if (!good) {
        for (int k = 0; k < 3; k++)
            expr_free(e[k]);
        return NULL;
    }
    patch *q = patch_function_new(a.kind, e, u, a.w);
    if (q)
        q->threads = threads;
    return q ? patch_surface_new(q) : NULL;
}
