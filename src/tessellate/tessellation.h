/* Displaced objects as triangles. A part of the object has a lattice of cells. block.c finds where cells are on the
 * screen, cell_lines.c how finely each is divided, tessellate.c makes the triangles, and mesh_error.c measures their
 * error. The caller chooses the fineness (povray/displaced_mesh.c).
 */
#ifndef KAGE_TESSELLATE_TESSELLATION_H
#define KAGE_TESSELLATE_TESSELLATION_H

#include "tessellate/vertices.h"
#include "base/progress.h"
#include "scene/scene.h"

/* With so many triangles the file has 250 MB, and POV-Ray needs 1 GB and half a minute to read it. */
enum { MOST_TRIANGLES = 4000000, FUNCTION_CELLS = 256 };

#define FINE 1.0     /* a facet's side in pixels: the facet covers less than half a pixel */
#define JOIN 0.25    /* blocks below this many pixels become one cell */
#define BULGE 0.06   /* how far a curved cell reaches beyond its corners, in its sides: for 16 cells around */
#define EDGE_ON 0.05 /* a sine: a cell that is turned away by less may be partly in sight */

/* How fine a mesh is. */
typedef struct fineness {
    double tolerance; /* the largest side of a facet, in pixels */
    double tilt;      /* the largest error of its unit normals */
    double shape;     /* the largest error of heights in a cell that no pixel's ray meets, in sides of the cell */
    int level;        /* blocks of 2^level x 2^level cells become one cell */
    bool met;         /* only cells that a pixel's ray may meet need exact normals */
} fineness;

/* A mesh in the making. */
typedef struct tessellation {
    const scene *s;
    const object *o;
    pov_vertices v;
    int64_t first[2], end[2]; /* cells */
    fineness fine;
    double height, pixels; /* the largest error of heights in the picture, in scene units and in pixels */
    bool points;           /* all camera rays go through pixel centres */
    bool flat, unbounded;
    bool closed; /* the inside of the part is never seen */
    int32_t (*face)[3];
    long faces, room, before; /* before: faces of earlier parts */
    bool counting, measuring; /* only count the faces; only measure their error */
    bool full, memory;        /* full: too many faces; memory: false if it ran out, or is to stop */
    const progress *progress; /* asked now and then whether to stop; NULL: none */
    double share;             /* of the whole work, that it is told */
    long cells;               /* until now */
} tessellation;

/* ---- block.c: size x size cells from cell (i, j) on ---- */

typedef struct corners {
    vec3 Q[4], X[4], n; /* in order around the block, smooth and displaced; the smooth unit normal at the first */
    double P[4];
    double slope[4][2]; /* of P along u and along w */
} corners;

corners block_corners(const tessellation *x, int64_t i, int64_t j, int64_t size);

/* x and y on the screen, each in -1..1, times the depth; z is the depth, or 1 for an orthographic camera. */
vec3 block_project(const scene *s, vec3 p);

/* The sides of the picture that a place is outside of, as bits. */
int block_beyond(const scene *s, vec3 at);

/* The longest side in pixels; infinite if the block reaches behind the eye. */
double block_pixels(const tessellation *x, const corners *c);

/* The error if the block were two facets: of unit normals; of heights, in the block's sides. */
double block_tilt(const corners *c);
double block_twist(const corners *c);

/* Whether the block, or the shadow that it casts down to the lowest level of its plane, can be in the picture. */
bool block_seen(const tessellation *x, const corners *c);

/* Whether no pixel's ray meets the block, nor a block as large beside it, which it could shade. */
bool block_missed(const tessellation *x, const corners *c);

/* Whether the block is turned away so far that bumps cannot bring it into sight. */
bool block_turned(const tessellation *x, const corners *c);

/* ---- cell_lines.c ---- */

/* The lines that divide a cell, of LATTICE + 1 possible ones along u and along w. */
typedef struct lines {
    bool on[2][LATTICE + 1];
} lines;

/* The number of parts of each side of cell (i, j); 0: there is no such cell. The same for the cell and its
 * neighbours. */
int cell_division(const tessellation *x, int64_t i, int64_t j);

/* Add to *l: the lines of an even division into k parts; those of a cell that is fine only where rays meet it. */
void lines_every(lines *l, int k);
void lines_met(const tessellation *x, const corners *c, lines *l);

/* ---- mesh_error.c: raise x->height and x->pixels to the errors of a block ---- */
void tessellation_measure(tessellation *x, int64_t i, int64_t j, int64_t size, const lines *l);

/* ---- tessellate.c: make the faces of a part; or count or measure them, if x->counting or x->measuring ---- */
void tessellate(tessellation *x, int part);

#endif
