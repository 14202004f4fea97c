/* Lights, as POV-Ray 3.7 has them. */
#ifndef KAGE_SCENE_LIGHT_H
#define KAGE_SCENE_LIGHT_H

#include "base/real.h"
#include "base/vec3.h"

enum { LIGHT_MAX_SIDE = 64 }; /* samples along a side */

typedef enum light_kind { LIGHT_POINT, LIGHT_SPOT, LIGHT_PARALLEL } light_kind;

/* A parallel light shines along `axis` from the plane across it at `at`. */
typedef struct light {
    char *name;
    light_kind kind;
    vec3 at;
    vec3 color; /* linear */
    vec3 to;    /* spot and parallel: what it points at, */
    vec3 axis;  /* and the unit vector there */
    double radius, falloff,
        tightness; /* spot: full light up to `radius` degrees from the axis, none from `falloff` on */
    double fade_distance, fade_power; /* fade_distance 0: its light does not fade */
    vec3 u, w;                        /* the sides of its area, whose middle is `at`; without one: 0 */
    int samples[2];                   /* along them; 1 x 1 without an area */
} light;

/* The light as its sample k < samples[0] samples[1] has it, at a place of its own, and the share of the sample. */
light light_sample(const light *l, int k, real *share);

/* For exports: the ends of a light's area as seen from p; how many there are. */
int light_corners(const light *l);
vec3 light_corner(const light *l, int k, vec3 p);

#endif
