/* The scene reader's state, and its small readers of numbers, vectors, colors, words, names and files. A wrong value
 * adds an error at its node and leaves the result unchanged. Reading then continues, so that one run reports all errors
 * of a scene.
 */
#ifndef KAGE_READ_VALUES_H
#define KAGE_READ_VALUES_H

#include "image/array.h"
#include "mesh/mesh_data.h"
#include "scene/scene.h"
#include "yaml/yaml.h"

/* Limits for numbers of a scene: products of a few of them stay within the range of float. */
#define BIG 1e6
#define SMALL SHAPE_SMALL

/* A list of copies. Its first object is the scene's; copies of other materials have more. */
typedef struct copies_list {
    int object; /* in the scene file's order */
    bool used;  /* the scene's object has copies */
    int count;
    object *more; /* owned by the list until the scene has them */
} copies_list;

typedef struct reader {
    yaml *y;
    scene *s;
    errors *e;
    const scene_source *from;
    node *now; /* what is being read, for errors of memory; NULL: nothing that has a place */
    int lists;
    copies_list *list;
    char *model_path; /* the last model of which a part was asked for, which need not be read again for the next part */
    mesh_data model;
} reader;

/* Returns p. Where it is NULL, adds the error that there is not enough memory, at what is being read. */
void *reader_made(reader *r, void *p);

/* Where this scene's memory is from. */
static inline memory *reader_memory(const reader *r) { return progress_memory(r->from->progress); }

/* The limit that holds. */
static inline cap reader_limit(const reader *r, limit_kind kind, int64_t built_in)
{
    return progress_limit(r->from->progress, kind, built_in);
}

/* A copy of the text, owned by the caller. NULL: the text is NULL, or there is an error. */
char *reader_copy(reader *r, const char *text);

/* The value of an optional key in a map; where it is absent, the result is unchanged. False with an error. `what`
 * describes the expected value in messages. A vector has three numbers within BIG; a linear color three from 0 to BIG;
 * a pair two from lo to BIG; counts are two whole numbers from 1 to hi. */
bool reader_vector(reader *r, node *map, const char *key, const char *what, vec3 *v);
bool reader_color(reader *r, node *map, const char *key, vec3 *v);
bool reader_pair(reader *r, node *map, const char *key, double lo, const char *what, double x[2]);
bool reader_counts(reader *r, node *map, const char *key, int hi, const char *what, int x[2]);

/* The same for a number lo <= x <= hi, or lo < x <= hi if `open`. */
bool reader_number(reader *r, node *map, const char *key, double lo, bool open, double hi, const char *what, double *x);

/* The same for one of `words`, which are separated by spaces. Returns its index; 0 without the key; -1 with an error.
 */
int reader_word(reader *r, node *map, const char *key, const char *words, const char *what);

/* Whether a vector has a length. False with an error at the key, or at the map without the key. noun: "a vector". */
bool reader_has_length(reader *r, node *map, const char *key, const char *noun, vec3 v);

/* Whether all keys, separated by spaces, are in the map. Adds an error for each that is missing. */
bool reader_need_all(reader *r, node *map, const char *keys, const char *what);

/* Whether exactly one of two keys is in the map. False with an error. noun: "a bump". */
bool reader_either(reader *r, node *map, const char *noun, const char *a, const char *b);

/* The keys from, at and up of a camera, or of a transform that looks at a place. `who` looks and `what` has the keys,
 * in messages. False with an error. */
bool reader_look(reader *r, node *map, const char *who, const char *what, vec3 *from, vec3 *to, vec3 *up);

/* Add the error that `up` has the direction of the view. Always false. */
bool reader_up_along(reader *r, node *map);

/* The name that a node is, of letters that names have; owned by the caller. NULL with an error. */
char *reader_plain_name(reader *r, node *key);

/* The name that is a key of the map, the first one of it; owned by the caller. NULL with an error. */
char *reader_name(reader *r, node *map, node *key);

/* Add the error that a name is there twice. Always false. */
bool reader_second(reader *r, node *key, const char *name);

/* The map of at most `most.most` named things under a required key of the scene. Sets *items_at to one zeroed item of
 * `size` bytes for each, owned by the scene. NULL with an error; *count is then unchanged. */
node *reader_named(reader *r, const char *key, cap most, size_t size, void *items_at, int *count);

/* The path of a file that is given relative to the scene's folder; owned by the caller. Adds the file to those that the
 * scene is made from. NULL: out of memory, with an error. */
char *reader_beside(reader *r, const char *file);

/* The same of a file that is read; file: the node of its name. NULL, with an error: it has too many bytes, too. */
char *reader_input(reader *r, node *file, const char *name);

/* Whether an image was read (if not, *e has the reason) and has at least 2 x 2 values. False with an error. Frees *e.
 */
bool reader_usable(reader *r, node *file, const char *name, bool was_read, int width, int height, const char *values,
                   errors *e);

/* A function of u and w; owned by the caller. NULL with an error. */
expr *reader_expr(reader *r, node *at, const char *what);

#endif
