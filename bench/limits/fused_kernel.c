/* A yardstick of the bench, not an example of style and no part of kage: how fast one hand-written loop, made for
 * this one scene, can be. The script builds it with the compile line below. */
/* The limit: figure 5's scene (plane with a 512x512 height map, cube, point light) in one hand-fused
 * loop, 1920x1080, one shadow ray a pixel, orders none (-1), 0 and 1. No general tracer can be much
 * faster; how close one comes is its quality. Not an example of style.
 *
 *   gcc -std=c99 -D_POSIX_C_SOURCE=200809L -O3 -fno-math-errno -fno-trapping-math -ffp-contract=off \
 *       -fopenmp fused_kernel.c -o fused_kernel -lm && ./fused_kernel THREADS
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <omp.h>
#define N 256
#define MINF(a, b) ((a) < (b) ? (a) : (b))
#define MAXF(a, b) ((a) > (b) ? (a) : (b))
static inline float MN(float a, float b) { return a < b ? a : b; }
static inline float MX(float a, float b) { return a > b ? a : b; }
#undef MINF
#undef MAXF
#define MINF MN
#define MAXF MX
typedef float R;
static R *hm;
static int HW = 512;
static R camx = 0, camy = 3.2f, camz = -6.5f;
static R lx = -4, ly = 5, lz = -2.5f;
static R b0[3] = {-.6f, .45f, -.6f}, b1[3] = {.6f, 1.65f, .6f};
static double now()
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}
static int ORD;
static inline __attribute__((always_inline)) void tile(int order, const R *restrict dx, const R *restrict dy,
                                                       const R *restrict dz, R *restrict out)
{
    const R *restrict h = hm;
    const int M = HW - 1;
#pragma omp simd
    for (int i = 0; i < N; i++) {
        R ix = 1 / dx[i], iy = 1 / dy[i], iz = 1 / dz[i];
        R ax = (b0[0] - camx) * ix, bx = (b1[0] - camx) * ix, ay = (b0[1] - camy) * iy, by = (b1[1] - camy) * iy,
          az = (b0[2] - camz) * iz, bz = (b1[2] - camz) * iz;
        R tn = MAXF(MAXF(MINF(ax, bx), MINF(ay, by)), MINF(az, bz)),
          tf = MINF(MINF(MAXF(ax, bx), MAXF(ay, by)), MAXF(az, bz));
        R tb = (tn <= tf && tf > 0) ? tn : 1e30f;
        R t = -camy * iy;
        t = t > 0 ? t : 1e30f;
        int hb = tb < t;
        R X = camx + t * dx[i], Z = camz + t * dz[i];
        R u = X * 40.f, w = Z * 40.f;
        R fu = floorf(u), fw = floorf(w);
        int iu = (int)fu, iw = (int)fw;
        R a = u - fu, b = w - fw;
        int i00 = ((iw & M) * HW + (iu & M)), i10 = ((iw & M) * HW + ((iu + 1) & M)),
            i01 = (((iw + 1) & M) * HW + (iu & M)), i11 = (((iw + 1) & M) * HW + ((iu + 1) & M));
        R h00 = h[i00], h10 = h[i10], h01 = h[i01], h11 = h[i11];
        R p = (h00 * (1 - a) + h10 * a) * (1 - b) + (h01 * (1 - a) + h11 * a) * b;
        R pu = ((h10 - h00) * (1 - b) + (h11 - h01) * b) * 40.f, pw = ((h01 - h00) * (1 - a) + (h11 - h10) * a) * 40.f;
        R il = 1 / sqrtf(1 + pu * pu + pw * pw);
        R nx = -pu * il, ny = il, nz = -pw * il;
        R dt = 0;
        if (order == 0)
            dt = p * iy;
        else if (order == 1)
            dt = p / (dy[i] - pu * dx[i] - pw * dz[i]);
        R sx = X + dt * dx[i], sy = dt * dy[i], sz = Z + dt * dz[i];
        R Lx = lx - sx, Ly = ly - sy, Lz = lz - sz;
        R jx = 1 / Lx, jy = 1 / Ly, jz = 1 / Lz;
        ax = (b0[0] - sx) * jx, bx = (b1[0] - sx) * jx, ay = (b0[1] - sy) * jy, by = (b1[1] - sy) * jy,
        az = (b0[2] - sz) * jz, bz = (b1[2] - sz) * jz;
        tn = MAXF(MAXF(MINF(ax, bx), MINF(ay, by)), MINF(az, bz)),
        tf = MINF(MINF(MAXF(ax, bx), MAXF(ay, by)), MAXF(az, bz));
        R vis = (tn <= tf && tf > 0 && tn < 1) ? 0.f : 1.f;
        R c = (nx * Lx + ny * Ly + nz * Lz) / sqrtf(Lx * Lx + Ly * Ly + Lz * Lz);
        c = c > 0 ? c : 0;
        R v = .1f + .9f * c * vis;
        out[i] = hb ? .5f : (t < 1e29f ? v : 0.f);
    }
}
#ifndef CLONES
#define CLONES __attribute__((target_clones("default", "arch=x86-64-v3")))
#endif
CLONES void t_none(const R *restrict a, const R *restrict b, const R *restrict c, R *restrict o)
{
    tile(-1, a, b, c, o);
}
CLONES void t_0(const R *restrict a, const R *restrict b, const R *restrict c, R *restrict o) { tile(0, a, b, c, o); }
CLONES void t_1(const R *restrict a, const R *restrict b, const R *restrict c, R *restrict o) { tile(1, a, b, c, o); }
int main(int c, char **v)
{
    hm = malloc(sizeof(R) * HW * HW);
    for (int i = 0; i < HW * HW; i++)
        hm[i] = .03f * (rand() / (R)RAND_MAX);
    int W = 1920, H = 1080;
    R *img = malloc(sizeof(R) * W * H);
    R f[3] = {0, -2.9f, 6.5f};
    R l = sqrtf(f[1] * f[1] + f[2] * f[2]);
    f[1] /= l;
    f[2] /= l;
    R up[3] = {0, f[2], -f[1]};
    int nt = c > 1 ? atoi(v[1]) : 1;
    omp_set_num_threads(nt);
    for (int order = -1; order < 2; order++) {
        double best = 1e9;
        for (int rep = 0; rep < 8; rep++) {
            double t0 = now();
#pragma omp parallel for schedule(dynamic, 8)
            for (int k = 0; k < W * H / N; k++) {
                R dx[N], dy[N], dz[N];
                for (int i = 0; i < N; i++) {
                    int q = k * N + i;
                    R x = ((q % W) + .5f) / W * 2 - 1, y = (1 - ((q / W) + .5f) / H * 2) * H / W;
                    R X = x * .364f, Y = y * .364f + y * 0;
                    R a = X, b = f[1] + Y * up[1], d = f[2] + Y * up[2];
                    R s = 1 / sqrtf(a * a + b * b + d * d);
                    dx[i] = a * s;
                    dy[i] = b * s;
                    dz[i] = d * s;
                }
                if (order == -1)
                    t_none(dx, dy, dz, img + k * N);
                else if (order == 0)
                    t_0(dx, dy, dz, img + k * N);
                else
                    t_1(dx, dy, dz, img + k * N);
            }
            double t = now() - t0;
            if (t < best)
                best = t;
        }
        printf("order %d  %.2f ms  %.2f ns/pixel  %.1f Mpix/s\n", order, best * 1e3, best * 1e9 / W / H,
               W * H / best / 1e6);
    }
    double s = 0;
    for (int i = 0; i < W * H; i++)
        s += img[i];
    printf("%g\n", s / W / H);
}
