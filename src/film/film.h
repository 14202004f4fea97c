/* The picture and its layers in memory. */
#ifndef KAGE_FILM_FILM_H
#define KAGE_FILM_FILM_H

#include "base/errors.h"
#include "image/image.h"
#include "scene/scene.h"

/* The planes of a film, by index: R G B, the layers from Z to order, and the visibility, 0..1, of each light. */
enum film_plane {
    FILM_R,
    FILM_G,
    FILM_B,
    FILM_PICTURE, /* the number of planes without layers */
    FILM_Z = FILM_PICTURE,
    FILM_ORDER = FILM_Z + 11,
    FILM_LIGHTS
};

/* A part of the picture: pixels x0 <= x < x1, y0 <= y < y1. */
typedef struct window {
    int x0, y0, x1, y1;
} window;

typedef struct film {
    window part;   /* the part of the picture that is on the film */
    int planes;    /* FILM_PICTURE, or FILM_LIGHTS + lights */
    float *memory; /* of all planes, one after another at equal distances */
    size_t room;   /* of the memory, in values */
    float **plane; /* each (y1 - y0) x (x1 - x0), row by row from the top */
    char **name;   /* of each plane: its channel in an OpenEXR file */
} film;

/* The number of pixels in a row, and the index of pixel x, y of the picture. */
static inline size_t film_width(const film *f) { return (size_t)(f->part.x1 - f->part.x0); }
static inline size_t film_index(const film *f, int x, int y)
{
    return (size_t)(y - f->part.y0) * film_width(f) + (size_t)(x - f->part.x0);
}

/* A film whose memory several threads have touched (0: all processors); its values are for a render to set. spare, or
 * NULL: a film whose memory it takes where that is large enough. m: what memory is taken from; NULL: no limit. NULL:
 * out of memory, with a message. */
film *film_new(const scene *s, window part, bool layers, int threads, film *spare, memory *m, errors *e);

/* Move the film down to the rows y0 to y1 of the picture, at most as many as it was made for. */
void film_move(film *f, int y0, int y1);

/* Copy f's pixels from a film with the same planes that contains f's part. */
void film_copy(film *f, const film *from);

void film_free(film *f);

#endif
