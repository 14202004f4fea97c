/* The camera and the size of the image of a scene from a model's. */
#include "import/scene.h"
#include "import/vector.h"

#include <assimp/version.h>

#include <stdio.h>
#include <string.h>

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
    text_vector_of(&k->out, "from", from, ", ");
    text_vector_of(&k->out, "at", at, ", ");
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
    text_vector_of(&k->out, "\n  from", from, "\n");
    text_vector_of(&k->out, "  at", at, "\n");
    if (fabs(dir[1]) > 0.999 || fabs(up[0] * dir[2] - up[2] * dir[0]) > 1e-4 || up[1] < 0) /* it rolls */
        text_vector_of(&k->out, "  up", up, "\n");
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
