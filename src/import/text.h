/* A text that grows, and how values are written into a scene's YAML. */
#ifndef KAGE_IMPORT_TEXT_H
#define KAGE_IMPORT_TEXT_H

#include <stdbool.h>
#include <stddef.h>

#if defined(__GNUC__)
#define TEXT_PRINTF(fmt, first) __attribute__((format(printf, fmt, first)))
#else
#define TEXT_PRINTF(fmt, first)
#endif

/* Zero-initialise; free(s). Once `failed`, for want of memory, it stays as it is. */
typedef struct text {
    char *s; /* NULL: empty */
    size_t n, room;
    bool failed;
} text;

/* Append as by printf. */
void text_add(text *t, const char *fmt, ...) TEXT_PRINTF(2, 3);

/* Append a number with `digits` digits, never as -0. */
void text_number(text *t, double x, int digits);

/* Append `[x, y, z]` with 7 digits. */
void text_vector(text *t, const double v[3]);

/* Append `key: [x, y, z]` and an end. */
void text_vector_of(text *t, const char *key, const double v[3], const char *end);

/* Append a string of YAML in double quotes, or without them where it needs none. */
void text_string(text *t, const char *s);

/* Make the name of something in a model one for a scene: up to 59 letters, digits, `_` and `-`; other characters
 * become `_`. */
enum { TEXT_NAME = 60 };
void text_scene_name(char to[TEXT_NAME], const char *name);

/* Make a name one that is not among the first n of `taken`: with _2, _3 ... behind it. */
void text_unique(char name[TEXT_NAME], char (*taken)[TEXT_NAME], int n);

#endif
