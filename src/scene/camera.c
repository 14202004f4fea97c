#include "math/kmath.h"
#include "scene/scene.h"

/* right, up: to the edges of a picture whose half width is `half`, as seen from unit depth. */
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
    return look(c, from, at, up, km_tan(fov * (3.14159265358979323846 / 360)), width, height);
}

bool camera_orthographic(camera *c, vec3 from, vec3 at, vec3 up, double across, int width, int height)
{
    c->orthographic = true;
    return look(c, from, at, up, across / 2, width, height);
}
