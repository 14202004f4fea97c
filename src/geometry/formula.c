/* Formulas of shapes that turn about an axis, as texts in the expression language. */
#include "geometry/closed_form.h"
#include "math/kmath.h"

#include <stdio.h>

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
