/* How finely a cell is divided: evenly, or only where rays through pixel centres meet it. */
#include "tessellate/tessellation.h"

/* The four corners relative to a pixel's centre, times depth: f is x, g is y. */
typedef struct aim {
    double f[4], g[4];
} aim;

/* Whether the displaced cell at (s,t), from corner 0, is turned away from the eye. False if its other side can be seen.
 */
static bool turned_away(const tessellation *x, const corners *c, double s, double t)
{
    const camera *eye = &x->s->camera;
    if (!x->closed && !x->unbounded)
        return false;
    const vec3 U0 = vec3_sub(c->X[1], c->X[0]), U1 = vec3_sub(c->X[2], c->X[3]), W0 = vec3_sub(c->X[3], c->X[0]),
               W1 = vec3_sub(c->X[2], c->X[1]);
    const vec3 N = vec3_cross(vec3_add(vec3_scale(U0, 1 - t), vec3_scale(U1, t)),
                              vec3_add(vec3_scale(W0, 1 - s), vec3_scale(W1, s)));
    const vec3 view = eye->orthographic ? eye->forward : vec3_sub(c->X[0], eye->from);
    const bool below = x->unbounded && vec3_dot(view, c->n) > 0;
    return (below ? -1 : 1) * vec3_dot(N, view) > EDGE_ON * vec3_length(N) * vec3_length(view);
}

/* t for a given s, by the better conditioned of the two equations. False: outside of the cell. */
static bool meet_at(const aim *m, double s, double margin, double *t)
{
    const double a = m->f[0] + (m->f[1] - m->f[0]) * s, b = m->f[3] + (m->f[2] - m->f[3]) * s - a;
    const double c = m->g[0] + (m->g[1] - m->g[0]) * s, d = m->g[3] + (m->g[2] - m->g[3]) * s - c;
    *t = fabs(b) > fabs(d) ? -a / b : -c / d;
    return s >= -margin && s <= 1 + margin && *t >= -margin && *t <= 1 + margin;
}

/* The places (s,t), 2 at most, where a ray meets the bilinear cell: t eliminated, a quadratic in s is left. */
static int meet_cell(const aim *m, double margin, double s[2], double t[2])
{
    const double *f = m->f, *g = m->g;
    const double A = f[0], B = f[1] - f[0], C = f[3] - f[0], D = f[0] - f[1] + f[2] - f[3];
    const double E = g[0], F = g[1] - g[0], G = g[3] - g[0], H = g[0] - g[1] + g[2] - g[3];
    const double a = B * H - F * D, b = A * H + B * G - E * D - F * C, c = A * G - E * C;
    const double root = b * b - 4 * a * c, q = -(b + copysign(sqrt(fmax(root, 0)), b)) / 2;
    const double at[2] = {q / a, c / q};
    int n = 0;
    for (int k = 0; k < 2 && root >= 0; k++)
        if (meet_at(m, at[k], margin, &t[n]))
            s[n++] = at[k];
    return n;
}

/* The first and last column and row of the pixels with centres in the box around a displaced cell. False: the cell
 * reaches behind the eye. */
static bool pixels_around(const tessellation *x, const vec3 p[4], int box[2][2])
{
    const int size[2] = {x->s->width, x->s->height};
    for (int a = 0; a < 2; a++) {
        double lo = HUGE_VAL, hi = -HUGE_VAL;
        for (int k = 0; k < 4; k++) {
            const double at = ((a ? p[k].y : p[k].x) / p[k].z + 1) / 2 * size[a] - 0.5;
            if (!(p[k].z > 0))
                return false;
            lo = fmin(lo, at);
            hi = fmax(hi, at);
        }
        const double bulge = 0.02 + (x->flat ? 0 : BULGE * (hi - lo));
        box[a][0] = (int)ceil(fmin(fmax(lo - bulge, 0), size[a]));
        box[a][1] = (int)floor(fmax(fmin(hi + bulge, size[a] - 1), -1));
    }
    return true;
}

static bool in_range(const tessellation *x, int64_t i, int64_t j)
{
    return i >= x->first[0] && i < x->end[0] && j >= x->first[1] && j < x->end[1];
}

int cell_division(const tessellation *x, int64_t i, int64_t j)
{
    if (!in_range(x, i, j))
        return 0;
    corners c = block_corners(x, i, j, 1);
    int k = x->fine.tolerance > FINE ? 1 : 2;
    if (block_turned(x, &c) || !block_seen(x, &c))
        return 1;
    const double pixels = block_pixels(x, &c), tilt = block_tilt(&c) / x->fine.tilt;
    while (k < LATTICE && (pixels > x->fine.tolerance * k || tilt > k * k))
        k *= 2;
    return k;
}

void lines_every(lines *l, int k)
{
    for (int a = 0; a <= LATTICE; a += LATTICE / k)
        l->on[0][a] = l->on[1][a] = true;
}

/* Add the lines around the facet, of k x k, that a ray meets at `at`, to within `unsure` facets. */
static void add_place(lines *l, int axis, double at, int k, double unsure)
{
    const int first = (int)floor(fmin(fmax(at * k - unsure, 0), k - 1)),
              last = (int)floor(fmin(fmax(at * k + unsure, 0), k - 1)) + 1;
    for (int a = first; a <= last; a++)
        l->on[axis][a * (LATTICE / k)] = true;
}

void lines_met(const tessellation *x, const corners *c, lines *l)
{
    enum { MANY = 25 }; /* a cell with more pixels is equally fine everywhere */
    const double margin = x->flat ? 0.01 : BULGE, unsure = x->flat ? 0.05 : 0.3;
    int box[2][2], k = 1, shaped = 1;
    vec3 p[4];
    for (int n = 0; n < 4; n++)
        p[n] = block_project(x->s, c->X[n]);
    const bool before = pixels_around(x, p, box), seen = block_seen(x, c);
    const double pixels = block_pixels(x, c), tilt = block_tilt(c) / x->fine.tilt,
                 twist = block_twist(c) / x->fine.shape;
    while (k < LATTICE && seen && (pixels > x->fine.tolerance * k || tilt > k * k))
        k *= 2;
    while (shaped < k && twist > shaped * shaped && !block_turned(x, c))
        shaped *= 2;
    const double many = ((double)box[0][1] - box[0][0] + 1) * ((double)box[1][1] - box[1][0] + 1);
    lines_every(l, seen && (!before || many > MANY) ? k : shaped);
    if (!before || many > MANY)
        return;
    for (int row = box[1][0]; row <= box[1][1]; row++)
        for (int column = box[0][0]; column <= box[0][1]; column++) {
            const double X = (2 * column + 1.0) / x->s->width - 1, Y = (2 * row + 1.0) / x->s->height - 1;
            double s[2], t[2];
            aim m;
            for (int n = 0; n < 4; n++) {
                m.f[n] = p[n].x - X * p[n].z;
                m.g[n] = p[n].y - Y * p[n].z;
            }
            for (int n = meet_cell(&m, margin, s, t) - 1; n >= 0; n--)
                if (!turned_away(x, c, s[n], t[n])) {
                    add_place(l, 0, s[n], k, unsure);
                    add_place(l, 1, t[n], k, unsure);
                }
        }
}
