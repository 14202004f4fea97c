/* The texture coordinates of a mesh: their range, mirrored triangles, and triangles on which the texture has no area
 * (mesh.h). */
#include "mesh/mesh.h"

#include <string.h>

#define SPREAD (1 / 4096.0) /* of the range: one pixel of a large image, and still 12 bits of float */

/* A triangle of the texture that is lower than this share of the largest coordinate has no digits of float left:
 * 170 times float's rounding, 1.2e-7. */
#define THIN 2e-5

#define LEAST_RANGE 1e-3 /* where u or w is the same on all triangles, so that there is a size to map a texture to */

/* Each triangle is the lower left half of the unit square, so that there are Qu and Qw. */
void mesh_lay_bare(mesh *f)
{
    static const float own[3][2] = {{0, 0}, {1, 0}, {0, 1}};
    f->u[0] = f->w[0] = 0;
    f->u[1] = f->w[1] = 1;
    for (int k = 0; k < f->d.n; k++)
        memcpy(f->d.skin[k].uv, own, sizeof own);
}

static void find_range(mesh *f)
{
    for (int a = 0; a < 2; a++) {
        double lo = HUGE_VAL, hi = -HUGE_VAL, *range = a == 0 ? f->u : f->w;
        for (int k = 0; k < f->d.n; k++)
            for (int i = 0; i < 3; i++) {
                const double x = (double)f->d.skin[k].uv[i][a];
                lo = lesser(lo, x);
                hi = greater(hi, x);
            }
        range[0] = lo;
        range[1] = greater(hi, lo + LEAST_RANGE);
    }
}

/* Twice the area on the texture; below 0 where it is mirrored. */
static double texture_area(const mesh_skin *x)
{
    const double bu = (double)x->uv[1][0] - (double)x->uv[0][0], bw = (double)x->uv[1][1] - (double)x->uv[0][1];
    const double cu = (double)x->uv[2][0] - (double)x->uv[0][0], cw = (double)x->uv[2][1] - (double)x->uv[0][1];
    return bu * cw - cu * bw;
}

/* Move the second corner along u and the third along w, or the other way, by +-step: of the eight ways, the one with
 * the largest area. */
static void spread(mesh_skin *x, float step)
{
    mesh_skin best = *x;
    for (int k = 0; k < 8; k++) {
        mesh_skin y = *x;
        y.uv[1][k >> 2] += k & 1 ? -step : step;
        y.uv[2][1 - (k >> 2)] += k & 2 ? -step : step;
        if (k == 0 || texture_area(&y) > texture_area(&best))
            best = y;
    }
    *x = best;
}

void mesh_lay_texture(mesh *f)
{
    find_range(f);
    const double most = fmax(fmax(fabs(f->u[0]), fabs(f->u[1])), fmax(fabs(f->w[0]), fabs(f->w[1])));
    const double range = f->u[1] - f->u[0], axis = f->u[1] + range,
                 step = SPREAD * fmax(most, fmax(range, f->w[1] - f->w[0]));
    f->d.notes.folded = f->d.notes.spread = 0;
    for (int k = 0; k < f->d.n; k++) {
        mesh_skin *x = &f->d.skin[k];
        double longest = 0;
        for (int i = 0; i < 3; i++)
            for (int a = 0; a < 2; a++)
                longest = greater(longest, fabs((double)x->uv[i][a] - (double)x->uv[(i + 1) % 3][a]));
        if (!(fabs(texture_area(x)) > THIN * most * longest)) {
            spread(x, (float)step);
            f->d.notes.spread++;
        }
        if (texture_area(x) < 0) {
            for (int i = 0; i < 3; i++)
                x->uv[i][0] = (float)(2 * axis - (double)x->uv[i][0]);
            f->d.notes.folded++;
        }
    }
}
