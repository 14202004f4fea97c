/* The sRGB function by a table of thresholds: the code of x is the number of thresholds <= x, where threshold k is the
 * linear light halfway between codes k-1 and k. Thresholds are computed with + - * / alone, so that they have the same
 * bytes everywhere; pow differs between processors and libraries.
 */
#include "image/srgb.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/real.h"

/* The search among thresholds starts from the upper half of the float's bits: sign, exponent and 7 bits of the
 * mantissa, 128 buckets an octave. An 8 bit code has at most one threshold in any, a 16 bit code some hundred. The
 * octaves from 2^-21 to 1 suffice: all below has code 0 (the least threshold is 0.5/65535/12.92 = 2^-20.7). */
enum { OCTAVES = 21, FIRST = (127 - OCTAVES) << 7, BUCKETS = (OCTAVES << 7) + 1 };

struct srgb {
    int step;             /* the first step of the search: a power of two */
    int32_t low[BUCKETS]; /* the code at the lower end of each bucket */
    float next[BUCKETS];  /* the threshold of the code after that */
    float at[];           /* at[k], the least float whose code is k or more; beyond the codes infinite */
};

static float float_of(uint32_t bits)
{
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static uint32_t bits_of(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

/* From sRGB to linear. y^2.4 = y^2 (y^(1/5))^2, the fifth root by Newton's iteration for r^5 = y, which falls
 * from 1 to the root; for y > 0.09 it has settled to about an ulp after 8 steps. */
static double linear_of(double s)
{
    if (s <= 0.04045)
        return s / 12.92;
    double y = (s + 0.055) / 1.055, r = 1;
    for (int i = 0; i < 8; i++)
        r -= (r - y / (r * r * r * r)) / 5;
    return y * y * (r * r);
}

srgb *srgb_create(int bits)
{
    const int max = (1 << bits) - 1, size = 2 << bits;
    srgb *s = malloc(sizeof *s + (size_t)size * sizeof *s->at);
    if (!s)
        return NULL;
    for (int k = 0; k < size; k++)
        s->at[k] = k > max ? INFINITY : 0;
    for (int k = 1; k <= max; k++) {
        double t = linear_of((k - 0.5) / max);
        float x = (float)t;
        s->at[k] = (double)x < t ? float_of(bits_of(x) + 1) : x;
    }
    int widest = 0;
    for (int i = 0, k = 0; i < BUCKETS; i++) {
        float end = float_of((uint32_t)(FIRST + i) << 16);
        while (s->at[k + 1] <= end)
            k++;
        s->low[i] = k;
        s->next[i] = s->at[k + 1];
        if (i > 0 && k - s->low[i - 1] > widest)
            widest = k - s->low[i - 1];
    }
    for (s->step = 1; 2 * s->step <= widest; s->step *= 2)
        ;
    return s;
}

void srgb_encode(const srgb *s, int n, const float *linear, uint16_t *code)
{
    const float least = float_of((uint32_t)FIRST << 16);
    for (int i = 0; i < n; i++) {
        float x = linear[i];
        x = x > least ? (x < 1 ? x : 1) : least; /* NaN compares false: least, code 0 */
        int k = s->low[(bits_of(x) >> 16) - FIRST];
        for (int step = s->step; step > 0; step /= 2)
            k += x >= s->at[k + step] ? step : 0;
        code[i] = (uint16_t)k;
    }
}

/* One step finds a code of 8 bits, as a bucket has at most one threshold. */
STAGE static void encode_bytes(const srgb *restrict s, int n, const float *restrict linear, int32_t *restrict code)
{
    const float least = float_of((uint32_t)FIRST << 16);
    for (int i = 0; i < n; i++) {
        float x = linear[i];
        x = x > least ? x : least;
        x = x < 1 ? x : 1;
        const int32_t at = (int32_t)(bits_of(x) >> 16) - FIRST;
        code[i] = s->low[at] + (x >= s->next[at]);
    }
}

STAGE static void interleave(int n, const int32_t *restrict r, const int32_t *restrict g, const int32_t *restrict b,
                             uint8_t *restrict rgba)
{
    for (int i = 0; i < n; i++) {
        rgba[4 * i] = (uint8_t)r[i];
        rgba[4 * i + 1] = (uint8_t)g[i];
        rgba[4 * i + 2] = (uint8_t)b[i];
        rgba[4 * i + 3] = 255;
    }
}

void srgb_encode_rgba(const srgb *s, int n, const float *r, const float *g, const float *b, uint8_t *rgba)
{
    enum { PART = 256 };
    int32_t code[3][PART];
    for (int at = 0; at < n; at += PART) {
        const int k = n - at < PART ? n - at : PART;
        encode_bytes(s, k, r + at, code[0]);
        encode_bytes(s, k, g + at, code[1]);
        encode_bytes(s, k, b + at, code[2]);
        interleave(k, code[0], code[1], code[2], rgba + 4 * (size_t)at);
    }
}

bool srgb_decode(size_t n, float *v)
{
    float *linear = malloc(65536 * sizeof *linear); /* 1/255 is 257/65535 */
    if (!linear)
        return false;
    for (int k = 0; k < 65536; k++)
        linear[k] = (float)linear_of(k / 65535.0);
    for (size_t i = 0; i < 4 * n; i++)
        v[i] = i % 4 < 3 ? linear[(int)(v[i] * 65535 + 0.5f)] : v[i];
    free(linear);
    return true;
}
