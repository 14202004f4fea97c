/* Point, spot, parallel and area lights, as in POV-Ray 3.7. */
#ifndef KAGE_SCENE_LIGHT_H
#define KAGE_SCENE_LIGHT_H

#include "base/real.h"
#include "base/vec3.h"

enum { LIGHT_MAX_SIDE = 64 }; /* samples along a side */

typedef enum light_kind { LIGHT_POINT, LIGHT_SPOT, LIGHT_PARALLEL } light_kind;

/* A parallel light shines along `axis`, from the plane through `at` perpendicular to it. */
typedef struct light {
    char *name;
    light_kind kind;
    vec3 at;
    vec3 color;             /* linear */
    vec3 to;                /* spot and parallel: the point it is aimed at */
    vec3 axis;              /* and the unit vector towards it */
    double radius, falloff; /* spot: full light up to `radius` degrees from the axis, none from `falloff` on */
    double tightness;       /* spot: the power of the cosine */
    double fade_distance, fade_power; /* fade_distance 0: no fading with distance */
    vec3 u, w;                        /* the sides of an area light, whose middle is `at`; otherwise 0 */
    int samples[2];                   /* along them; 1 x 1 without an area */
} light;

/* Sample k < samples[0] samples[1] of an area light, as a light at one point, and its weight in *share, 0..1. */
light light_sample(const light *l, int k, real *share);

/* For exports: the number of corners of the light's area (1 without one), and corner k as seen from p. */
int light_corners(const light *l);
vec3 light_corner(const light *l, int k, vec3 p);

#endif
