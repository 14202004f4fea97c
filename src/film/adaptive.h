/* Where a picture needs more samples: beside a pixel that looks different. */
#ifndef KAGE_FILM_ADAPTIVE_H
#define KAGE_FILM_ADAPTIVE_H

#include "film/film.h"

/* For each pixel of `part`, row by row: 1 where it and a neighbour (left, right, above or below, within the film)
 * differ by more than `threshold`, 0 elsewhere. The difference is the sum over red, green and blue, each 0..1 as
 * displayed (sRGB, 16 bits). free() it. NULL with a message: out of memory. The bytes do not depend on the threads (0:
 * as many as there are processors). */
unsigned char *adaptive_find(const film *f, window part, double threshold, int threads, errors *e);

#endif
