/* Lines and columns of a text, and errors that show them. Independent of libfyaml. */
#ifndef KAGE_YAML_TEXT_H
#define KAGE_YAML_TEXT_H

#include <stddef.h>

#include "base/errors.h"

/* How a scalar is written. */
typedef enum scalar_style { SCALAR_PLAIN, SCALAR_SINGLE, SCALAR_DOUBLE, SCALAR_LITERAL, SCALAR_FOLDED } scalar_style;

/* The byte of `text` at which byte `offset` of a scalar's value is written: past escapes, doubled quotes, folded lines
 * and indentation. `start`: after the opening quote, or at the first line of a block. */
size_t text_offset(const char *text, size_t start, scalar_style style, size_t offset);

/* Line and column, from 1, of a byte of the text. A column is a character (UTF-8); \n, \r\n and \r end a line. */
void text_place(const char *text, size_t at, int *line, int *column);

/* Add the message with its place, the line (of a very long one the part around the column) and a caret. Control
 * characters become '?': a scene must not steer the terminal. Always false. */
bool text_error(errors *e, const char *name, const char *text, int line, int column, const char *message);

/* The index of the first byte that is not UTF-8, or `size`. */
size_t text_not_utf8(const char *text, size_t size);

#endif
