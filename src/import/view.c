/* The camera and the lights of a scene from a model's.
 *
 * Brightness: file formats have candela, lux, watts or plain numbers. Only their ratios are kept. All lights are
 * multiplied by one factor, so that together they light white paper in the middle of the model to 1, as an automatic
 * exposure would.
 */
#include "import/scene.h"

#include <assimp/version.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846
#define DEGREES (180 / PI)

static double length(const double v[3]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/* Make a direction a unit vector; `otherwise` where it has none. */
static void make_unit(double v[3], const double otherwise[3])
{
    const double l = length(v);
    for (int k = 0; k < 3; k++)
        v[k] = l > 1e-30 && l < 1e30 ? v[k] / l : otherwise[k];
}

/* from + t dir */
static void along(const double from[3], double t, const double dir[3], double to[3])
{
    for (int k = 0; k < 3; k++)
        to[k] = from[k] + t * dir[k];
}

/* ---- camera ---- */

static void add_place(importer *k, const char *key, const double v[3], const char *end)
{
    text_add(&k->out, "%s: ", key);
    text_vector(&k->out, v);
    text_add(&k->out, "%s", end);
}

/* The image's size for width/height; 0: not known. */
static void add_image(importer *k, double aspect)
{
    const bool known = aspect > 0.02 && aspect < 50;
    int width = 640, height = 480;
    if (known && aspect >= 1)
        height = (int)(width / aspect + 0.5);
    else if (known)
        width = (int)((height = 640) * aspect + 0.5);
    text_add(&k->out, "image: {size: [%d, %d], background: [0.05, 0.05, 0.05]}\n", width, height);
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* How far a camera must be from the middle of the box to see all of it, with some air around it. */
static double distance_to_box(const importer *k, const double middle[3], const double dir[3], double fov)
{
    const double across = 0.9 * tan(fov / 2 / DEGREES), down = 0.75 * across;
    const double flat = hypot(dir[0], dir[2]), x[3] = {dir[2] / flat, 0, -dir[0] / flat};
    const double y[3] = {-dir[1] * dir[0] / flat, flat, -dir[1] * dir[2] / flat};
    double most = 0;
    for (int corner = 0; corner < 8; corner++) {
        double c[3];
        for (int a = 0; a < 3; a++)
            c[a] = (corner >> a & 1 ? k->hi[a] : k->lo[a]) - middle[a];
        most = fmax(most, fmax(fabs(dot(c, x)) / across, fabs(dot(c, y)) / down) - dot(c, dir));
    }
    return most;
}

/* A view of the whole box, from the front, a little from the right and from above. */
static void camera_of_box(importer *k)
{
    static const double fov = 40, toward[3] = {-0.42, -0.42, 0.8}, ahead[3] = {0, 0, 1};
    double at[3], dir[3] = {toward[0], toward[1], toward[2]}, from[3];
    scene_middle(k, at);
    make_unit(dir, ahead);
    along(at, -distance_to_box(k, at, dir, fov), dir, from);
    scene_tell(k, 0, "the model has no camera: the scene's sees all of it");
    text_add(&k->out, "camera: {");
    add_place(k, "from", from, ", ");
    add_place(k, "at", at, ", ");
    text_add(&k->out, "fov: %g}\n", fov);
    add_image(k, 0);
}

/* The horizontal angle of view, in radians. assimp has all of it, not half of it as its documentation says. Before 5.3
 * it multiplied glTF's vertical one by the aspect. Without an aspect it is the vertical one, and the picture is 4 : 3.
 */
static double angle_of(const importer *k, const struct aiCamera *c)
{
    const double given = (double)c->mHorizontalFOV, aspect = (double)c->mAspect;
    if (aspect <= 0)
        return 2 * atan(tan(given / 2) * 4 / 3);
    const bool product = k->gltf && (aiGetVersionMajor() < 5 || (aiGetVersionMajor() == 5 && aiGetVersionMinor() < 3));
    return product ? 2 * atan(tan(given / aspect / 2) * aspect) : given;
}

/* The distance from a camera to the point that it looks at: level with the middle of the model, in front of it. */
static double distance_at(const importer *k, const double from[3], const double dir[3])
{
    double m[3], t = 0;
    const double size = scene_middle(k, m);
    for (int a = 0; a < 3; a++)
        t += (m[a] - from[a]) * dir[a];
    return t > 0.01 * size ? t : size;
}

static void write_camera(importer *k, const struct aiCamera *c)
{
    static const double ahead[3] = {0, 0, 1}, above[3] = {0, 1, 0};
    const struct aiMatrix4x4 m = parts_matrix(k->s, c->mName.data);
    double from[3], dir[3], up[3], at[3];
    /* glTF's stands in its node's origin; assimp has the node's place here once more */
    scene_place(k, &m, k->gltf ? &(struct aiVector3D){0, 0, 0} : &c->mPosition, 1, from);
    scene_place(k, &m, &c->mLookAt, 0, dir);
    scene_place(k, &m, &c->mUp, 0, up);
    make_unit(dir, ahead);
    make_unit(up, above);
    along(from, distance_at(k, from, dir), dir, at);
    text_add(&k->out, "camera: # ");
    text_string(&k->out, c->mName.data);
    add_place(k, "\n  from", from, "\n");
    add_place(k, "  at", at, "\n");
    if (fabs(dir[1]) > 0.999 || fabs(up[0] * dir[2] - up[2] * dir[0]) > 1e-4 || up[1] < 0) /* it rolls */
        add_place(k, "  up", up, "\n");
    const double fov = angle_of(k, c), aspect = (double)c->mAspect, width = 2 * (double)c->mOrthographicWidth;
    if (width > 0)
        text_add(&k->out, "  width: %.7g\n", width);
    else
        text_add(&k->out, "  fov: %.7g\n", fov > 0.001 && fov < 3 ? fov * DEGREES : 40);
    add_image(k, aspect);
}

bool scene_camera(importer *k, char why[MESH_WHY])
{
    const char *wanted = k->wish->camera;
    unsigned c = 0;
    while (c < k->s->mNumCameras && wanted && strcmp(k->s->mCameras[c]->mName.data, wanted) != 0)
        c++;
    if (c < k->s->mNumCameras) {
        write_camera(k, k->s->mCameras[c]);
        if (k->s->mNumCameras > 1 && !wanted)
            scene_tell(k, 0, "the first of %u cameras is taken, %.100s; --camera NAME takes another", k->s->mNumCameras,
                       k->s->mCameras[0]->mName.data);
        return true;
    }
    if (!wanted) {
        camera_of_box(k);
        return true;
    }
    size_t n = (size_t)snprintf(why, MESH_WHY, "no camera '%.100s', expected %s", wanted,
                                k->s->mNumCameras ? "one of these: " : "none, as the model has no cameras");
    for (c = 0; c < k->s->mNumCameras && n < MESH_WHY - 100; c++)
        n += (size_t)snprintf(why + n, MESH_WHY - n, "%s'%.80s'", c ? ", " : "", k->s->mCameras[c]->mName.data);
    return false;
}

/* ---- lights ---- */

typedef struct lamp {
    const struct aiLight *l;
    double at[3], dir[3], color[3]; /* color: at a distance of 1 where it fades */
    int power;                      /* the light falls off with this power of the distance */
} lamp;

static bool is_lamp(const struct aiLight *l)
{
    return l->mType == aiLightSource_POINT || l->mType == aiLightSource_SPOT || l->mType == aiLightSource_AREA ||
           l->mType == aiLightSource_DIRECTIONAL;
}

static lamp lamp_of(const importer *k, const struct aiLight *l)
{
    static const double down[3] = {0, -1, 0};
    const struct aiMatrix4x4 m = parts_matrix(k->s, l->mName.data);
    lamp x = {.l = l,
              .color = {fmax((double)l->mColorDiffuse.r, 0), fmax((double)l->mColorDiffuse.g, 0),
                        fmax((double)l->mColorDiffuse.b, 0)}};
    scene_place(k, &m, &l->mPosition, 1, x.at);
    scene_place(k, &m, &l->mDirection, 0, x.dir);
    make_unit(x.dir, down);
    if (l->mType != aiLightSource_DIRECTIONAL) {
        const double a = (double)l->mAttenuationQuadratic, b = (double)l->mAttenuationLinear;
        const double by = a > 0 ? a : b > 0 ? b : fmax((double)l->mAttenuationConstant, 1e-6);
        x.power = a > 0 ? 2 : b > 0 ? 1 : 0;
        for (int c = 0; c < 3; c++)
            x.color[c] /= by > 1e-6 ? by : 1;
    }
    return x;
}

/* Its light in the middle of the model, as a grey. */
static double brightness(const importer *k, const lamp *x)
{
    double m[3], d[3];
    const double size = scene_middle(k, m);
    for (int a = 0; a < 3; a++)
        d[a] = x->at[a] - m[a];
    return (0.2126 * x->color[0] + 0.7152 * x->color[1] + 0.0722 * x->color[2]) /
           pow(fmax(length(d), 0.1 * size), x->power);
}

static void add_color(importer *k, const lamp *x, double factor)
{
    double c[3];
    for (int a = 0; a < 3; a++)
        c[a] = fmin(factor * x->color[a], 1e6);
    add_place(k, "    color", c, "\n");
}

static void add_spot(importer *k, const lamp *x)
{
    const double half = k->gltf ? 1 : 0.5; /* assimp gives glTF's angles from the axis, others from side to side */
    const double outer = fmin(fmax(half * (double)x->l->mAngleOuterCone * DEGREES, 0.1), 90);
    const double inner = fmin(fmax(half * (double)x->l->mAngleInnerCone * DEGREES, 0), outer);
    double to[3];
    along(x->at, 0.25 * scene_middle(k, (double[3]){0}), x->dir, to);
    add_place(k, "    spot: {to", to, "");
    text_add(&k->out, ", radius: %.5g, falloff: %.5g}\n", inner, outer);
}

/* Two sides of its rectangle, across its direction. */
static void add_area(importer *k, const lamp *x)
{
    const double other[3] = {fabs(x->dir[1]) > 0.9, fabs(x->dir[1]) <= 0.9, 0}, *d = x->dir;
    double u[3] = {d[1] * other[2] - d[2] * other[1], d[2] * other[0] - d[0] * other[2],
                   d[0] * other[1] - d[1] * other[0]};
    make_unit(u, other);
    double w[3] = {d[1] * u[2] - d[2] * u[1], d[2] * u[0] - d[0] * u[2], d[0] * u[1] - d[1] * u[0]};
    for (int a = 0; a < 3; a++) {
        u[a] *= (double)x->l->mSize.x;
        w[a] *= (double)x->l->mSize.y;
    }
    add_place(k, "    area: {u", u, ", ");
    add_place(k, "w", w, ", samples: [4, 4]}\n");
}

static void write_lamp(importer *k, const lamp *x, const char *name, double factor)
{
    const double size = scene_middle(k, (double[3]){0}), near = 0.05 * size;
    text_add(&k->out, "  %s:\n", name);
    if (x->l->mType == aiLightSource_DIRECTIONAL) { /* kage's begins on a plane, which must be outside */
        double to[3], at[3];
        scene_middle(k, to);
        along(to, -2 * size, x->dir, at);
        add_place(k, "    at", at, "\n");
        add_place(k, "    parallel: {to", to, "}\n");
        add_color(k, x, factor);
        return;
    }
    add_place(k, "    at", x->at, "\n");
    /* kage's 2 color/(1 + (d/near)^power) is color'/d^power far from `near` */
    add_color(k, x, x->power ? factor / (2 * pow(near, x->power)) : factor);
    if (x->power)
        text_add(&k->out, "    fade: {distance: %.7g, power: %d}\n", near, x->power);
    if (x->l->mType == aiLightSource_SPOT)
        add_spot(k, x);
    if (x->l->mType == aiLightSource_AREA && x->l->mSize.x > 0 && x->l->mSize.y > 0)
        add_area(k, x);
}

static void light_of_box(importer *k)
{
    double m[3];
    const double size = scene_middle(k, m), at[3] = {m[0] - 0.9 * size, m[1] + 1.3 * size, m[2] - 0.9 * size};
    scene_tell(k, 2, "the model has no lights: the scene's is above, in front, to the left");
    text_add(&k->out, "  lamp:\n");
    add_place(k, "    at", at, "\n");
    text_add(&k->out, "    color: [%g, %g, %g]\n", k->wish->brightness, k->wish->brightness, k->wish->brightness);
}

void scene_lights(importer *k)
{
    const unsigned n = k->s->mNumLights < 4096 ? k->s->mNumLights : 4096;
    char(*name)[TEXT_NAME] = calloc(n + 1, sizeof *name);
    double sum = 0;
    int made = 0;
    k->out.failed |= !name;
    for (unsigned i = 0; i < n; i++) {
        const lamp x = lamp_of(k, k->s->mLights[i]);
        sum += is_lamp(x.l) ? brightness(k, &x) : 0;
    }
    const double factor = sum > 0 && sum < HUGE_VAL ? k->wish->brightness / sum : k->wish->brightness;
    text_add(&k->out, "\nlights:\n");
    for (unsigned i = 0; i < n && name; i++) {
        const lamp x = lamp_of(k, k->s->mLights[i]);
        if (!is_lamp(x.l)) {
            scene_tell(k, 2, "light %.100s is left out: kage has no light of its kind", x.l->mName.data);
            continue;
        }
        if (made == 0)
            text_add(&k->out, "  # as in the model, all times %.4g: white in its middle is %g\n", factor,
                     k->wish->brightness);
        text_scene_name(name[made], x.l->mName.data);
        text_unique(name[made], name, made);
        write_lamp(k, &x, name[made], factor);
        made++;
    }
    if (made == 0)
        light_of_box(k);
    free(name);
}
