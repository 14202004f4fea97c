/* A block of cells: its corners, where it is on the screen, how large, and how far from flat. */
#include "tessellate/tessellation.h"

vec3 block_project(const scene *s, vec3 p)
{
    const camera *c = &s->camera;
    vec3 d = vec3_sub(p, c->from);
    return (vec3){vec3_dot(d, c->right) / vec3_dot(c->right, c->right), vec3_dot(d, c->up) / vec3_dot(c->up, c->up),
                  c->orthographic ? 1 : vec3_dot(d, c->forward)};
}

corners block_corners(const tessellation *x, int64_t i, int64_t j, int64_t size)
{
    corners c = {.n = {0, 0, 0}};
    partials q;
    bump_values h;
    int32_t part[4];
    real u[4], w[4];
    for (int k = 0; k < 4; k++) {
        part[k] = x->v.lattice.part;
        u[k] = (real)pov_lattice_at(&x->v.lattice, 0, i + (k == 1 || k == 2 ? size : 0), 0);
        w[k] = (real)pov_lattice_at(&x->v.lattice, 1, j + (k >= 2 ? size : 0), 0);
    }
    x->o->shape->ops->eval(x->o->shape, 4, part, u, w, 1, &q);
    x->o->bump->ops->eval(x->o->bump, 4, u, w, 1, &h);
    for (int k = 0; k < 4; k++) {
        const vec3 U = vec3s_get(&q.Qu, k), W = vec3s_get(&q.Qw, k), n = vec3_unit(vec3_cross(U, W));
        c.n = k == 0 ? n : c.n;
        c.Q[k] = vec3s_get(&q.Q, k);
        c.slope[k][0] = (double)h.Pu[k] / vec3_length(U);
        c.slope[k][1] = (double)h.Pw[k] / vec3_length(W);
        c.P[k] = (double)h.P[k];
        c.X[k] = vec3_add(c.Q[k], vec3_scale(n, c.P[k]));
    }
    return c;
}

double block_pixels(const tessellation *x, const corners *c)
{
    double longest = 0;
    vec3 p[4];
    for (int k = 0; k < 4; k++) {
        p[k] = block_project(x->s, c->Q[k]);
        if (!(p[k].z > 0))
            return HUGE_VAL;
    }
    for (int k = 0; k < 4; k++) {
        vec3 a = p[k], b = p[(k + 1) % 4];
        longest =
            fmax(longest, hypot((a.x / a.z - b.x / b.z) * x->s->width / 2, (a.y / a.z - b.y / b.z) * x->s->height / 2));
    }
    return longest;
}

/* A facet interpolates its slopes linearly and normalises them; the surface's slopes are bilinear. The first term is
 * the difference of the slopes, the second that of the normalised length. */
double block_tilt(const corners *c)
{
    double worst = 0;
    for (int a = 0; a < 2; a++) {
        double g[4] = {c->slope[0][a], c->slope[1][a], c->slope[2][a], c->slope[3][a]};
        double most = fmax(fmax(g[0], g[1]), fmax(g[2], g[3])), least = fmin(fmin(g[0], g[1]), fmin(g[2], g[3]));
        worst = fmax(worst, fabs(g[0] - g[1] + g[2] - g[3]) / 4 + (most - least) * (most - least) / 8);
    }
    return worst < 1 ? worst : 1; /* at a pole slopes are infinite */
}

double block_twist(const corners *c)
{
    const double side = fmin(vec3_length(vec3_sub(c->Q[1], c->Q[0])), vec3_length(vec3_sub(c->Q[3], c->Q[0])));
    const double twist = fabs(c->P[0] - c->P[1] + c->P[2] - c->P[3]) / 4;
    return twist < side ? twist / side : 1;
}

int block_beyond(const scene *s, vec3 at)
{
    vec3 p = block_project(s, at);
    return (p.x > p.z) | (p.x < -p.z) << 1 | (p.y > p.z) << 2 | (p.y < -p.z) << 3 | (p.z < 0) << 4;
}

bool block_seen(const tessellation *x, const corners *c)
{
    const double lo = (double)x->o->bump->Pmin, hi = (double)x->o->bump->Pmax;
    int outside = ~0;
    for (int k = 0; k < 4; k++) {
        vec3 low = vec3_add(c->Q[k], vec3_scale(c->n, lo)), top = vec3_add(c->Q[k], vec3_scale(c->n, hi));
        outside &= block_beyond(x->s, low) & block_beyond(x->s, top);
        for (int l = 0; l < x->s->lights && x->s->self_shadow && outside; l++)
            for (int j = 0; j < light_corners(&x->s->light[l]); j++) {
                vec3 ray = vec3_sub(top, light_corner(&x->s->light[l], j, top));
                double fall = -vec3_dot(ray, c->n);
                if (fall > 0)
                    outside &= block_beyond(x->s, vec3_add(top, vec3_scale(ray, (hi - lo) / fall)));
            }
    }
    return !outside;
}

bool block_missed(const tessellation *x, const corners *c)
{
    const double level[2] = {(double)x->o->bump->Pmin, (double)x->o->bump->Pmax};
    const int size[2] = {x->s->width, x->s->height};
    double lo[2] = {HUGE_VAL, HUGE_VAL}, hi[2] = {-HUGE_VAL, -HUGE_VAL};
    for (int k = 0; k < 8; k++) {
        const vec3 p = block_project(x->s, vec3_add(c->Q[k % 4], vec3_scale(c->n, level[k / 4])));
        if (!(p.z > 0))
            return false;
        const double at[2] = {(p.x / p.z + 1) / 2 * size[0] - 0.5, (p.y / p.z + 1) / 2 * size[1] - 0.5};
        for (int a = 0; a < 2; a++) {
            lo[a] = fmin(lo[a], at[a]);
            hi[a] = fmax(hi[a], at[a]);
        }
    }
    const double side = block_pixels(x, c);
    bool met = true;
    for (int a = 0; a < 2; a++)
        met &= floor(fmin(hi[a] + side, size[a] - 1)) >= ceil(fmax(lo[a] - side, 0));
    return !met;
}

bool block_turned(const tessellation *x, const corners *c)
{
    vec3 view = x->s->camera.orthographic ? x->s->camera.forward : vec3_sub(c->Q[0], x->s->camera.from);
    return x->closed && vec3_dot(c->n, view) > 0.4 * vec3_length(view);
}
