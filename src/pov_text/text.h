/* Writes the text of a POV-Ray file: buffered, the same in every locale, under a temporary name until it is complete.
 */
#ifndef KAGE_POV_TEXT_TEXT_H
#define KAGE_POV_TEXT_TEXT_H

#include "base/file_writer.h"
#include "base/vec3.h"
#include "expr/expr.h"

typedef struct pov_text {
    file_writer file;
    uint64_t size; /* bytes already in the file */
    size_t used;   /* bytes in the buffer */
    char buffer[1 << 16];
} pov_text;

/* False with an error in *e; then pov_end must not be called. */
bool pov_begin(pov_text *t, const char *path, errors *e);

/* Complete the file; or, where `why` is not NULL, remove it with that as the error. Errors as in file_writer_close. */
bool pov_end(pov_text *t, const char *why, errors *e);

/* Add n bytes. */
void pov_put(pov_text *t, const char *from, size_t n);

/* Add a text in which %s is a string, %d an int, %g a double, %v a vec3. The decimal sign is always a point. */
void pov_print(pov_text *t, const char *fmt, ...);

typedef struct pov_digits {
    char text[40];
} pov_digits;

pov_digits pov_number(double x, int digits); /* significant digits */
pov_digits pov_exact(double x);              /* as many as give x again */

/* POV-Ray's `matrix` that maps the unit vectors to x, y, z and 0 to the origin, followed by the text `after`. */
void pov_matrix(pov_text *t, vec3 x, vec3 y, vec3 z, vec3 origin, const char *after);

/* The name of a scene's material or object as a POV-Ray identifier, without '-'. `index` tells a-b from a_b. */
typedef struct pov_identifier {
    char text[96];
} pov_identifier;

pov_identifier pov_identify(const char *kind, const char *name, int index);

/* (expr.c) An expression in the syntax of POV-Ray's functions of u and w, owned by the caller (free). NULL: it has
 * noise or numbers that are not finite, which POV-Ray lacks; it is longer than 256 KiB; or out of memory. */
char *expr_pov(const expr *e);

#endif
