/* A file in colour where a grey one is wanted: whether its colours are all grey. */
#ifndef KAGE_IMAGE_GREY_H
#define KAGE_IMAGE_GREY_H

#include <stdbool.h>
#include <stdint.h>

/* What is found in such a file. Zero-initialise. */
typedef struct grey_colours {
    int64_t pixels, unequal, units; /* unequal: red, green and blue differ; units: as 2 c - 1 they are a unit vector */
    double sum[3];                  /* of each, 0..1 */
} grey_colours;

/* n pixels of red, green and blue: note them, and keep one of the three, in place. */
void grey_take(int n, float *v, grey_colours *c);

/* Whether all were grey, or there were none; if not, the reason goes to `why`. */
bool grey_found(const grey_colours *c, char *why);

#endif
