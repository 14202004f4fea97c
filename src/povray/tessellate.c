/* Displaced objects as meshes: maps, and functions that POV-Ray cannot evaluate.
 *
 * The lattice has the map's own samples, so that a mesh is the bilinear surface between them and no other. A cell is
 * divided so that its facets are below half a pixel on the screen, into a power of two; beside a coarser cell the finer
 * one's vertices on the common edge are put onto that edge, so that no crack opens. Of an unbounded plane only what the
 * camera sees, and what casts shadows there, is made; far away cells are joined. Where that would be too many
 * triangles, a ladder of coarser rules is tried.
 */
#include "povray/flat.h"
#include "povray/material.h"
#include "povray/parts.h"
#include "povray/vertices.h"

#include <stdlib.h>
#include <string.h>

/* POV-Ray takes 1 GB and half a minute to read so many, and the file has 250 MB. */
enum { MOST_TRIANGLES = 4000000, FUNCTION_CELLS = 256 };
enum { FIRST_MET = 7, FIRST_STEEP = 14, FIRST_WIDE = 22, FIRST_JOINED = 28, RUNGS = 60 }; /* see rung() */

#define FINE 1.0    /* a facet's side in pixels: it covers less than half a pixel */
#define JOIN 0.25   /* cells are joined while the block is smaller, in pixels */
#define SHAPE 0.005 /* of heights, in sides of a cell */
#define TILT 0.003  /* by how much a facet's normals may be off, against unit length: less than a step of 1/255 */
#define LOOSEST 0.02
#define COARSER 1.4
#define BULGE 0.06   /* of a curved cell beyond its corners, in its sides: for 16 cells around */
#define EDGE_ON 0.05 /* a sine: of what is turned away by less, some may be in sight */

/* How fine a mesh is. */
typedef struct fineness {
    double tolerance; /* a facet's side in pixels */
    double tilt;      /* what its normals may be off */
    double shape;     /* of a cell that no pixel meets: what the height may be off, in sides of the cell */
    int level;        /* 2^level cells are one, everywhere */
    bool met;         /* normals matter in cells alone that a pixel's ray may meet */
} fineness;

typedef struct tessellation {
    const scene *s;
    const object *o;
    pov_vertices v;
    int64_t first[2], end[2]; /* cells */
    fineness fine;
    double height, pixels; /* what heights are off at most, of what is in the picture */
    bool points;           /* the picture is made of rays through the pixels' middles, and no others */
    bool flat, unbounded;
    bool closed; /* of the part no inner side is seen */
    int32_t (*face)[3];
    long faces, room, before; /* before: faces of the parts before */
    bool counting, measuring; /* how many faces there would be, and no more; how far off they are */
    bool full, memory;        /* memory: there is still some */
} tessellation;

/* ---- where a cell is on the screen ---- */

/* Depth along the view, and places on the screen times depth; orthographic, as for depth 1. */
static vec3 project(const scene *s, vec3 p)
{
    const camera *c = &s->camera;
    vec3 d = vec3_sub(p, c->from);
    return (vec3){vec3_dot(d, c->right) / vec3_dot(c->right, c->right), vec3_dot(d, c->up) / vec3_dot(c->up, c->up),
                  c->orthographic ? 1 : vec3_dot(d, c->forward)};
}

typedef struct corners {
    vec3 Q[4], X[4], n; /* around the block, smooth and rough; n unit, in the first one */
    double P[4];
    double slope[4][2]; /* of P, along u and along w */
} corners;

static corners block_corners(const tessellation *x, int64_t i, int64_t j, int64_t size)
{
    corners c;
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
        vec3 U = {(double)q.Qu.x[k], (double)q.Qu.y[k], (double)q.Qu.z[k]},
             W = {(double)q.Qw.x[k], (double)q.Qw.y[k], (double)q.Qw.z[k]};
        c.Q[k] = (vec3){(double)q.Q.x[k], (double)q.Q.y[k], (double)q.Q.z[k]};
        c.slope[k][0] = (double)h.Pu[k] / vec3_length(U);
        c.slope[k][1] = (double)h.Pw[k] / vec3_length(W);
        c.P[k] = (double)h.P[k];
        c.X[k] = vec3_add(c.Q[k], vec3_scale(vec3_unit(vec3_cross(U, W)), c.P[k]));
    }
    vec3 Qu = {(double)q.Qu.x[0], (double)q.Qu.y[0], (double)q.Qu.z[0]},
         Qw = {(double)q.Qw.x[0], (double)q.Qw.y[0], (double)q.Qw.z[0]};
    c.n = vec3_unit(vec3_cross(Qu, Qw));
    return c;
}

/* The longest side in pixels; infinite where the block reaches behind the eye. */
static double block_pixels(const tessellation *x, const corners *c)
{
    double longest = 0;
    vec3 p[4];
    for (int k = 0; k < 4; k++) {
        p[k] = project(x->s, c->Q[k]);
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

/* How far the normal in a facet that is the whole block can be from that of the surface: what lies between three
 * normals on unit length is a plane, where the slopes are bilinear and unit length is not linear. */
static double block_tilt(const corners *c)
{
    double worst = 0;
    for (int a = 0; a < 2; a++) {
        double g[4] = {c->slope[0][a], c->slope[1][a], c->slope[2][a], c->slope[3][a]};
        double most = fmax(fmax(g[0], g[1]), fmax(g[2], g[3])), least = fmin(fmin(g[0], g[1]), fmin(g[2], g[3]));
        worst = fmax(worst, fabs(g[0] - g[1] + g[2] - g[3]) / 4 + (most - least) * (most - least) / 8);
    }
    return worst < 1 ? worst : 1; /* at a pole u has no length */
}

/* How far two facets are from the bilinear surface, in the block's sides. */
static double block_twist(const corners *c)
{
    const double side = fmin(vec3_length(vec3_sub(c->Q[1], c->Q[0])), vec3_length(vec3_sub(c->Q[3], c->Q[0])));
    const double twist = fabs(c->P[0] - c->P[1] + c->P[2] - c->P[3]) / 4;
    return twist < side ? twist / side : 1;
}

/* Which sides of the picture a place is beyond. */
static int beyond(const scene *s, vec3 at)
{
    vec3 p = project(s, at);
    return (p.x > p.z) | (p.x < -p.z) << 1 | (p.y > p.z) << 2 | (p.y < -p.z) << 3 | (p.z < 0) << 4;
}

/* Whether the block, or the shadow that it casts down to the lowest level of its plane, can be in the picture. */
static bool block_seen(const tessellation *x, const corners *c)
{
    const double lo = (double)x->o->bump->Pmin, hi = (double)x->o->bump->Pmax;
    int outside = ~0;
    for (int k = 0; k < 4; k++) {
        vec3 low = vec3_add(c->Q[k], vec3_scale(c->n, lo)), top = vec3_add(c->Q[k], vec3_scale(c->n, hi));
        outside &= beyond(x->s, low) & beyond(x->s, top);
        for (int l = 0; l < x->s->lights && x->s->self_shadow && outside; l++)
            for (int j = 0; j < light_corners(&x->s->light[l]); j++) {
                vec3 ray = vec3_sub(top, light_corner(&x->s->light[l], j, top));
                double fall = -vec3_dot(ray, c->n);
                if (fall > 0)
                    outside &= beyond(x->s, vec3_add(top, vec3_scale(ray, (hi - lo) / fall)));
            }
    }
    return !outside;
}

/* ---- where pixels meet a cell ---- */

/* A corner on the screen, times depth, against the middle of a pixel. */
typedef struct aim {
    double f[4], g[4];
} aim;

/* s u and t w from corner 0: the rough cell is turned away from the eye. Told only where its other side is never seen.
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

/* Where s is given, t by that of the two equations that knows it better. False: outside of the cell. */
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

/* The pixels whose middles are in the box around a rough cell, first and last of columns and rows. False: it reaches
 * behind the eye. */
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

/* ---- cells ---- */

/* Whether no pixel's ray meets a block of cells, nor one as large beside it, which it could shade. */
static bool block_missed(const tessellation *x, const corners *c)
{
    const double level[2] = {(double)x->o->bump->Pmin, (double)x->o->bump->Pmax};
    const int size[2] = {x->s->width, x->s->height};
    double lo[2] = {HUGE_VAL, HUGE_VAL}, hi[2] = {-HUGE_VAL, -HUGE_VAL};
    for (int k = 0; k < 8; k++) {
        const vec3 p = project(x->s, vec3_add(c->Q[k % 4], vec3_scale(c->n, level[k / 4])));
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

/* Of the LATTICE + 1 lines that a cell can be divided by, those that it is, along u and along w. */
typedef struct lines {
    bool on[2][LATTICE + 1];
} lines;

/* Turned away beyond what bumps bring into sight. */
static bool turned(const tessellation *x, const corners *c)
{
    vec3 view = x->s->camera.orthographic ? x->s->camera.forward : vec3_sub(c->Q[0], x->s->camera.from);
    return x->closed && vec3_dot(c->n, view) > 0.4 * vec3_length(view);
}

static bool in_range(const tessellation *x, int64_t i, int64_t j)
{
    return i >= x->first[0] && i < x->end[0] && j >= x->first[1] && j < x->end[1];
}

/* Into how many parts each side of a cell is divided: 0 where there is no cell. Depends on nothing else, so that a
 * neighbour finds the same. */
static int cell_division(const tessellation *x, int64_t i, int64_t j)
{
    if (!in_range(x, i, j))
        return 0;
    corners c = block_corners(x, i, j, 1);
    int k = x->fine.tolerance > FINE ? 1 : 2;
    if (turned(x, &c) || !block_seen(x, &c))
        return 1;
    const double pixels = block_pixels(x, &c), tilt = block_tilt(&c) / x->fine.tilt;
    while (k < LATTICE && (pixels > x->fine.tolerance * k || tilt > k * k))
        k *= 2;
    return k;
}

static void add_lines(lines *l, int k)
{
    for (int a = 0; a <= LATTICE; a += LATTICE / k)
        l->on[0][a] = l->on[1][a] = true;
}

/* The facet of k x k that a ray meets, and those beside it where that is not sure. */
static void add_place(lines *l, int axis, double at, int k, double unsure)
{
    const int first = (int)floor(fmin(fmax(at * k - unsure, 0), k - 1)),
              last = (int)floor(fmin(fmax(at * k + unsure, 0), k - 1)) + 1;
    for (int a = first; a <= last; a++)
        l->on[axis][a * (LATTICE / k)] = true;
}

/* The lines of a cell that is fine only where pixels' rays meet it. */
static void met_lines(const tessellation *x, const corners *c, lines *l)
{
    enum { MANY = 25 }; /* pixels: all of the cell is as fine */
    const double margin = x->flat ? 0.01 : BULGE, unsure = x->flat ? 0.05 : 0.3;
    int box[2][2], k = 1, shaped = 1;
    vec3 p[4];
    for (int n = 0; n < 4; n++)
        p[n] = project(x->s, c->X[n]);
    const bool before = pixels_around(x, p, box), seen = block_seen(x, c);
    const double pixels = block_pixels(x, c), tilt = block_tilt(c) / x->fine.tilt,
                 twist = block_twist(c) / x->fine.shape;
    while (k < LATTICE && seen && (pixels > x->fine.tolerance * k || tilt > k * k))
        k *= 2;
    while (shaped < k && twist > shaped * shaped && !turned(x, c))
        shaped *= 2;
    const double many = ((double)box[0][1] - box[0][0] + 1) * ((double)box[1][1] - box[1][0] + 1);
    add_lines(l, seen && (!before || many > MANY) ? k : shaped);
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

static void add_face(tessellation *x, int32_t a, int32_t b, int32_t c)
{
    const float *A = x->v.vertex[a].at, *B = x->v.vertex[b].at, *C = x->v.vertex[c].at;
    const size_t size = sizeof x->v.vertex[a].at;
    if (x->full || !memcmp(A, B, size) || !memcmp(B, C, size) || !memcmp(C, A, size))
        return; /* at a pole a side has no length */
    if (x->faces == x->room) {
        long room = x->room ? 2 * x->room : 1 << 16;
        int32_t(*face)[3] = realloc(x->face, sizeof *face * (size_t)room);
        if (!face) {
            x->memory = false;
            x->full = true;
            return;
        }
        x->face = face;
        x->room = room;
    }
    int32_t *f = x->face[x->faces++];
    f[0] = a;
    f[1] = b;
    f[2] = c;
}

/* A vertex of a finer side onto the straight line between those two that the coarser neighbour has. */
static void onto(pov_vertices *v, int32_t it, int32_t a, int32_t b, float share)
{
    for (int k = 0; k < 3; k++)
        v->vertex[it].at[k] = v->vertex[a].at[k] + (v->vertex[b].at[k] - v->vertex[a].at[k]) * share;
}

/* number[(k + 1) row + column]; `stride` leads along a side, from `first`. */
static void stitch(pov_vertices *v, const int32_t *number, const bool *fresh, int k, int other, int first, int stride)
{
    if (other == 0 || other >= k)
        return;
    const int m = k / other;
    for (int s = 0; s <= k; s++)
        if (s % m && fresh[first + s * stride])
            onto(v, number[first + s * stride], number[first + s / m * m * stride],
                 number[first + (s / m + 1) * m * stride], (float)(s % m) / (float)m);
}

/* ---- how far heights are off ---- */

/* What facets are off on a block of k x k that is not bilinear, by heights at n places along a facet's side. */
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

/* Of facets between the lines of a map's cell, which is bilinear; or of others. */
static void measure(tessellation *x, int64_t i, int64_t j, int64_t size, const lines *l)
{
    const corners c = block_corners(x, i, j, size);
    int outside = ~0, widest[2] = {0, 0};
    for (int k = 0; k < 4; k++)
        outside &= beyond(x->s, c.Q[k]);
    if (outside || turned(x, &c))
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
    const double depth = project(x->s, c.Q[0]).z;
    x->height = fmax(x->height, off);
    if (depth > 0)
        x->pixels = fmax(x->pixels, off / depth * x->s->width / (2 * vec3_length(x->s->camera.right)));
}

/* ---- quads ---- */

/* All on the straight sides between the corners, so that neighbours need not have the same lines. */
static void straighten(pov_vertices *v, const int32_t *number, const bool *fresh, const int at[][2], int n, int row)
{
    const int32_t corner[2][2] = {{number[0], number[row - 1]}, {number[n - row], number[n - 1]}}; /* [w][u] */
    for (int k = 0; k < n; k++) {
        const int a = at[k][0], b = at[k][1];
        const bool end_u = a % LATTICE == 0, end_w = b % LATTICE == 0;
        if (!fresh[k] || end_u == end_w)
            continue;
        if (end_w)
            onto(v, number[k], corner[b > 0][0], corner[b > 0][1], (float)a / LATTICE);
        else
            onto(v, number[k], corner[0][a > 0], corner[1][a > 0], (float)b / LATTICE);
    }
}

static void stitch_all(tessellation *x, int64_t i, int64_t j, const int32_t *number, const bool *fresh, int k)
{
    const int row = k + 1;
    stitch(&x->v, number, fresh, k, cell_division(x, i, j - 1), 0, 1);
    stitch(&x->v, number, fresh, k, cell_division(x, i, j + 1), k * row, 1);
    stitch(&x->v, number, fresh, k, cell_division(x, i - 1, j), 0, row);
    stitch(&x->v, number, fresh, k, cell_division(x, i + 1, j), k, row);
}

/* Quads between the lines of a cell, or of a block of cells. */
static void add_grid(tessellation *x, int64_t i, int64_t j, int64_t size, const lines *l)
{
    enum { MOST = (LATTICE + 1) * (LATTICE + 1) };
    int64_t cell[MOST][2];
    int at[MOST][2], place[MOST][2], count[2] = {0, 0}, n = 0;
    int32_t number[MOST];
    bool fresh[MOST];
    if (x->measuring) {
        measure(x, i, j, size, l);
        return;
    }
    for (int a = 0; a <= LATTICE; a++)
        for (int axis = 0; axis < 2; axis++)
            count[axis] += l->on[axis][a];
    if (x->counting) {
        x->faces += 2 * (count[0] - 1) * (count[1] - 1);
        x->full = x->before + x->faces > MOST_TRIANGLES;
        return;
    }
    for (int b = 0; b <= LATTICE; b++)
        for (int a = 0; a <= LATTICE; a++) {
            if (!l->on[0][a] || !l->on[1][b])
                continue;
            /* the last place of a cell is the first of the next, or both ends of the last cell */
            cell[n][0] = i + (a == LATTICE ? size : 0);
            cell[n][1] = j + (b == LATTICE ? size : 0);
            place[n][0] = a % LATTICE;
            place[n][1] = b % LATTICE;
            at[n][0] = a;
            at[n++][1] = b;
        }
    if (!pov_vertices_get(&x->v, n, (const int64_t(*)[2])cell, (const int(*)[2])place, number, fresh)) {
        x->memory = false;
        x->full = true;
        return;
    }
    if (x->fine.met)
        straighten(&x->v, number, fresh, (const int(*)[2])at, n, count[0]);
    else if (size == 1 && count[0] > 2)
        stitch_all(x, i, j, number, fresh, count[0] - 1);
    for (int b = 0; b < count[1] - 1; b++)
        for (int a = 0; a < count[0] - 1; a++) {
            const int32_t *p = number + b * count[0] + a, *q = p + count[0];
            add_face(x, p[0], p[1], q[1]);
            add_face(x, p[0], q[1], q[0]);
        }
}

static void add_cell(tessellation *x, int64_t i, int64_t j)
{
    lines l = {0};
    if (x->fine.met) {
        const corners c = block_corners(x, i, j, 1);
        met_lines(x, &c, &l);
    } else
        add_lines(&l, cell_division(x, i, j));
    add_grid(x, i, j, 1, &l);
}

static void add_joined(tessellation *x, int64_t i, int64_t j, int64_t size)
{
    lines l = {0};
    add_lines(&l, 1);
    add_grid(x, i, j, size, &l);
}

/* A block of size x size cells, a power of two. */
static void add_block(tessellation *x, int64_t i, int64_t j, int64_t size)
{
    if (x->full || i >= x->end[0] || j >= x->end[1])
        return;
    if (size == 1 && !x->unbounded && !x->fine.level) {
        add_cell(x, i, j);
        return;
    }
    corners c = block_corners(x, i, j, size);
    if (x->unbounded && !block_seen(x, &c))
        return;
    if (x->fine.level && size <= (int64_t)1 << x->fine.level)
        add_joined(x, i, j, size);
    else if (size == 1)
        add_cell(x, i, j);
    else if (x->flat && i + size <= x->end[0] && j + size <= x->end[1] &&
             block_pixels(x, &c) < JOIN / FINE * x->fine.tolerance &&
             (!x->fine.met || x->fine.tolerance > FINE || block_missed(x, &c)))
        add_joined(x, i, j, size);
    else
        for (int k = 0; k < 4; k++)
            add_block(x, i + (k & 1) * (size / 2), j + (k >> 1) * (size / 2), size / 2);
}

/* ---- the lattice ---- */

/* The lines of a map's samples, or where there are none, some that are fine against what is seen. */
static void lay(tessellation *x, int part)
{
    const object *o = x->o;
    const map_layout *m = &o->bump_spec.layout;
    const int samples[2] = {o->map.width, o->map.height};
    double range[2][2];
    pov_lattice *l = &x->v.lattice;
    l->part = part;
    x->flat = pov_is_flat(&o->shape_spec, part);
    x->closed = !x->flat && !o->shape_spec.values.open;
    o->shape->ops->extent(o->shape, part, range[0], range[1]);
    for (int a = 0; a < 2; a++) {
        l->lo[a] = range[a][0];
        l->hi[a] = range[a][1];
    }
    if (x->unbounded)
        pov_plane_region(x->s, o, range[0], range[1]);
    for (int a = 0; a < 2; a++) {
        if (o->bump_spec.function) {
            const pov_flat f = pov_flat_of(o, 0);
            double edge = vec3_length(a ? f.W : f.U), away = vec3_length(vec3_sub(x->s->view.at, x->s->camera.from));
            l->step[a] = x->unbounded ? away / edge / FUNCTION_CELLS : (range[a][1] - range[a][0]) / FUNCTION_CELLS;
            l->start[a] = x->unbounded ? 0 : range[a][0];
        } else {
            l->step[a] = m->size[a] / (samples[a] - m->corners);
            l->start[a] = m->offset[a] + (m->corners ? 0 : l->step[a] / 2);
        }
        /* a line that is at the end but for rounding makes no cell more */
        double first = (range[a][0] - l->start[a]) / l->step[a], end = (range[a][1] - l->start[a]) / l->step[a];
        x->first[a] = (int64_t)floor(first + 1e-6);
        x->end[a] = (int64_t)ceil(end - 1e-6);
    }
}

static void tessellate(tessellation *x, int part)
{
    lay(x, part);
    pov_vertices_clear(&x->v);
    x->faces = 0;
    int64_t size = 1;
    while (size < x->end[0] - x->first[0] || size < x->end[1] - x->first[1])
        size *= 2;
    add_block(x, x->first[0], x->first[1], size);
}

/* ---- writing ---- */

static void put_mesh(pov_text *t, const tessellation *x)
{
    pov_begin_mesh(t, x->v.vertex, x->v.count, pov_by_uv(x->s, x->o));
    pov_print(t, "  face_indices { %d", (int)x->faces);
    for (long k = 0; k < x->faces; k++)
        pov_print(t, k % 8 ? ",<%d,%d,%d>" : ",\n<%d,%d,%d>", (int)x->face[k][0], (int)x->face[k][1],
                  (int)x->face[k][2]);
    pov_print(t, " }\n");
}

static void all_parts(tessellation *x)
{
    x->before = 0;
    x->full = false;
    for (int part = 0; part < x->o->shape->ops->parts && !x->full; part++) {
        if (pov_rim(&x->o->shape_spec, part) == 0)
            continue;
        tessellate(x, part);
        x->before += x->faces;
    }
}

/* The ladder. First normals are given up a little. Then, in a picture of rays through the pixels' middles, all that
 * these do not meet: of the rest only the shape is kept, which casts shadows, and of that less and less. From
 * FIRST_STEEP on the mesh is coarse: normals, then facets, then cells are given up. The last rung is one quad for a
 * part. */
static fineness rung(const tessellation *x, int k)
{
    fineness f = {.tolerance = FINE, .tilt = TILT, .shape = SHAPE};
    if (k < FIRST_MET) {
        f.tilt *= pow(COARSER, k);
        return f;
    }
    f.met = x->points;
    f.shape *= ldexp(1, k - FIRST_MET);
    if (k >= FIRST_STEEP)
        f.tilt *= ldexp(1, (k < FIRST_WIDE ? k : FIRST_WIDE) - FIRST_STEEP + 1);
    if (k >= FIRST_WIDE)
        f.tolerance *= ldexp(1, k - FIRST_WIDE + 1);
    if (k >= FIRST_JOINED)
        f.level = k - FIRST_JOINED + 1;
    return f;
}

static bool fits(tessellation *x, int k)
{
    x->fine = rung(x, k);
    x->counting = true;
    all_parts(x);
    x->counting = false;
    return !x->full;
}

/* The finest rung that fits, by bisection: 8 rounds at most, and each ends where MOST_TRIANGLES are counted. */
static int fit(tessellation *x)
{
    if (fits(x, 0))
        return 0;
    const bool loose = fits(x, FIRST_MET - 1);
    int full = loose ? 0 : FIRST_MET - 1, good = loose ? FIRST_MET - 1 : RUNGS - 1;
    while (good - full > 1) {
        const int middle = (full + good) / 2;
        if (fits(x, middle))
            good = middle;
        else
            full = middle;
    }
    x->full = false;
    x->fine = rung(x, good);
    if (good >= FIRST_MET) {
        x->measuring = true;
        all_parts(x);
        x->measuring = false;
    }
    return good;
}

static void put_note(pov_text *t, const tessellation *x, int k)
{
    if (x->unbounded)
        pov_print(t, "// The plane has no end; here it is cut to what the camera sees and what can shade that.\n");
    pov_print(t, "// a mesh made for %d x %d pixels", x->s->width, x->s->height);
    if (k >= FIRST_MET && x->fine.met)
        pov_print(t, ", fine where the rays through their middles meet it");
    if (k >= FIRST_STEEP)
        pov_print(t, "; COARSE: finer ones are above %d triangles", MOST_TRIANGLES);
    pov_print(t, "\n");
    if (k >= FIRST_MET)
        pov_print(t, "// its heights are off by up to %s, which is %s pixels\n", pov_number(x->height, 3).text,
                  pov_number(x->pixels, 3).text);
    if (k >= FIRST_JOINED)
        pov_print(t, "// %g x %g samples of its map are one cell\n", ldexp(1, x->fine.level), ldexp(1, x->fine.level));
    else if (k >= FIRST_STEEP)
        pov_print(t, "// its normals are off by up to %s, its facets up to %s pixels wide\n",
                  pov_number(fmin(x->fine.tilt, 1), 2).text, pov_number(x->fine.tolerance, 2).text);
}

bool pov_mesh(pov_text *t, const scene *s, const object *o, pov_report *report)
{
    const int parts = o->shape->ops->parts;
    tessellation x = {.s = s, .o = o, .memory = true, .unbounded = o->shape_spec.form == &form_plane};
    x.v.f = o->shape;
    x.v.P = o->bump;
    x.points = o->map.file && !s->sends && s->aa == 1;
    const int k = fit(&x);
    put_note(t, &x, k);
    if (k >= FIRST_STEEP && (!report->coarse || x.pixels > report->pixels))
        *report = (pov_report){o->name, x.height, x.pixels};
    if (parts > 1)
        pov_print(t, "union {\n");
    for (int part = 0; part < parts && x.memory; part++) {
        const double rim = pov_rim(&o->shape_spec, part);
        if (rim == 0)
            continue;
        tessellate(&x, part);
        put_mesh(t, &x);
        if (pov_by_parts(s, o))
            pov_texture(t, s, o, part);
        if (rim > 0)
            pov_clip_rim(t, o, part);
        if (parts > 1)
            pov_print(t, "}\n");
    }
    free(x.face);
    pov_vertices_free(&x.v);
    return x.memory;
}
