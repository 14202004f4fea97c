/* Surfaces that POV-Ray has no shape for, smooth or displaced, as one mesh2 on a grid over (u,w), with the surface's
 * normals. All parts have the same grid, so that they share vertices where they join.
 */
#include "povray/parts.h"

#include "displaced/offset.h"
#include "tessellate/vertices.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_TRIANGLES = 1500000, PROBES = 64, LEAST = 8, FINEST = 4096 };

/* The most that a cell's side may be, in pixels, and its normals may differ, in radians. At this angle a facet shades
 * its neighbour only where the light is below 1/255. */
#define PIXELS 3.0
#define TURN 0.012

typedef struct grid {
    const scene *s;
    const object *o;
    bool rough;
    int n[2]; /* cells along u and along w */
} grid;

static double line(const double range[2], int i, int n)
{
    return i == n ? range[1] : range[0] + (range[1] - range[0]) * i / n;
}

static vec3 wide(bs_vec3 x) { return (vec3){(double)x.x, (double)x.y, (double)x.z}; }

static vec3 difference(const float a[3], const float b[3])
{
    return (vec3){(double)b[0] - (double)a[0], (double)b[1] - (double)a[1], (double)b[2] - (double)a[2]};
}

/* The n[0] + 1 vertices of a line of the grid along u. */
static void evaluate(const grid *g, int part, int row, pov_vertex *out)
{
    double U[2], W[2];
    const surface *f = g->o->shape;
    f->ops->extent(f, part, U, W);
    for (int first = 0; first <= g->n[0]; first += LANES) {
        const int n = g->n[0] + 1 - first < LANES ? g->n[0] + 1 - first : LANES;
        real u[LANES], w[LANES];
        int32_t parts[LANES];
        partials q;
        bump_values h;
        for (int i = 0; i < n; i++) {
            u[i] = (real)line(U, first + i, g->n[0]);
            w[i] = (real)line(W, row, g->n[1]);
            parts[i] = part;
            h.P[i] = h.Pu[i] = h.Pw[i] = 0;
        }
        f->ops->eval(f, n, parts, u, w, 2, &q);
        if (g->rough)
            g->o->bump->ops->eval(g->o->bump, n, u, w, 1, &h);
        for (int i = 0; i < n; i++) {
            const bs_vec3 Qu = lane_get(&q.Qu, i), Qw = lane_get(&q.Qw, i);
            const offset o = offset_of(Qu, Qw, lane_get(&q.Quu, i), lane_get(&q.Quw, i), lane_get(&q.Qww, i), h.P[i]);
            const bs_vec3 normal = bs_regular(bs_normal(Qu, Qw), Qu, Qw) ? offset_normal(o, h.Pu[i], h.Pw[i]) : o.n;
            out[first + i] = pov_vertex_of(wide(offset_mix(lane_get(&q.Q, i), h.P[i], o.n)), wide(normal), (double)u[i],
                                           (double)w[i]);
        }
    }
}

/* ---- how fine ---- */

static double pixels_between(const scene *s, const float a[3], const float b[3])
{
    const camera *c = &s->camera;
    vec3 to = vec3_sub((vec3){(double)a[0], (double)a[1], (double)a[2]}, c->from);
    const double depth = vec3_dot(to, c->forward), step = vec3_length(difference(a, b));
    return depth > step ? step / depth * s->width / (2 * vec3_length(c->right)) : PIXELS;
}

static void probe(const pov_vertex *a, const pov_vertex *b, const grid *g, double *most)
{
    const double turn = vec3_length(difference(a->normal, b->normal));
    *most = fmax(*most, pixels_between(g->s, a->at, b->at) / PIXELS);
    *most = fmax(*most, turn < HUGE_VAL ? turn / TURN : 0); /* not finite: there is no normal */
}

/* Set n so that the largest cell is fine enough, measured on a grid of probes on each part. False: out of memory. */
static bool measure(grid *g)
{
    const int parts = g->o->shape->ops->parts;
    pov_vertex *row = malloc(sizeof *row * 2 * (PROBES + 1)), *last = row + PROBES + 1;
    double most[2] = {0, 0};
    if (!row)
        return false;
    g->n[0] = g->n[1] = PROBES;
    for (int part = 0; part < parts; part++)
        for (int j = 0; j <= PROBES; j++) {
            evaluate(g, part, j, row);
            for (int i = 0; i <= PROBES; i++) {
                if (i > 0)
                    probe(&row[i - 1], &row[i], g, &most[0]);
                if (j > 0)
                    probe(&last[i], &row[i], g, &most[1]);
            }
            memcpy(last, row, sizeof *row * (PROBES + 1));
        }
    free(row);
    for (int a = 0; a < 2; a++)
        g->n[a] = (int)fmin(fmax(ceil(PROBES * most[a]), LEAST), FINEST);
    const double all = 2.0 * g->n[0] * g->n[1] * parts;
    for (int a = 0; a < 2 && all > MOST_TRIANGLES; a++)
        g->n[a] = (int)fmax(g->n[a] * sqrt(MOST_TRIANGLES / all), LEAST);
    return true;
}

/* Increase n so that a map's samples are on lines of the grid: between them the map is bilinear. */
static void fit_map(grid *g)
{
    const object *o = g->o;
    const map_layout *m = &o->bump_spec.layout;
    const int samples[2] = {o->map.width, o->map.height};
    double range[2][2];
    o->shape->ops->extent(o->shape, 0, range[0], range[1]);
    for (int a = 0; a < 2; a++) {
        /* in the middle of cells: two lines for each */
        const double lines = (range[a][1] - range[a][0]) / m->size[a] * (m->corners ? samples[a] - 1 : 2 * samples[a]);
        const int each = (int)(lines + 0.5);
        if (each > 0 && each <= FINEST)
            g->n[a] = (g->n[a] + each - 1) / each * each;
    }
}

/* ---- writing ---- */

static bool same(const pov_vertex *a, const pov_vertex *b) { return memcmp(a->at, b->at, sizeof a->at) == 0; }

/* The two triangles of each cell, except those without an area. Returns how many. */
static int make_faces(const grid *g, const pov_vertex *v, int32_t (*face)[3])
{
    const int row = g->n[0] + 1, all = (g->n[1] + 1) * row;
    int n = 0;
    for (int part = 0; part < g->o->shape->ops->parts; part++)
        for (int j = 0; j < g->n[1]; j++)
            for (int i = 0; i < g->n[0]; i++) {
                const int a = part * all + j * row + i;
                const int corner[2][3] = {{a, a + 1, a + row + 1}, {a, a + row + 1, a + row}};
                for (int k = 0; k < 2; k++) {
                    const int *c = corner[k];
                    if (same(&v[c[0]], &v[c[1]]) || same(&v[c[1]], &v[c[2]]) || same(&v[c[2]], &v[c[0]]))
                        continue;
                    memcpy(face[n++], c, sizeof *face);
                }
            }
    return n;
}

bool pov_patch(pov_text *t, const scene *s, const pov_options *how, const object *o)
{
    grid g = {.s = s, .o = o, .rough = s->displaced && o->bump};
    if (!measure(&g))
        return false;
    if (g.rough && o->map.file)
        fit_map(&g);
    const int row = g.n[0] + 1, all = (g.n[1] + 1) * row, parts = o->shape->ops->parts;
    memory *m = progress_memory(how->progress);
    pov_vertex *v = memory_new(m, sizeof *v * (size_t)all * (size_t)parts);
    int32_t(*face)[3] = memory_new(m, sizeof *face * 2 * (size_t)g.n[0] * (size_t)g.n[1] * (size_t)parts);
    const bool good = v && face;
    for (int part = 0; good && part < parts; part++)
        for (int j = 0; j <= g.n[1]; j++)
            evaluate(&g, part, j, v + part * all + j * row);
    if (good) {
        const int n = make_faces(&g, v, face);
        pov_print(t, "// a mesh made for %d x %d pixels: %d x %d cells%s\n", s->width, s->height, g.n[0], g.n[1],
                  parts > 1 ? " a part" : "");
        pov_mesh2(t, v, all * parts, pov_by_uv(s, o), n, (const int32_t(*)[3])face);
    }
    memory_free(face);
    memory_free(v);
    return good;
}
