#include "kmath.h"
#include "scene.h"

bool camera_look(camera *c, vec3 from, vec3 at, vec3 up, double fov, int width, int height)
{
    vec3 forward = vec3_sub(at, from);
    vec3 right = vec3_cross(up, forward); /* left-handed: x to the right, y up, z away */
    double sine = vec3_length(right) / (vec3_length(up) * vec3_length(forward));
    if (!(sine > 1e-9))
        return false;
    c->from = from;
    c->forward = vec3_unit(forward);
    double half = km_tan(fov * (3.14159265358979323846 / 360));
    c->right = vec3_scale(vec3_unit(right), half);
    c->up = vec3_scale(vec3_unit(vec3_cross(forward, right)), half * height / width);
    return true;
}
