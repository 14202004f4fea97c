/* Makes the triangles of a part between the lines of its cells. At the edge to a coarser cell, the finer one's vertices
 * are moved onto that edge, so that there are no cracks.
 */
#include "pov_text/flat.h"
#include "tessellate/tessellation.h"

#include <stdlib.h>
#include <string.h>

static void add_face(tessellation *x, int32_t a, int32_t b, int32_t c)
{
    const float *A = x->v.vertex[a].at, *B = x->v.vertex[b].at, *C = x->v.vertex[c].at;
    const size_t size = sizeof x->v.vertex[a].at;
    if (x->full || !memcmp(A, B, size) || !memcmp(B, C, size) || !memcmp(C, A, size))
        return; /* at a pole a side has no length */
    if (x->faces == x->room) {
        long room = x->room ? 2 * x->room : 1 << 16;
        int32_t(*face)[3] = memory_resize(progress_memory(x->progress), x->face, sizeof *face * (size_t)room);
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

/* Move a vertex onto the line between vertices a and b, which the coarser neighbour has. */
static void onto(pov_vertices *v, int32_t it, int32_t a, int32_t b, float share)
{
    for (int k = 0; k < 3; k++)
        v->vertex[it].at[k] = v->vertex[a].at[k] + (v->vertex[b].at[k] - v->vertex[a].at[k]) * share;
}

/* Move the vertices of one side, first + s stride in `number`, onto the neighbour's `other` parts. */
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

/* ---- quads ---- */

/* Move the vertices of all sides onto straight lines between the corners: neighbours may have other lines. */
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
        tessellation_measure(x, i, j, size, l);
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

/* A cell, or a block as one cell. */
static void add_cell(tessellation *x, int64_t i, int64_t j, int64_t size, bool joined)
{
    lines l = {0};
    if (x->cells++ % 1024 == 0 && !progress_show(x->progress, "writing", x->share)) {
        x->memory = false;
        x->full = true;
        return;
    }
    if (!joined && x->fine.met) {
        const corners c = block_corners(x, i, j, 1);
        lines_met(x, &c, &l);
    } else
        lines_every(&l, joined ? 1 : cell_division(x, i, j));
    add_grid(x, i, j, size, &l);
}

/* A block of size x size cells, a power of two. */
static void add_block(tessellation *x, int64_t i, int64_t j, int64_t size)
{
    if (x->full || i >= x->end[0] || j >= x->end[1])
        return;
    if (size == 1 && !x->unbounded && !x->fine.level) {
        add_cell(x, i, j, 1, false);
        return;
    }
    corners c = block_corners(x, i, j, size);
    if (x->unbounded && !block_seen(x, &c))
        return;
    const bool small = x->fine.level && size <= (int64_t)1 << x->fine.level;
    if (small || size == 1 ||
        (x->flat && i + size <= x->end[0] && j + size <= x->end[1] &&
         block_pixels(x, &c) < JOIN / FINE * x->fine.tolerance &&
         (!x->fine.met || x->fine.tolerance > FINE || block_missed(x, &c))))
        add_cell(x, i, j, size, small || size > 1);
    else
        for (int k = 0; k < 4; k++)
            add_block(x, i + (k & 1) * (size / 2), j + (k >> 1) * (size / 2), size / 2);
}

/* ---- the lattice ---- */

/* Set the lattice: lines at a map's samples, or FUNCTION_CELLS cells over the part or over the view. */
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
        /* 1e-6: rounding must not make one more cell at an end */
        double first = (range[a][0] - l->start[a]) / l->step[a], end = (range[a][1] - l->start[a]) / l->step[a];
        x->first[a] = (int64_t)floor(first + 1e-6);
        x->end[a] = (int64_t)ceil(end - 1e-6);
    }
}

void tessellate(tessellation *x, int part)
{
    lay(x, part);
    pov_vertices_clear(&x->v);
    x->faces = 0;
    int64_t size = 1;
    while (size < x->end[0] - x->first[0] || size < x->end[1] - x->first[1])
        size *= 2;
    add_block(x, x->first[0], x->first[1], size);
}
