/* Transforms: steps in order, each about the scene's origin and axes, as in POV-Ray. */
#include "math/kmath.h"
#include "read/parts.h"

#define PLACE "[x, y, z]"
#define SCALE "a factor or [x, y, z], each 1e-6 to 1e6 or -1e6 to -1e-6"

/* Cosine and sine of an angle in degrees, exact for right angles. */
static void circle(double degrees, double *c, double *s)
{
    const double quarter = km_floor(degrees / 90 + 0.5), rest = (degrees - 90 * quarter) * (KM_PI / 180);
    const int k = (int)(quarter - 4 * km_floor(quarter / 4));
    const double x = rest == 0 ? 1 : km_cos(rest), y = rest == 0 ? 0 : km_sin(rest);
    *c = k == 0 ? x : k == 1 ? -y : k == 2 ? -x : y;
    *s = k == 0 ? y : k == 1 ? x : k == 2 ? -y : -x;
}

affine reader_rotation(const double degrees[3])
{
    double c[3], s[3];
    for (int k = 0; k < 3; k++)
        circle(degrees[k], &c[k], &s[k]);
    const affine x = {{1, 0, 0}, {0, c[0], s[0]}, {0, -s[0], c[0]}, {0, 0, 0}};
    const affine y = {{c[1], 0, -s[1]}, {0, 1, 0}, {s[1], 0, c[1]}, {0, 0, 0}};
    const affine z = {{c[2], s[2], 0}, {-s[2], c[2], 0}, {0, 0, 1}, {0, 0, 0}};
    const affine xy = affine_then(&x, &y);
    return affine_then(&xy, &z);
}

static bool rotate(reader *r, node *at, affine *m)
{
    double a[3];
    if (!yaml_numbers(r->y, at, 3, -BIG, BIG, "angles in degrees about the axes, " PLACE, a))
        return false;
    *m = reader_rotation(a);
    return true;
}

static bool translate(reader *r, node *at, affine *m)
{
    double v[3];
    *m = affine_identity();
    if (!yaml_numbers(r->y, at, 3, -BIG, BIG, "how far along x, y and z, " PLACE, v))
        return false;
    m->o = (vec3){v[0], v[1], v[2]};
    return true;
}

/* One factor for all axes, or one for each. */
static bool scale(reader *r, node *at, affine *m)
{
    const bool three = yaml_is_list(at);
    double v[3];
    if (three ? !yaml_numbers(r->y, at, 3, -BIG, BIG, SCALE, v) : !yaml_number(r->y, at, -BIG, false, BIG, SCALE, v))
        return false;
    for (int k = 0; k < (three ? 3 : 1); k++)
        if (fabs(v[k]) < SMALL)
            return yaml_error(r->y, three ? yaml_item(at, k) : at, "a scale of %g has no extent, expected " SCALE,
                              v[k]);
    if (!three)
        v[1] = v[2] = v[0];
    *m = (affine){{v[0], 0, 0}, {0, v[1], 0}, {0, 0, v[2]}, {0, 0, 0}};
    return true;
}

/* Place the object like a camera: the origin goes to `from`, +z points to `at`, +y is closest to `up`. */
static bool look(reader *r, node *at, affine *m)
{
    vec3 from = {0, 0, 0}, to = {0, 0, 0}, up = {0, 1, 0};
    if (!yaml_map(r->y, at, "look", "from at up"))
        return false;
    if (!reader_look(r, at, "it", "look", &from, &to, &up))
        return false;
    const vec3 z = vec3_unit(vec3_sub(to, from)), x = vec3_cross(vec3_unit(up), z);
    if (vec3_length(x) < SMALL)
        return reader_up_along(r, at);
    *m = (affine){vec3_unit(x), vec3_cross(z, vec3_unit(x)), z, from};
    return true;
}

static bool read_step(reader *r, node *at, affine *m)
{
    static const struct {
        const char *name;
        bool (*read)(reader *r, node *at, affine *m);
    } steps[] = {{"translate", translate}, {"rotate", rotate}, {"scale", scale}, {"look", look}};
    int k = 0;
    affine next;
    if (!yaml_map(r->y, at, "a step", "translate rotate scale look"))
        return false;
    if (yaml_size(at) != 1)
        return yaml_error(r->y, at, "a step with %d keys, expected one, since the order matters", yaml_size(at));
    while (!yaml_get(at, steps[k].name))
        k++;
    if (!steps[k].read(r, yaml_get(at, steps[k].name), &next))
        return false;
    *m = affine_then(m, &next);
    return true;
}

bool reader_transform(reader *r, node *at, affine *m)
{
    const int n = yaml_list(r->y, at, "a list of steps, such as [{rotate: [0, 45, 0]}, {translate: [1, 0, 0]}]");
    bool good = n >= 0;
    for (int i = 0; i < n; i++)
        good = read_step(r, yaml_item(at, i), m) && good;
    return good;
}
