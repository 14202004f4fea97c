/* How the texture of a mesh lies on its triangles: see mesh.h.
 */
#include "mesh/mesh.h"

#include <string.h>

#define SPREAD (1 / 4096.0)
#define THIN                                                                                                           \
    2e-5 /* a texture triangle that is lower than this share of the largest coordinate has no digits of float left */

/* Without any, each triangle has its own, so that there is a Qu and a Qw. */
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
    f->u[0] = f->w[0] = HUGE_VAL;
    f->u[1] = f->w[1] = -HUGE_VAL;
    for (int k = 0; k < f->d.n; k++)
        for (int i = 0; i < 3; i++) {
            const float *uv = f->d.skin[k].uv[i];
            f->u[0] = fmin(f->u[0], (double)uv[0]);
            f->u[1] = fmax(f->u[1], (double)uv[0]);
            f->w[0] = fmin(f->w[0], (double)uv[1]);
            f->w[1] = fmax(f->w[1], (double)uv[1]);
        }
    /* all of it on one line */
    f->u[1] = fmax(f->u[1], f->u[0] + 1e-3);
    f->w[1] = fmax(f->w[1], f->w[0] + 1e-3);
}

static double texture_area(const mesh_skin *x)
{
    const double bu = (double)x->uv[1][0] - (double)x->uv[0][0], bw = (double)x->uv[1][1] - (double)x->uv[0][1];
    const double cu = (double)x->uv[2][0] - (double)x->uv[0][0], cw = (double)x->uv[2][1] - (double)x->uv[0][1];
    return bu * cw - cu * bw;
}

/* Move two corners by `step`, each along u or w, so that the most area comes out. */
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
    const double range = f->u[1] - f->u[0], fold = f->u[1] + range,
                 step = SPREAD * fmax(most, fmax(range, f->w[1] - f->w[0]));
    f->d.notes.folded = f->d.notes.spread = 0;
    for (int k = 0; k < f->d.n; k++) {
        mesh_skin *x = &f->d.skin[k];
        double longest = 0;
        for (int i = 0; i < 3; i++)
            for (int a = 0; a < 2; a++)
                longest = fmax(longest, fabs((double)x->uv[i][a] - (double)x->uv[(i + 1) % 3][a]));
        if (!(fabs(texture_area(x)) > THIN * most * longest)) {
            spread(x, (float)step);
            f->d.notes.spread++;
        }
        if (texture_area(x) < 0) {
            for (int i = 0; i < 3; i++)
                x->uv[i][0] = (float)(2 * fold - (double)x->uv[i][0]);
            f->d.notes.folded++;
        }
    }
}
