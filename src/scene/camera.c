/* The camera's frame, and rays by base + x right + y up. */
#include "scene/camera.h"

#include "math/kmath.h"
#include "wave/lane.h"

/* half: half the picture's width, of a pinhole at unit depth. */
static bool look(camera *c, vec3 from, vec3 at, vec3 up, double half, int width, int height)
{
    vec3 forward = vec3_sub(at, from);
    vec3 right = vec3_cross(up, forward); /* left-handed: x to the right, y up, z away */
    double sine = vec3_length(right) / (vec3_length(up) * vec3_length(forward));
    if (!(sine > 1e-9))
        return false;
    c->from = from;
    c->forward = vec3_unit(forward);
    c->right = vec3_scale(vec3_unit(right), half);
    c->up = vec3_scale(vec3_unit(vec3_cross(forward, right)), half * height / width);
    return true;
}

bool camera_look(camera *c, vec3 from, vec3 at, vec3 up, double fov, int width, int height)
{
    c->orthographic = false;
    return look(c, from, at, up, km_tan(fov * (KM_PI / 360)), width, height);
}

bool camera_orthographic(camera *c, vec3 from, vec3 at, vec3 up, double across, int width, int height)
{
    c->orthographic = true;
    return look(c, from, at, up, across / 2, width, height);
}

/* base + x right + y up, x and y in -1..1 from the left and from the bottom. */
STAGE static void over_image(const camera *c, vec3 base, int n, const real *restrict x, const real *restrict y,
                             vec3s *restrict v)
{
    const real fx = (real)base.x, fy = (real)base.y, fz = (real)base.z;
    const real rx = (real)c->right.x, ry = (real)c->right.y, rz = (real)c->right.z;
    const real ux = (real)c->up.x, uy = (real)c->up.y, uz = (real)c->up.z;
    for (int i = 0; i < n; i++) {
        v->x[i] = fx + x[i] * rx + y[i] * ux;
        v->y[i] = fy + x[i] * ry + y[i] * uy;
        v->z[i] = fz + x[i] * rz + y[i] * uz;
    }
}

void camera_common(const camera *c, int n, rays *to)
{
    const vec3 v = c->orthographic ? c->forward : c->from;
    vec3s_fill(c->orthographic ? &to->s : &to->r, n, (real)v.x, (real)v.y, (real)v.z);
}

void camera_rays(const camera *c, int n, const real *x, const real *y, rays *to)
{
    over_image(c, c->orthographic ? c->from : c->forward, n, x, y, c->orthographic ? &to->r : &to->s);
}

void camera_ray(const camera *c, int width, int height, double x, double y, rays *to, int lane)
{
    const real sx = camera_screen(x, width), sy = -camera_screen(y, height);
    rays one;
    camera_common(c, 1, &one);
    camera_rays(c, 1, &sx, &sy, &one);
    lane_set(&to->r, lane, lane_get(&one.r, 0));
    lane_set(&to->s, lane, lane_get(&one.s, 0));
}
