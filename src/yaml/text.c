/* Lines and columns of a text, the excerpt that an error shows, and how a scalar's value maps to its written form. */
#include "yaml/text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- characters ---- */

static bool is_tail(char c) { return ((unsigned char)c & 0xc0) == 0x80; }

/* Bytes of the character at s: 0 where it is none, or is cut short. */
static size_t character(const char *s, size_t size)
{
    const unsigned char *c = (const unsigned char *)s;
    size_t n = c[0] < 0x80 ? 1 : c[0] < 0xc2 ? 0 : c[0] < 0xe0 ? 2 : c[0] < 0xf0 ? 3 : c[0] < 0xf5 ? 4 : 0;
    if (n == 0 || n > size)
        return 0;
    for (size_t k = 1; k < n; k++)
        if (!is_tail(s[k]))
            return 0;
    bool overlong = (c[0] == 0xe0 && c[1] < 0xa0) || (c[0] == 0xf0 && c[1] < 0x90);
    bool beyond = (c[0] == 0xed && c[1] >= 0xa0) || (c[0] == 0xf4 && c[1] >= 0x90);
    return overlong || beyond ? 0 : n;
}

size_t text_not_utf8(const char *text, size_t size)
{
    size_t at = 0, n;
    while (at < size && (n = character(text + at, size - at)) > 0)
        at += n;
    return at;
}

/* Copy at most `most` bytes into `room` bytes: whole characters only, control characters as '?'. */
static void copy_shown(char *to, size_t room, const char *from, size_t most)
{
    size_t at = 0, out = 0;
    while (at < most && from[at]) {
        size_t n = character(from + at, most - at);
        unsigned char c = (unsigned char)from[at], d = n == 2 ? (unsigned char)from[at + 1] : 0;
        if (out + (n ? n : 1) >= room)
            break;
        if (n > 1 && !(c == 0xc2 && d < 0xa0))
            memcpy(to + out, from + at, n);
        else
            to[out] = n == 1 && (c == '\t' || (c >= 0x20 && c != 0x7f)) ? from[at] : '?';
        out += n > 1 && !(c == 0xc2 && d < 0xa0) ? n : 1;
        at += n ? n : 1;
    }
    to[out] = 0;
}

/* ---- lines ---- */

/* Bytes of the line's end at s: 0, 1, or 2 for \r\n. */
static size_t line_end(const char *s) { return *s == '\r' ? 1 + (s[1] == '\n') : *s == '\n'; }

void text_place(const char *text, size_t at, int *line, int *column)
{
    *line = *column = 1;
    for (size_t k = 0; k < at && text[k]; k++)
        if (text[k] == '\n' || (text[k] == '\r' && text[k + 1] != '\n')) {
            ++*line;
            *column = 1;
        } else if (!is_tail(text[k]))
            ++*column;
}

bool text_error(errors *e, const char *name, const char *text, int line, int column, const char *message)
{
    enum { BEFORE = 60, SHOWN = 150, BYTES = 4 };
    char shown_message[1024], shown[SHOWN * BYTES + 1], blank[SHOWN + 1], excerpt[sizeof shown + sizeof blank + 32];
    const char *from = text;
    copy_shown(shown_message, sizeof shown_message, message, strlen(message));
    for (int k = 1; k < line; k++) {
        const char *next = from + strcspn(from, "\r\n");
        next += line_end(next);
        if (!*next) { /* behind the last line: at its end */
            line = k;
            column = 1;
            for (const char *c = from; *c && !line_end(c); c++)
                column += !is_tail(*c);
            break;
        }
        from = next;
    }
    const char *end = from + strcspn(from, "\r\n"), *caret = from;
    int before = 0, pad = 0;
    for (int k = 1; k < column && caret < end; k++, before++)
        for (caret++; is_tail(*caret);)
            caret++;
    for (; before > 2 * BEFORE; before--)
        for (from++; is_tail(*from);)
            from++;
    size_t length = 0;
    for (int k = 0; k < SHOWN && from + length < end; k++)
        for (length++; is_tail(from[length]);)
            length++;
    for (const char *c = from; c < caret; c++) /* a tab is as wide below as above */
        if (!is_tail(*c))
            blank[pad++] = *c == '\t' ? '\t' : ' ';
    blank[pad] = 0;
    copy_shown(shown, sizeof shown, from, length);
    snprintf(excerpt, sizeof excerpt, "\n%5d | %s\n      | %s^", line, shown, blank);
    return errors_add_at(e, name, line, column, shown_message, excerpt);
}

/* ---- scalars ---- */

/* The length of an escape at s in double quotes. *made: the bytes of UTF-8 that it stands for. */
static size_t escape(const char *s, size_t *made)
{
    const char c = s[1];
    char digits[9] = "";
    if (line_end(s + 1)) { /* a line continued */
        *made = 0;
        size_t n = 1 + line_end(s + 1);
        return n + strspn(s + n, " \t");
    }
    size_t n = c == 'x' ? 2 : c == 'u' ? 4 : c == 'U' ? 8 : 0;
    for (size_t k = 0; k < n && s[2 + k]; k++)
        digits[k] = s[2 + k];
    unsigned long code = strtoul(digits, NULL, 16);
    *made = c == 'N' || c == '_'   ? 2
            : c == 'L' || c == 'P' ? 3
            : code < 0x80          ? 1
            : code < 0x800         ? 2
            : code < 0x10000       ? 3
                                   : 4;
    return c ? 2 + strlen(digits) : 1;
}

/* The length of a run of blanks and line ends. *made: the bytes of its value, where YAML folds lines. */
static size_t fold(const char *s, size_t *made)
{
    size_t n = strspn(s, " \t"), lines = 0;
    *made = n;
    for (size_t end; (end = line_end(s + n)); lines++) {
        n += end;
        n += strspn(s + n, " \t");
    }
    if (lines)
        *made = lines > 1 ? lines - 1 : 1;
    return n;
}

static size_t flow_offset(const char *text, size_t at, scalar_style style, size_t offset)
{
    while (offset > 0 && text[at]) {
        size_t made = 1, n = 1;
        if (strchr(" \t\r\n", text[at])) {
            n = fold(text + at, &made);
            if (made == n && offset < n) /* blanks within a line */
                return at + offset;
        } else if (style == SCALAR_DOUBLE && text[at] == '\\')
            n = escape(text + at, &made);
        else if (style == SCALAR_SINGLE && text[at] == '\'' && text[at + 1] == '\'')
            n = 2;
        at += n;
        offset -= made < offset ? made : offset;
    }
    if (style == SCALAR_DOUBLE && text[at] == '\\' && line_end(text + at + 1)) {
        size_t made;
        at += escape(text + at, &made);
    }
    return at;
}

static size_t block_offset(const char *text, size_t at, scalar_style style, size_t offset)
{
    while (at > 0 && !line_end(text + at - 1))
        at--;
    const char *first = text + at + strspn(text + at, " \r\n");
    size_t indent = 0;
    while (first - indent > text + at && first[-1 - (ptrdiff_t)indent] == ' ')
        indent++;
    while (text[at]) {
        size_t blanks = strspn(text + at, " ");
        at += blanks < indent ? blanks : indent;
        size_t length = strcspn(text + at, "\r\n");
        if (offset <= length)
            return at + offset;
        offset -= length;
        at += length;
        size_t made = 1, n = style == SCALAR_FOLDED ? fold(text + at, &made) : line_end(text + at);
        if (style == SCALAR_FOLDED)
            while (n > 1 && (text[at + n - 1] == ' ' || text[at + n - 1] == '\t')) /* the next line's indentation */
                n--;
        at += n;
        if (offset <= made && !text[at])
            return at;
        offset -= made < offset ? made : offset;
    }
    return at;
}

size_t text_offset(const char *text, size_t start, scalar_style style, size_t offset)
{
    return style == SCALAR_LITERAL || style == SCALAR_FOLDED ? block_offset(text, start, style, offset)
                                                             : flow_offset(text, start, style, offset);
}
