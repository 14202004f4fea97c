/* The vertices of meshes. Those of a displaced surface are on a lattice of (u,w), each made once: X = Q + P n/|n| with
 * the displaced surface's normal. Private to the POV-Ray writer. */
#ifndef KAGE_TESSELLATE_VERTICES_H
#define KAGE_TESSELLATE_VERTICES_H

#include <stdbool.h>
#include <stdint.h>

#include "texture/bump.h"
#include "pov_text/text.h"
#include "geometry/surface.h"

enum { LATTICE = 16 }; /* places along a cell's side */

/* A lattice over part of a surface: line i at start + i step, and no farther than lo and hi. */
typedef struct pov_lattice {
    int part;
    double start[2], step[2], lo[2], hi[2]; /* in u and in w */
} pov_lattice;

/* u (axis 0) or w (axis 1) of place s of LATTICE in cell i. */
double pov_lattice_at(const pov_lattice *l, int axis, int64_t i, int s);

typedef struct pov_vertex {
    float at[3], normal[3], uv[2];
} pov_vertex;

/* A mesh2 of n vertices, where `uv` with their (u,w), and of triangles between them; its brace stays open. */
void pov_mesh2(pov_text *t, const pov_vertex *v, int n, bool uv, int faces, const int32_t (*face)[3]);

typedef struct pov_vertices {
    const surface *f;
    const bump *P;
    pov_lattice lattice;
    pov_vertex *vertex;
    int64_t *key;
    int count, room;
    int32_t *slot; /* a hash table of numbers of vertices, -1: free */
    int slots;     /* a power of two, at least twice the count */
} pov_vertices;

/* The numbers of n <= (LATTICE + 1)^2 places, (cell i, place s) of both axes for each; new ones are evaluated together.
 * `fresh`: which were new. False: out of memory. */
bool pov_vertices_get(pov_vertices *v, int n, const int64_t (*cell)[2], const int (*place)[2], int32_t *number,
                      bool *fresh);

/* Forget all vertices, to start on another lattice. */
void pov_vertices_clear(pov_vertices *v);
void pov_vertices_free(pov_vertices *v);

#endif
