/* Compares neighbours in sRGB, row by row. */
#include "film/adaptive.h"

#include <stdlib.h>
#include <string.h>

#include "base/real.h"
#include "base/threads.h"
#include "image/srgb.h"

/* The picture in 16-bit sRGB, a plane for each colour. */
typedef struct display {
    int width, height;
    uint16_t *code[3];
} display;

static uint16_t *row(const display *d, int plane, int y) { return d->code[plane] + (size_t)y * (size_t)d->width; }

/* Mark the n pixels of a row that differ from those of another. */
STAGE static void mark(int n, int limit, const uint16_t *restrict r, const uint16_t *restrict g,
                       const uint16_t *restrict b, const uint16_t *restrict r2, const uint16_t *restrict g2,
                       const uint16_t *restrict b2, unsigned char *restrict out)
{
    for (int x = 0; x < n; x++) {
        int dr = r[x] - r2[x], dg = g[x] - g2[x], db = b[x] - b2[x];
        int sum = (dr < 0 ? -dr : dr) + (dg < 0 ? -dg : dg) + (db < 0 ? -db : db);
        out[x] = out[x] | (sum > limit);
    }
}

/* Compare n pixels from (x,y) on with those from (x2,y2) on. */
static void compare(const display *d, int n, int limit, int x, int y, int x2, int y2, unsigned char *out)
{
    if (n > 0 && y2 >= 0 && y2 < d->height)
        mark(n, limit, row(d, 0, y) + x, row(d, 1, y) + x, row(d, 2, y) + x, row(d, 0, y2) + x2, row(d, 1, y2) + x2,
             row(d, 2, y2) + x2, out);
}

/* Compare a row of n pixels from (x,y) on with its four neighbours, where these are on the film. */
static void mark_row(const display *d, int x, int y, int n, int limit, unsigned char *out)
{
    const int left = x == 0, right = x + n == d->width;
    memset(out, 0, (size_t)n);
    compare(d, n - left, limit, x + left, y, x + left - 1, y, out + left);
    compare(d, n - right, limit, x, y, x + 1, y, out);
    compare(d, n, limit, x, y, x, y - 1, out);
    compare(d, n, limit, x, y, x, y + 1, out);
}

enum { FEW = 1 << 14 }; /* pixels that are compared before another thread has started */

unsigned char *adaptive_find(const film *f, window part, double threshold, int threads, memory *m, errors *e)
{
    display d = {f->part.x1 - f->part.x0, f->part.y1 - f->part.y0, {NULL}};
    const size_t pixels = (size_t)d.width * (size_t)d.height;
    const int width = part.x1 - part.x0, height = part.y1 - part.y0, limit = (int)(threshold * 65535);
    unsigned char *found = memory_new(m, (size_t)width * (size_t)height);
    srgb *curve = srgb_create(16);
    uint16_t *code = memory_new(m, 3 * pixels * sizeof *code);
    bool good = found && curve && code;
    threads = pixels > FEW ? threads_of(threads) : 1;
    (void)threads; /* without OpenMP */
    if (good) {
        for (int k = 0; k < 3; k++)
            d.code[k] = code + (size_t)k * pixels;
#pragma omp parallel for num_threads(threads) schedule(static)
        for (int y = 0; y < d.height; y++)
            for (int k = 0; k < 3; k++)
                srgb_encode(curve, d.width, f->plane[FILM_R + k] + (size_t)y * (size_t)d.width, row(&d, k, y));
#pragma omp parallel for num_threads(threads) schedule(static)
        for (int y = 0; y < height; y++)
            mark_row(&d, part.x0 - f->part.x0, y + part.y0 - f->part.y0, width, limit,
                     found + (size_t)y * (size_t)width);
    } else {
        char words[MEMORY_WORDS];
        memory_free(found);
        found = NULL;
        errors_add(e, "the contrasts of %d x %d pixels: %s", width, height, memory_words(m, words));
    }
    free(curve);
    memory_free(code);
    return found;
}
