/* Lists of points as text: a line of names, then a line for each point. */
#include "points/parts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/spelling.h"

enum { FIELDS = 256, SHOWN = 40, SHOW_EVERY = 1 << 16 };

/* Names, and what separates fields; ' ': any spaces and tabs. */
typedef struct head {
    int columns, kind[FIELDS];
    char between;
} head;

static const char *spaces(const char *at) { return at + strspn(at, " \t"); }

static const char *line_end(const char *at) { return at + strcspn(at, "\r\n"); }

static const char *next_line(const char *at)
{
    at = line_end(at);
    at += *at == '\r' && at[1] == '\n' ? 2 : *at != 0;
    return at;
}

/* Whether the line at `at` has no point. */
static bool is_empty(const char *at)
{
    at = spaces(at);
    return *at == '#' || *at == '\r' || *at == '\n' || !*at;
}

/* Where a text in quotes ends, behind them; two quotes in it are one. NULL: the field is no such text. */
static const char *behind_quotes(const char *at, const char *stop)
{
    if (*at != '"')
        return NULL;
    for (at++; *at != '"' || at[1] == '"'; at++) {
        at += *at == '"';
        if (!*at || *at == '\r' || *at == '\n')
            return NULL;
    }
    at++;
    return strchr(stop, *at) || strchr(stop, at[strspn(at, " ")]) ? at : NULL; /* 0 is in it, too */
}

/* A field: its text without quotes and outer spaces, and where the next one begins. NULL: it was the last. */
static const char *field(const char *at, char between, const char **text, size_t *length)
{
    at = between == '\t' ? at + strspn(at, " ") : spaces(at);
    const char stop[] = {'\r', '\n', between, between == ' ' ? '\t' : 0, 0};
    const char *end;
    const char *quoted = behind_quotes(at, stop);
    if (quoted) {
        *text = at + 1;
        *length = (size_t)(quoted - at) - 2;
        end = quoted + strcspn(quoted, stop);
    } else {
        *text = at;
        end = at + strcspn(at, stop);
        *length = (size_t)(end - at);
        while (*length > 0 && (at[*length - 1] == ' ' || at[*length - 1] == '\t'))
            --*length;
    }
    if (between == ' ')
        end = spaces(end);
    if (!*end || *end == '\r' || *end == '\n')
        return NULL;
    return between == ' ' ? end : end + 1;
}

/* ---- the names ---- */

static bool name_column(const points_file *f, const char *text, size_t length, head *h)
{
    char message[256], name[SPELLING_LONGEST + 1], near[64], known[256];
    const int kind = points_find(f, text, length);
    for (int k = 0; kind != POINTS_NOTHING && k < h->columns; k++)
        if (h->kind[k] == kind) {
            snprintf(message, sizeof message, "a second '%.*s', expected each column once", (int)length, text);
            return points_wrong_at(f, text, message);
        }
    h->kind[h->columns++] = kind;
    if (kind != POINTS_NOTHING || length < 3 || length > SPELLING_LONGEST)
        return true;
    snprintf(known, sizeof known, "%s", f->label);
    for (int k = 0; f->column[k].name; k++)
        if (strlen(f->column[k].name) > 2)
            strncat(strncat(known, " ", sizeof known - strlen(known) - 1), f->column[k].name,
                    sizeof known - strlen(known) - 1);
    snprintf(name, sizeof name, "%.*s", (int)length, text);
    spelling_nearest(name, known, near, sizeof near);
    if (!*near)
        return true; /* some other program's */
    snprintf(message, sizeof message, "unknown column '%s', did you mean '%s'?", name, near);
    return points_wrong_at(f, text, message);
}

/* Where the line of names begins. */
static const char *first_line(const char *at)
{
    at += strncmp(at, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
    while (*at && spaces(at) == line_end(at))
        at = next_line(at);
    at = spaces(at);
    return *at == '#' ? spaces(at + 1) : at;
}

static bool read_head(const points_file *f, const char *at, head *h)
{
    const size_t length = (size_t)(line_end(at) - at);
    char message[256];
    bool good = true;
    h->columns = 0;
    h->between = memchr(at, ',', length) ? ',' : memchr(at, ';', length) ? ';' : memchr(at, '\t', length) ? '\t' : ' ';
    for (const char *next = at; next;) {
        const char *text;
        size_t n;
        if (h->columns == FIELDS)
            return points_wrong_at(f, next, "more than 256 columns, expected no more");
        next = field(next, h->between, &text, &n);
        good = name_column(f, text, n, h) && good;
    }
    for (int k = 0; good && f->column[k].name; k++) {
        bool there = !f->column[k].needed;
        for (int c = 0; c < h->columns; c++)
            there = there || h->kind[c] == k;
        if (!there) {
            snprintf(message, sizeof message, "no column '%s' in the first line, expected the columns' names there",
                     f->column[k].name);
            good = points_wrong_at(f, at, message);
        }
    }
    return good;
}

/* ---- the points ---- */

static bool read_number(const points_file *f, int kind, const char *text, size_t length, double *x)
{
    const points_column *c = &f->column[kind];
    const char *end = text;
    char message[256];
    if (points_number(&end, x) && end == text + length) {
        points_check(c, *x, message);
        return !*message || points_wrong_at(f, text, message);
    }
    if (length == 0)
        snprintf(message, sizeof message, "no value for %s, expected %s", c->name, c->expected);
    else
        snprintf(message, sizeof message, "'%.*s' is no number, expected %s", (int)(length < SHOWN ? length : SHOWN),
                 text, c->expected);
    return points_wrong_at(f, text, message);
}

static bool read_label(const points_file *f, const char *text, size_t length, int32_t row)
{
    const int32_t k = points_label(f->p, text, length, row);
    f->p->label[row] = k;
    return k > -2 || points_wrong_at(f, text, "a name of more than 63 letters, or more than 256 names");
}

static bool read_row(const points_file *f, const head *h, const char *at)
{
    const int32_t row = f->p->n;
    char message[256];
    const char *text = at;
    size_t length;
    for (int k = 0; k < h->columns; k++) {
        if (!at) {
            snprintf(message, sizeof message, "%d value%s in this line, expected %d, as in the first line", k,
                     k == 1 ? "" : "s", h->columns);
            return points_wrong_at(f, text, message);
        }
        const int kind = h->kind[k];
        at = field(at, h->between, &text, &length);
        if (kind >= 0 && !read_number(f, kind, text, length, &f->p->v[kind][row]))
            return false;
        if (kind == POINTS_LABEL && !read_label(f, text, length, row))
            return false;
    }
    if (!at)
        return true;
    snprintf(message, sizeof message, "more values in this line, expected %d, as in the first line", h->columns);
    return points_wrong_at(f, at, message);
}

static size_t count_lines(const char *at)
{
    size_t n = 1;
    for (; (at = strpbrk(at, "\r\n")); at++)
        n++;
    return n;
}

static bool too_many(const points_file *f, const char *at, cap rows)
{
    char message[128];
    snprintf(message, sizeof message, "too many points, expected at most %d%s", (int)rows.most, rows.by);
    return points_wrong_at(f, at, message);
}

bool points_csv(points_file *f)
{
    points *p = f->p;
    head h;
    const int before = f->e->count;
    if (memchr(f->text, 0, f->size))
        return errors_add(f->e, "%s: bytes of 0, expected text: a CSV file, or a PLY file", f->name);
    const char *at = first_line(f->text);
    const size_t most = count_lines(at);
    if (!read_head(f, at, &h) || !points_make(f, h.columns, h.kind, most))
        return false;
    if (!(p->line = memory_new(progress_memory(f->progress), sizeof *p->line * most)))
        return points_no_memory(f);
    const cap rows = progress_limit(f->progress, LIMIT_COPIES, POINTS_MOST);
    int32_t line = 1;
    for (const char *k = f->text; k < at; k = next_line(k))
        line += next_line(k) <= at;
    for (at = next_line(at), line++; *at; at = next_line(at), line++) {
        if (is_empty(at))
            continue;
        if (p->n == rows.most)
            return too_many(f, at, rows);
        p->line[p->n] = line;
        if (read_row(f, &h, at))
            p->n++;
        else if (f->e->count - before >= ERRORS_SHOWN)
            return false;
        if (p->n % SHOW_EVERY == 0 && !progress_show(f->progress, "reading", (double)(at - f->text) / (double)f->size))
            return errors_add(f->e, "cancelled");
    }
    return f->e->count == before;
}
