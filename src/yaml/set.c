/* --set: changes of the document. Each new node stores the setting that it comes from, for errors in it. */
#include "yaml/document.h"

#include <libfyaml.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/spelling.h"
#include "yaml/text.h"

#define NAME_LETTERS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-"

static void keys_of(node *map, char *out, size_t size)
{
    size_t at = 0;
    *out = 0;
    for (int i = 0; i < fy_node_mapping_item_count(map) && at + 40 < size; i++) {
        struct fy_node_pair *p = fy_node_mapping_get_by_index(map, i);
        const char *key = fy_node_get_scalar0(fy_node_pair_key(p));
        if (key && strlen(key) < 32)
            at += (size_t)snprintf(out + at, size - at, "%s%s", at ? " " : "", key);
    }
}

static bool set_error(yaml *y, const char *set, const char *at, const char *fmt, ...) KAGE_PRINTF(4, 5);
static bool set_error(yaml *y, const char *set, const char *at, const char *fmt, ...)
{
    char message[512];
    int line, column;
    va_list args;
    va_start(args, fmt);
    vsnprintf(message, sizeof message, fmt, args);
    va_end(args);
    text_place(set, (size_t)(at - set), &line, &column);
    return yaml_add_error(y, &(origin){set, 1, true, line, column}, line, column, message);
}

/* Call before a node changes: stores its place, and those of the nodes that contain it. */
static void keep_places(yaml *y, node *at)
{
    for (; at; at = fy_node_get_parent(at)) {
        origin *own = fy_node_get_meta(at), *o = own ? own : &y->origins[y->count_origins];
        const origin *around = yaml_origin(at);
        if (own && own->placed)
            return;
        if (!own)
            *o = around ? *around : (origin){NULL, 1, false, 1, 1};
        o->placed = false;
        yaml_place(y, at, &o->line, &o->column);
        o->placed = true;
        if (!own) {
            y->count_origins++;
            fy_node_set_meta(at, o);
        }
    }
}

/* Parse the part of a setting at `at`: a key of n letters, or the value to the end. NULL: an error is added. */
static node *made(yaml *y, const char *set, const char *at, size_t n, bool key)
{
    int line, column;
    char *quoted = key ? malloc(n + 3) : NULL; /* owned by the document once parsed */
    if (key && !quoted) {
        errors_add(y->errors, "out of memory");
        return NULL;
    }
    origin *o = &y->origins[y->count_origins];
    text_place(set, (size_t)(at - set), &line, &column);
    *o = (origin){set, key ? 1 : column, key, line, column};
    if (key)
        snprintf(quoted, n + 3, "\"%.*s\"", (int)n, at);
    node *new =
        key ? fy_node_build_from_malloc_string(y->doc, quoted, FY_NT) : fy_node_build_from_string(y->doc, at, FY_NT);
    if (!new) {
        yaml_syntax_errors(y, o);
        return NULL;
    }
    y->count_origins++;
    fy_node_set_meta(new, o);
    return new;
}

/* Add a key and its value to a map. */
static bool append(yaml *y, const char *set, const char *at, size_t n, node *map, node *value)
{
    node *key = made(y, set, at, n, true);
    return (key && fy_node_mapping_append(map, key, value) == 0) || set_error(y, set, at, "can't be set");
}

/* One step down the path: from `at` by the name of n letters at k. *next: the node there, NULL where the last name is
 * new; *index: its place in a list, else -1. False: an error is added. */
static bool step(yaml *y, const char *set, const char *k, size_t n, node *at, const char *optional, node **next,
                 int *index)
{
    char key[64], near[64], keys[2048];
    const bool last = k[n] == '=', root = at == fy_document_root(y->doc);
    snprintf(key, sizeof key, "%.*s", (int)n, k);
    *next = NULL;
    *index = -1;
    if (fy_node_is_sequence(at)) {
        char *end;
        long i = strtol(key, &end, 10);
        int count = fy_node_sequence_item_count(at);
        if (*end || *key < '0' || *key > '9' || i >= count)
            return set_error(y, set, k, "no item '%s' in this list, expected a number from 0 to %d", key, count - 1);
        *index = (int)i;
        *next = fy_node_sequence_get_by_index(at, *index);
        return true;
    }
    if (!fy_node_is_mapping(at))
        return set_error(y, set, k, "no '%s' here: what stands before it is a single value, expected a map or a list",
                         key);
    *next = fy_node_mapping_lookup_by_string(at, key, n);
    if (*next || last)
        return true;
    if (root && spelling_among(key, optional) >= 0) {
        keep_places(y, at);
        *next = fy_node_create_mapping(y->doc);
        fy_node_set_meta(*next, &y->origins[y->count_origins]); /* that of its key */
        return append(y, set, k, n, at, *next);
    }
    keys_of(at, keys, sizeof keys);
    if (!*keys)
        return set_error(y, set, k, "the scene has no '%s' here, there is nothing here", key);
    spelling_nearest(key, keys, near, sizeof near);
    if (*near)
        return set_error(y, set, k, "the scene has no '%s' here, did you mean '%s'?", key, near);
    return set_error(y, set, k, "the scene has no '%s' here, expected one of: %s", key, keys);
}

/* Make one change: go down the path, then put the value in its place. */
static bool apply(yaml *y, const char *set, const char *optional)
{
    const char *equals = strchr(set, '='), *k = set;
    node *at = fy_document_root(y->doc), *next;
    int index;
    size_t n;
    if (!equals || equals == set)
        return set_error(y, set, set, "not a setting, expected PATH=VALUE, as objects.ground.bump.scale=0.1");
    if (strlen(set) > 65536)
        return errors_add(y->errors, "--set: more than 65536 characters");
    if (text_not_utf8(set, strlen(set)) < strlen(set))
        return errors_add(y->errors, "--set: a byte that is no UTF-8");
    if (set[strcspn(set, "\r\n")]) /* a picture keeps the changes a line each */
        return set_error(y, set, set + strcspn(set, "\r\n"), "a line break, expected the change on one line");
    for (;; at = next, k += n + 1) {
        n = strcspn(k, ".=");
        if (n == 0 || n >= 60 || strspn(k, NAME_LETTERS) < n)
            return set_error(y, set, k,
                             "no name here, expected names of letters, digits, _ and - with dots between them");
        if (!step(y, set, k, n, at, optional, &next, &index))
            return false;
        if (k[n] == '=')
            break;
    }
    if (!equals[1 + strspn(equals + 1, " \t\r\n")])
        return set_error(y, set, equals + 1, "no value, expected one after '='");
    keep_places(y, at);
    node *value = made(y, set, equals + 1, 0, false);
    if (!value)
        return false;
    if (index >= 0) {
        fy_node_sequence_insert_before(at, next, value);
        fy_node_free(fy_node_sequence_remove(at, next));
        return true;
    }
    if (!next)
        return append(y, set, k, n, at, value);
    return fy_node_pair_set_value(fy_node_mapping_lookup_pair_by_string(at, k, n), value) == 0 ||
           set_error(y, set, set, "can't be set");
}

bool yaml_change(yaml *y, int sets, const char *const *set, const char *optional)
{
    size_t origins = 1;
    for (int k = 0; k < sets; k++, origins += 5) /* the root, a map, two keys and a value, and what lies on the path */
        for (const char *c = set[k]; *c; c++)
            origins += *c == '.';
    y->origins = calloc(origins, sizeof *y->origins);
    if (!y->origins)
        return false;
    fy_document_register_meta(y->doc, NULL, NULL);
    for (int k = 0; k < sets; k++)
        apply(y, set[k], optional);
    return true;
}
