/* A yardstick of the bench, not an example of style and no part of kage: what Embree, a general library
 * that is made for speed, needs for such a scene. The script builds it with the compile line below where Embree 3 is.
 */
/* The peer: the same scene as a triangle mesh of N x N cells (N = 1: smooth) through Embree 3, 16 rays
 * a call, one thread, primary and shadow ray, Lambert. Prints build time and ns a pixel.
 *
 *   gcc -O3 -march=native -ffast-math embree_loop.c -o embree_loop -lembree3 -lm && ./embree_loop 1024
 */
#include <embree3/rtcore.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <xmmintrin.h>
#include <pmmintrin.h>
static double now()
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}
int main(int c, char **v)
{
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
    int G = c > 1 ? atoi(v[1]) : 1; // grid resolution of ground
    RTCDevice d = rtcNewDevice("threads=1");
    RTCScene s = rtcNewScene(d);
    RTCGeometry g = rtcNewGeometry(d, RTC_GEOMETRY_TYPE_TRIANGLE);
    float *vb = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, (G + 1) * (G + 1));
    unsigned *ib = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, 2 * G * G);
    for (int j = 0; j <= G; j++)
        for (int i = 0; i <= G; i++) {
            float x = -6.4f + 12.8f * i / G, z = -6.4f + 12.8f * j / G;
            float *q = vb + 3 * (j * (G + 1) + i);
            q[0] = x;
            q[1] = G > 1 ? .03f * (sinf(6 * x) * cosf(5.4f * z) + .5f * sinf(10.2f * x + 6.6f * z)) : 0;
            q[2] = z;
        }
    int k = 0;
    for (int j = 0; j < G; j++)
        for (int i = 0; i < G; i++) {
            unsigned a = j * (G + 1) + i;
            ib[k++] = a;
            ib[k++] = a + 1;
            ib[k++] = a + G + 1;
            ib[k++] = a + 1;
            ib[k++] = a + G + 2;
            ib[k++] = a + G + 1;
        }
    rtcCommitGeometry(g);
    rtcAttachGeometry(s, g);
    rtcReleaseGeometry(g);
    g = rtcNewGeometry(d, RTC_GEOMETRY_TYPE_QUAD);
    float *q = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, 8);
    for (int i = 0; i < 8; i++) {
        q[3 * i] = (i & 1) ? .6f : -.6f;
        q[3 * i + 1] = (i & 2) ? 1.65f : .45f;
        q[3 * i + 2] = (i & 4) ? .6f : -.6f;
    }
    unsigned *qi = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 16, 6);
    unsigned F[24] = {0, 1, 3, 2, 4, 6, 7, 5, 0, 4, 5, 1, 2, 3, 7, 6, 0, 2, 6, 4, 1, 5, 7, 3};
    memcpy(qi, F, sizeof F);
    rtcCommitGeometry(g);
    rtcAttachGeometry(s, g);
    rtcReleaseGeometry(g);
    double t0 = now();
    rtcCommitScene(s);
    printf("G=%d build %.1f ms\n", G, (now() - t0) * 1e3);
    int W = 1920, H = 1080;
    float *img = malloc(4 * W * H);
    float cam[3] = {0, 3.2f, -6.5f}, l = hypotf(2.9f, 6.5f), fy = -2.9f / l, fz = 6.5f / l;
    double best = 1e9;
    for (int rep = 0; rep < 6; rep++) {
        t0 = now();
        struct RTCIntersectContext cx;
        rtcInitIntersectContext(&cx);
        cx.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        for (int y = 0; y < H; y += 4)
            for (int x = 0; x < W; x += 4) {
                struct RTCRayHit16 r __attribute__((aligned(64)));
                int val[16] __attribute__((aligned(64)));
                for (int i = 0; i < 16; i++) {
                    float X = ((x + (i & 3) + .5f) / W * 2 - 1) * .364f,
                          Y = (1 - (y + (i >> 2) + .5f) / H * 2) * H / W * .364f;
                    float a = X, b = fy + Y * fz, e = fz - Y * fy;
                    float s1 = 1 / sqrtf(a * a + b * b + e * e);
                    r.ray.org_x[i] = cam[0];
                    r.ray.org_y[i] = cam[1];
                    r.ray.org_z[i] = cam[2];
                    r.ray.dir_x[i] = a * s1;
                    r.ray.dir_y[i] = b * s1;
                    r.ray.dir_z[i] = e * s1;
                    r.ray.tnear[i] = 0;
                    r.ray.tfar[i] = 1e30f;
                    r.ray.time[i] = 0;
                    r.ray.mask[i] = -1;
                    r.ray.flags[i] = 0;
                    r.hit.geomID[i] = -1;
                    r.hit.instID[0][i] = -1;
                    val[i] = -1;
                }
                rtcIntersect16(val, s, &cx, &r);
                struct RTCRay16 o __attribute__((aligned(64)));
                for (int i = 0; i < 16; i++) {
                    int h = r.hit.geomID[i] != -1u;
                    val[i] = h ? -1 : 0;
                    float t = h ? r.ray.tfar[i] : 1;
                    float n = 1 / sqrtf(r.hit.Ng_x[i] * r.hit.Ng_x[i] + r.hit.Ng_y[i] * r.hit.Ng_y[i] +
                                        r.hit.Ng_z[i] * r.hit.Ng_z[i]);
                    float px = cam[0] + t * r.ray.dir_x[i], py = cam[1] + t * r.ray.dir_y[i] + 1e-4f,
                          pz = cam[2] + t * r.ray.dir_z[i];
                    float Lx = -4 - px, Ly = 5 - py, Lz = -2.5f - pz;
                    o.org_x[i] = px;
                    o.org_y[i] = py;
                    o.org_z[i] = pz;
                    o.dir_x[i] = Lx;
                    o.dir_y[i] = Ly;
                    o.dir_z[i] = Lz;
                    o.tnear[i] = 1e-3f;
                    o.tfar[i] = 1;
                    o.time[i] = 0;
                    o.mask[i] = -1;
                    o.flags[i] = 0;
                    float cc = fabsf(Lx * r.hit.Ng_x[i] + Ly * r.hit.Ng_y[i] + Lz * r.hit.Ng_z[i]) * n /
                               sqrtf(Lx * Lx + Ly * Ly + Lz * Lz);
                    r.hit.u[i] = cc;
                }
                rtcOccluded16(val, s, &cx, &o);
                for (int i = 0; i < 16; i++)
                    img[(y + (i >> 2)) * W + x + (i & 3)] = val[i] ? (.1f + .9f * (o.tfar[i] < 0 ? 0 : r.hit.u[i])) : 0;
            }
        double t = now() - t0;
        if (t < best)
            best = t;
    }
    double sum = 0;
    for (int i = 0; i < W * H; i++)
        sum += img[i];
    printf("embree16 %.2f ms %.2f ns/pixel mean %g\n", best * 1e3, best * 1e9 / W / H, sum / W / H);
}
