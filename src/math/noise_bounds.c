/* Bounds of the noise over a rectangle, by Taylor's theorem from the values at the centre. */
#include "math/noise.h"

/* Bounds of all partials in the plane, of order 1, 2 and 3. The first partials are at most 2.9262, at the centre of a
 * cell whose four gradients are at their worst; found on a grid of 4001 x 4001, rounded up by more than they can rise
 * between its points. The others by the triangle inequality, with gradients below 1.4143, fades whose derivatives are
 * below 1.876, 5.78 and 60, and places in the unit square. */
#define SLOPE 2.93
#define SECOND 31
#define THIRD 260

/* f at the centre, its partials there fu and fv, and a bound of the second ones, over the half sides x and y; clamped
 * to -limit..limit. 1e-12 is far above the rounding of f, whose terms are at most 260. */
static interval around(double f, double fu, double fv, double x, double y, double second, double limit)
{
    const double off = fabs(fu) * x + fabs(fv) * y + 0.5 * second * (x + y) * (x + y) + 1e-12;
    return (interval){greater(f - off, -limit), lesser(f + off, limit)};
}

noise_bounds noise_bounds_over(interval a, interval b)
{
    const double x = 0.5 * (a.hi - a.lo), y = 0.5 * (b.hi - b.lo);
    const interval f = {-1, 1}, d = {-SLOPE, SLOPE}, dd = {-SECOND, SECOND};
    if (!(x + y < 1))
        return (noise_bounds){f, d, d, dd, dd, dd};
    const noise_jet n = noise_at(a.lo + x, b.lo + y);
    return (noise_bounds){
        around(n.f, n.x, n.y, x, y, SECOND, 1),      around(n.x, n.xx, n.xy, x, y, THIRD, SLOPE),
        around(n.y, n.xy, n.yy, x, y, THIRD, SLOPE), around(n.xx, THIRD, THIRD, x, y, 0, SECOND),
        around(n.xy, THIRD, THIRD, x, y, 0, SECOND), around(n.yy, THIRD, THIRD, x, y, 0, SECOND),
    };
}
