/* What several kinds of surfaces share: freeing, ranges of (u,w), the formula of shapes that turn about an axis. */
#include "base/shared.h"
#include "geometry/closed_form.h"
#include "math/kmath.h"

#include <stdio.h>
#include <stdlib.h>

surface *surface_share(surface *f)
{
    shared_add(&f->others);
    return f;
}

void surface_free(surface *f)
{
    if (f && !shared_drop(&f->others))
        return;
    if (f && f->free)
        f->free(f);
    else
        free(f);
}

void formula_revolve(form_formula *f, frame axes, const char *rho, const char *y)
{
    const double X[3] = {axes.x.x, axes.x.y, axes.x.z}, Y[3] = {axes.y.x, axes.y.y, axes.y.z};
    const double Z[3] = {axes.z.x, axes.z.y, axes.z.z};
    f->u[0] = -KM_PI;
    f->u[1] = KM_PI;
    for (int k = 0; k < 3; k++)
        snprintf(f->xyz[k], sizeof f->xyz[k], "(%s)*(%.17g*cos(u) + %.17g*sin(u)) + %.17g*(%s)", rho, X[k], Z[k], Y[k],
                 y);
}

void extent_unit(const surface *f, int part, double u[2], double w[2])
{
    (void)f;
    (void)part;
    u[0] = w[0] = 0;
    u[1] = w[1] = 1;
}

void extent_polar(const surface *f, int part, double u[2], double w[2])
{
    (void)f;
    (void)part;
    u[0] = -KM_PI;
    u[1] = KM_PI;
    w[0] = 0;
    w[1] = KM_PI;
}

void bend_flat(const surface *f, int part, int n, const rays *x, const closest_points *p, path_bends *out)
{
    (void)f;
    (void)part;
    (void)x;
    (void)p;
    for (int i = 0; i < n; i++) {
        out->u[i] = out->w[i] = out->h[i] = 0;
        out->reach[i] = REAL_FAR;
    }
}
