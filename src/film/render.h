/* Rendering: the picture in tiles, one wave a tile and sample, on all threads. */
#ifndef KAGE_FILM_RENDER_H
#define KAGE_FILM_RENDER_H

#include "film/film.h"
#include "render/stats.h"
#include "render/workspace.h"

typedef struct render_options {
    int aa;           /* aa x aa samples a pixel, */
    double threshold; /* of those that differ from a neighbour by more than this (adaptive.h), and one of the others; <
                         0: of all */
    int threads;      /* 0: as many as there are processors */
    bool timing;      /* time the stages, in one tile of TIMED_TILES */
    const progress *progress; /* called now and then in the caller's thread; may end the render; NULL: nobody */
} render_options;

/* Render the part of the picture that is on the film; the layers too where the film has them. The bytes do not depend
 * on the threads. The picture and the visibilities are means over the samples of a pixel, the other layers are those of
 * the sample next to its middle (with a threshold: in its middle). False with a message: out of
 * memory, or ended by o->progress. */
bool render(const tracer *tr, const render_options *o, film *f, stats *sum, errors *e);

#endif
