/* A small renderer on Embree, somebody else's, into which bumpshadow.h is put: the lines marked (kage). A box over a
 * ground with bumps. Prints a PPM.
 *
 *     cc embree.c -o embree $(pkg-config --cflags kage) -lembree3 -lm
 *     ./embree none > none.ppm; ./embree 0 > order0.ppm
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#define TRACE(how, scene, x) how(scene, x, NULL)
#else
#include <embree3/rtcore.h>
#define TRACE(how, scene, x) how(scene, &(struct RTCIntersectContext){.instID = {-1u}}, x)
#endif

#include <bumpshadow.h> /* (kage) */

enum { WIDTH = 320, HEIGHT = 240, GROUND = 0 };
#define HEIGHT_OF_BUMPS 0.1f

typedef bs_vec3 vec;
static vec add(vec a, float k, vec b) { return (vec){a.x + k * b.x, a.y + k * b.y, a.z + k * b.z}; }
static vec scale(float k, vec a) { return (vec){k * a.x, k * a.y, k * a.z}; }
static vec unit(vec a) { return scale(1 / sqrtf(bs_dot(a, a)), a); }

/* The height P of the bumps and its partials. On the ground u = z and w = x, so that Qu x Qw points up. */
static bs_bump bumps(float u, float w)
{
    const float H = HEIGHT_OF_BUMPS, k = 5;
    return (bs_bump){.P = H * sinf(k * u) * sinf(k * w),
                     .Pu = H * k * cosf(k * u) * sinf(k * w),
                     .Pw = H * k * sinf(k * u) * cosf(k * w)};
}

/* ---- Embree ---- */

static RTCGeometry triangles(RTCDevice device, const float *at, unsigned corners, const unsigned *index, unsigned n)
{
    RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    memcpy(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, corners), at, 12 * corners);
    memcpy(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, n), index, 12 * n);
    rtcCommitGeometry(g);
    return g;
}

static RTCGeometry new_box(RTCDevice device, vec lo, vec hi)
{
    static const unsigned index[] = {0, 1, 3, 0, 3, 2, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                     2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 3, 7, 1, 7, 5};
    float at[24];
    for (int k = 0; k < 8; k++) {
        at[3 * k] = k & 1 ? hi.x : lo.x;
        at[3 * k + 1] = k & 2 ? hi.y : lo.y;
        at[3 * k + 2] = k & 4 ? hi.z : lo.z;
    }
    return triangles(device, at, 8, index, 12);
}

static RTCScene scene_of(RTCDevice device, int n, const RTCGeometry *g, unsigned first)
{
    RTCScene scene = rtcNewScene(device);
    for (int k = 0; k < n; k++)
        rtcAttachGeometryByID(scene, g[k], first + (unsigned)k);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(scene);
    return scene;
}

static struct RTCRay ray(vec from, vec along, float far)
{
    return (struct RTCRay){from.x, from.y, from.z, 1e-4f, along.x, along.y, along.z, 0, far, -1u, 0, 0};
}

static struct RTCRayHit nearest(RTCScene scene, vec from, vec along)
{
    struct RTCRayHit x = {.ray = ray(from, along, INFINITY), .hit = {.geomID = RTC_INVALID_GEOMETRY_ID}};
    TRACE(rtcIntersect1, scene, &x);
    return x;
}

static int is_occluded(RTCScene scene, vec from, vec to)
{
    struct RTCRay x = ray(from, add(to, -1, from), 1);
    TRACE(rtcOccluded1, scene, &x);
    return x.tfar < 0;
}

/* ---- the picture ---- */

static void put(float x) /* in sRGB */
{
    x = x < 0 ? 0 : x > 1 ? 1 : x;
    putchar((int)(255 * (x <= 0.0031308f ? 12.92f * x : 1.055f * powf(x, 1 / 2.4f) - 0.055f) + 0.5f));
}

int main(int argc, char **argv)
{
    const int shifts = argc > 1 && strcmp(argv[1], "0") == 0; /* (kage) order 0, or none */
    const vec from = {0.5f, 3, -5}, lamp = {-4, 3, -2}, color = {0.8f, 0.7f, 0.6f};
    const float plain[] = {-50, 0, -50, 50, 0, -50, 50, 0, 50, -50, 0, 50};
    const unsigned two[] = {0, 1, 2, 0, 2, 3};
    RTCDevice device = rtcNewDevice(NULL);
    const RTCGeometry g[] = {triangles(device, plain, 4, two, 2),
                             new_box(device, (vec){-1, 0.4f, -0.5f}, (vec){0, 1, 0.5f})};
    RTCScene all = scene_of(device, 2, g, GROUND), ground = scene_of(device, 1, g, 0),
             others = scene_of(device, 1, g + 1, 1);
    const vec z = unit(scale(-1, from)), x = unit(bs_cross((vec){0, 1, 0}, z)), y = bs_cross(z, x);
    const float half = tanf(20 * 3.14159265f / 180);
    printf("P6 %d %d 255\n", WIDTH, HEIGHT);
    for (int k = 0; k < WIDTH * HEIGHT; k++) {
        const float right = half * (2 * (k % WIDTH + 0.5f) / WIDTH - 1);
        const float up = half * (HEIGHT - 2 * ((float)(k / WIDTH) + 0.5f)) / WIDTH;
        const vec s = add(add(z, right, x), up, y);
        const struct RTCRayHit h = nearest(all, from, s);
        vec rgb = {0.1f, 0.2f, 0.3f};
        if (h.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
            const vec at = add(from, h.ray.tfar, s);
            vec n = unit((vec){h.hit.Ng_x, h.hit.Ng_y, h.hit.Ng_z}), start = at;
            n = bs_dot(n, s) > 0 ? scale(-1, n) : n;
            if (h.hit.geomID == GROUND) { /* (kage) */
                const vec Qu = {0, 0, 1}, Qw = {1, 0, 0}, N = bs_normal(Qu, Qw);
                const bs_bump P = bumps(at.z, at.x);
                const bs_view v = bs_view_of(s, N, Qu, Qw);
                const bs_slab slab = bs_slab_of(v, -HEIGHT_OF_BUMPS, HEIGHT_OF_BUMPS);
                n = unit(bs_perturbed_normal(N, Qu, Qw, P.Pu, P.Pw)); /* shade with n', */
                if (shifts)                                           /* and let shadows begin at r + s t0 */
                    start = add(at, bs_shift_of(0, 1, v, 0, P, slab).tau, s);
            }
            const float cosine = bs_dot(n, unit(add(lamp, -1, at)));
            /* (kage) the receiver from the smooth hit, all others from the start; here only the ground has bumps */
            const int bumped = h.hit.geomID == GROUND;
            const int dark = cosine <= 0 || is_occluded(bumped ? ground : all, at, lamp) ||
                             (bumped && is_occluded(others, start, lamp));
            rgb = scale(0.1f + (dark ? 0 : 0.8f * cosine), color);
        }
        put(rgb.x);
        put(rgb.y);
        put(rgb.z);
    }
    return 0;
}
