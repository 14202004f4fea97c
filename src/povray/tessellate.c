/* Displaced objects as meshes: maps, and functions that POV-Ray cannot evaluate.
 *
 * The lattice has the map's own samples, so that a mesh is the bilinear surface between them and no other. A cell is
 * divided so that its facets are below half a pixel on the screen, into a power of two; beside a coarser cell the finer
 * one's vertices on the common edge are put onto that edge, so that no crack opens. Of an unbounded plane only what the
 * camera sees, and what casts shadows there, is made; far away cells are joined.
 */
#include "povray/flat.h"
#include "povray/material.h"
#include "povray/parts.h"
#include "povray/vertices.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_TRIANGLES = 4000000, FUNCTION_CELLS = 256 };

#define FINE 1.0   /* a facet's side in pixels: it covers less than half a pixel */
#define JOIN 0.25  /* cells are joined while the block is smaller, in pixels */
#define TILT 0.003 /* by how much a facet's normals may be off, against unit length: less than a step of 1/255 */
#define LOOSEST 0.02
#define COARSER 1.4 /* where the triangles are too many: first the normals, then the facets */

typedef struct tessellation {
    const scene *s;
    const object *o;
    pov_vertices v;
    int64_t first[2], end[2]; /* cells */
    double tolerance;         /* a facet's side in pixels */
    double tilt;              /* what its normals may be off */
    bool flat, unbounded;
    bool closed; /* of the part no inner side is seen */
    int32_t (*face)[3];
    long faces, room, before; /* before: faces of the parts before */
    bool counting;            /* how many faces there would be, and no more */
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
    vec3 Q[4], n;       /* around the block; n unit, in the first one */
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

/* ---- cells ---- */

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
    int k = x->tolerance > FINE ? 1 : 2;
    vec3 view = x->s->camera.orthographic ? x->s->camera.forward : vec3_sub(c.Q[0], x->s->camera.from);
    bool away = x->closed && vec3_dot(c.n, view) > 0.4 * vec3_length(view); /* beyond what bumps bring into sight */
    if (away || !block_seen(x, &c))
        return 1;
    const double pixels = block_pixels(x, &c), tilt = block_tilt(&c) / x->tilt;
    while (k < LATTICE && (pixels > x->tolerance * k || tilt > k * k))
        k *= 2;
    return k;
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

/* A grid of k x k quads over the cell, or over a block of cells, k = 1. */
static void add_grid(tessellation *x, int64_t i, int64_t j, int64_t size, int k)
{
    enum { MOST = (LATTICE + 1) * (LATTICE + 1) };
    int64_t cell[MOST][2];
    int place[MOST][2];
    int32_t number[MOST];
    bool fresh[MOST];
    int n = 0;
    if (x->counting) {
        x->faces += 2 * k * k;
        x->full = x->before + x->faces > MOST_TRIANGLES;
        return;
    }
    for (int b = 0; b <= k; b++)
        for (int a = 0; a <= k; a++, n++) {
            /* the last place of a cell is the first of the next, or both ends of the last cell */
            cell[n][0] = i + (a == k ? size : 0);
            cell[n][1] = j + (b == k ? size : 0);
            place[n][0] = a == k ? 0 : a * (LATTICE / k);
            place[n][1] = b == k ? 0 : b * (LATTICE / k);
        }
    if (!pov_vertices_get(&x->v, n, (const int64_t(*)[2])cell, (const int(*)[2])place, number, fresh)) {
        x->memory = false;
        x->full = true;
        return;
    }
    if (size == 1 && k > 1) {
        const int row = k + 1;
        stitch(&x->v, number, fresh, k, cell_division(x, i, j - 1), 0, 1);
        stitch(&x->v, number, fresh, k, cell_division(x, i, j + 1), k * row, 1);
        stitch(&x->v, number, fresh, k, cell_division(x, i - 1, j), 0, row);
        stitch(&x->v, number, fresh, k, cell_division(x, i + 1, j), k, row);
    }
    for (int b = 0; b < k; b++)
        for (int a = 0; a < k; a++) {
            const int32_t *p = number + b * (k + 1) + a, *q = p + k + 1;
            add_face(x, p[0], p[1], q[1]);
            add_face(x, p[0], q[1], q[0]);
        }
}

/* A block of size x size cells, a power of two. */
static void add_block(tessellation *x, int64_t i, int64_t j, int64_t size)
{
    if (x->full || i >= x->end[0] || j >= x->end[1])
        return;
    if (size == 1 && !x->unbounded) {
        add_grid(x, i, j, 1, cell_division(x, i, j));
        return;
    }
    corners c = block_corners(x, i, j, size);
    if (x->unbounded && !block_seen(x, &c))
        return;
    if (size == 1)
        add_grid(x, i, j, 1, cell_division(x, i, j));
    else if (x->flat && i + size <= x->end[0] && j + size <= x->end[1] &&
             block_pixels(x, &c) < JOIN / FINE * x->tolerance)
        add_grid(x, i, j, size, 1);
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

/* The tolerances at which all parts together stay below the limit. */
static void fit(tessellation *x)
{
    x->tolerance = FINE;
    x->tilt = TILT;
    x->counting = true;
    do {
        x->before = 0;
        x->full = false;
        for (int part = 0; part < x->o->shape->ops->parts && !x->full; part++) {
            if (pov_rim(&x->o->shape_spec, part) == 0)
                continue;
            tessellate(x, part);
            x->before += x->faces;
        }
        if (x->full && x->tilt < LOOSEST)
            x->tilt *= COARSER;
        else if (x->full)
            x->tolerance *= COARSER;
    } while (x->full);
    x->counting = false;
}

static void put_note(pov_text *t, const tessellation *x)
{
    if (x->unbounded)
        pov_print(t, "// The plane has no end; here it is cut to what the camera sees and what can shade that.\n");
    pov_print(t, "// a mesh made for %d x %d pixels", x->s->width, x->s->height);
    if (x->tolerance > FINE)
        pov_print(t, ", with facets up to %s pixels wide: finer ones would be too many",
                  pov_number(x->tolerance, 2).text);
    pov_print(t, "\n");
}

bool pov_mesh(pov_text *t, const scene *s, const object *o, pov_report *report)
{
    const int parts = o->shape->ops->parts;
    tessellation x = {.s = s, .o = o, .memory = true, .unbounded = o->shape_spec.form == &form_plane};
    x.v.f = o->shape;
    x.v.P = o->bump;
    fit(&x);
    put_note(t, &x);
    if (x.tolerance > FINE && x.tolerance > report->pixels) {
        report->coarse = o->name;
        report->pixels = x.tolerance;
    }
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
