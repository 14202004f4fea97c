/* The document behind yaml.h, as its parts share it. Private to the yaml files. */
#ifndef KAGE_YAML_DOCUMENT_H
#define KAGE_YAML_DOCUMENT_H

#include "yaml/yaml.h"

struct fy_diag;
struct fy_diag_error;
struct fy_document;

/* Where a node, and what is in it, comes from; kept with nodes that a --set made, and with those around them. */
typedef struct origin {
    const char *set; /* NULL: the file */
    int start;       /* the column at which the text that libfyaml saw begins in it */
    bool
        placed; /* the node's own place in that text is known: libfyaml can't say it once something in it has changed */
    int line, column;
} origin;

struct yaml {
    char *path, *text;
    size_t size;
    struct fy_diag *diag;
    void *seen; /* the last report of libfyaml's that has been looked at */
    struct fy_document *doc;
    origin *origins;
    int count_origins;
    errors *errors;
    char **scalars; /* texts handed out */
    int count;
};

/* libfyaml's next report, NULL where there is none. */
struct fy_diag_error *yaml_report(yaml *y);

/* Where a node comes from; NULL: as it stands in the file. */
const origin *yaml_origin(node *at);

/* A node's line and column, from 1, in the file or in the value of a --set. */
void yaml_place(yaml *y, node *at, int *line, int *column);

/* Add an error at a place in the file (o: NULL) or in a --set. Always false. */
bool yaml_tell(yaml *y, const origin *o, int line, int column, const char *message);

/* Add what libfyaml itself has found wrong with the text. The first: the ones after it are mostly its consequences.
 * Always false. */
bool yaml_syntax_errors(yaml *y, const origin *o);

/* Make the changes to the document, once it is loaded. What is wrong with one is told, and the next is made. False: out
 * of memory. */
bool yaml_change(yaml *y, int sets, const char *const *set, const char *optional);

#endif
