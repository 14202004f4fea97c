/* The loaded document: the struct and functions that the files of this room share. Private to them. */
#ifndef KAGE_YAML_DOCUMENT_H
#define KAGE_YAML_DOCUMENT_H

#include "yaml/yaml.h"

struct fy_diag;
struct fy_diag_error;
struct fy_document;

/* Where a node comes from. Attached as libfyaml's "meta" to nodes that a --set made and to those that contain them. */
typedef struct origin {
    const char *set; /* NULL: the file */
    int start;       /* column in `set` at which the text given to libfyaml begins */
    bool placed;     /* line and column are set, as libfyaml loses the place of a changed node */
    int line, column;
} origin;

struct yaml {
    char *path, *text;
    size_t size;
    struct fy_diag *diag;
    void *seen; /* the last error of libfyaml that yaml_report returned */
    struct fy_document *doc;
    origin *origins;
    int count_origins;
    errors *errors;
    char **scalars; /* the copies that yaml_text has returned */
    int count;
};

/* The next error that libfyaml has collected, NULL where there is none. */
struct fy_diag_error *yaml_report(yaml *y);

/* The origin of a node or of the nearest node around it that has one. NULL: the file. */
const origin *yaml_origin(node *at);

/* A node's line and column, from 1, in the file or in the value of a --set. */
void yaml_place(yaml *y, node *at, int *line, int *column);

/* Add an error at a place in the file (o: NULL) or in a --set. Always false. */
bool yaml_add_error(yaml *y, const origin *o, int line, int column, const char *message);

/* Add the first syntax error that libfyaml found; later ones are mostly consequences of it. Always false. */
bool yaml_syntax_errors(yaml *y, const origin *o);

/* Whether no map or list of the document has too many around it. False with an error. */
bool yaml_nesting_is_good(yaml *y, cap most);

/* Make the changes to the loaded document. A wrong one adds an error and is skipped. False: out of memory. */
bool yaml_change(yaml *y, int sets, const char *const *set, const char *optional);

#endif
