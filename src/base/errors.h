/* Errors are values: functions that can fail on a user's input add messages to a list and return false or NULL.
 * Nothing in the library prints or exits.
 */
#ifndef KAGE_BASE_ERRORS_H
#define KAGE_BASE_ERRORS_H

#include <stdbool.h>
#include <stddef.h>

#if defined(__GNUC__)
#define KAGE_PRINTF(fmt, first) __attribute__((format(printf, fmt, first)))
#else
#define KAGE_PRINTF(fmt, first)
#endif

enum { ERRORS_SHOWN = 50 }; /* more than that are only counted */

/* A message in errors.text, and the place in a file that it points to. */
typedef struct error_item {
    size_t start, end; /* bytes in errors.text, without the newline */
    size_t file;       /* length of the file's name at the start of the message; 0: the message has no place */
    int line, column;  /* from 1 */
    size_t what;       /* length of `file:line:column: ` */
} error_item;

/* Zero-initialise; errors_free when done. Not for several threads at once. */
typedef struct errors {
    char *text;  /* all messages, each ended by a newline; NULL: none */
    size_t size; /* bytes in text, without the final 0 */
    int count;   /* messages, including those that are not in text */
    int items;   /* messages in text */
    error_item item[ERRORS_SHOWN];
} errors;

/* Add a message, formatted as by printf, of one or several lines, without a newline at its end. Always returns false,
 * so that a function can end with `return errors_add(...)`. */
bool errors_add(errors *e, const char *fmt, ...) KAGE_PRINTF(2, 3);

/* Add `file:line:column: what` and the lines that show the place. Always false. */
bool errors_add_at(errors *e, const char *file, int line, int column, const char *what, const char *excerpt);

void errors_free(errors *e);

#endif
