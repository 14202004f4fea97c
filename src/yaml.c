#include "yaml.h"

#include <errno.h>
#include <libfyaml.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "yaml_text.h"

/* Where a node, and what is in it, comes from; kept with nodes that a --set made, and with those around them. */
typedef struct origin {
    const char *set; /* NULL: the file */
    int start;       /* the column at which the text that libfyaml saw begins in it */
    bool placed;     /* the node's own place in that text is known: libfyaml can't say it once something in it has changed */
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

/* ---- errors ---- */

#define NAME_LETTERS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-"

enum { MAX_ANCHORS = 1000 };

static const char scene_expected[] = "expected a map with camera, lights, materials and objects";
static const char set_name[] = "--set";

/* libfyaml's next report. */
static struct fy_diag_error *next_report(yaml *y)
{
    void *last = y->seen;
    struct fy_diag_error *k = fy_diag_errors_iterate(y->diag, &last);
    if (k)
        y->seen = last;
    return k;
}

/* libfyaml knows where a node begins; it is asked by letting it collect a report about the node. */
static bool place(yaml *y, node *at, int *line, int *column)
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
    for (; (k = next_report(y)); found = true) {
        *line = k->line;
        *column = k->column;
    }
    return found;
}

static const origin *origin_of(node *at)
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

/* An empty value has no place, nor has a map that begins with one: it is that of its key, or of what is around it. */
static void nearest_place(yaml *y, node *at, int *line, int *column)
{
    *line = *column = 1;
    for (; at && !place(y, at, line, column); at = fy_node_get_parent(at)) {
        node *key = key_of(fy_node_get_parent(at), at), *first = key_of(at, NULL);
        if ((first && place(y, first, line, column)) || (key && place(y, key, line, column)))
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

/* A place in the text of the file, or in the value of a --set. */
static bool tell(yaml *y, const origin *o, int line, int column, const char *message)
{
    const bool set = o && o->set;
    if (set && line == 1)
        column += o->start - 1;
    return text_error(y->errors, set ? set_name : y->path, set ? o->set : y->text, line, column, message);
}

static bool error_at(yaml *y, node *at, size_t offset, const char *fmt, va_list args)
{
    char message[1024];
    int line = 1, column = 1;
    if (y->errors->count >= ERRORS_SHOWN) {
        y->errors->count++;
        return false;
    }
    vsnprintf(message, sizeof message, fmt, args);
    const origin *o = origin_of(at);
    struct fy_token *token = offset && fy_node_is_scalar(at) ? fy_node_get_scalar_token(at) : NULL;
    const struct fy_mark *mark = token ? fy_token_start_mark(token) : NULL;
    if (!mark)
        nearest_place(y, at, &line, &column);
    else {
        const char *text = o && o->set ? o->set + o->start - 1 : y->text;
        text_place(text, text_offset(text, mark->input_pos, style_of(token), offset), &line, &column);
    }
    return tell(y, o, line, column, message);
}

bool yaml_error_in(yaml *y, node *at, size_t offset, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    error_at(y, at, offset, fmt, args);
    va_end(args);
    return false;
}

bool yaml_error(yaml *y, node *at, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    error_at(y, at, 0, fmt, args);
    va_end(args);
    return false;
}

/* How many letters must be inserted, left out, replaced or swapped with the next to make a of b; up to 31 letters each. */
static int distance(const char *a, size_t n, const char *b, size_t m)
{
    int row[3][32];
    for (size_t i = 0; i <= n; i++)
        for (size_t j = 0; j <= m; j++) {
            int *d = row[i % 3], *above = row[(i + 2) % 3], *before = row[(i + 1) % 3];
            if (i == 0 || j == 0) {
                d[j] = (int)(i + j);
                continue;
            }
            d[j] = above[j - 1] + (a[i - 1] != b[j - 1]);
            d[j] = above[j] + 1 < d[j] ? above[j] + 1 : d[j];
            d[j] = d[j - 1] + 1 < d[j] ? d[j - 1] + 1 : d[j];
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] && before[j - 2] + 1 < d[j])
                d[j] = before[j - 2] + 1;
        }
    return row[n % 3][m];
}

void yaml_nearest(const char *text, const char *words, char *out, size_t size)
{
    int best = (int)(strlen(text) + 2) / 3 + 1; /* nearer than about a third of the word */
    *out = 0;
    if (strlen(text) > 31)
        return;
    for (const char *w = words; *w;) {
        size_t n = strcspn(w, " ");
        int d = n <= 31 ? distance(text, strlen(text), w, n) : best;
        if (d < best) {
            best = d;
            snprintf(out, size, "%.*s", (int)n, w);
        }
        w += n + (w[n] == ' ');
    }
}

/* ---- opening ---- */

/* Why these bytes are no scene, as an error with its place; true: they may be one. */
static bool is_text(const char *path, const char *text, size_t n, errors *e)
{
    char message[80];
    int line, column;
    size_t bad = text_not_utf8(text, n);
    const char *zero = memchr(text, 0, bad);
    if (n > YAML_MAX_BYTES)
        return errors_add(e, "%s: the scene is too large, expected at most %d MiB", path, YAML_MAX_BYTES >> 20);
    int anchors = 0; /* libfyaml's time grows with their square */
    for (size_t k = 0; k < n; k++)
        anchors += text[k] == '&';
    if (anchors > MAX_ANCHORS)
        return errors_add(e, "%s: %d times '&', expected at most %d: kage takes no anchors", path, anchors, MAX_ANCHORS);
    if (!zero && bad == n)
        return text[strspn(text, " \t\r\n")] ||
               errors_add(e, "%s:1:1: an empty file, %s", path, scene_expected);
    bad = zero ? (size_t)(zero - text) : bad;
    text_place(text, bad, &line, &column);
    snprintf(message, sizeof message, "the byte 0x%02X, expected a text in UTF-8", (unsigned)(unsigned char)text[bad]);
    return text_error(e, path, text, line, column, message);
}

static char *read_all(const char *path, size_t *size, errors *e)
{
    FILE *f = fopen(path, "rb");
    char *text = f ? malloc(YAML_MAX_BYTES + 2) : NULL;
    size_t n = 0;
    bool good = text != NULL;
    if (text) {
        errno = 0;
        n = fread(text, 1, YAML_MAX_BYTES + 1, f);
        good = !ferror(f);
        text[n] = 0;
    }
    if (!good)
        errors_add(e, "%s: can't read the scene: %s", path, strerror(errno));
    if (f)
        fclose(f);
    if (good && n >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0) /* a byte order mark */
        memmove(text, text + 3, (n -= 3) + 1);
    if (!good || !is_text(path, text, n, e)) {
        free(text);
        return NULL;
    }
    *size = n;
    char *fit = realloc(text, n + 1);
    return fit ? fit : text;
}

/* libfyaml's words where they leave a person wondering. */
static const char *reworded(const char *message)
{
    static const char *const words[][2] = {
        {"invalid tab as indendation in a mapping", "a tab as indentation, expected spaces"},
        {"did not find expected node content", "no value here, expected one, or the bracket that closes"},
        {"could not find expected ':'", "a line without ':', expected 'key: value'"},
        {"Max depth (64) exceeded", "nested too deep, expected at most 64 levels"},
        {"flow sequence without a closing bracket", "a list that is not closed, expected ']'"},
        {"flow mapping without a closing brace", "a map that is not closed, expected '}'"},
    };
    for (size_t k = 0; k < sizeof words / sizeof *words; k++)
        if (strcmp(message, words[k][0]) == 0)
            return words[k][1];
    return message;
}

/* What libfyaml itself has found wrong with the text. The first: the ones after it are mostly its consequences. */
static bool syntax_errors(yaml *y, const origin *o)
{
    struct fy_diag_error *k;
    bool told = false;
    while ((k = next_report(y)))
        if (k->line >= 1 && !told) {
            tell(y, o, k->line, k->column, reworded(k->msg));
            told = true;
        }
    return told ? false : tell(y, o, 1, 1, o ? "no value here" : "no scene here, only comments");
}

static struct fy_diag *new_diag(void)
{
    struct fy_diag_cfg cfg;
    fy_diag_cfg_default(&cfg);
    cfg.fp = NULL;
    cfg.colorize = false;
    struct fy_diag *d = fy_diag_create(&cfg);
    if (d)
        fy_diag_set_collect_errors(d, true);
    return d;
}

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
    return text_error(y->errors, set_name, set, line, column, message);
}

/* The index of a word among words separated by spaces, -1 where it is none of them. */
static int among(const char *word, const char *words)
{
    size_t length = strlen(word);
    for (int i = 0; *words; i++) {
        size_t n = strcspn(words, " ");
        if (n == length && strncmp(words, word, n) == 0)
            return i;
        words += n + (words[n] == ' ');
    }
    return -1;
}

/* Before something in a node changes: keep its place, and those of the nodes around it. */
static void keep_places(yaml *y, node *at)
{
    for (; at; at = fy_node_get_parent(at)) {
        origin *own = fy_node_get_meta(at), *o = own ? own : &y->origins[y->count_origins];
        const origin *around = origin_of(at);
        if (own && own->placed)
            return;
        if (!own)
            *o = around ? *around : (origin){NULL, 1, false, 1, 1};
        o->placed = false;
        nearest_place(y, at, &o->line, &o->column);
        o->placed = true;
        if (!own) {
            y->count_origins++;
            fy_node_set_meta(at, o);
        }
    }
}

/* A new node from a part of a setting, with its origin. NULL: an error is told. */
static node *made(yaml *y, const char *set, const char *at, size_t n, bool key)
{
    int line, column;
    char *quoted = key ? malloc(n + 3) : NULL; /* the document's, once it is parsed */
    if (key && !quoted) {
        errors_add(y->errors, "out of memory");
        return NULL;
    }
    origin *o = &y->origins[y->count_origins];
    text_place(set, (size_t)(at - set), &line, &column);
    *o = (origin){set, key ? 1 : column, key, line, column};
    if (key)
        snprintf(quoted, n + 3, "\"%.*s\"", (int)n, at);
    node *new = key ? fy_node_build_from_malloc_string(y->doc, quoted, FY_NT) : fy_node_build_from_string(y->doc, at, FY_NT);
    if (!new) {
        syntax_errors(y, o);
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

/* The node that the first n letters of k lead to from a node; NULL where there is none, with an error where it can't be
 * added either. *index: its place in a list, else -1. */
static bool step(yaml *y, const char *set, const char *k, size_t n, node *at, const char *optional, node **next, int *index)
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
        return set_error(y, set, k, "no '%s' here: what stands before it is a single value, expected a map or a list", key);
    *next = fy_node_mapping_lookup_by_string(at, key, n);
    if (*next || last)
        return true;
    if (root && among(key, optional) >= 0) {
        keep_places(y, at);
        *next = fy_node_create_mapping(y->doc);
        fy_node_set_meta(*next, &y->origins[y->count_origins]); /* that of its key */
        return append(y, set, k, n, at, *next);
    }
    keys_of(at, keys, sizeof keys);
    if (!*keys)
        return set_error(y, set, k, "the scene has no '%s' here, there is nothing here", key);
    yaml_nearest(key, keys, near, sizeof near);
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
            return set_error(y, set, k, "no name here, expected names of letters, digits, _ and - with dots between them");
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

/* The file's document, the only one in it. */
static bool load(yaml *y)
{
    struct fy_parse_cfg cfg = {.flags = FYPCF_QUIET | FYPCF_COLLECT_DIAG | FYPCF_ALLOW_DUPLICATE_KEYS, .diag = y->diag};
    struct fy_parser *parser = fy_parser_create(&cfg);
    bool good = parser && fy_parser_set_string(parser, y->text, y->size) == 0;
    y->doc = good ? fy_parse_load_document(parser) : NULL;
    struct fy_document *second = y->doc ? fy_parse_load_document(parser) : NULL;
    if (!y->doc || fy_parser_get_stream_error(parser))
        good = syntax_errors(y, NULL);
    else if (!fy_document_root(y->doc) || !fy_node_is_mapping(fy_document_root(y->doc)))
        good = yaml_error(y, fy_document_root(y->doc), "no scene here, %s", scene_expected);
    else if (second)
        good = yaml_error(y, fy_document_root(second), "a second document, expected one scene a file");
    fy_document_destroy(second);
    fy_parser_destroy(parser);
    return good;
}

yaml *yaml_open(const char *path, int sets, char *const *set, const char *optional, errors *e)
{
    yaml *y = calloc(1, sizeof *y);
    if (!y) {
        errors_add(e, "%s: out of memory", path);
        return NULL;
    }
    y->errors = e;
    y->path = strdup(path);
    y->text = read_all(path, &y->size, e);
    y->diag = new_diag();
    size_t origins = 1;
    for (int k = 0; k < sets; k++, origins += 5) /* the root, a map, two keys and a value, and what lies on the path */
        for (const char *c = set[k]; *c; c++)
            origins += *c == '.';
    y->origins = calloc(origins, sizeof *y->origins);
    if (!y->path || !y->text || !y->diag || !y->origins || !load(y)) {
        yaml_close(y);
        return NULL;
    }
    fy_document_register_meta(y->doc, NULL, NULL);
    for (int k = 0; k < sets; k++)
        apply(y, set[k], optional);
    return y;
}

void yaml_close(yaml *y)
{
    if (!y)
        return;
    for (int k = 0; k < y->count; k++)
        free(y->scalars[k]);
    free(y->scalars);
    fy_document_destroy(y->doc);
    fy_diag_destroy(y->diag);
    free(y->origins);
    free(y->path);
    free(y->text);
    free(y);
}

node *yaml_root(const yaml *y) { return fy_document_root(y->doc); }

const char *yaml_source(const yaml *y) { return y->text; }

/* ---- values ---- */

static bool is_empty(node *at)
{
    const char *text = fy_node_is_scalar(at) ? fy_node_get_scalar0(at) : NULL;
    return fy_node_is_scalar(at) && !fy_node_is_alias(at) && !(text && *text);
}

static const char *kind_of(node *at)
{
    if (fy_node_is_alias(at))
        return "an alias, which kage does not take";
    if (fy_node_is_mapping(at))
        return "a map";
    if (fy_node_is_sequence(at))
        return "a list";
    return is_empty(at) ? "nothing here" : "a single value";
}

bool yaml_map(yaml *y, node *at, const char *what, const char *keys)
{
    if (!fy_node_is_mapping(at))
        return yaml_error(y, at, "%s is %s, expected a map", what, is_empty(at) ? "empty" : kind_of(at));
    bool good = true;
    unsigned seen = 0;
    void *next = NULL;
    struct fy_node_pair *p;
    while (keys && (p = fy_node_mapping_iterate(at, &next))) {
        char near[64];
        node *key = fy_node_pair_key(p);
        const char *text = key && fy_node_is_scalar(key) && !fy_node_is_alias(key) ? fy_node_get_scalar0(key) : NULL;
        int k = text ? among(text, keys) : -1;
        if (k >= 0 && !(seen & 1u << k)) {
            seen |= 1u << k;
            continue;
        }
        yaml_nearest(text ? text : "", keys, near, sizeof near);
        if (k >= 0)
            good = yaml_error(y, key, "a second '%s' in %s, expected one", text, what);
        else if (!text)
            good = yaml_error(y, key ? key : at, "%s as a key, expected one of: %s", key ? kind_of(key) : "nothing", keys);
        else if (*near)
            good = yaml_error(y, key, "%s has no '%.60s', did you mean '%s'?", what, text, near);
        else
            good = yaml_error(y, key, "%s has no '%.60s', expected one of: %s", what, text, keys);
    }
    return good;
}

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

static bool scalar(yaml *y, node *at, const char *what)
{
    if (at && fy_node_is_scalar(at) && !fy_node_is_alias(at))
        return true;
    return yaml_error(y, at, "%s, expected %s", kind_of(at), what);
}

const char *yaml_text(yaml *y, node *at, const char *what)
{
    if (!scalar(y, at, what))
        return NULL;
    const char *text = fy_node_get_scalar0(at);
    if (!text || !*text) {
        yaml_error(y, at, "nothing here, expected %s", what);
        return NULL;
    }
    char **more = realloc(y->scalars, sizeof *more * (size_t)(y->count + 1)), *copy = strdup(text);
    if (more)
        y->scalars = more;
    if (!more || !copy) {
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
    if (!scalar(y, at, what))
        return false;
    const char *text = fy_node_get_scalar0(at);
    double v;
    if (!text || !number(text, &v))
        return yaml_error(y, at, "%s%.60s%s, expected %s", text && *text ? "'" : "", text && *text ? text : "nothing",
                          text && *text ? "' is no number" : " here", what);
    if (v < lo || v > hi)
        return yaml_error(y, at, "%.60s is %s than %.7g, expected %s", text, v < lo ? "less" : "more", v < lo ? lo : hi, what);
    if (open && v <= lo)
        return yaml_error(y, at, "%.60s is too small, expected %s", text, what);
    *x = v;
    return true;
}

bool yaml_whole(yaml *y, node *at, int lo, int hi, const char *what, int *x)
{
    double v;
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

bool yaml_numbers(yaml *y, node *at, int n, double lo, double hi, const char *what, double *x)
{
    if (!fy_node_is_sequence(at))
        return yaml_error(y, at, "%s, expected %s", kind_of(at), what);
    int count = fy_node_sequence_item_count(at);
    if (count != n)
        return yaml_error(y, at, "%d value%s, expected %s", count, count == 1 ? "" : "s", what);
    bool good = true;
    for (int i = 0; i < n; i++)
        good = yaml_number(y, fy_node_sequence_get_by_index(at, i), lo, false, hi, what, &x[i]) && good;
    return good;
}

int yaml_word(yaml *y, node *at, const char *words, const char *what)
{
    char near[64];
    const char *text = yaml_text(y, at, what);
    if (!text)
        return -1;
    int i = among(text, words);
    if (i >= 0)
        return i;
    yaml_nearest(text, words, near, sizeof near);
    yaml_error(y, at, "'%.60s' is unknown, expected %s%s%s%s", text, what, *near ? "; did you mean '" : "", near, *near ? "'?" : "");
    return -1;
}
