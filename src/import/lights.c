/* The lights of a scene from a model's.
 *
 * Brightness: file formats have candela, lux, watts or plain numbers. Only their ratios are kept. All lights are
 * multiplied by one factor, so that together they light white paper in the middle of the model to 1, as an automatic
 * exposure would.
 */
#include "import/scene.h"
#include "import/vector.h"

#include <stdlib.h>

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
    text_vector_of(&k->out, "    color", c, "\n");
}

static void add_spot(importer *k, const lamp *x)
{
    const double half = k->gltf ? 1 : 0.5; /* assimp gives glTF's angles from the axis, others from side to side */
    const double outer = fmin(fmax(half * (double)x->l->mAngleOuterCone * DEGREES, 0.1), 90);
    const double inner = fmin(fmax(half * (double)x->l->mAngleInnerCone * DEGREES, 0), outer);
    double to[3];
    along(x->at, 0.25 * scene_middle(k, (double[3]){0}), x->dir, to);
    text_vector_of(&k->out, "    spot: {to", to, "");
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
    text_vector_of(&k->out, "    area: {u", u, ", ");
    text_vector_of(&k->out, "w", w, ", samples: [4, 4]}\n");
}

static void write_lamp(importer *k, const lamp *x, const char *name, double factor)
{
    const double size = scene_middle(k, (double[3]){0}), near = 0.05 * size;
    text_add(&k->out, "  %s:\n", name);
    if (x->l->mType == aiLightSource_DIRECTIONAL) { /* kage's begins on a plane, which must be outside */
        double to[3], at[3];
        scene_middle(k, to);
        along(to, -2 * size, x->dir, at);
        text_vector_of(&k->out, "    at", at, "\n");
        text_vector_of(&k->out, "    parallel: {to", to, "}\n");
        add_color(k, x, factor);
        return;
    }
    text_vector_of(&k->out, "    at", x->at, "\n");
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
    text_vector_of(&k->out, "    at", at, "\n");
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
