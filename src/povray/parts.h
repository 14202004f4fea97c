/* What the parts of the POV-Ray writer share. Private to pov_*.c. */
#ifndef KAGE_POVRAY_PARTS_H
#define KAGE_POVRAY_PARTS_H

#include "patch/surface.h"
#include "povray/povray.h"
#include "povray/text.h"

/* A flat surface in a frame of its own: Q = O + u U + w W; x runs along U, z along W, both in scene units, and y is the
 * height over it, so that U and W need not be at a right angle. */
typedef struct pov_flat {
    vec3 O, U, W;
    vec3 x, y, z; /* unit */
} pov_flat;

pov_flat pov_flat_of(const object *o, int part); /* in the scene */

/* Whether part of a shape is flat. */
bool pov_is_flat(const shape_spec *f, int part);

/* What the object's transform makes of lengths: 1 where it has none, 0 where not all grow alike. */
double pov_scale(const object *o);

/* Whether u runs the other way (surface_transformed); u of what turns about y, as a function of x and z. */
bool pov_mirrored(const object *o);
const char *pov_around(const object *o);

/* The shape before its transform, but for the size. */
shape_spec pov_sized(const object *o);

/* The radius of a disc, or of a flat part that is one; in units of u and w; it may be 0, and then there is no such
 * part. Negative: no disc. */
double pov_rim(const shape_spec *f, int part);

/* Of an object's displaced disc, which is made as a square, leave what is on the disc. */
void pov_clip_rim(pov_text *t, const object *o, int part);

/* P's range with some air: a container must hold all of the surface. */
void pov_levels(const object *o, double y[2]);

/* The part of an unbounded plane that matters for the picture, as ranges of u and w: what the camera sees of the rough
 * surface, and what of it can shade that. */
void pov_plane_region(const scene *s, const object *o, double u[2], double w[2]);

/* The name of a thing of the scene as an identifier of POV-Ray, which has no '-'; `index` keeps a-b and a_b apart. */
typedef struct pov_identifier {
    char text[96];
} pov_identifier;

pov_identifier pov_identify(const char *kind, const char *name, int index);

/* Whether an object is made by pov_patch: POV-Ray has no shape for it, or none for its displacement. */
static inline bool pov_is_sheet(const scene *s, const object *o)
{
    const shape_kind kind = o->shape_spec.kind;
    return kind == SHAPE_PATCH || (s->displaced && patch_surface_is(o->shape));
}

/* All materials; and that of an object, on a part of its surface. pov_by_parts: each part has its own; pov_by_uv: its
 * mesh must say where in (u,w) vertices are. */
void pov_materials(pov_text *t, const scene *s);
void pov_texture(pov_text *t, const scene *s, const object *o, int part);
bool pov_by_parts(const scene *s, const object *o);
bool pov_by_uv(const scene *s, const object *o);

/* P as a POV-Ray function of u and w, named by `name`. False where there is none. */
bool pov_function(pov_text *t, const object *o, const char *name);

/* The displaced object as isosurfaces that call the function `name`. pov_isosurface_gradient: the bound of its
 * gradient, infinite where none is known or none serves. */
double pov_isosurface_gradient(const object *o, int part);
void pov_isosurface(pov_text *t, const scene *s, const object *o, const char *name);

/* The displaced object as one mesh. False: out of memory. */
bool pov_mesh(pov_text *t, const scene *s, const object *o, pov_report *report);

/* An object without a shape of POV-Ray's, smooth or displaced as the scene says, as one mesh. False: out of memory. */
bool pov_patch(pov_text *t, const scene *s, const object *o);

/* A mesh from a file likewise. */
bool pov_triangle_mesh(pov_text *t, const scene *s, const object *o);

/* A transformation that puts x, y, z and 0 where these are; without a new line. */
void pov_matrix(pov_text *t, vec3 x, vec3 y, vec3 z, vec3 origin);

/* The end of an object: its material, its shadow, the brace. */
void pov_object_end(pov_text *t, const scene *s, const pov_options *how, const object *o);

#endif
