/* Golden vectors: JSON read through libfyaml (JSON is YAML). Each number is looked up by name in a case. */
#ifndef KAGE_GOLDEN_JSON_H
#define KAGE_GOLDEN_JSON_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <libfyaml.h>
#include <stdlib.h>
#include <string.h>

static inline struct fy_document *golden_open(const char *file)
{
    struct fy_document *d = fy_document_build_from_file(NULL, file);
    assert_non_null(d);
    return d;
}

static inline struct fy_node *golden_get(struct fy_node *map, const char *key)
{
    struct fy_node *v = fy_node_mapping_lookup_by_string(map, key, FY_NT);
    if (!v)
        print_error("golden vectors lack '%s'\n", key);
    assert_non_null(v);
    return v;
}

/* 1 and the number, or 0 for null. */
static inline int golden_number(struct fy_node *at, double *x)
{
    const char *text = fy_node_get_scalar0(at);
    *x = 0;
    if (!text || strcmp(text, "null") == 0)
        return 0;
    char *end;
    *x = strtod(text, &end);
    assert_int_equal(*end, 0);
    return 1;
}

#endif
