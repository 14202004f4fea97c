/* How many maps and lists are one in another. */
#include "yaml/document.h"

#include <libfyaml.h>

/* A map or a list, and where the walk through it stands. */
typedef struct place {
    node *at;
    void *next;
} place;

/* Its next value, NULL where it is empty. False: there is none. */
static bool step(place *p, node **value)
{
    if (fy_node_is_sequence(p->at))
        return (*value = fy_node_sequence_iterate(p->at, &p->next));
    struct fy_node_pair *pair = fy_node_mapping_iterate(p->at, &p->next);
    *value = pair ? fy_node_pair_value(pair) : NULL;
    return pair;
}

/* All of the document, changes in it, too: each of them may have a few levels of its own. */
bool yaml_nesting_is_good(yaml *y, cap most)
{
    place around[YAML_MAX_NESTING] = {{fy_document_root(y->doc), NULL}};
    node *at;
    for (int depth = 1; depth > 0;)
        if (!step(&around[depth - 1], &at))
            depth--;
        else if (at && !fy_node_is_scalar(at)) {
            if (depth == most.most)
                return yaml_error(y, at, "nested too deep, expected at most %d levels of maps and lists%s",
                                  (int)most.most, most.by);
            around[depth++] = (place){at, NULL};
        }
    return true;
}
