/* Opening and closing: reads the file, checks its bytes, and loads the one document in it. */
#include "yaml/document.h"

#include "base/files.h"

#include <errno.h>
#include <libfyaml.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "yaml/text.h"

enum { MAX_ANCHORS = 1000 };

static const char scene_expected[] = "expected a map with camera, lights, materials and objects";

/* ---- the bytes ---- */

/* Are the bytes a text that can be a scene? If not, adds an error with its place. */
static bool is_text(const char *path, const char *text, size_t n, cap most, errors *e)
{
    char message[80];
    int line, column;
    size_t bad = text_not_utf8(text, n);
    const char *zero = memchr(text, 0, bad);
    if ((int64_t)n > most.most)
        return errors_add(e, "%s: the scene is too large, expected at most %lld bytes%s", path, (long long)most.most,
                          most.by);
    int anchors = 0; /* libfyaml's time grows with their square */
    for (size_t k = 0; k < n; k++)
        anchors += text[k] == '&';
    if (anchors > MAX_ANCHORS)
        return errors_add(e, "%s: %d times '&', expected at most %d: kage takes no anchors", path, anchors,
                          MAX_ANCHORS);
    if (!zero && bad == n)
        return text[strspn(text, " \t\r\n")] || errors_add(e, "%s:1:1: an empty file, %s", path, scene_expected);
    bad = zero ? (size_t)(zero - text) : bad;
    text_place(text, bad, &line, &column);
    snprintf(message, sizeof message, "the byte 0x%02X, expected a text in UTF-8", (unsigned)(unsigned char)text[bad]);
    return text_error(e, path, text, line, column, message);
}

/* A copy of the file, or of `text`, ended by a 0. The caller frees it. NULL: an error is added. */
static char *read_bytes(const char *path, const char *text, size_t *size, int64_t allowed, errors *e)
{
    const char *why = NULL;
    FILE *f = text ? NULL : files_open_input(path, &why);
    const size_t most = (size_t)allowed + 1, n = text && *size < most ? *size : most;
    char *bytes = text || f ? malloc(n + 1) : NULL;
    bool good = bytes != NULL;
    if (bytes && text)
        memcpy(bytes, text, *size = n);
    else if (bytes) {
        errno = 0;
        *size = fread(bytes, 1, n, f);
        good = !ferror(f);
        why = strerror(errno);
    }
    if (!good && (text || f) && !bytes)
        errors_add(e, "%s: out of memory", path);
    else if (!good)
        errors_add(e, "%s: can't read the scene: %s", path, why);
    else
        bytes[*size] = 0;
    if (f)
        fclose(f);
    if (good)
        return bytes;
    free(bytes);
    return NULL;
}

static char *read_all(const char *path, const char *from, size_t *size, cap most, errors *e)
{
    char *text = read_bytes(path, from, size, most.most, e);
    if (text && *size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0) /* a byte order mark */
        memmove(text, text + 3, (*size -= 3) + 1);
    if (!text || !is_text(path, text, *size, most, e)) {
        free(text);
        return NULL;
    }
    char *fit = realloc(text, *size + 1);
    return fit ? fit : text;
}

/* ---- the document ---- */

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

/* The file's document, the only one in it. */
static bool load(yaml *y)
{
    struct fy_parse_cfg cfg = {.flags = FYPCF_QUIET | FYPCF_COLLECT_DIAG | FYPCF_ALLOW_DUPLICATE_KEYS, .diag = y->diag};
    struct fy_parser *parser = fy_parser_create(&cfg);
    bool good = parser && fy_parser_set_string(parser, y->text, y->size) == 0;
    y->doc = good ? fy_parse_load_document(parser) : NULL;
    struct fy_document *second = y->doc ? fy_parse_load_document(parser) : NULL;
    if (!y->doc || fy_parser_get_stream_error(parser))
        good = yaml_syntax_errors(y, NULL);
    else if (!fy_document_root(y->doc) || !fy_node_is_mapping(fy_document_root(y->doc)))
        good = yaml_error(y, fy_document_root(y->doc), "no scene here, %s", scene_expected);
    else if (second)
        good = yaml_error(y, fy_document_root(second), "a second document, expected one scene a file");
    fy_document_destroy(second);
    fy_parser_destroy(parser);
    return good;
}

yaml *yaml_open(const char *path, const char *text, size_t size, int sets, const char *const *set, const char *optional,
                const limits *l, errors *e)
{
    yaml *y = calloc(1, sizeof *y);
    if (!y) {
        errors_add(e, "%s: out of memory", path);
        return NULL;
    }
    y->errors = e;
    y->path = strdup(path);
    y->size = size;
    y->text = read_all(path, text, &y->size, limit_of(l, LIMIT_SCENE, YAML_MAX_BYTES), e);
    y->diag = new_diag();
    const bool good = y->path && y->diag;
    if (!good)
        errors_add(e, "%s: out of memory", path);
    if (!good || !y->text || !load(y) || !yaml_change(y, sets, set, optional) ||
        !yaml_nesting_is_good(y, limit_of(l, LIMIT_NESTING, YAML_MAX_NESTING))) {
        yaml_close(y);
        return NULL;
    }
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
