/* Breaks texts into lines of a terminal's width. */
#include "cli/command.h"

#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

int terminal_columns(FILE *to)
{
    struct winsize size;
    if (!isatty(fileno(to)))
        return 0;
    return ioctl(fileno(to), TIOCGWINSZ, &size) == 0 && size.ws_col >= 20 ? size.ws_col : COLUMNS;
}

/* Of a text in UTF-8. */
static int columns_of(const char *text, size_t size)
{
    int n = 0;
    for (size_t k = 0; k < size; k++)
        n += ((unsigned char)text[k] & 0xc0) != 0x80;
    return n;
}

void print_wrapped(FILE *to, int at, int indent, int width, const char *text)
{
    bool first = true; /* of its line */
    while (*text) {
        const size_t spaces = strspn(text, " "), n = strcspn(text + spaces, " ");
        const int more = columns_of(text + spaces, n);
        if (!first && width && at + (int)spaces + more > width) {
            fprintf(to, "\n%*s", indent, "");
            at = indent;
        } else {
            fprintf(to, "%.*s", (int)spaces, text);
            at += (int)spaces;
        }
        fprintf(to, "%.*s", (int)n, text + spaces);
        at += more;
        text += spaces + n;
        first = false;
    }
    fputs("\n", to);
}

void print_message(const char *message)
{
    enum { INDENT = 4, LONGEST = 4096 };
    char first[LONGEST];
    const size_t n = strcspn(message, "\n");
    snprintf(first, sizeof first, "%.*s", (int)n, message);
    if (n < sizeof first)
        print_wrapped(stderr, 0, INDENT, terminal_columns(stderr), first);
    else
        fprintf(stderr, "%.*s\n", (int)n, message);
    if (message[n])
        fprintf(stderr, "%s\n", message + n + 1);
}
