/* Materials: from metal and roughness, or from Phong's numbers, to kage's. What is lost is noted.
 *
 *     diffuse     1 - mirror
 *     specular    F0 (n + 2)/8, at most 1, with n = 2/r^4 - 2: the height of the normalised highlight
 *     roughness   1/n, the inverse of the highlight's exponent
 *     reflection  mirror times the base colour; mirror = metallic (1 - r)^2, as kage's mirrors are sharp
 *
 * r is the roughness; F0 is 0.04 for what is no metal, and the base colour's grey for metal.
 */
#include "import/scene.h"

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A material as numbers, before it is written. */
typedef struct look {
    double color[3], ambient, diffuse, specular, roughness, mirror[3], filter, transmit;
    const char *name;
    enum aiTextureType image; /* of the colour; aiTextureType_NONE: none */
    struct aiString uri;
} look;

static double grey(const double c[3]) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; }

static bool get_number(const struct aiMaterial *m, const char *key, unsigned type, unsigned index, double *to)
{
    ai_real x;
    if (aiGetMaterialFloatArray(m, key, type, index, &x, NULL) != aiReturn_SUCCESS || !isfinite(x))
        return false;
    *to = (double)x;
    return true;
}

static bool get_color(const struct aiMaterial *m, const char *key, unsigned type, unsigned index, double to[4])
{
    struct aiColor4D c;
    if (aiGetMaterialColor(m, key, type, index, &c) != aiReturn_SUCCESS)
        return false;
    to[0] = fmax((double)c.r, 0);
    to[1] = fmax((double)c.g, 0);
    to[2] = fmax((double)c.b, 0);
    to[3] = fmin(fmax((double)c.a, 0), 1);
    return true;
}

static bool has_image(const struct aiMaterial *m, enum aiTextureType type)
{
    return aiGetMaterialTextureCount(m, type) > 0;
}

static double within(double x, double lo, double hi) { return fmin(fmax(x, lo), hi); }

/* ---- numbers ---- */

static void set_highlight(look *l, double n, double F0)
{
    l->roughness = within(1 / fmax(n, 1e-3), 1e-4, 100);
    l->specular = n > 0 ? within(F0 * (n + 2) / 8, 0, 1) : 0;
}

static void of_metal(const struct aiMaterial *m, double metallic, look *l)
{
    double r = 1;
    get_number(m, AI_MATKEY_ROUGHNESS_FACTOR, &r);
    r = within(r, 0.03, 1);
    metallic = within(metallic, 0, 1);
    const double mirror = metallic * (1 - r) * (1 - r), n = 2 / (r * r * r * r) - 2;
    l->diffuse = 1 - mirror;
    set_highlight(l, n, 0.04 + metallic * (fmin(grey(l->color), 1) - 0.04));
    for (int c = 0; c < 3; c++)
        l->mirror[c] = fmin(mirror * l->color[c], 1);
}

/* An OBJ's illum 3 and above are mirrors. */
static void of_phong(const struct aiMaterial *m, look *l)
{
    double shine[4] = {0, 0, 0, 1}, mirror[4], n = 0, share = 0;
    int illum = 0, shading = 0;
    aiGetMaterialIntegerArray(m, AI_MATKEY_SHADING_MODEL, &shading, NULL);
    const bool dull = shading == aiShadingMode_Flat || shading == aiShadingMode_Gouraud;
    get_color(m, AI_MATKEY_COLOR_SPECULAR, shine);
    get_number(m, AI_MATKEY_SHININESS, &n);
    l->diffuse = 1;
    if (n > 0 && grey(shine) > 0 && !dull) {
        l->specular = within(grey(shine), 0, 1);
        l->roughness = within(1 / n, 1e-4, 100);
    }
    if (aiGetMaterialIntegerArray(m, "$mat.illum", 0, 0, &illum, NULL) == aiReturn_SUCCESS && illum >= 3 && illum <= 7)
        memcpy(l->mirror, shine, sizeof l->mirror);
    else if (get_number(m, AI_MATKEY_REFLECTIVITY, &share) && get_color(m, AI_MATKEY_COLOR_REFLECTIVE, mirror))
        for (int c = 0; c < 3; c++)
            l->mirror[c] = share * mirror[c];
    for (int c = 0; c < 3; c++)
        l->mirror[c] = within(l->mirror[c], 0, 1);
}

static void set_clearness(const struct aiMaterial *m, double alpha, look *l)
{
    struct aiString mode = {0};
    double opacity = 1, through = 0;
    const bool gltf = aiGetMaterialString(m, AI_MATKEY_GLTF_ALPHAMODE, &mode) == aiReturn_SUCCESS;
    get_number(m, AI_MATKEY_OPACITY, &opacity);
    opacity = gltf ? (strcmp(mode.data, "BLEND") == 0 ? alpha : 1) : opacity;
    get_number(m, AI_MATKEY_TRANSMISSION_FACTOR, &through);
    l->transmit = within(1 - opacity, 0, 1);
    l->filter = within(through, 0, 1 - l->transmit);
}

/* What shines by itself is seen without light, as `ambient` is. */
static void set_glow(const struct aiMaterial *m, look *l)
{
    double e[4] = {0, 0, 0, 1};
    l->ambient = 0.1;
    get_color(m, AI_MATKEY_COLOR_EMISSIVE, e);
    if (has_image(m, aiTextureType_EMISSIVE) || grey(e) <= 0)
        return;
    if (grey(l->color) < grey(e) && l->image == aiTextureType_NONE) {
        l->diffuse *= grey(l->color) / grey(e);
        memcpy(l->color, e, sizeof l->color);
    }
    l->ambient += fmin(grey(e) / fmax(grey(l->color), 1e-3), 100);
}

static void find_image(const struct aiMaterial *m, look *l)
{
    static const enum aiTextureType types[] = {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE};
    l->image = aiTextureType_NONE;
    for (int k = 0; k < 2 && l->image == aiTextureType_NONE; k++)
        if (aiGetMaterialString(m, AI_MATKEY_TEXTURE(types[k], 0), &l->uri) == aiReturn_SUCCESS && l->uri.length)
            l->image = types[k];
}

static look look_of(const struct aiMaterial *m, const char *name, bool textured)
{
    look l = {.color = {0.8, 0.8, 0.8}, .diffuse = 1, .ambient = 0.1, .roughness = 0.05, .name = name};
    double color[4] = {0.8, 0.8, 0.8, 1}, metallic;
    if (!m)
        return l;
    find_image(m, &l);
    if (!get_color(m, AI_MATKEY_BASE_COLOR, color))
        get_color(m, AI_MATKEY_COLOR_DIFFUSE, color);
    memcpy(l.color, color, sizeof l.color);
    if (get_number(m, AI_MATKEY_METALLIC_FACTOR, &metallic))
        of_metal(m, metallic, &l);
    else
        of_phong(m, &l);
    set_clearness(m, color[3], &l);
    if (!textured)
        l.image = aiTextureType_NONE;
    set_glow(m, &l);
    return l;
}

/* ---- what is lost ---- */

static void note_lost(importer *k, const struct aiMaterial *m, const look *l)
{
    static const struct {
        enum aiTextureType type;
        const char *what;
    } maps[] = {{aiTextureType_METALNESS, "the image of metal and roughness; their factors are used"},
                {aiTextureType_EMISSIVE, "the image of its own light"},
                {aiTextureType_LIGHTMAP, "the image of ambient occlusion"},
                {aiTextureType_SPECULAR, "the image of highlights"},
                {aiTextureType_OPACITY, "the image of opacity"},
                {aiTextureType_DISPLACEMENT, "the height map; put it on an object by --bump"},
                {aiTextureType_TRANSMISSION, "the image of transmission"},
                {aiTextureType_CLEARCOAT, "the clear coat's image"}};
    struct aiString mode = {0};
    double x = 0;
    for (size_t i = 0; i < sizeof maps / sizeof *maps; i++)
        if (has_image(m, maps[i].type))
            scene_tell(k, 2, "material %s: left out: %s", l->name, maps[i].what);
    if (has_image(m, aiTextureType_NORMALS) || has_image(m, aiTextureType_NORMAL_CAMERA))
        scene_tell(
            k, 2,
            "material %s: left out: the normal map, which has slopes but no heights; docs/models.md tells how to "
            "make a height map",
            l->name);
    if (has_image(m, aiTextureType_HEIGHT))
        scene_tell(k, 2, "material %s: left out: the bump map; if it has heights, put it on an object by --bump",
                   l->name);
    if (aiGetMaterialString(m, AI_MATKEY_GLTF_ALPHAMODE, &mode) == aiReturn_SUCCESS && strcmp(mode.data, "MASK") == 0)
        scene_tell(k, 2, "material %s: left out: what its alpha cuts away", l->name);
    if (get_number(m, AI_MATKEY_CLEARCOAT_FACTOR, &x) && x > 0)
        scene_tell(k, 2, "material %s: left out: the clear coat", l->name);
}

/* ---- text ---- */

/* How the image lies on the texture coordinates. assimp's v is upward. */
static void add_layout(importer *k, const struct aiMaterial *m, const look *l)
{
    struct aiUVTransform t;
    int mode = 0, filter = 0, set = 0;
    if (aiGetMaterialUVTransform(m, AI_MATKEY_UVTRANSFORM(l->image, 0), &t) == aiReturn_SUCCESS && t.mScaling.x > 0 &&
        t.mScaling.y > 0 && fabsf(t.mRotation) < 1e-6f) {
        const double sx = (double)t.mScaling.x, sy = (double)t.mScaling.y, tx = (double)t.mTranslation.x,
                     ty = 1 - sy - (double)t.mTranslation.y;
        if (sx != 1 || sy != 1)
            text_add(&k->out, ", size: [%.7g, %.7g]", 1 / sx, 1 / sy);
        if (fabs(tx) > 1e-6 || fabs(ty) > 1e-6)
            text_add(&k->out, ", offset: [%.7g, %.7g]", -tx / sx, -ty / sy);
    }
    aiGetMaterialIntegerArray(m, AI_MATKEY_MAPPINGMODE_U(l->image, 0), &mode, NULL);
    if (mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Mirror)
        text_add(&k->out, ", wrap: %s", mode == aiTextureMapMode_Clamp ? "clamp" : "mirror");
    if (aiGetMaterialIntegerArray(m, AI_MATKEY_GLTF_MAPPINGFILTER_MAG(l->image, 0), &filter, NULL) ==
            aiReturn_SUCCESS &&
        filter == 9728) /* GL_NEAREST */
        text_add(&k->out, ", interpolation: nearest");
    aiGetMaterialIntegerArray(m, AI_MATKEY_UVWSRC(l->image, 0), &set, NULL);
    if (set != 0)
        k->to->note(k->to->user,
                    "an image uses a second set of texture coordinates, expected the first: it will lie wrong");
}

/* Where the layout has something that add_layout can't write. */
static void note_layout(importer *k, const struct aiMaterial *m, const look *l)
{
    struct aiUVTransform t;
    if (aiGetMaterialUVTransform(m, AI_MATKEY_UVTRANSFORM(l->image, 0), &t) == aiReturn_SUCCESS &&
        (t.mScaling.x <= 0 || t.mScaling.y <= 0 || fabsf(t.mRotation) >= 1e-6f))
        scene_tell(k, 2, "material %s: left out: how its image is turned or mirrored", l->name);
}

/* The colour multiplies the image; a grey one does so as a factor of diffuse and ambient. */
static const char *image_of(importer *k, look *l)
{
    const double most = fmax(fmax(l->color[0], l->color[1]), l->color[2]);
    double factor[3] = {1, 1, 1};
    if (most <= 0)
        return NULL;
    for (int c = 0; c < 3; c++)
        factor[c] = l->color[c] / most > 0.999 ? 1 : l->color[c] / most;
    const char *file = scene_image_file(k, l->uri.data, factor, l->name);
    if (file && fabs(most - 1) > 1e-3) {
        l->diffuse *= most;
        l->ambient *= most;
    }
    return file;
}

static void add_number(importer *k, const char *key, double x)
{
    text_add(&k->out, "    %s: ", key);
    text_number(&k->out, x, 5);
    text_add(&k->out, "\n");
}

static void write_material(importer *k, const struct aiMaterial *m, const char *name, bool textured)
{
    look l = look_of(m, name, textured);
    if (m)
        note_lost(k, m, &l);
    if (l.image != aiTextureType_NONE)
        note_layout(k, m, &l);
    const char *file = l.image != aiTextureType_NONE ? image_of(k, &l) : NULL;
    text_add(&k->out, "  %s:\n    color: ", name);
    if (file) {
        text_add(&k->out, "{image: {file: ");
        text_string(&k->out, file);
        add_layout(k, m, &l);
        text_add(&k->out, "}}\n");
    } else {
        text_vector(&k->out, l.color);
        text_add(&k->out, "\n");
    }
    add_number(k, "ambient", l.ambient);
    add_number(k, "diffuse", l.diffuse);
    if (l.specular > 0) {
        add_number(k, "specular", l.specular);
        add_number(k, "roughness", l.roughness);
    }
    if (grey(l.mirror) > 0.001) {
        text_add(&k->out, "    reflection: ");
        text_vector(&k->out, l.mirror);
        text_add(&k->out, "\n");
    }
    if (l.filter > 0)
        add_number(k, "filter", l.filter);
    if (l.transmit > 0)
        add_number(k, "transmit", l.transmit);
}

void scene_materials(importer *k)
{
    const int n = (int)k->s->mNumMaterials + 1;
    char(*taken)[TEXT_NAME] = calloc(2 * (size_t)n, sizeof *taken);
    k->out.failed |= !taken;
    text_add(&k->out, "\nmaterials:\n");
    for (int i = 0, made = 0; i < n && taken; i++)
        for (int textured = 1; textured >= 0; textured--) {
            const struct aiMaterial *m = i < n - 1 ? k->s->mMaterials[i] : NULL;
            struct aiString name = {0};
            if (!k->material[i].used[textured])
                continue;
            if (m)
                aiGetMaterialString(m, AI_MATKEY_NAME, &name);
            text_scene_name(taken[made], name.length ? name.data : "material");
            text_unique(taken[made], taken, made);
            memcpy(k->material[i].name[textured], taken[made], TEXT_NAME);
            write_material(k, m, taken[made++], textured);
        }
    free(taken);
}
