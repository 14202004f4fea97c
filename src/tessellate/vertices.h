/* Vertices of meshes, written as a mesh2. Those of a displaced surface are on a lattice of (u,w), each evaluated once:
 * X = Q + P n/|n| with the displaced surface's normal. */
#ifndef KAGE_TESSELLATE_VERTICES_H
#define KAGE_TESSELLATE_VERTICES_H

#include <stdbool.h>
#include <stdint.h>

#include "base/memory.h"
#include "texture/bump.h"
#include "pov_text/text.h"
#include "geometry/surface.h"

enum { LATTICE = 16 }; /* places along a cell's side */

/* Lines of u and of w over a part of a surface: line i is at start + i step, clamped to lo and hi. */
typedef struct pov_lattice {
    int part;
    double start[2], step[2], lo[2], hi[2]; /* in u and in w */
} pov_lattice;

/* u (axis 0) or w (axis 1) at s/LATTICE of the way through cell i. */
double pov_lattice_at(const pov_lattice *l, int axis, int64_t i, int s);

typedef struct pov_vertex {
    float at[3], normal[3], uv[2];
} pov_vertex;

pov_vertex pov_vertex_of(vec3 at, vec3 normal, double u, double w);

/* Write a mesh2 of n vertices, with (u,w) if `uv`, and of triangles between them. Its brace stays open. */
void pov_mesh2(pov_text *t, const pov_vertex *v, int n, bool uv, int faces, const int32_t (*face)[3]);

typedef struct pov_vertices {
    const surface *f;
    const bump *P;
    memory *memory; /* NULL: no limit */
    pov_lattice lattice;
    pov_vertex *vertex;
    int64_t *key;
    int count, room;
    int32_t *slot; /* a hash table of indices of vertices, -1: free */
    int slots;     /* a power of two, at least twice the count */
} pov_vertices;

/* The indices of n <= (LATTICE + 1)^2 vertices, each at a place of a cell along u and w, as in pov_lattice_at. New
 * vertices are evaluated together; fresh[i]: vertex i is new. False: out of memory. */
bool pov_vertices_get(pov_vertices *v, int n, const int64_t (*cell)[2], const int (*place)[2], int32_t *number,
                      bool *fresh);

/* Remove all vertices, before the lattice changes. */
void pov_vertices_clear(pov_vertices *v);
void pov_vertices_free(pov_vertices *v);

#endif
