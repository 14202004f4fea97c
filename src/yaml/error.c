/* Errors at nodes: finds the line and column of a node in the file or in a --set. Rewords libfyaml's syntax errors. */
#include "yaml/document.h"

#include <libfyaml.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "yaml/text.h"

struct fy_diag_error *yaml_report(yaml *y)
{
    void *last = y->seen;
    struct fy_diag_error *k = fy_diag_errors_iterate(y->diag, &last);
    if (k)
        y->seen = last;
    return k;
}

/* The only way to get a node's place from libfyaml is a report about the node. */
static bool own_place(yaml *y, node *at, int *line, int *column)
{
    struct fy_diag_error *k;
    const origin *own = fy_node_get_meta(at);
    bool found = own && own->placed;
    if (found) {
        *line = own->line;
        *column = own->column;
        return true;
    }
    fy_node_report(at, FYET_ERROR, "%s", "here");
    for (; (k = yaml_report(y)); found = true) {
        *line = k->line;
        *column = k->column;
    }
    return found;
}

const origin *yaml_origin(node *at)
{
    const origin *o = NULL;
    for (; at && !o; at = fy_node_get_parent(at))
        o = fy_node_get_meta(at);
    return o;
}

/* The key of a value in a map; of NULL, the map's first. */
static node *key_of(node *map, node *value)
{
    void *next = NULL;
    struct fy_node_pair *p;
    while (map && fy_node_is_mapping(map) && (p = fy_node_mapping_iterate(map, &next)))
        if (!value || fy_node_pair_value(p) == value)
            return fy_node_pair_key(p);
    return NULL;
}

/* An empty value has no place, nor has a map that begins with one. It gets that of its key, or of its parent. */
void yaml_place(yaml *y, node *at, int *line, int *column)
{
    *line = *column = 1;
    for (; at && !own_place(y, at, line, column); at = fy_node_get_parent(at)) {
        node *key = key_of(fy_node_get_parent(at), at), *first = key_of(at, NULL);
        if ((first && own_place(y, first, line, column)) || (key && own_place(y, key, line, column)))
            return;
    }
}

static scalar_style style_of(struct fy_token *token)
{
    switch (fy_token_scalar_style(token)) {
    case FYSS_SINGLE_QUOTED:
        return SCALAR_SINGLE;
    case FYSS_DOUBLE_QUOTED:
        return SCALAR_DOUBLE;
    case FYSS_LITERAL:
        return SCALAR_LITERAL;
    case FYSS_FOLDED:
        return SCALAR_FOLDED;
    default:
        return SCALAR_PLAIN;
    }
}

bool yaml_add_error(yaml *y, const origin *o, int line, int column, const char *message)
{
    const bool set = o && o->set;
    if (set && line == 1)
        column += o->start - 1;
    return text_error(y->errors, set ? "--set" : y->path, set ? o->set : y->text, line, column, message);
}

bool yaml_error_in(yaml *y, node *at, size_t offset, const char *fmt, ...)
{
    char message[1024];
    int line = 1, column = 1;
    if (y->errors->count >= ERRORS_SHOWN) {
        y->errors->count++;
        return false;
    }
    va_list args;
    va_start(args, fmt);
    vsnprintf(message, sizeof message, fmt, args);
    va_end(args);
    const origin *o = yaml_origin(at);
    struct fy_token *token = offset && fy_node_is_scalar(at) ? fy_node_get_scalar_token(at) : NULL;
    const struct fy_mark *mark = token ? fy_token_start_mark(token) : NULL;
    if (!mark)
        yaml_place(y, at, &line, &column);
    else {
        const char *text = o && o->set ? o->set + o->start - 1 : y->text;
        text_place(text, text_offset(text, mark->input_pos, style_of(token), offset), &line, &column);
    }
    return yaml_add_error(y, o, line, column, message);
}

/* ---- syntax ---- */

#define TEXT_OF(x) #x
#define NUMBER_TEXT(x) TEXT_OF(x)
#define TOO_DEEP "nested too deep, expected at most " NUMBER_TEXT(YAML_MAX_NESTING) " levels of maps and lists"

/* Clearer words for some of libfyaml's messages. */
static const char *reworded(const char *message)
{
    static const char *const words[][2] = {
        {"invalid tab as indendation in a mapping", "a tab as indentation, expected spaces"},
        {"did not find expected node content", "no value here, expected one, or the bracket that closes"},
        {"could not find expected ':'", "a line without ':', expected 'key: value'"},
        {"Max depth (64) exceeded", TOO_DEEP},
        {"depth limit exceeded", TOO_DEEP},
        {"flow sequence without a closing bracket", "a list that is not closed, expected ']'"},
        {"flow mapping without a closing brace", "a map that is not closed, expected '}'"},
    };
    for (size_t k = 0; k < sizeof words / sizeof *words; k++)
        if (strcmp(message, words[k][0]) == 0)
            return words[k][1];
    return message;
}

bool yaml_syntax_errors(yaml *y, const origin *o)
{
    struct fy_diag_error *k = yaml_report(y);
    while (k && k->line < 1)
        k = yaml_report(y);
    yaml_add_error(y, o, k ? k->line : 1, k ? k->column : 1,
                   k   ? reworded(k->msg)
                   : o ? "no value here"
                       : "no scene here, only comments");
    while (k)
        k = yaml_report(y);
    return false;
}
