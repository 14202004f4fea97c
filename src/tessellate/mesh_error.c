/* The error of the heights in a mesh that is coarse. */
#include "tessellate/tessellation.h"

/* The error of k x k facets on a block that is not bilinear, by heights at n places along a facet's side. */
static double sampled_error(const tessellation *x, int64_t i, int64_t j, int64_t size, int k)
{
    enum { MOST = 2 * LATTICE };
    const int n = k == 1 ? LATTICE : 2, row = k * n + 1;
    const pov_lattice *l = &x->v.lattice;
    double P[MOST + 1][MOST + 1], worst = 0;
    const double u0 = pov_lattice_at(l, 0, i, 0), u1 = pov_lattice_at(l, 0, i + size, 0);
    const double w0 = pov_lattice_at(l, 1, j, 0), w1 = pov_lattice_at(l, 1, j + size, 0);
    for (int b = 0; b < row; b++)
        for (int first = 0; first < row; first += LANES) {
            const int lanes = row - first < LANES ? row - first : LANES;
            real u[LANES], w[LANES];
            bump_values h;
            for (int a = 0; a < lanes; a++) {
                u[a] = (real)(u0 + (u1 - u0) * (first + a) / (row - 1));
                w[a] = (real)(w0 + (w1 - w0) * b / (row - 1));
            }
            x->o->bump->ops->eval(x->o->bump, lanes, u, w, 1, &h);
            for (int a = 0; a < lanes; a++)
                P[b][first + a] = (double)h.P[a];
        }
    for (int b = 0; b < row - 1; b++)
        for (int a = 0; a < row - 1; a++) {
            const int a0 = a / n * n, b0 = b / n * n;
            const double s = (double)(a - a0) / n, t = (double)(b - b0) / n;
            const double middle = s > t ? P[b0][a0 + n] : P[b0 + n][a0]; /* of the facet on this side of the diagonal */
            const double flat = (1 - fmax(s, t)) * P[b0][a0] + fabs(s - t) * middle + fmin(s, t) * P[b0 + n][a0 + n];
            worst = fmax(worst, fabs(P[b][a] - flat));
        }
    return worst;
}

void tessellation_measure(tessellation *x, int64_t i, int64_t j, int64_t size, const lines *l)
{
    const corners c = block_corners(x, i, j, size);
    int outside = ~0, widest[2] = {0, 0};
    for (int k = 0; k < 4; k++)
        outside &= block_beyond(x->s, c.Q[k]);
    if (outside || block_turned(x, &c))
        return;
    for (int axis = 0; axis < 2; axis++)
        for (int a = 1, last = 0; a <= LATTICE; a++)
            if (l->on[axis][a]) {
                widest[axis] = a - last > widest[axis] ? a - last : widest[axis];
                last = a;
            }
    const double twist = fabs(c.P[0] - c.P[1] + c.P[2] - c.P[3]) / 4, whole = LATTICE * LATTICE;
    const double off = size == 1 && x->o->map.file ? twist * widest[0] * widest[1] / whole
                                                   : sampled_error(x, i, j, size, LATTICE / widest[0]);
    const double depth = block_project(x->s, c.Q[0]).z;
    x->height = fmax(x->height, off);
    if (depth > 0)
        x->pixels = fmax(x->pixels, off / depth * x->s->width / (2 * vec3_length(x->s->camera.right)));
}
