/* What the files of displaced meshes share: a lattice of cells over a part of the object, and how finely each cell is
 * divided. block.c, cell_lines.c and mesh_error.c look at cells; tessellate.c makes the quads; displaced_mesh.c chooses
 * how fine all is and writes. Private to these.
 */
#ifndef KAGE_TESSELLATE_TESSELLATION_H
#define KAGE_TESSELLATE_TESSELLATION_H

#include "tessellate/vertices.h"
#include "scene/scene.h"

/* POV-Ray takes 1 GB and half a minute to read so many, and the file has 250 MB. */
enum { MOST_TRIANGLES = 4000000, FUNCTION_CELLS = 256 };

#define FINE 1.0     /* a facet's side in pixels: it covers less than half a pixel */
#define JOIN 0.25    /* cells are joined while the block is smaller, in pixels */
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

/* A mesh in the making. */
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

/* ---- block.c: size x size cells from cell (i, j) on ---- */

typedef struct corners {
    vec3 Q[4], X[4], n; /* around the block, smooth and rough; n unit, in the first one */
    double P[4];
    double slope[4][2]; /* of P, along u and along w */
} corners;

corners block_corners(const tessellation *x, int64_t i, int64_t j, int64_t size);

/* Depth along the view, and places on the screen times depth; orthographic, as for depth 1. */
vec3 block_project(const scene *s, vec3 p);

/* Which sides of the picture a place is beyond, as bits. */
int block_beyond(const scene *s, vec3 at);

/* The longest side in pixels; infinite where the block reaches behind the eye. */
double block_pixels(const tessellation *x, const corners *c);

/* How far the normals, and the heights in the block's sides, of two facets are off that are the whole block. */
double block_tilt(const corners *c);
double block_twist(const corners *c);

/* Whether the block, or the shadow that it casts, can be in the picture; whether no pixel's ray meets it; whether it is
 * turned away beyond what bumps bring into sight. */
bool block_seen(const tessellation *x, const corners *c);
bool block_missed(const tessellation *x, const corners *c);
bool block_turned(const tessellation *x, const corners *c);

/* ---- cell_lines.c ---- */

/* Of the LATTICE + 1 lines that a cell can be divided by, those that it is, along u and along w. */
typedef struct lines {
    bool on[2][LATTICE + 1];
} lines;

/* Into how many parts each side of a cell is divided: 0 where there is no cell. Depends on nothing else, so that a
 * neighbour finds the same. */
int cell_division(const tessellation *x, int64_t i, int64_t j);

/* The lines of an even division into k parts; of a cell that is fine only where pixels' rays meet it. Add to *l. */
void lines_every(lines *l, int k);
void lines_met(const tessellation *x, const corners *c, lines *l);

/* ---- mesh_error.c: note in x->height and x->pixels what heights are off ---- */
void tessellation_measure(tessellation *x, int64_t i, int64_t j, int64_t size, const lines *l);

/* ---- tessellate.c: make, count or measure the faces of a part, as x says ---- */
void tessellate(tessellation *x, int part);

#endif
