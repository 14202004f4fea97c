/* What both kinds of files have: columns, numbers, labels, errors. */
#include "points/parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "yaml/text.h"

/* ---- columns and rows ---- */

static bool is(const char *name, size_t length, const char *text)
{
    return strlen(text) == length && strncasecmp(text, name, length) == 0;
}

int points_find(const points_file *f, const char *name, size_t length)
{
    if (is(name, length, f->label))
        return POINTS_LABEL;
    for (int k = 0; f->column[k].name; k++)
        if (is(name, length, f->column[k].name))
            return k;
    return POINTS_NOTHING;
}

bool points_no_memory(const points_file *f)
{
    char words[MEMORY_WORDS];
    return errors_add(f->e, "%s: %s", f->name, memory_words(progress_memory(f->progress), words));
}

bool points_make(points_file *f, int columns, const int *kind, size_t n)
{
    points *p = f->p;
    memory *m = progress_memory(f->progress);
    bool good = true;
    if (n > INT32_MAX)
        return errors_add(f->e, "%s: %zu rows, expected at most %d", f->name, n, INT32_MAX);
    n += n == 0;
    for (int k = 0; k < columns; k++)
        if (kind[k] == POINTS_LABEL)
            good = good && (p->label = memory_new(m, sizeof *p->label * n));
        else if (kind[k] >= 0)
            good = good && (p->v[kind[k]] = memory_new(m, sizeof **p->v * n));
    return good || points_no_memory(f);
}

/* ---- values ---- */

/* The powers of ten that double has exactly. */
static const double ten[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                             1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
enum { TENS = 22, DIGITS = 15 };

/* A number of at most 15 digits and a small power of ten is exact by one product or quotient [Clinger 1990]; strtod
 * reads others, ten times as slowly. */
bool points_number(const char **at, double *x)
{
    const char *s = *at;
    const bool minus = *s == '-';
    uint64_t whole = 0;
    int digits = 0, power = 0, any = 0;
    s += *s == '-' || *s == '+';
    for (; *s >= '0' && *s <= '9'; s++, any++) {
        whole = digits < DIGITS ? 10 * whole + (uint64_t)(*s - '0') : whole;
        digits += whole > 0 || digits > 0;
    }
    if (*s == '.')
        for (s++; *s >= '0' && *s <= '9'; s++, any++) {
            whole = digits < DIGITS ? 10 * whole + (uint64_t)(*s - '0') : whole;
            digits += whole > 0 || digits > 0;
            power--;
        }
    if (!any)
        return false;
    if (*s == 'e' || *s == 'E') {
        const char *first = s + 1 + (s[1] == '-' || s[1] == '+');
        if (!(*first >= '0' && *first <= '9'))
            return false;
        char *end;
        const long e = strtol(s + 1, &end, 10);
        s = end;
        power += e > -1000 && e < 1000 ? (int)e : 1000;
    }
    if (digits <= DIGITS && power >= -TENS && power <= TENS) {
        const double v = power < 0 ? (double)whole / ten[-power] : (double)whole * ten[power];
        *x = minus ? -v : v;
    } else
        *x = strtod(*at, NULL);
    *at = s;
    return true;
}

void points_check(const points_column *c, double x, char message[256])
{
    *message = 0;
    if (!(x >= c->lo && x <= c->hi))
        snprintf(message, 256, "%s is %.7g, expected %s", c->name, x, c->expected);
}

int32_t points_label(points *p, const char *text, size_t length, int32_t row)
{
    if (length == 0)
        return -1;
    for (int k = p->labels - 1; k >= 0; k--)
        if (strncmp(p->name[k], text, length) == 0 && !p->name[k][length])
            return k;
    if (p->labels == POINTS_LABELS || length >= POINTS_LABEL_SIZE)
        return -2;
    memcpy(p->name[p->labels], text, length);
    p->name[p->labels][length] = 0;
    p->first[p->labels] = row;
    return p->labels++;
}

/* ---- errors ---- */

bool points_wrong_at(const points_file *f, const char *at, const char *message)
{
    int line, column;
    text_place(f->text, (size_t)(at - f->text), &line, &column);
    return text_error(f->e, f->name, f->text, line, column, message);
}
