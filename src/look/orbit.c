/* The eye and the lights turn about a point. */
#include "look/orbit.h"

#include <math.h>

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Make it a unit vector. False: it has no length. */
static int unit(double v[3])
{
    const double length = sqrt(dot(v, v));
    for (int k = 0; k < 3 && length > 0; k++)
        v[k] /= length;
    return length > 0;
}

double orbit_distance(const double a[3], const double b[3])
{
    const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return sqrt(dot(d, d));
}

/* A unit vector across `axis`, along v where that has such a part. */
static void across(const double axis[3], const double v[3], double out[3])
{
    const double along = dot(v, axis);
    for (int k = 0; k < 3; k++)
        out[k] = v[k] - along * axis[k];
    if (unit(out))
        return;
    const double other[3] = {fabs(axis[2]) < 0.9 ? 0 : 1, 0, fabs(axis[2]) < 0.9 ? 1 : 0};
    cross(axis, other, out);
    unit(out);
}

void orbit_turn(double place[3], const double about[3], const double up[3], double turn, double tilt)
{
    const double steepest = 89 * 3.14159265358979323846 / 180;
    double axis[3] = {up[0], up[1], up[2]}, flat[3], side[3];
    const double v[3] = {place[0] - about[0], place[1] - about[1], place[2] - about[2]};
    const double length = sqrt(dot(v, v));
    if (!unit(axis) || !(length > 0))
        return;
    across(axis, v, flat);
    cross(axis, flat, side);
    double height = atan2(dot(v, axis), dot(v, flat));
    height = fmin(fmax(height + tilt, -steepest), steepest);
    for (int k = 0; k < 3; k++)
        place[k] =
            about[k] + length * (cos(height) * (cos(turn) * flat[k] + sin(turn) * side[k]) + sin(height) * axis[k]);
}

void orbit_approach(double place[3], const double about[3], double factor)
{
    for (int k = 0; k < 3; k++)
        place[k] = about[k] + factor * (place[k] - about[k]);
}

void orbit_pan(double from[3], double at[3], const double up[3], double right, double above)
{
    double forward[3] = {at[0] - from[0], at[1] - from[1], at[2] - from[2]}, side[3], top[3];
    if (!unit(forward))
        return;
    cross(up, forward, side);
    if (!unit(side))
        return;
    cross(forward, side, top);
    for (int k = 0; k < 3; k++) {
        from[k] += right * side[k] + above * top[k];
        at[k] += right * side[k] + above * top[k];
    }
}
