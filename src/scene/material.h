/* Materials: colour, POV-Ray's finish, and the weights of secondary rays. */
#ifndef KAGE_SCENE_MATERIAL_H
#define KAGE_SCENE_MATERIAL_H

#include <stdbool.h>

#include "base/vec3.h"
#include "texture/color.h"

/* How a colour varies over (u,w). */
typedef enum pattern { PATTERN_NONE, PATTERN_CHECKER, PATTERN_IMAGE } pattern;

/* POV-Ray's finish: ambient and diffuse light on the colour, and two kinds of highlight in the light's colour. */
typedef struct material {
    char *name;
    vec3 color;                /* linear */
    pattern pattern;           /* none: constant; otherwise object.color has it */
    vec3 field[2];             /* the two colours of a checker */
    map_layout layout;         /* of a checker; of an image only the wrap, as the rest depends on the surface */
    texels *texels;            /* of an image, shared by the objects */
    char *file;                /* the image, as the scene names it */
    bool exr, linear, nearest; /* an EXR; a PNG read as linear; no interpolation */
    double ambient, diffuse;
    double phong, phong_size;
    double specular, roughness;
    vec3 reflection;         /* the weight of the mirrored ray */
    double filter, transmit; /* weights of light from behind: times the material's colour; unchanged */
    double ior;              /* index of refraction */
} material;

/* Whether it is transparent. */
static inline bool material_clear(const material *m) { return m->filter + m->transmit > 0; }

/* The share of ambient and diffuse light, 0..1. */
static inline double material_opacity(const material *m) { return 1 - m->filter - m->transmit; }

static inline bool material_mirrors(const material *m)
{
    return m->reflection.x + m->reflection.y + m->reflection.z > 0;
}

/* Whether it has secondary rays. */
static inline bool material_sends(const material *m) { return material_clear(m) || material_mirrors(m); }

#endif
