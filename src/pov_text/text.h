/* The text of a POV-Ray file: buffered, the same in every locale, and under another name until it is complete. */
#ifndef KAGE_POV_TEXT_TEXT_H
#define KAGE_POV_TEXT_TEXT_H

#include "base/affine.h"
#include "base/file_writer.h"

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

/* Add n bytes. */
void pov_put(pov_text *t, const char *from, size_t n);

/* Add a text in which %s is a string, %d an int, %g a double, %v a vec3, all with a point in numbers. */
void pov_print(pov_text *t, const char *fmt, ...);

typedef struct pov_digits {
    char text[40];
} pov_digits;

pov_digits pov_number(double x, int digits); /* significant digits */
pov_digits pov_exact(double x);              /* as many as give x again */

/* POV-Ray's `matrix` that takes the unit vectors to x, y, z and 0 to the origin; that of an affine map. No new line. */
void pov_matrix(pov_text *t, vec3 x, vec3 y, vec3 z, vec3 origin);
void pov_affine(pov_text *t, const affine *m);

/* The name of a thing of the scene as an identifier of POV-Ray, which has no '-'; `index` keeps a-b and a_b apart. */
typedef struct pov_identifier {
    char text[96];
} pov_identifier;

pov_identifier pov_identify(const char *kind, const char *name, int index);

#endif
