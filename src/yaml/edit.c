/* Changes written into a scene's text: only the bytes of a changed value are replaced, and what is missing is inserted,
 * so that comments and layout stay. A document remembers no places of its collections, so the text is parsed into
 * events, down to the place of the change.
 */
#include "yaml/yaml.h"

#include <libfyaml.h>
#include <stdlib.h>
#include <string.h>

/* ---- texts that grow ---- */

typedef struct buffer {
    char *text; /* ended by a 0; NULL at first, and once memory has run out */
    size_t size;
    bool failed;
} buffer;

static void put(buffer *b, const char *from, size_t n)
{
    char *more = b->failed ? NULL : realloc(b->text, b->size + n + 1);
    if (!more) {
        free(b->text);
        *b = (buffer){.failed = true};
        return;
    }
    b->text = more;
    memcpy(more + b->size, from, n);
    b->size += n;
    more[b->size] = 0;
}

static void put_all(buffer *b, const char *text) { put(b, text, strlen(text)); }

/* ---- events ---- */

typedef struct walk {
    struct fy_parser *parser;
    struct fy_event *now; /* the next one that is not passed; NULL: the end */
    const char *text;
} walk;

/* The bytes of a node. */
typedef struct span {
    size_t start, end;
    bool empty; /* nothing is written */
    bool block; /* a collection in block style */
} span;

static void next(walk *w)
{
    if (w->now)
        fy_parser_event_free(w->parser, w->now);
    w->now = fy_parser_parse(w->parser);
}

static void end_walk(walk *w)
{
    if (w->now)
        fy_parser_event_free(w->parser, w->now);
    fy_parser_destroy(w->parser);
}

/* Stop at the first node. False: out of memory. */
static bool begin_walk(walk *w, const char *text)
{
    static const struct fy_parse_cfg cfg = {.flags = FYPCF_QUIET | FYPCF_ALLOW_DUPLICATE_KEYS};
    *w = (walk){.parser = fy_parser_create(&cfg), .text = text};
    if (!w->parser || fy_parser_set_string(w->parser, text, FY_NT) != 0) {
        end_walk(w);
        return false;
    }
    do
        next(w);
    while (w->now && (w->now->type == FYET_STREAM_START || w->now->type == FYET_DOCUMENT_START));
    return true;
}

static bool is_end(const walk *w)
{
    return !w->now || w->now->type == FYET_MAPPING_END || w->now->type == FYET_SEQUENCE_END ||
           w->now->type == FYET_DOCUMENT_END || w->now->type == FYET_STREAM_END;
}

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

static size_t mark_of(const struct fy_mark *m) { return m ? m->input_pos : 0; }

static enum fy_node_style style_of(const walk *w) { return fy_event_get_node_style(w->now); }

/* Where the node's anchor or tag begins, or `start`. */
static size_t with_properties(const walk *w, size_t start)
{
    struct fy_token *const all[] = {fy_event_get_anchor_token(w->now), fy_event_get_tag_token(w->now)};
    for (int k = 0; k < 2; k++) {
        size_t at = all[k] ? mark_of(fy_token_start_mark(all[k])) : start;
        while (all[k] && at > 0 && !is_blank(w->text[at - 1]) && !strchr("[{,", w->text[at - 1]))
            at--;
        start = at < start ? at : start;
    }
    return start;
}

/* Behind the colon that follows a key; the key's end where there is none, as in {a, b}. */
static size_t behind_colon(const char *text, size_t key_end)
{
    const size_t at = key_end + strspn(text + key_end, " \t");
    return text[at] == ':' ? at + 1 : key_end;
}

/* The | or > of a block scalar, which is the first one after `from` that is in no comment. */
static size_t header_of(const char *text, size_t from)
{
    for (; text[from] && text[from] != '|' && text[from] != '>'; from++)
        if (text[from] == '#' && from > 0 && is_blank(text[from - 1]))
            from += strcspn(text + from, "\r\n") - 1;
    return from;
}

static span pass_scalar(walk *w, size_t from)
{
    const struct fy_mark *start = fy_event_start_mark(w->now), *end = fy_event_end_mark(w->now);
    const enum fy_node_style style = style_of(w);
    span s = {mark_of(start), mark_of(end), false, false};
    if (!start || (style != FYNS_SINGLE_QUOTED && style != FYNS_DOUBLE_QUOTED && s.start == s.end)) {
        s.empty = true;
        s.start = s.end = behind_colon(w->text, from);
    } else if (style == FYNS_SINGLE_QUOTED || style == FYNS_DOUBLE_QUOTED) {
        s.start--;
        s.end++;
    } else if (style == FYNS_LITERAL || style == FYNS_FOLDED) {
        s.start = header_of(w->text, from);
        while (s.end > s.start && is_blank(w->text[s.end - 1]))
            s.end--;
    }
    if (!s.empty)
        s.start = with_properties(w, s.start);
    next(w);
    return s;
}

/* Pass a node. from: the end of what stands before it. */
static span pass(walk *w, size_t from)
{
    if (is_end(w))
        return (span){from, from, true, false};
    if (w->now->type != FYET_MAPPING_START && w->now->type != FYET_SEQUENCE_START)
        return pass_scalar(w, from);
    const bool map = w->now->type == FYET_MAPPING_START;
    const size_t at = mark_of(fy_event_start_mark(w->now));
    const bool brackets = w->text[at] == (map ? '{' : '[') && style_of(w) == FYNS_FLOW;
    span s = {with_properties(w, at), at + brackets, false, style_of(w) == FYNS_BLOCK};
    next(w);
    for (bool key = map; !is_end(w); key = map && !key) {
        const span child = pass(w, s.end);
        s.start = child.start < s.start ? child.start : s.start;
        s.end = child.end;
    }
    if (brackets && w->now)
        s.end = mark_of(fy_event_end_mark(w->now));
    next(w);
    return s;
}

/* ---- the place of a change ---- */

typedef struct place {
    bool found, flow; /* there is a value; it is in a flow collection */
    bool item;        /* of a list */
    span value;       /* found: the value */
    size_t from;      /* found: the end of the key */
    size_t first;     /* not found: where the first key of the map begins, which lacks the name, */
    size_t end;       /* and where its last entry ends */
    bool bare;        /* a map of one pair without braces, in a list */
    bool no_entry;    /* {} */
} place;

static bool is_name(const walk *w, const char *name, size_t n)
{
    size_t size = 0;
    const char *text = w->now && w->now->type == FYET_SCALAR ? fy_token_get_text(w->now->scalar.value, &size) : NULL;
    return text && size == n && memcmp(text, name, n) == 0;
}

/* Look for a name in the map that begins now. True: stopped at its value; *from is then the key's end. */
static bool look_in_map(walk *w, const char *name, size_t n, place *p)
{
    const size_t at = mark_of(fy_event_start_mark(w->now));
    p->bare = style_of(w) == FYNS_FLOW && w->text[at] != '{';
    p->end = at + (style_of(w) == FYNS_FLOW && !p->bare);
    p->no_entry = true;
    next(w);
    while (!is_end(w)) {
        const bool is = is_name(w, name, n);
        const span key = pass(w, p->end);
        if (p->no_entry)
            p->first = key.start;
        p->no_entry = false;
        p->from = key.end;
        if (is)
            return true;
        p->end = pass(w, key.end).end;
    }
    return false;
}

static bool look_in_list(walk *w, const char *name, place *p)
{
    size_t end = mark_of(fy_event_end_mark(w->now));
    next(w);
    for (long k = strtol(name, NULL, 10); k > 0 && !is_end(w); k--)
        end = pass(w, end).end;
    p->from = end;
    return !is_end(w);
}

/* Find the place that a path names. Returns the rest of the path from the name that is missing on, or "". */
static const char *find(walk *w, const char *path, place *p)
{
    for (*p = (place){.found = false}; w->now;) {
        const size_t n = strcspn(path, ".=");
        const bool map = w->now->type == FYET_MAPPING_START;
        if (!map && w->now->type != FYET_SEQUENCE_START)
            return path;
        p->flow = p->flow || style_of(w) == FYNS_FLOW;
        p->item = !map;
        if (!(map ? look_in_map(w, path, n, p) : look_in_list(w, path, p)))
            return path;
        if (path[n] == '=') {
            p->found = true;
            p->value = pass(w, p->from);
            return "";
        }
        path += n + 1;
    }
    return path;
}

/* ---- the new value ---- */

/* A plain scalar may hold more in block style than in a flow collection. */
static void put_scalar(buffer *b, const char *text, size_t n, bool plain, bool flow)
{
    bool quote = false;
    for (size_t k = 0; plain && flow && k < n; k++)
        quote = quote || strchr(",[]{}", text[k]);
    if (!quote) {
        put(b, text, n);
        return;
    }
    put_all(b, "'");
    for (size_t k = 0; k < n; k++)
        put(b, text[k] == '\'' ? "''" : text + k, text[k] == '\'' ? 2 : 1);
    put_all(b, "'");
}

/* The node that begins now, as it is written, but collections in block style with brackets. */
static void put_node(buffer *b, walk *w, bool flow)
{
    const bool map = w->now && w->now->type == FYET_MAPPING_START;
    if (is_end(w))
        return;
    if (w->now->type == FYET_SCALAR || w->now->type == FYET_ALIAS || style_of(w) == FYNS_FLOW) {
        const bool plain = w->now->type == FYET_SCALAR && style_of(w) == FYNS_PLAIN;
        const span s = pass(w, 0);
        put_scalar(b, w->text + s.start, s.end - s.start, plain, flow);
        return;
    }
    put_all(b, map ? "{" : "[");
    next(w);
    for (int k = 0; !is_end(w); k++) {
        put_all(b, k == 0 ? "" : map && k % 2 ? ": " : ", ");
        put_node(b, w, true);
    }
    put_all(b, map ? "}" : "]");
    next(w);
}

/* The value of a change, for a place. */
static bool put_value(buffer *b, const char *set, bool flow)
{
    walk w;
    if (!begin_walk(&w, strchr(set, '=') + 1))
        return false;
    put_node(b, &w, flow);
    end_walk(&w);
    return true;
}

/* ---- the new text ---- */

static size_t line_start(const char *text, size_t at)
{
    while (at > 0 && text[at - 1] != '\n' && text[at - 1] != '\r')
        at--;
    return at;
}

static size_t line_end(const char *text, size_t at) { return at + strcspn(text + at, "\r\n"); }

/* As the text ends its lines. */
static const char *end_of_line(const char *text)
{
    const size_t n = strcspn(text, "\r\n");
    return text[n] == '\r' ? text[n + 1] == '\n' ? "\r\n" : "\r" : "\n";
}

/* A name and its value, or a chain of maps: a: {b: value}. */
static bool put_entry(buffer *b, const char *set, const char *rest, bool flow)
{
    int open = 0;
    for (size_t n; n = strcspn(rest, ".="), put(b, rest, n), put_all(b, ": "), rest[n] == '.'; rest += n + 1, open++)
        put_all(b, "{");
    const bool good = put_value(b, set, flow || open);
    while (open-- > 0)
        put_all(b, "}");
    return good;
}

static bool replace(buffer *b, const char *text, const place *p, const char *set)
{
    const size_t colon = p->item ? p->value.start : behind_colon(text, p->from), end = line_end(text, colon);
    bool good;
    if (!p->item && p->value.block &&
        p->value.start > end) { /* it begins on another line: what follows the key stays */
        put(b, text, colon);
        put_all(b, " ");
        good = put_value(b, set, p->flow);
        put(b, text + colon, end - colon);
    } else {
        put(b, text, p->value.start);
        put_all(b, !p->value.empty || p->item ? "" : colon > p->from ? " " : ": ");
        put_all(b, !p->value.empty && p->value.start > 0 && text[p->value.start - 1] == ':' ? " " : "");
        good = put_value(b, set, p->flow);
    }
    put_all(b, text + p->value.end);
    return good;
}

/* The rest of the path is new in the map. */
static bool insert(buffer *b, const char *text, const place *p, const char *set, const char *rest)
{
    const size_t at = p->flow ? p->end : line_end(text, p->end);
    bool good;
    put(b, text, p->bare ? p->first : at);
    if (p->bare) {
        put_all(b, "{");
        put(b, text + p->first, at - p->first);
    }
    if (p->flow)
        put_all(b, p->no_entry ? "" : ", ");
    else {
        put_all(b, end_of_line(text));
        for (size_t k = line_start(text, p->first); k < p->first; k++)
            put_all(b, " ");
    }
    good = put_entry(b, set, rest, p->flow);
    put_all(b, p->bare ? "}" : "");
    put_all(b, text + at);
    return good;
}

/* NULL: out of memory. */
static char *edited_by(const char *text, const char *set)
{
    buffer b = {.text = NULL};
    place p;
    walk w;
    if (!begin_walk(&w, text))
        return NULL;
    const char *rest = find(&w, set, &p);
    const bool good = p.found ? replace(&b, text, &p, set) : insert(&b, text, &p, set, rest);
    end_walk(&w);
    if (good && !b.failed)
        return b.text;
    free(b.text);
    return NULL;
}

char *yaml_edited(const char *text, int sets, const char *const *set)
{
    char *now = strdup(text);
    for (int k = 0; now && k < sets; k++) {
        char *after = edited_by(now, set[k]);
        free(now);
        now = after;
    }
    return now;
}
