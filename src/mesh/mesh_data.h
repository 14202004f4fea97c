/* A mesh as plain arrays of triangles, from the file (import/assimp.c, load.c) through the checks (clean.c) to the
 * surface (mesh.h).
 *
 * Coordinates are kage's, left-handed; a triangle's corners follow each other so that (b - a) x (c - a) points outward.
 */
#ifndef KAGE_MESH_MESH_DATA_H
#define KAGE_MESH_MESH_DATA_H

#include <stdbool.h>
#include <stdint.h>

#include "base/files.h"
#include "base/progress.h"
#include "base/vec3.h"

enum {
    MESH_MOST = 1 << 24, /* triangles; more are refused */
    MESH_WHY = 400,      /* bytes of a message */
    MESH_PART_NAME = 128,
};

/* What shading needs of a triangle; intersection needs only its corners. */
typedef struct mesh_skin {
    float normal[3][3]; /* of each corner, a unit vector; 0: none in the file */
    float uv[3][2];     /* NaN: none in the file */
} mesh_skin;

/* How often something was found in a file, and changed. */
typedef struct mesh_notes {
    int flat;   /* triangles without an area, removed */
    int turned; /* triangles flipped, as all three normals were on the other side */
    int bent;   /* corners whose normal faced away from the triangle; now it is the triangle's own */
    int bare;   /* triangles without texture coordinates */
    int folded; /* triangles whose texture is mirrored */
    int spread; /* triangles on which the texture has no area */
} mesh_notes;

/* A model's part: the triangles of one node and material, which follow each other. */
typedef struct mesh_part {
    char name[MESH_PART_NAME];
    int first, n; /* triangles */
} mesh_part;

typedef struct mesh_data {
    int n;             /* triangles */
    float (*at)[3][3]; /* the corners of each, in scene units; owned, as all here: memory_free */
    mesh_skin *skin;   /* of each; owned */
    mesh_notes notes;
    mesh_part *part; /* owned; NULL once the triangles are changed */
    int parts;
} mesh_data;

/* A vertex or a normal as a vector in double, and back. */
static inline vec3 mesh_get(const float v[3]) { return (vec3){(double)v[0], (double)v[1], (double)v[2]}; }
static inline void mesh_set(float to[3], vec3 v)
{
    to[0] = (float)v.x;
    to[1] = (float)v.y;
    to[2] = (float)v.z;
}

/* A model in memory, which means what a file means: right-handed, v upward. normals, uvs: NULL: none. */
typedef struct mesh_array {
    int vertices, triangles;
    const double *positions, *normals, *uvs; /* 3, 3 and 2 numbers a vertex */
    const uint32_t *corners;                 /* 3 a triangle */
} mesh_array;

/* Its triangles. w: what their memory is taken from, as below; NULL: no limit. False, with the reason in one line.
 * (array.c) */
bool mesh_array_read(const mesh_array *a, const progress *w, mesh_data *out, char why[MESH_WHY]);

/* Free the arrays and empty *d. */
void mesh_data_free(mesh_data *d);

typedef enum mesh_normals { MESH_NORMALS_FILE, MESH_NORMALS_SMOOTH, MESH_NORMALS_FLAT } mesh_normals;

/* Read a model with the program `reader`; NULL: the one that reader.c finds. The model's file and those that it refers
 * to are added to *opened. False, with the reason in one line. Reentrant. */
bool mesh_file_read(const char *path, const char *reader, const progress *w, files *opened, mesh_data *out,
                    char why[MESH_WHY]);

/* The triangles of one part; the result is the caller's. False, with the reason: no such part, or out of memory. */
bool mesh_data_part(const mesh_data *d, const char *name, const progress *w, mesh_data *out, char why[MESH_WHY]);

/* Say in `why` that there is not enough memory, and what is needed. Always false. (array.c) */
bool mesh_refuse_memory(const progress *w, char why[MESH_WHY]);

/* Whether a model may have so many triangles. False, with the reason. (array.c) */
bool mesh_count_is_good(int triangles, const progress *w, char why[MESH_WHY]);

/* Check the numbers, remove triangles without an area, and find a normal for every corner: the file's where it is
 * usable, otherwise the mean over the triangles about the vertex that are within `crease` degrees of this one. False,
 * with the reason: a coordinate beyond `most`, no triangle left, or out of memory. The result does not depend on the
 * threads, 0: one for each processor. (clean.c) */
bool mesh_clean(mesh_data *d, mesh_normals normals, double crease, double most, int threads, const progress *w,
                char why[MESH_WHY]);

#endif
