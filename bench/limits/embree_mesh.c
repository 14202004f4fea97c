/* A yardstick of the bench, not an example of style and no part of kage: what Embree, a general library that is made
 * for speed, needs for a mesh of a million triangles. The script builds it with the compile line below where Embree 3
 * is.
 */
/* The peer: the triangles of a binary PLY (vertices of n floats, of which the first three are the place; faces of three
 * ints) through Embree 3, 16 rays a call, one thread, primary and shadow ray, Lambert. Prints the times of reading and
 * building, and ns a pixel. The camera and the light are those of the scene that bench/ makes for kage.
 *
 *   gcc -O3 -march=native -ffast-math embree_mesh.c -o embree_mesh -lembree3 -lm && ./embree_mesh ball.ply
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
/* right-handed in the file, left-handed here */
static RTCGeometry read_ply(RTCDevice d, const char *path)
{
    char line[256];
    int vertices = 0, faces = 0, floats = 0;
    FILE *f = fopen(path, "rb");
    while (f && fgets(line, sizeof line, f) && strcmp(line, "end_header\n")) {
        sscanf(line, "element vertex %d", &vertices);
        sscanf(line, "element face %d", &faces);
        floats += !strncmp(line, "property float", 14);
    }
    if (!f || vertices <= 0 || faces <= 0 || floats < 3)
        exit(2);
    RTCGeometry g = rtcNewGeometry(d, RTC_GEOMETRY_TYPE_TRIANGLE);
    float *vb = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, vertices);
    unsigned *ib = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, faces);
    float *row = malloc(4 * floats);
    unsigned char face[13];
    for (int k = 0; k < vertices; k++) {
        if (!fread(row, 4 * floats, 1, f))
            exit(2);
        vb[3 * k] = row[0];
        vb[3 * k + 1] = row[1] + 1;
        vb[3 * k + 2] = -row[2];
    }
    for (int k = 0; k < faces; k++) {
        if (!fread(face, 13, 1, f))
            exit(2);
        memcpy(ib + 3 * k, face + 1, 12);
    }
    free(row);
    fclose(f);
    return g;
}
int main(int c, char **v)
{
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
    if (c != 2)
        return 2;
    RTCDevice d = rtcNewDevice("threads=1");
    RTCScene s = rtcNewScene(d);
    double t0 = now();
    RTCGeometry g = read_ply(d, v[1]);
    printf("read %.0f ms\n", (now() - t0) * 1e3);
    t0 = now();
    rtcCommitGeometry(g);
    rtcAttachGeometry(s, g);
    rtcReleaseGeometry(g);
    rtcCommitScene(s);
    printf("build %.0f ms\n", (now() - t0) * 1e3);
    int W = 1920, H = 1080;
    float *img = malloc(4 * W * H);
    float cam[3] = {.3f, 2.9f, -5.2f}, F[3] = {-.3f, -1.9f, 5.2f}, size = tanf(12 * (float)M_PI / 180);
    float l = sqrtf(F[0] * F[0] + F[1] * F[1] + F[2] * F[2]), h = hypotf(F[0], F[2]);
    for (int k = 0; k < 3; k++)
        F[k] /= l;
    float R[3] = {F[2] * l / h, 0, -F[0] * l / h}, U[3]; // left-handed: right, up, forward
    U[0] = F[1] * R[2] - F[2] * R[1];
    U[1] = F[2] * R[0] - F[0] * R[2];
    U[2] = F[0] * R[1] - F[1] * R[0];
    double best = 1e9;
    for (int rep = 0; rep < 3; rep++) {
        t0 = now();
        struct RTCIntersectContext cx;
        rtcInitIntersectContext(&cx);
        cx.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        for (int y = 0; y < H; y += 4)
            for (int x = 0; x < W; x += 4) {
                struct RTCRayHit16 r __attribute__((aligned(64)));
                int val[16] __attribute__((aligned(64)));
                for (int i = 0; i < 16; i++) {
                    float X = ((x + (i & 3) + .5f) / W * 2 - 1) * size,
                          Y = (1 - (y + (i >> 2) + .5f) / H * 2) * H / W * size;
                    float a = F[0] + X * R[0] + Y * U[0], b = F[1] + X * R[1] + Y * U[1],
                          e = F[2] + X * R[2] + Y * U[2];
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
                    int hit = r.hit.geomID[i] != -1u;
                    val[i] = hit ? -1 : 0;
                    float t = hit ? r.ray.tfar[i] : 1;
                    float n = 1 / sqrtf(r.hit.Ng_x[i] * r.hit.Ng_x[i] + r.hit.Ng_y[i] * r.hit.Ng_y[i] +
                                        r.hit.Ng_z[i] * r.hit.Ng_z[i]);
                    float px = cam[0] + t * r.ray.dir_x[i], py = cam[1] + t * r.ray.dir_y[i],
                          pz = cam[2] + t * r.ray.dir_z[i];
                    float Lx = -4.5f - px, Ly = 5.2f - py, Lz = -2.2f - pz;
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
    long hits = 0;
    for (int i = 0; i < W * H; i++) {
        sum += img[i];
        hits += img[i] > 0;
    }
    printf("embree16 %.2f ms %.2f ns/pixel mean %g hits %ld\n", best * 1e3, best * 1e9 / W / H, sum / W / H, hits);
}
