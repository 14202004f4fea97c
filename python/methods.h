/* The functions of bumpshadow.h in loops over arrays: what kage.methods calls. Also cffi's declarations. */
#ifndef KAGE_METHODS_H
#define KAGE_METHODS_H

#include <stddef.h>

/* One function over n places. x: the arrays of its inputs, then those of its outputs; a struct has one for each of its
 * fields, in their order. step: how many numbers further the next place is, 0: all places have the same. */
typedef struct methods_loop {
    const char *name;
    const char *inputs, *outputs; /* a letter for each array: r real, v vectors of 3 reals, i int */
    void (*run)(ptrdiff_t n, void *const *x, const ptrdiff_t *step);
} methods_loop;

extern const methods_loop methods_float[], methods_double[]; /* the last has no name */

#endif
