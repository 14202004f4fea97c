/* The text of a POV-Ray file as it is written: buffered, the same in every locale, aside until it is whole. */
#ifndef KAGE_POVRAY_TEXT_H
#define KAGE_POVRAY_TEXT_H

#include "base/file_writer.h"
#include "base/vec3.h"

typedef struct pov_text {
    file_writer file;
    uint64_t size; /* bytes already in the file */
    size_t used;   /* bytes in the buffer */
    char buffer[1 << 16];
} pov_text;

/* False with a message in *e; then there is nothing to end. */
bool pov_begin(pov_text *t, const char *path, errors *e);

/* With `why` NULL the file takes its place, otherwise it is dropped; errors as from file_writer_close. */
bool pov_end(pov_text *t, const char *why, errors *e);

/* Add a text in which %s is a string, %d an int, %g a double, %v a vec3, all with a point in numbers. */
void pov_print(pov_text *t, const char *fmt, ...);

typedef struct pov_digits {
    char text[40];
} pov_digits;

pov_digits pov_number(double x, int digits); /* significant digits */
pov_digits pov_exact(double x);              /* as many as give x again */

#endif
