/* The typed getters. Each checks its value; its error names what was expected. */
#include "yaml/document.h"

#include <libfyaml.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/spelling.h"

/* A scalar's text, "" where it is empty, as a missing value (at: NULL) is. NULL: no scalar. */
static const char *text_of(node *at)
{
    if (!fy_node_is_scalar(at) || fy_node_is_alias(at))
        return NULL;
    const char *text = fy_node_get_scalar0(at);
    return text ? text : "";
}

static const char *kind_of(node *at)
{
    if (fy_node_is_alias(at))
        return "an alias, which kage does not take";
    if (fy_node_is_mapping(at))
        return "a map";
    if (fy_node_is_sequence(at))
        return "a list";
    const char *text = text_of(at);
    return text && !*text ? "nothing here" : "a single value";
}

/* The key nearest to `text`; to a single letter, of those that the map lacks: beside a `u`, `v` is a `w`. */
static void nearest_key(node *map, const char *text, const char *keys, char *near, size_t size)
{
    char lacking[1024] = "";
    size_t n = 0;
    for (const char *k = strlen(text) == 1 ? keys : ""; *k; k += strspn(k, " ")) {
        const int length = (int)strcspn(k, " ");
        if (!fy_node_mapping_lookup_by_string(map, k, (size_t)length) && n + (size_t)length + 2 < sizeof lacking)
            n += (size_t)snprintf(lacking + n, sizeof lacking - n, "%s%.*s", n ? " " : "", length, k);
        k += length;
    }
    spelling_nearest(text, *lacking ? lacking : keys, near, size);
}

bool yaml_map(yaml *y, node *at, const char *what, const char *keys)
{
    const char *single = text_of(at);
    if (!fy_node_is_mapping(at))
        return yaml_error(y, at, "%s is %s, expected a map", what, single && !*single ? "empty" : kind_of(at));
    bool good = true;
    unsigned seen = 0;
    void *next = NULL;
    struct fy_node_pair *p;
    while (keys && (p = fy_node_mapping_iterate(at, &next))) {
        char near[64];
        node *key = fy_node_pair_key(p);
        const char *text = text_of(key);
        int k = text ? spelling_among(text, keys) : -1;
        if (k >= 0 && !(seen & 1u << k)) {
            seen |= 1u << k;
            continue;
        }
        nearest_key(at, text ? text : "", keys, near, sizeof near);
        if (k >= 0)
            good = yaml_error(y, key, "a second '%s' in %s, expected one", text, what);
        else if (!text || !*text)
            good =
                yaml_error(y, key ? key : at, "%s as a key, expected one of: %s", key ? kind_of(key) : "nothing", keys);
        else if (*near)
            good = yaml_error(y, key, "%s has no '%.60s', did you mean '%s'?", what, text, near);
        else
            good = yaml_error(y, key, "%s has no '%.60s', expected one of: %s", what, text, keys);
    }
    return good;
}

bool yaml_is_map(node *at) { return fy_node_is_mapping(at); }

node *yaml_get(node *map, const char *key) { return fy_node_mapping_lookup_by_string(map, key, FY_NT); }

node *yaml_first(node *map, const char *key)
{
    struct fy_node_pair *p = fy_node_mapping_lookup_pair_by_string(map, key, FY_NT);
    return p ? fy_node_pair_key(p) : NULL;
}

node *yaml_need(yaml *y, node *map, const char *key, const char *what)
{
    node *v = yaml_get(map, key);
    if (!v)
        yaml_error(y, map, "%s lacks its '%s'", what, key);
    return v;
}

int yaml_size(node *map) { return fy_node_mapping_item_count(map); }

node *yaml_pair(node *map, int i, node **key)
{
    struct fy_node_pair *p = fy_node_mapping_get_by_index(map, i);
    *key = fy_node_pair_key(p);
    return fy_node_pair_value(p);
}

void yaml_pairs(node *map, node **key, node **value)
{
    void *next = NULL;
    struct fy_node_pair *p;
    for (int i = 0; (p = fy_node_mapping_iterate(map, &next)); i++) {
        key[i] = fy_node_pair_key(p);
        value[i] = fy_node_pair_value(p);
    }
}

/* Doubled each time: there may be one in each of many objects. */
static bool room_for_one_more(yaml *y)
{
    const bool full = (y->count & (y->count - 1)) == 0; /* 0, 1, 2, 4 .. */
    char **more = full ? realloc(y->scalars, sizeof *more * (2 * (size_t)y->count + 1)) : y->scalars;
    y->scalars = more ? more : y->scalars;
    return more;
}

const char *yaml_text(yaml *y, node *at, const char *what)
{
    const char *text = text_of(at);
    if (!text || !*text) {
        yaml_error(y, at, "%s, expected %s", kind_of(at), what);
        return NULL;
    }
    char *copy = strdup(text);
    if (!copy || !room_for_one_more(y)) {
        free(copy);
        errors_add(y->errors, "%s: out of memory", y->path);
        return NULL;
    }
    return y->scalars[y->count++] = copy;
}

/* A plain decimal number, no infinity and no NaN, which strtod would take. */
static bool number(const char *text, double *x)
{
    char *end;
    if (!*text || strspn(text, "+-.0123456789eE") != strlen(text))
        return false;
    *x = strtod(text, &end);
    return !*end && isfinite(*x);
}

bool yaml_number(yaml *y, node *at, double lo, bool open, double hi, const char *what, double *x)
{
    const char *text = text_of(at);
    double v;
    if (!text || !*text)
        return yaml_error(y, at, "%s, expected %s", kind_of(at), what);
    if (!number(text, &v))
        return yaml_error(y, at, "'%.60s' is no number, expected %s", text, what);
    if (v < lo || v > hi)
        return yaml_error(y, at, "%.60s is %s than %.7g, expected %s", text, v < lo ? "less" : "more", v < lo ? lo : hi,
                          what);
    if (open && v <= lo)
        return yaml_error(y, at, "%.60s is too small, expected %s", text, what);
    *x = v;
    return true;
}

bool yaml_whole(yaml *y, node *at, int lo, int hi, const char *what, int *x)
{
    double v = 0;
    if (!yaml_number(y, at, lo, false, hi, what, &v))
        return false;
    if (v != floor(v))
        return yaml_error(y, at, "%g is no whole number, expected %s", v, what);
    *x = (int)v;
    return true;
}

bool yaml_bool(yaml *y, node *at, const char *what, bool *x)
{
    int k = yaml_word(y, at, "false true", what);
    *x = k == 1;
    return k >= 0;
}

bool yaml_is_list(node *at) { return fy_node_is_sequence(at); }

int yaml_list(yaml *y, node *at, const char *what)
{
    if (fy_node_is_sequence(at))
        return fy_node_sequence_item_count(at);
    yaml_error(y, at, "%s, expected %s", kind_of(at), what);
    return -1;
}

node *yaml_item(node *list, int i) { return fy_node_sequence_get_by_index(list, i); }

bool yaml_numbers(yaml *y, node *at, int n, double lo, double hi, const char *what, double *x)
{
    int count = yaml_list(y, at, what);
    if (count < 0)
        return false;
    if (count != n)
        return yaml_error(y, at, "%d value%s, expected %s", count, count == 1 ? "" : "s", what);
    bool good = true;
    for (int i = 0; i < n; i++)
        good = yaml_number(y, yaml_item(at, i), lo, false, hi, what, &x[i]) && good;
    return good;
}

int yaml_word(yaml *y, node *at, const char *words, const char *what)
{
    char near[64];
    const char *text = yaml_text(y, at, what);
    if (!text)
        return -1;
    int i = spelling_among(text, words);
    if (i >= 0)
        return i;
    spelling_nearest(text, words, near, sizeof near);
    yaml_error(y, at, "'%.60s' is unknown, expected %s%s%s%s", text, what, *near ? "; did you mean '" : "", near,
               *near ? "'?" : "");
    return -1;
}
