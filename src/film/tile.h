/* A tile of the picture: what one thread renders at a time, one wave for each sample of its pixels. */
#ifndef KAGE_FILM_TILE_H
#define KAGE_FILM_TILE_H

#include "film/film.h"
#include "render/trace.h"

enum { TILE = 16, TILE_ROWS = LANES / TILE }; /* pixels; less at the picture's right and lower edges */

typedef struct tile {
    int x0, y0, width, height;
} tile;

/* Render it with aa x aa samples a pixel. Where v's pulse says so, it ends soon and what is on the film is not used. */
void tile_render(const tracer *tr, int aa, const tile *b, film *f, workspace *v);

/* Render the marked pixels again with aa x aa samples each, which fill waves pixel by pixel. A pixel adds its samples
 * in the same order as in tile_render, so the result has the same bytes. */
void tile_refine(const tracer *tr, int aa, const tile *b, const unsigned char *marked, film *f, workspace *v);

#endif
