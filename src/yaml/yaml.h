/* A YAML file for the scene reader: nodes, and errors that point at them. Only this room includes libfyaml.
 *
 * A wrong value adds one message to the list given to yaml_open, with the place of the node,
 *
 *     scene.yaml:12:10: what is wrong, expected what was expected
 *        12 |     scale: -1
 *           |            ^
 *
 * and the reader goes on, so that all errors of a file are reported at once.
 */
#ifndef KAGE_YAML_YAML_H
#define KAGE_YAML_YAML_H

#include <stdbool.h>

#include "base/errors.h"
#include "base/limits.h"

struct fy_node;
typedef struct fy_node node;
typedef struct yaml yaml;

/* Of maps and lists, libfyaml's own limit: a value within them is a level to it, too. */
#define YAML_MAX_NESTING 63
enum { YAML_MAX_BYTES = 1 << 26 };

/* Read the file at `path`, or `text` of `size` bytes if that is not NULL (then `path` is only its name), and make the
 * changes PATH=VALUE (PATH: keys and indices with dots between them; VALUE: YAML). A change may create the top-level
 * maps named in `optional`. l: the caller's limits, or NULL. Errors go to e, until yaml_close. NULL: there is no
 * document. One thread at a time. */
yaml *yaml_open(const char *path, const char *text, size_t size, int sets, const char *const *set, const char *optional,
                const limits *l, errors *e);
void yaml_close(yaml *y);

/* The text with changes in it, which yaml_open has made of it without an error; comments and layout stay. free() it.
 * NULL: out of memory. */
char *yaml_edited(const char *text, int sets, const char *const *set);

node *yaml_root(const yaml *y);
const char *yaml_source(const yaml *y); /* the file's text, owned by y */

/* Add an error about a node, or about the byte `offset` of its text. Always false. */
#define yaml_error(y, at, ...) yaml_error_in(y, at, 0, __VA_ARGS__)
bool yaml_error_in(yaml *y, node *at, size_t offset, const char *fmt, ...) KAGE_PRINTF(4, 5);

/* Maps. `yaml_map` checks that the node is a map with no keys but `keys` (separated by spaces; NULL: any). In this
 * and other functions `what` names the map or the value expected, for the message. */
bool yaml_map(yaml *y, node *at, const char *what, const char *keys);
bool yaml_is_map(node *at);
node *yaml_get(node *map, const char *key);                             /* NULL: not there */
node *yaml_first(node *map, const char *key);                           /* the node of the key, not of its value */
node *yaml_need(yaml *y, node *map, const char *key, const char *what); /* NULL, with an error: not there */
int yaml_size(node *map);
node *yaml_pair(node *map, int i, node **key);

/* All of the map's pairs: yaml_size(map) keys and values. Where there are many, yaml_pair would look for each. */
void yaml_pairs(node *map, node **key, node **value);

/* Scalars. y owns the texts. NULL or false, with an error: not such a scalar. */
const char *yaml_text(yaml *y, node *at, const char *what);

/* A number lo <= x <= hi; `open`: lo < x. */
bool yaml_number(yaml *y, node *at, double lo, bool open, double hi, const char *what, double *x);
bool yaml_whole(yaml *y, node *at, int lo, int hi, const char *what, int *x);
bool yaml_bool(yaml *y, node *at, const char *what, bool *x);

/* n numbers in [ ]. */
bool yaml_numbers(yaml *y, node *at, int n, double lo, double hi, const char *what, double *x);

/* Lists. yaml_list: the number of items; -1, with an error: it is no list. */
bool yaml_is_list(node *at);
int yaml_list(yaml *y, node *at, const char *what);
node *yaml_item(node *list, int i);

/* The index of the text among words separated by spaces; -1 with an error where it is none of them. */
int yaml_word(yaml *y, node *at, const char *words, const char *what);

#endif
