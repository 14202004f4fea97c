/* What all parts of the scene reader build on: its state, and the small readers of numbers, vectors, colors, names and
 * files. A wrong value adds an error at its node and is left as it was; what is read after it is read all the same, so
 * that all errors of a scene are found at once. The lowest part: it calls no other.
 */
#ifndef KAGE_READ_VALUES_H
#define KAGE_READ_VALUES_H

#include "scene/scene.h"
#include "yaml/yaml.h"

/* Numbers of a scene: within these, no product of a few overflows float, and no square vanishes. */
#define BIG 1e6
#define SMALL SHAPE_SMALL

typedef struct reader {
    yaml *y;
    scene *s;
    errors *e;
    const scene_source *from;
} reader;

/* An owned copy of a text; NULL of NULL, or with an error. */
char *reader_copy(reader *r, const char *text);

/* The value of a key: three numbers, each within BIG. An absent key leaves *v and is no error here, as in the next
 * three. Returns whether there was no error, as all readers of values do. */
bool reader_vector(reader *r, node *map, const char *key, const char *what, vec3 *v);

/* A linear color: three numbers from 0 to BIG. */
bool reader_color(reader *r, node *map, const char *key, vec3 *v);

/* A number lo <= x <= hi; `open`: lo < x. `what` names the value for the message. */
bool reader_number(reader *r, node *map, const char *key, double lo, bool open, double hi, const char *what, double *x);

/* A vector's length. False with an error at the key, which may be absent: then at the map. noun: "a vector". */
bool reader_has_length(reader *r, node *map, const char *key, const char *noun, vec3 v);

/* Whether all of the keys are in the map, separated by spaces; an error for each that is not. */
bool reader_need_all(reader *r, node *map, const char *keys, const char *what);

/* A name in a map of named things; owned. NULL with an error. */
char *reader_name(reader *r, node *map, node *key);

/* The scene's map of named things under a key, which it needs. Makes *array, an item of that size for each, all zero;
 * owned by the scene. NULL with an error, with *count as it was. */
node *reader_named(reader *r, const char *key, size_t size, void *array, int *count);

/* The path of a file beside the scene, so that a scene finds its files from any working directory; owned. The file is
 * noted as one that the scene is made from. NULL: out of memory, with an error. */
char *reader_beside(reader *r, const char *file);

/* A function of u and w; owned. NULL with an error. */
expr *reader_expr(reader *r, node *at, const char *what);

#endif
