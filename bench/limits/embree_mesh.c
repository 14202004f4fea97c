/* A yardstick of the bench, not an example of style and no part of kage: a mesh of many triangles through Embree 3's
 * own triangles, 16 rays a call, one thread, primary and shadow ray, Lambert. The bench builds it with the line below.
 * The PLY is as bench/speed/inputs.py writes it: x y z in float, then faces of a count byte and three ints. Camera and
 * light are those of its scene. Prints seconds of reading and building, and ns a pixel.
 *
 *   gcc -O3 -march=native -ffast-math embree_mesh.c -o embree_mesh -lembree3 -lm && ./embree_mesh mesh.ply 1920 1080
 */
#include <embree3/rtcore.h>
#include <math.h>
#include <pmmintrin.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <xmmintrin.h>

static const float from[3] = {0, 1.2f, -3.2f}, lamp[3] = {-4, 5, -4};
static const float half_width = .36397023f; /* tan(fov / 2), fov 40 degrees */

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void fail(const char *what)
{
    fprintf(stderr, "embree_mesh: %s\n", what);
    exit(1);
}

static void read_mesh(RTCGeometry g, const char *path)
{
    FILE *f = fopen(path, "rb");
    char line[256] = "";
    unsigned vertices = 0, faces = 0;
    if (!f)
        fail("the mesh can't be opened");
    while (strcmp(line, "end_header\n")) {
        if (!fgets(line, sizeof line, f))
            fail("the mesh has no header");
        sscanf(line, "element vertex %u", &vertices);
        sscanf(line, "element face %u", &faces);
    }
    float *v = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, vertices);
    char *index = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, faces);
    char *raw = malloc(13 * (size_t)faces);
    if (!v || !index || !raw || fread(v, 12, vertices, f) != vertices || fread(raw, 13, faces, f) != faces)
        fail("the mesh is cut short");
    for (size_t k = 0; k < faces; k++)
        memcpy(index + 12 * k, raw + 13 * k + 1, 12);
    free(raw);
    fclose(f);
}

static void normalize(float v[3])
{
    float l = 1 / sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    v[0] *= l, v[1] *= l, v[2] *= l;
}

static void trace(RTCScene s, int width, int height, float *image)
{
    struct RTCIntersectContext cx;
    rtcInitIntersectContext(&cx);
    cx.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    float ahead[3] = {-from[0], -from[1], -from[2]};
    normalize(ahead);
    const float fy = ahead[1], fz = ahead[2];
    for (int y = 0; y < height; y += 4)
        for (int x = 0; x < width; x += 4) {
            struct RTCRayHit16 r __attribute__((aligned(64)));
            int valid[16] __attribute__((aligned(64)));
            for (int i = 0; i < 16; i++) {
                float a = (((float)(x + (i & 3)) + .5f) / (float)width * 2 - 1) * half_width;
                float b = ((float)height - ((float)(y + (i >> 2)) + .5f) * 2) / (float)width * half_width;
                float d[3] = {a, fy + b * fz, fz - b * fy};
                normalize(d);
                r.ray.org_x[i] = from[0], r.ray.org_y[i] = from[1], r.ray.org_z[i] = from[2];
                r.ray.dir_x[i] = d[0], r.ray.dir_y[i] = d[1], r.ray.dir_z[i] = d[2];
                r.ray.tnear[i] = r.ray.time[i] = 0;
                r.ray.tfar[i] = 1e30f;
                r.ray.mask[i] = valid[i] = -1;
                r.ray.flags[i] = 0;
                r.hit.geomID[i] = r.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
            }
            rtcIntersect16(valid, s, &cx, &r);
            struct RTCRay16 o __attribute__((aligned(64)));
            float light[16];
            for (int i = 0; i < 16; i++) {
                const int hit = r.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
                const float t = hit ? r.ray.tfar[i] : 1;
                float n[3] = {r.hit.Ng_x[i], r.hit.Ng_y[i], r.hit.Ng_z[i]};
                normalize(n);
                o.org_x[i] = from[0] + t * r.ray.dir_x[i];
                o.org_y[i] = from[1] + t * r.ray.dir_y[i];
                o.org_z[i] = from[2] + t * r.ray.dir_z[i];
                float l[3] = {lamp[0] - o.org_x[i], lamp[1] - o.org_y[i], lamp[2] - o.org_z[i]};
                o.dir_x[i] = l[0], o.dir_y[i] = l[1], o.dir_z[i] = l[2];
                o.tnear[i] = 1e-3f;
                o.tfar[i] = 1;
                o.time[i] = 0;
                o.mask[i] = -1;
                o.flags[i] = 0;
                valid[i] = hit ? -1 : 0;
                normalize(l);
                light[i] = fabsf(l[0] * n[0] + l[1] * n[1] + l[2] * n[2]);
            }
            rtcOccluded16(valid, s, &cx, &o);
            for (int i = 0; i < 16; i++)
                image[(y + (i >> 2)) * width + x + (i & 3)] = valid[i] ? .1f + .9f * (o.tfar[i] < 0 ? 0 : light[i]) : 0;
        }
}

int main(int count, char **word)
{
    const int width = count == 4 ? atoi(word[2]) : 0, height = count == 4 ? atoi(word[3]) : 0;
    if (width < 4 || height < 4 || width % 4 || height % 4)
        fail("expected MESH.ply WIDTH HEIGHT, multiples of 4");
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
    RTCDevice d = rtcNewDevice("threads=1");
    RTCScene s = rtcNewScene(d);
    RTCGeometry g = rtcNewGeometry(d, RTC_GEOMETRY_TYPE_TRIANGLE);
    const double t0 = now();
    read_mesh(g, word[1]);
    const double t1 = now();
    rtcCommitGeometry(g);
    rtcAttachGeometry(s, g);
    rtcReleaseGeometry(g);
    rtcCommitScene(s);
    printf("read %.1f ms build %.1f ms\n", (t1 - t0) * 1e3, (now() - t1) * 1e3);
    float *image = calloc((size_t)width * (size_t)height, sizeof *image);
    double best = 1e9, sum = 0;
    for (int k = 0; k < 4; k++) {
        const double begin = now();
        trace(s, width, height, image);
        best = fmin(best, now() - begin);
    }
    for (int i = 0; i < width * height; i++)
        sum += image[i];
    printf("embree16 %.2f ms %.2f ns/pixel mean %g\n", best * 1e3, best * 1e9 / width / height, sum / width / height);
    rtcReleaseScene(s);
    rtcReleaseDevice(d);
    free(image);
    return 0;
}
