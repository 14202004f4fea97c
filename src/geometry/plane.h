/* The struct of planes, rectangles and discs, for surfaces that contain some. Private to geometry. */
#ifndef KAGE_GEOMETRY_PLANE_H
#define KAGE_GEOMETRY_PLANE_H

#include "geometry/surface.h"

/* Q(u,w) = O + u U + w W. */
typedef struct plane {
    surface base;
    real O[3], U[3], W[3];
    real N[3];         /* U x W, unit */
    real Du[3], Dw[3]; /* the dual basis: Du.U = 1, Du.W = 0; so u = Du.(p - O) */
    real R;            /* the radius of a disc */
} plane;

/* Place *f; its methods and its radius stay. False where U and W are parallel, zero or not finite. */
bool plane_place(plane *f, vec3 origin, vec3 U, vec3 W);

/* Make *f a rectangle, to be placed by plane_place. */
void rectangle_set(plane *f);

/* Make *f a disc; U and W as disc_new says. */
void disc_set(plane *f, vec3 centre, vec3 U, vec3 W, double radius);

#endif
