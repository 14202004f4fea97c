/* Lists of points as PLY [Turk 1994]: a head of lines that describes elements, then their values as text or as bytes.
 * Only the element `vertex` with plain numbers is read. (assimp, which reads our meshes, drops properties that it does
 * not know, as scale and turn.)
 */
#include "points/parts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PROPERTIES = 256, SHOWN = 40, SHOW_EVERY = 1 << 16 };

typedef enum number_kind { INT8, UINT8, INT16, UINT16, INT32, UINT32, FLOAT32, FLOAT64, KINDS } number_kind;

static const size_t bytes_of[KINDS] = {1, 1, 2, 2, 4, 4, 4, 8};

typedef enum encoding { ASCII, LITTLE, BIG, ENCODINGS } encoding;

typedef struct head {
    encoding encoding;
    long long points; /* -1: no element `vertex` */
    bool done;        /* an element after it */
    int columns, kind[PROPERTIES];
    number_kind number[PROPERTIES];
    const char *values; /* where they begin */
} head;

/* ---- the head ---- */

static bool is_word(const char *at, const char *word)
{
    const size_t n = strlen(word);
    return strncmp(at, word, n) == 0 && strchr(" \t\r\n", at[n]);
}

/* The next word of the line. */
static const char *next_word(const char *at)
{
    at += strcspn(at, " \t\r\n");
    return at + strspn(at, " \t");
}

static bool read_format(const points_file *f, const char *at, head *h)
{
    static const char *const names[ENCODINGS] = {"ascii", "binary_little_endian", "binary_big_endian"};
    for (int k = 0; k < ENCODINGS; k++)
        if (is_word(at, names[k])) {
            h->encoding = (encoding)k;
            return true;
        }
    return points_wrong_at(f, at, "an unknown format, expected ascii, binary_little_endian or binary_big_endian");
}

static bool read_element(const points_file *f, const char *at, head *h)
{
    if (h->points >= 0) {
        h->done = true;
        return true;
    }
    if (!is_word(at, "vertex"))
        return points_wrong_at(f, at, "another element before 'vertex', expected that first");
    char *end;
    const char *number = next_word(at);
    h->points = strtoll(number, &end, 10);
    return (end > number && h->points >= 0 && h->points <= INT32_MAX) ||
           points_wrong_at(f, number, "no number of vertices, expected one of at most 2147483647");
}

static bool read_property(const points_file *f, const char *at, head *h)
{
    static const char *const names[2][KINDS] = {
        {"char", "uchar", "short", "ushort", "int", "uint", "float", "double"},
        {"int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"}};
    if (h->done)
        return true;
    if (h->points < 0)
        return points_wrong_at(f, at, "a property without an element, expected 'element vertex' first");
    if (h->columns == PROPERTIES)
        return points_wrong_at(f, at, "more than 256 properties, expected no more");
    int kind = 0;
    while (kind < KINDS && !is_word(at, names[0][kind]) && !is_word(at, names[1][kind]))
        kind++;
    if (kind == KINDS)
        return points_wrong_at(f, at, "an unknown type of a vertex's property, expected a number as float or int");
    const char *name = next_word(at);
    h->number[h->columns] = (number_kind)kind;
    h->kind[h->columns] = points_find(f, name, strcspn(name, " \t\r\n"));
    for (int k = 0; k < h->columns && h->kind[h->columns] != POINTS_NOTHING; k++)
        if (h->kind[k] == h->kind[h->columns])
            return points_wrong_at(f, name, "a second property of this name, expected each once");
    h->columns++;
    return true;
}

static bool read_head(const points_file *f, head *h)
{
    *h = (head){.encoding = ENCODINGS, .points = -1};
    for (const char *at = f->text; *at;) {
        const char *end = at + strcspn(at, "\r\n"), *next = end + (*end == '\r' && end[1] == '\n') + (*end != 0);
        bool good = true;
        if (is_word(at, "end_header")) {
            h->values = next;
            break;
        }
        if (is_word(at, "format"))
            good = read_format(f, next_word(at), h);
        else if (is_word(at, "element"))
            good = read_element(f, next_word(at), h);
        else if (is_word(at, "property"))
            good = read_property(f, next_word(at), h);
        if (!good)
            return false;
        at = next;
    }
    const char *what = !h->values                 ? "no line 'end_header'"
                       : h->encoding == ENCODINGS ? "no line 'format'"
                       : h->points < 0            ? "no 'element vertex'"
                                                  : NULL;
    if (what)
        return errors_add(f->e, "%s: %s, expected one in the head of a PLY file", f->name, what);
    for (int k = 0; f->column[k].name; k++) {
        bool there = !f->column[k].needed;
        for (int c = 0; c < h->columns; c++)
            there = there || h->kind[c] == k;
        if (!there)
            return errors_add(f->e, "%s: no property '%s' of the vertices, expected it", f->name, f->column[k].name);
    }
    return true;
}

/* ---- the values ---- */

static double number_at(const unsigned char *at, number_kind kind, bool big)
{
    const size_t n = bytes_of[kind];
    uint64_t v = 0;
    for (size_t k = 0; k < n; k++)
        v |= (uint64_t)at[k] << 8 * (big ? n - 1 - k : k);
    const uint32_t low = (uint32_t)v;
    float single;
    double whole;
    memcpy(&single, &low, sizeof single);
    memcpy(&whole, &v, sizeof whole);
    switch (kind) {
    case INT8:
        return (int8_t)v;
    case INT16:
        return (int16_t)v;
    case INT32:
        return (int32_t)low;
    case FLOAT32:
        return (double)single;
    case FLOAT64:
        return whole;
    default:
        return (double)v;
    }
}

static bool take(const points_file *f, int kind, double x)
{
    points *p = f->p;
    char message[256];
    if (kind >= 0) {
        p->v[kind][p->n] = x;
        points_check(&f->column[kind], x, message);
        return !*message || errors_add(f->e, "%s: vertex %d: %s", f->name, (int)p->n, message);
    }
    if (kind != POINTS_LABEL)
        return true;
    const int length = snprintf(message, sizeof message, "%.9g", x);
    const int32_t k = points_label(p, message, (size_t)length, p->n);
    p->label[p->n] = k;
    return k > -2 || errors_add(f->e, "%s: vertex %d: more than 256 numbers under '%s'", f->name, (int)p->n, f->label);
}

/* The file is shorter than its head says. Always false. */
static bool ends_early(const points_file *f, const head *h, const char **at)
{
    *at = f->text + f->size;
    return errors_add(f->e, "%s: the file ends at vertex %d, expected %lld", f->name, (int)f->p->n, h->points);
}

static bool read_bytes(const points_file *f, const head *h, const char **at)
{
    const char *const end = f->text + f->size;
    bool good = true;
    for (int k = 0; k < h->columns; k++) {
        const size_t n = bytes_of[h->number[k]];
        if ((size_t)(end - *at) < n)
            return ends_early(f, h, at);
        good = take(f, h->kind[k], number_at((const unsigned char *)*at, h->number[k], h->encoding == BIG)) && good;
        *at += n;
    }
    return good;
}

static bool read_text(const points_file *f, const head *h, const char **at)
{
    bool good = true;
    for (int k = 0; k < h->columns; k++) {
        double x = 0;
        *at += strspn(*at, " \t\r\n");
        const size_t n = strcspn(*at, " \t\r\n");
        const char *behind = *at;
        if (n == 0) /* at the end, or a byte of 0 */
            return ends_early(f, h, at);
        if (!points_number(&behind, &x) || behind != *at + n) {
            char message[128];
            snprintf(message, sizeof message, "'%.*s' is no number, expected a value of vertex %d",
                     (int)(n < SHOWN ? n : SHOWN), *at, (int)f->p->n);
            good = points_wrong_at(f, *at, message);
        } else
            good = take(f, h->kind[k], x) && good;
        *at += n;
    }
    return good;
}

bool points_ply(points_file *f)
{
    head h;
    const int before = f->e->count;
    if (!read_head(f, &h))
        return false;
    const cap most = progress_limit(f->progress, LIMIT_COPIES, POINTS_MOST);
    if (h.points > most.most)
        return errors_add(f->e, "%s: %lld vertices, expected at most %d%s", f->name, h.points, (int)most.most, most.by);
    if ((unsigned long long)h.points > f->size)
        return errors_add(f->e, "%s: %lld vertices in %zu bytes, expected a longer file", f->name, h.points, f->size);
    if (!points_make(f, h.columns, h.kind, (size_t)h.points))
        return false;
    const char *at = h.values;
    for (long long i = 0; i < h.points; i++) {
        const bool good = (h.encoding == ASCII ? read_text : read_bytes)(f, &h, &at);
        f->p->n++;
        if (!good && (f->e->count - before >= ERRORS_SHOWN || at >= f->text + f->size))
            return false;
        if (i % SHOW_EVERY == 0 && !progress_show(f->progress, "reading", (double)i / (double)h.points))
            return errors_add(f->e, "cancelled");
    }
    return f->e->count == before;
}
