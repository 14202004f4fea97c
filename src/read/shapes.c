/* The scene reader's surfaces. */
#include "read/reader.h"

#define LENGTH "a length from 1e-6 to 1e6"

static surface *read_flat(reader *r, node *at, const char *kind, bool bounded, shape_spec *said)
{
    vec3 O = {0, 0, 0}, U = {0, 0, 0}, W = {0, 0, 0};
    if (!yaml_map(r->y, at, kind, "origin u w"))
        return NULL;
    bool good = yaml_need(r->y, at, "origin", kind) && yaml_need(r->y, at, "u", kind) && yaml_need(r->y, at, "w", kind);
    good = reader_vector(r, at, "origin", "the place of u = w = 0, [x, y, z]", &O) && good;
    good = reader_vector(r, at, "u", "the edge along u, [x, y, z]", &U) && good;
    good = reader_vector(r, at, "w", "the edge along w, [x, y, z]", &W) && good;
    if (!good)
        return NULL;
    if (vec3_length(U) < SMALL || vec3_length(W) < SMALL) {
        yaml_error(r->y, yaml_get(at, vec3_length(U) < SMALL ? "u" : "w"),
                   "no direction, expected an edge with a length");
        return NULL;
    }
    *said = (shape_spec){.kind = bounded ? SHAPE_RECTANGLE : SHAPE_PLANE, .a = O, .u = U, .w = W};
    surface *f = plane_new(O, U, W, bounded);
    if (!f)
        yaml_error(r->y, at, "u and w are parallel, expected two directions");
    return f;
}

static surface *read_plane(reader *r, node *at, shape_spec *said) { return read_flat(r, at, "plane", false, said); }
static surface *read_rectangle(reader *r, node *at, shape_spec *said)
{
    return read_flat(r, at, "rectangle", true, said);
}

/* A direction, of any length. */
static bool read_direction(reader *r, node *at, const char *key, const char *what, vec3 *v)
{
    return reader_vector(r, at, key, what, v) &&
           (vec3_length(*v) >= SMALL ||
            yaml_error(r->y, yaml_get(at, key), "no direction, expected a vector with a length"));
}

static surface *read_disc(reader *r, node *at, shape_spec *said)
{
    vec3 c = {0, 0, 0}, normal = {0, 1, 0};
    double radius = 1;
    if (!yaml_map(r->y, at, "disc", "center normal radius"))
        return NULL;
    bool good = yaml_need(r->y, at, "center", "disc") && yaml_need(r->y, at, "normal", "disc") &&
                yaml_need(r->y, at, "radius", "disc");
    good = reader_vector(r, at, "center", "a place [x, y, z]", &c) && good;
    good = read_direction(r, at, "normal", "the direction of n, [x, y, z]", &normal) && good;
    good = reader_number(r, at, "radius", SMALL, false, BIG, LENGTH, &radius) && good;
    *said = (shape_spec){.kind = SHAPE_DISC, .a = c, .u = normal, .radius = {radius}};
    return good ? disc_new(c, normal, radius) : NULL;
}

static surface *read_box(reader *r, node *at, shape_spec *said)
{
    vec3 from = {0, 0, 0}, to = {0, 0, 0};
    if (!yaml_map(r->y, at, "box", "from to"))
        return NULL;
    bool good = yaml_need(r->y, at, "from", "box") && yaml_need(r->y, at, "to", "box");
    good = reader_vector(r, at, "from", "a corner [x, y, z]", &from) && good;
    good = reader_vector(r, at, "to", "the opposite corner [x, y, z]", &to) && good;
    *said = (shape_spec){.kind = SHAPE_BOX, .a = from, .u = to};
    surface *f = good ? box_new(from, to) : NULL;
    if (good && !f)
        yaml_error(r->y, yaml_get(at, "to"),
                   "a box without thickness, expected 'to' apart from 'from' along x, y and z");
    return f;
}

static surface *read_sphere(reader *r, node *at, shape_spec *said)
{
    vec3 c = {0, 0, 0};
    double radius = 1;
    if (!yaml_map(r->y, at, "sphere", "center radius"))
        return NULL;
    bool good = yaml_need(r->y, at, "center", "sphere") && yaml_need(r->y, at, "radius", "sphere");
    good = reader_vector(r, at, "center", "a place [x, y, z]", &c) && good;
    good = reader_number(r, at, "radius", SMALL, false, BIG, LENGTH, &radius) && good;
    *said = (shape_spec){.kind = SHAPE_SPHERE, .a = c, .radius = {radius}};
    return good ? sphere_new(c, radius) : NULL;
}

/* What cylinder and cone have in common: the axis, and whether the ends are open. */
static bool read_axis(reader *r, node *at, const char *kind, shape_spec *said)
{
    bool good = yaml_need(r->y, at, "from", kind) && yaml_need(r->y, at, "to", kind);
    node *open = yaml_get(at, "open");
    good = reader_vector(r, at, "from", "the middle of one end [x, y, z]", &said->a) && good;
    good = reader_vector(r, at, "to", "the middle of the other end [x, y, z]", &said->u) && good;
    good = (!open || yaml_bool(r->y, open, "true or false", &said->open)) && good;
    if (good && vec3_length(vec3_sub(said->u, said->a)) < SMALL)
        good = yaml_error(r->y, yaml_get(at, "to"), "a %s without length, expected 'to' apart from 'from'", kind);
    return good;
}

static surface *read_cylinder(reader *r, node *at, shape_spec *said)
{
    double radius = 1;
    *said = (shape_spec){.kind = SHAPE_CYLINDER};
    if (!yaml_map(r->y, at, "cylinder", "from to radius open"))
        return NULL;
    bool good = read_axis(r, at, "cylinder", said);
    good = yaml_need(r->y, at, "radius", "cylinder") && good;
    good = reader_number(r, at, "radius", SMALL, false, BIG, LENGTH, &radius) && good;
    said->radius[0] = said->radius[1] = radius;
    return good ? cone_new(said->a, radius, said->u, radius, said->open) : NULL;
}

static surface *read_cone(reader *r, node *at, shape_spec *said)
{
    double *radius = said->radius;
    *said = (shape_spec){.kind = SHAPE_CONE};
    if (!yaml_map(r->y, at, "cone", "from from_radius to to_radius open"))
        return NULL;
    bool good = read_axis(r, at, "cone", said);
    good = yaml_need(r->y, at, "from_radius", "cone") && yaml_need(r->y, at, "to_radius", "cone") && good;
    good = reader_number(r, at, "from_radius", 0, false, BIG, "a length from 0 to 1e6", &radius[0]) && good;
    good = reader_number(r, at, "to_radius", 0, false, BIG, "a length from 0 to 1e6", &radius[1]) && good;
    if (good && radius[0] < SMALL && radius[1] < SMALL)
        good = yaml_error(r->y, at, "a cone without thickness, expected a radius of 1e-6 or more at one end");
    return good ? cone_new(said->a, radius[0], said->u, radius[1], said->open) : NULL;
}

static surface *read_torus(reader *r, node *at, shape_spec *said)
{
    vec3 c = {0, 0, 0}, axis = {0, 1, 0};
    double major = 2, minor = 1;
    if (!yaml_map(r->y, at, "torus", "center axis major minor"))
        return NULL;
    bool good = yaml_need(r->y, at, "center", "torus") && yaml_need(r->y, at, "axis", "torus");
    good = yaml_need(r->y, at, "major", "torus") && yaml_need(r->y, at, "minor", "torus") && good;
    good = reader_vector(r, at, "center", "a place [x, y, z]", &c) && good;
    good = read_direction(r, at, "axis", "the direction of the axis, [x, y, z]", &axis) && good;
    good = reader_number(r, at, "major", SMALL, false, BIG, LENGTH, &major) && good;
    good = reader_number(r, at, "minor", SMALL, false, BIG, LENGTH, &minor) && good;
    if (good && minor >= major)
        good = yaml_error(r->y, yaml_get(at, "minor"), "a tube that closes the hole, expected 'minor' below 'major'");
    *said = (shape_spec){.kind = SHAPE_TORUS, .a = c, .u = axis, .radius = {major, minor}};
    return good ? torus_new(c, axis, major, minor) : NULL;
}

static const struct {
    const char *kind;
    surface *(*read)(reader *r, node *at, shape_spec *said);
} shapes[] = {
    {"plane", read_plane},       {"rectangle", read_rectangle}, {"disc", read_disc},
    {"box", read_box},           {"sphere", read_sphere},       {"cylinder", read_cylinder},
    {"cone", read_cone},         {"torus", read_torus},         {"parametric", reader_parametric},
    {"patches", reader_patches}, {"mesh", reader_mesh},
};
enum { SHAPES = sizeof shapes / sizeof *shapes };

surface *reader_surface(reader *r, node *at, shape_spec *said)
{
    node *shape = NULL;
    int kind = 0;
    for (int k = 0; k < SHAPES; k++) {
        node *v = yaml_get(at, shapes[k].kind);
        if (v && shape) {
            yaml_error(r->y, v, "a second shape, '%s' beside '%s', expected one", shapes[k].kind, shapes[kind].kind);
            return NULL;
        }
        if (v) {
            shape = v;
            kind = k;
        }
    }
    if (!shape) {
        yaml_error(r->y, at, "an object lacks its shape, expected one of: " READER_SHAPES);
        return NULL;
    }
    return shapes[kind].read(r, shape, said);
}

bool reader_no_shape(reader *r, node *at)
{
    for (int k = 0; k < SHAPES; k++)
        if (yaml_get(at, shapes[k].kind))
            return yaml_error(r->y, yaml_get(at, shapes[k].kind), "a shape, '%s', beside 'copy', expected one of them",
                              shapes[k].kind);
    return true;
}
