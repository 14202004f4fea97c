#include "yaml.h"

#include <errno.h>
#include <libfyaml.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct yaml {
    char *path, *text;
    size_t size;
    struct fy_diag *diag;
    struct fy_document *doc;
    char *const *set;
    int sets;
    errors *errors;
    char **scalars; /* texts handed out */
    int count;
};

/* ---- errors ---- */

/* The message with its place, the line and a caret. line and column count from 1; `text` is what the line is in. */
static void tell(yaml *y, const char *name, const char *text, int line, int column, int shown, const char *message)
{
    const char *from = text;
    for (int k = 1; k < line && from; k++) {
        from = strchr(from, '\n');
        from = from ? from + 1 : NULL;
    }
    if (!from) {
        errors_add(y->errors, "%s:%d:%d: %s", name, line, column, message);
        return;
    }
    int length = (int)strcspn(from, "\r\n"), at = column - 1 < length ? column - 1 : length;
    /* of a very long line the part around the caret */
    int skip = at > 100 ? at - 60 : 0, width = length - skip > 160 ? 160 : length - skip;
    char blank[256];
    int pad = at - skip;
    for (int k = 0; k < pad; k++) /* a tab is as wide below as above, an UTF-8 tail is nothing */
        blank[k] = from[skip + k] == '\t' ? '\t' : ' ';
    blank[pad] = 0;
    errors_add(y->errors, "%s:%d:%d: %s\n%5d | %.*s\n      | %s^", name, shown, column, message, line, width, from + skip,
               blank);
}

static const char *set_of(node *at, const yaml *y)
{
    for (; at; at = fy_node_get_parent(at)) {
        void *meta = fy_node_get_meta(at);
        if (meta)
            return y->set[(char *const *)meta - y->set];
    }
    return NULL;
}

static void tell_at(yaml *y, const char *set, int line, int column, const char *message)
{
    if (!set) {
        tell(y, y->path, y->text, line, column, line, message);
        return;
    }
    int k = 0;
    while (y->set[k] != set)
        k++;
    tell(y, "--set", set, 1, column + (int)(strchr(set, '=') - set) + 1, k + 1, message);
}

/* libfyaml knows where a node begins; it is asked by letting it collect a report about the node. */
static bool place(yaml *y, node *at, int *line, int *column)
{
    void *last = NULL;
    struct fy_diag_error *found = NULL, *k;
    fy_node_report(at, FYET_ERROR, "%s", "here");
    while ((k = fy_diag_errors_iterate(y->diag, &last)))
        found = k;
    if (!found)
        return false;
    *line = found->line;
    *column = found->column;
    return true;
}

static bool error_at(yaml *y, node *at, size_t offset, const char *fmt, va_list args)
{
    char message[1024];
    int line = 1, column = 1;
    vsnprintf(message, sizeof message, fmt, args);
    if (!place(y, at, &line, &column))
        return errors_add(y->errors, "%s: %s", y->path, message);
    enum fy_scalar_style quoted = FYSS_PLAIN;
    struct fy_token *token = fy_node_is_scalar(at) ? fy_node_get_scalar_token(at) : NULL;
    if (token)
        quoted = fy_token_scalar_style(token);
    if (offset && (quoted == FYSS_SINGLE_QUOTED || quoted == FYSS_DOUBLE_QUOTED))
        offset++;
    tell_at(y, set_of(at, y), line, column + (int)offset, message);
    return false;
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

/* Levenshtein's distance, for words of up to 31 letters. */
static int distance(const char *a, size_t n, const char *b, size_t m)
{
    int row[32];
    for (size_t j = 0; j <= m; j++)
        row[j] = (int)j;
    for (size_t i = 1; i <= n; i++) {
        int diagonal = row[0];
        row[0] = (int)i;
        for (size_t j = 1; j <= m; j++) {
            int best = diagonal + (a[i - 1] != b[j - 1]);
            diagonal = row[j];
            best = row[j] + 1 < best ? row[j] + 1 : best;
            row[j] = row[j - 1] + 1 < best ? row[j - 1] + 1 : best;
        }
    }
    return row[m];
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

static char *read_all(const char *path, size_t *size, errors *e)
{
    FILE *f = fopen(path, "rb");
    char *text = f ? malloc(YAML_MAX_BYTES + 1) : NULL;
    size_t n = 0;
    bool failed = !text;
    if (text) {
        errno = 0;
        n = fread(text, 1, YAML_MAX_BYTES + 1, f);
        failed = ferror(f) != 0;
    }
    if (failed)
        errors_add(e, "%s: can't read the scene: %s", path, strerror(errno));
    else if (n > YAML_MAX_BYTES)
        failed = !errors_add(e, "%s: the scene is too large, expected at most %d MiB", path, YAML_MAX_BYTES >> 20);
    else if (memchr(text, 0, n))
        failed = !errors_add(e, "%s: not a text file: byte %zu is 0", path,
                             (size_t)((char *)memchr(text, 0, n) - text));
    if (f)
        fclose(f);
    if (failed) {
        free(text);
        return NULL;
    }
    text[n] = 0;
    *size = n;
    char *fit = realloc(text, n + 1);
    return fit ? fit : text;
}

/* What libfyaml itself has found wrong with the text. */
static void syntax_errors(yaml *y, const char *set)
{
    void *last = NULL;
    struct fy_diag_error *k;
    int told = 0;
    while ((k = fy_diag_errors_iterate(y->diag, &last)))
        if (k->line >= 1 && told++ == 0) /* the ones after it are mostly its consequences */
            tell_at(y, set, k->line, k->column, k->msg);
    if (!told)
        tell_at(y, set, 1, 1, "not YAML");
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
    va_list args;
    int k = 0;
    va_start(args, fmt);
    vsnprintf(message, sizeof message, fmt, args);
    va_end(args);
    while (y->set[k] != set)
        k++;
    tell(y, "--set", set, 1, (int)(at - set) + 1, k + 1, message);
    return false;
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

/* Make one change: go down the path, then put the value in its place. */
static bool apply(yaml *y, char *const *setting, const char *optional)
{
    const char *set = *setting, *equals = strchr(set, '='), *k = set;
    node *at = fy_document_root(y->doc);
    if (!equals || equals == set)
        return set_error(y, set, set, "not a setting, expected PATH=VALUE, as objects.ground.bump.scale=0.1");
    if (strlen(set) > 65536)
        return errors_add(y->errors, "--set: more than 65536 characters");
    for (;;) {
        size_t n = strcspn(k, ".=");
        char key[64], near[64], keys[2048];
        if (n == 0 || n >= sizeof key)
            return set_error(y, set, k, "no name here, expected names with single dots between them");
        snprintf(key, sizeof key, "%.*s", (int)n, k);
        bool last = k[n] == '=';
        node *next = NULL;
        int index = -1;
        if (fy_node_is_mapping(at)) {
            next = fy_node_mapping_lookup_by_string(at, key, n);
            if (!next && !last && at == fy_document_root(y->doc) && among(key, optional) >= 0) {
                next = fy_node_create_mapping(y->doc);
                fy_node_mapping_append(at, fy_node_create_scalar_copy(y->doc, key, n), next);
            }
            if (!next && !last) {
                keys_of(at, keys, sizeof keys);
                yaml_nearest(key, keys, near, sizeof near);
                return set_error(y, set, k, "the scene has no '%s' here%s%s%s", key, *near ? ", did you mean '" : "", near,
                                 *near ? "'?" : "");
            }
        } else if (fy_node_is_sequence(at)) {
            char *end;
            long i = strtol(key, &end, 10);
            int count = fy_node_sequence_item_count(at);
            if (*end || i < 0 || i >= count)
                return set_error(y, set, k, "no item '%s', expected a number from 0 to %d", key, count - 1);
            index = (int)i;
            next = fy_node_sequence_get_by_index(at, index);
        } else
            return set_error(y, set, k, "'%s' has nothing to be set in: it is below a single value", key);
        if (!last) {
            at = next;
            k += n + 1;
            continue;
        }
        node *value = fy_node_build_from_string(y->doc, equals + 1, FY_NT);
        if (!value) {
            if (!equals[1])
                return set_error(y, set, equals + 1, "no value, expected one after '='");
            syntax_errors(y, set);
            return false;
        }
        fy_node_set_meta(value, (void *)setting);
        int failed;
        if (index >= 0) {
            fy_node_sequence_insert_before(at, next, value);
            fy_node_free(fy_node_sequence_remove(at, next));
            failed = 0;
        } else if (next) {
            failed = fy_node_pair_set_value(fy_node_mapping_lookup_pair_by_string(at, key, n), value);
        } else
            failed = fy_node_mapping_append(at, fy_node_create_scalar_copy(y->doc, key, n), value);
        return !failed || set_error(y, set, set, "can't be set");
    }
}

yaml *yaml_open(const char *path, int sets, char *const *set, const char *optional, errors *e)
{
    yaml *y = calloc(1, sizeof *y);
    if (!y) {
        errors_add(e, "%s: out of memory", path);
        return NULL;
    }
    y->errors = e;
    y->set = set;
    y->sets = sets;
    y->path = strdup(path);
    y->text = read_all(path, &y->size, e);
    y->diag = new_diag();
    if (y->path && y->text && y->diag) {
        struct fy_parse_cfg cfg = {.flags = FYPCF_QUIET | FYPCF_COLLECT_DIAG, .diag = y->diag};
        y->doc = fy_document_build_from_string(&cfg, y->text, y->size);
        if (!y->doc)
            syntax_errors(y, NULL);
        else if (!fy_document_root(y->doc) || !fy_node_is_mapping(fy_document_root(y->doc))) {
            errors_add(e, "%s:1:1: no scene here, expected a map with camera, lights, materials and objects", path);
            fy_document_destroy(y->doc);
            y->doc = NULL;
        }
    }
    if (!y->doc) {
        yaml_close(y);
        return NULL;
    }
    fy_document_register_meta(y->doc, NULL, NULL);
    for (int k = 0; k < sets; k++)
        apply(y, &set[k], optional);
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
    free(y->path);
    free(y->text);
    free(y);
}

node *yaml_root(const yaml *y) { return fy_document_root(y->doc); }

const char *yaml_source(const yaml *y) { return y->text; }

/* ---- values ---- */

static const char *kind_of(node *at)
{
    if (fy_node_is_alias(at))
        return "an alias (kage takes none: write the value out)";
    return fy_node_is_mapping(at) ? "a map" : fy_node_is_sequence(at) ? "a list" : "a single value";
}

bool yaml_map(yaml *y, node *at, const char *what, const char *keys)
{
    if (!fy_node_is_mapping(at))
        return yaml_error(y, at, "%s is %s, expected a map", what, kind_of(at));
    bool good = true;
    for (int i = 0; keys && i < yaml_size(at); i++) {
        node *key;
        char near[64];
        yaml_pair(at, i, &key);
        const char *text = fy_node_is_alias(key) ? NULL : fy_node_get_scalar0(key);
        if (text && among(text, keys) >= 0)
            continue;
        yaml_nearest(text ? text : "", keys, near, sizeof near);
        if (*near)
            good = yaml_error(y, key, "%s has no '%.60s', did you mean '%s'?", what, text, near);
        else
            good = yaml_error(y, key, "%s has no '%.60s', expected one of: %s", what, text ? text : "", keys);
    }
    return good;
}

node *yaml_get(node *map, const char *key) { return fy_node_mapping_lookup_by_string(map, key, FY_NT); }

node *yaml_need(yaml *y, node *map, const char *key, const char *what)
{
    node *v = yaml_get(map, key);
    if (!v)
        yaml_error(y, map, "%s lacks '%s'", what, key);
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
        return yaml_error(y, at, "'%.60s' is no number, expected %s", text ? text : "", what);
    if (v < lo || (open && v <= lo) || v > hi)
        return yaml_error(y, at, "%.60s is out of range, expected %s", text, what);
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
        return yaml_error(y, at, "%d values, expected %s", count, what);
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
    yaml_error(y, at, "'%.60s', expected %s%s%s%s", text, what, *near ? "; did you mean '" : "", near, *near ? "'?" : "");
    return -1;
}
