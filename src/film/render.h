/* Rendering: the picture in tiles, on several threads; one wave for each tile and sample. */
#ifndef KAGE_FILM_RENDER_H
#define KAGE_FILM_RENDER_H

#include "film/film.h"
#include "render/stats.h"
#include "render/workspace.h"

typedef struct render_options {
    int aa;                   /* aa x aa samples a pixel */
    double threshold;         /* >= 0: only where neighbours differ by more (adaptive.h), elsewhere one sample */
    int threads;              /* 0: as many as there are processors */
    bool timing;              /* time the stages, in one tile of TIMED_TILES */
    const progress *progress; /* called in the caller's thread; may end the render; NULL: none */
} render_options;

/* Render the part of the picture that is on the film. The result does not depend on the threads. The picture and the
 * visibilities are means over a pixel's samples; other layers are from the sample nearest to its middle. False with a
 * message: out of memory, or ended by o->progress. */
bool render(const tracer *tr, const render_options *o, film *f, stats *sum, errors *e);

#endif
