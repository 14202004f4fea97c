/* Finds the pixels that need more samples: those that differ from a neighbour. */
#ifndef KAGE_FILM_ADAPTIVE_H
#define KAGE_FILM_ADAPTIVE_H

#include "film/film.h"

/* For each pixel of `part`, row by row: 1 where it and a neighbour (left, right, above or below, within the film)
 * differ by more than `threshold`, 0 elsewhere. The difference is the sum over red, green and blue, each 0..1 as
 * displayed (sRGB, 16 bits). The caller frees it. NULL with a message: out of memory. threads: 0 for one a
 * processor; the result does not depend on it. */
unsigned char *adaptive_find(const film *f, window part, double threshold, int threads, memory *m, errors *e);

#endif
