/* Smoothing of heights that come in steps, as those of an image of 8 bits do: each goes toward the mean of those around
 * it, weighted by a Gaussian, but not farther than a given bound. So a slope that the steps have made into stairs comes
 * out as a slope again, while edges that are many steps high stay what they are.
 *
 * Sums are in double and in one order, so that the result depends on neither threads nor processor.
 */
#include "texture/heights.h"

#include <stdlib.h>

#include "base/gate.h"
#include "math/kmath.h"

/* What the means need: weights, of which w[0] is a sample's own and the last is n samples away, and the indices of the
 * samples from -n to width + n - 1, and to height + n - 1. */
typedef struct kernel {
    int n;
    double *w;
    int *column, *row; /* at index 0 */
    int *all;          /* of both; owned */
} kernel;

/* The weights are 0 from 3 radii on. False: out of memory; kernel_free in either case. */
static bool kernel_new(kernel *g, const heights *h, double radius)
{
    const int n = (int)ceil(3 * radius);
    *g = (kernel){.n = n, .w = malloc(((size_t)n + 1) * sizeof *g->w)};
    g->all = malloc(((size_t)h->width + (size_t)h->height + 4 * (size_t)n) * sizeof *g->all);
    if (!g->w || !g->all)
        return false;
    double sum = 0;
    for (int k = 0; k <= n; k++) {
        g->w[k] = km_exp(-0.5 * k * k / (radius * radius));
        sum += k ? 2 * g->w[k] : g->w[k];
    }
    for (int k = 0; k <= n; k++)
        g->w[k] /= sum;
    g->column = g->all + n;
    g->row = g->column + h->width + 2 * n;
    for (int k = -n; k < h->width + n; k++)
        g->column[k] = table_sample(k, h->width, &h->layout);
    for (int k = -n; k < h->height + n; k++)
        g->row[k] = table_sample(k, h->height, &h->layout);
    return true;
}

static void kernel_free(kernel *g)
{
    free(g->w);
    free(g->all);
}

/* The means along u of a row. */
static void mean_along(const heights *h, const kernel *g, int row, real *to)
{
    const real *v = heights_at(h, row, 0);
    for (int x = 0; x < h->width; x++) {
        double sum = g->w[0] * (double)v[x];
        for (int k = 1; k <= g->n; k++)
            sum += g->w[k] * ((double)v[g->column[x - k]] + (double)v[g->column[x + k]]);
        to[x] = (real)sum;
    }
}

/* The means along w of these; then the bound. */
static void mean_down(heights *h, const kernel *g, int row, const real *along, double most)
{
    const size_t width = (size_t)h->width;
    real *v = h->v + (heights_at(h, row, 0) - h->v);
    for (size_t x = 0; x < width; x++) {
        const double before = (double)v[x];
        double sum = g->w[0] * (double)along[(size_t)row * width + x];
        for (int k = 1; k <= g->n; k++)
            sum += g->w[k] * ((double)along[(size_t)g->row[row - k] * width + x] +
                              (double)along[(size_t)g->row[row + k] * width + x]);
        v[x] = (real)fmin(fmax(sum, before - most), before + most);
    }
}

bool heights_smooth(heights *h, double radius, double most, int threads, const progress *w)
{
    kernel g;
    real *along = memory_new(progress_memory(w), (size_t)h->width * (size_t)h->height * sizeof *along);
    const bool good = kernel_new(&g, h, radius) && along;
    gate on = {.to = w, .what = "smoothing", .all = 2L * h->height};
    threads = threads_of(threads);
    (void)threads; /* without OpenMP */
    if (good) {
#pragma omp parallel for schedule(static) num_threads(threads)
        for (int row = 0; row < h->height; row++)
            if (gate_is_open(&on)) {
                mean_along(h, &g, row, along + (size_t)row * (size_t)h->width);
                gate_pass(&on, 1);
            }
#pragma omp parallel for schedule(static) num_threads(threads)
        for (int row = 0; row < h->height; row++)
            if (gate_is_open(&on)) {
                mean_down(h, &g, row, along, most);
                gate_pass(&on, 1);
            }
    }
    kernel_free(&g);
    memory_free(along);
    return good && gate_is_open(&on);
}
