/* Meshes from files, smooth or displaced, as one mesh2; equal vertices are written once. A displaced triangle becomes
 * n x n triangles with the displaced surface's normals; n is the same for all, so that there are no gaps.
 */
#include "povray/parts.h"

#include "displaced/prism.h"
#include "tessellate/vertices.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_TRIANGLES = 1500000, FINEST = 800 };

#define FINE 1.0 /* a facet's longest side in pixels: it covers less than half a pixel */

typedef struct pile {
    pov_vertex *v;
    int32_t (*face)[3];
    int vertices, faces;
    int32_t *table; /* of vertices, -1: free; its size is a power of two */
    uint32_t size;
} pile;

static uint32_t hash_of(const pov_vertex *v)
{
    uint32_t word[sizeof *v / sizeof(uint32_t)], h = 2166136261u;
    memcpy(word, v, sizeof *v);
    for (size_t k = 0; k < sizeof word / sizeof *word; k++) {
        h = (h ^ word[k]) * 16777619u;
        h ^= h >> 15;
    }
    return h;
}

static int32_t index_of(pile *p, const pov_vertex *v)
{
    uint32_t k = hash_of(v) & (p->size - 1);
    while (p->table[k] >= 0 && memcmp(&p->v[p->table[k]], v, sizeof *v) != 0)
        k = (k + 1) & (p->size - 1);
    if (p->table[k] < 0) {
        p->v[p->vertices] = *v;
        p->table[k] = p->vertices++;
    }
    return p->table[k];
}

static bool begin(pile *p, int faces, memory *m)
{
    for (p->size = 16; p->size < 6 * (uint32_t)faces; p->size *= 2)
        ;
    p->v = memory_new(m, sizeof *p->v * 3 * (size_t)faces);
    p->face = memory_new(m, sizeof *p->face * (size_t)faces);
    p->table = memory_new(m, sizeof *p->table * p->size);
    if (p->table)
        memset(p->table, 0xff, sizeof *p->table * p->size);
    return p->v && p->face && p->table;
}

/* u, where mirrored, reflected back (texture/mirrored_uv.h). */
static double reflected(const mesh *f, double u)
{
    const double fold = 2 * f->u[1] - f->u[0];
    return u > fold ? 2 * fold - u : u;
}

static void add_smooth(pile *p, const mesh *f)
{
    for (int k = 0; k < f->d.n; k++)
        for (int i = 0; i < 3; i++) {
            pov_vertex v;
            memcpy(v.at, f->d.at[k][i], sizeof v.at);
            memcpy(v.normal, f->d.skin[k].normal[i], sizeof v.normal);
            v.uv[0] = (float)reflected(f, (double)f->d.skin[k].uv[i][0]);
            v.uv[1] = f->d.skin[k].uv[i][1];
            p->face[k][i] = index_of(p, &v);
        }
    p->faces = f->d.n;
}

/* ---- displaced ---- */

/* The longest side of a triangle in pixels; 0 if it is behind the eye. */
static double pixels_of(const scene *s, const mesh_triangle *x)
{
    const camera *c = &s->camera;
    double side = 0;
    for (int i = 0; i < 3; i++)
        side = fmax(side, vec3_length(vec3_sub(x->at[(i + 1) % 3], x->at[i])));
    const vec3 middle = vec3_scale(vec3_add(x->at[0], vec3_add(x->at[1], x->at[2])), 1.0 / 3);
    const double depth = c->orthographic ? 1 : vec3_dot(vec3_sub(middle, c->from), c->forward);
    return depth > 0 ? side / fmax(depth, 0.5 * side) * s->width / (2 * vec3_length(c->right)) : 0;
}

static int division_of(const scene *s, const mesh *f)
{
    double most = 1;
    for (int k = 0; k < f->d.n; k++) {
        const mesh_triangle x = mesh_triangle_of(f, k);
        most = fmax(most, pixels_of(s, &x) / FINE);
    }
    const double room = sqrt((double)MOST_TRIANGLES / f->d.n);
    return (int)fmax(1, fmin(fmin(ceil(most), floor(room)), FINEST));
}

/* The index of the first place in row j of the lattice on a triangle. Row j has n - j + 1 places. */
static int row_start(int n, int j) { return j * (n + 1) - j * (j - 1) / 2; }

static pov_vertex rough_vertex(const mesh *f, const mesh_triangle *x, real u, real w, real P, real Pu, real Pw)
{
    double b, c;
    vec3 gu, gw;
    mesh_shares(x, (double)u, (double)w, &b, &c);
    const prism_point p = prism_at(x, b, c, (double)P);
    prism_gradients(x, &p, vec3_dot(vec3_cross(p.Xb, p.Xc), p.N), &gu, &gw);
    const vec3 n = vec3_sub(p.N, vec3_add(vec3_scale(gu, (double)Pu), vec3_scale(gw, (double)Pw)));
    return pov_vertex_of(p.place, vec3_unit(n), reflected(f, (double)u), (double)w);
}

/* Evaluate all places of the lattice on a triangle, LANES at a time. */
static void rough_places(const object *o, const mesh *f, int index, int n, pov_vertex *out)
{
    const mesh_triangle x = mesh_triangle_of(f, index);
    real u[LANES], w[LANES];
    int lane = 0;
    for (int j = 0; j <= n; j++)
        for (int i = 0; i <= n - j; i++) {
            const double b = (double)i / n, c = (double)j / n;
            bump_values h;
            u[lane] = (real)(x.u[0] + b * (x.u[1] - x.u[0]) + c * (x.u[2] - x.u[0]));
            w[lane++] = (real)(x.w[0] + b * (x.w[1] - x.w[0]) + c * (x.w[2] - x.w[0]));
            if (lane < LANES && j < n)
                continue;
            o->bump->ops->eval(o->bump, lane, u, w, 1, &h);
            for (int k = 0; k < lane; k++)
                *out++ = rough_vertex(f, &x, u[k], w[k], h.P[k], h.Pu[k], h.Pw[k]);
            lane = 0;
        }
}

static void add_face(pile *p, const pov_vertex *a, const pov_vertex *b, const pov_vertex *c)
{
    int32_t *face = p->face[p->faces++];
    face[0] = index_of(p, a);
    face[1] = index_of(p, b);
    face[2] = index_of(p, c);
}

static bool add_rough(pile *p, const object *o, const mesh *f, int n)
{
    pov_vertex *v = malloc(sizeof *v * (size_t)row_start(n, n + 1));
    for (int k = 0; v && k < f->d.n; k++) {
        rough_places(o, f, k, n, v);
        for (int j = 0; j < n; j++)
            for (int i = 0; i < n - j; i++) {
                const pov_vertex *low = &v[row_start(n, j) + i], *high = &v[row_start(n, j + 1) + i];
                add_face(p, low, low + 1, high);
                if (i < n - j - 1)
                    add_face(p, low + 1, high + 1, high);
            }
    }
    free(v);
    return v;
}

bool pov_triangle_mesh(pov_text *t, const scene *s, const pov_options *how, const object *o)
{
    const bool rough = s->displaced && o->bump;
    const mesh *f = (const mesh *)(rough ? o->shape : o->own);
    const int n = rough ? division_of(s, f) : 1;
    pile p = {0};
    bool good = begin(&p, f->d.n * n * n, progress_memory(how->progress));
    if (good && rough)
        good = add_rough(&p, o, f, n);
    else if (good)
        add_smooth(&p, f);
    if (good) {
        pov_print(t, "// the triangles of %s", o->shape_spec.file);
        if (rough)
            pov_print(t, ", each in %d x %d for %d x %d pixels", n, n, s->width, s->height);
        pov_print(t, "\n");
        pov_mesh2(t, p.v, p.vertices, pov_by_uv(s, o), p.faces, (const int32_t(*)[3])p.face);
    }
    memory_free(p.v);
    memory_free(p.face);
    memory_free(p.table);
    if (good && o->moved && !rough)
        pov_matrix(t, o->placed.x, o->placed.y, o->placed.z, o->placed.o, " // its transform\n");
    return good;
}
