/* The picture and its layers, in memory. */
#ifndef KAGE_FILM_FILM_H
#define KAGE_FILM_FILM_H

#include "base/errors.h"
#include "image/image.h"
#include "scene/scene.h"

/* Planes of a film. From FILM_LIGHTS on: the visibility of each light, 0..1. */
enum film_plane {
    FILM_R,
    FILM_G,
    FILM_B,
    FILM_PICTURE, /* the planes of the picture alone */
    FILM_Z = FILM_PICTURE,
    FILM_PX,
    FILM_PY,
    FILM_PZ,
    FILM_NX,
    FILM_NY,
    FILM_NZ,
    FILM_U,
    FILM_W,
    FILM_HEIGHT,
    FILM_TAU,
    FILM_ORDER,
    FILM_LIGHTS
};

/* A part of the picture: pixels x0 <= x < x1, y0 <= y < y1. */
typedef struct window {
    int x0, y0, x1, y1;
} window;

typedef struct film {
    window part;   /* of the picture that is on the film */
    int planes;    /* FILM_PICTURE, or FILM_LIGHTS + lights */
    float **plane; /* each (y1 - y0) x (x1 - x0), row by row from the top */
    char **name;   /* of each plane, as OpenEXR's users know them */
} film;

/* NULL: out of memory, with a message. */
film *film_new(const scene *s, window part, bool layers, errors *e);

/* The values of `from`, which has the same planes, and all of the part of f. */
void film_copy(film *f, const film *from);

void film_free(film *f);

#endif
