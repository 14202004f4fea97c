/* Materials: colour, POV-Ray's finish, and what they do to rays that go on. */
#ifndef KAGE_SCENE_MATERIAL_H
#define KAGE_SCENE_MATERIAL_H

#include <stdbool.h>

#include "base/vec3.h"
#include "texture/color.h"

/* What a colour is made of. */
typedef enum pattern { PATTERN_NONE, PATTERN_CHECKER, PATTERN_IMAGE } pattern;

/* POV-Ray's finish: ambient and diffuse light on the colour, and two kinds of highlight in the light's colour. */
typedef struct material {
    char *name;
    vec3 color;        /* linear */
    pattern pattern;   /* none: the colour is the same everywhere; otherwise it is the object's */
    vec3 field[2];     /* of a checker */
    map_layout layout; /* of the checker's fields; of an image the wrap alone, as the rest depends on the surface */
    texels *texels;    /* of an image, shared by the objects */
    char *file;        /* the image as the file said it, */
    bool exr, linear, nearest; /* its kind; a PNG taken for linear; without interpolation */
    double ambient, diffuse;
    double phong, phong_size;
    double specular, roughness;
    vec3 reflection;         /* of the light from the mirrored direction */
    double filter, transmit; /* of the light from behind, in the material's colour and in its own */
    double ior;
} material;

/* Whether light comes from behind; the share of ambient and diffuse light that is left; whether rays go on from here.
 */
static inline bool material_clear(const material *m) { return m->filter + m->transmit > 0; }
static inline double material_opacity(const material *m) { return 1 - m->filter - m->transmit; }
static inline bool material_mirrors(const material *m)
{
    return m->reflection.x + m->reflection.y + m->reflection.z > 0;
}
static inline bool material_sends(const material *m) { return material_clear(m) || material_mirrors(m); }

#endif
