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

/* Where one message stands in errors.text, and the place in a file that it is about. */
typedef struct error_item {
    size_t start, end; /* of the whole message, without the newline at its end */
    size_t file;       /* bytes of the file's name, with which the message begins; 0: it is about no place in a file */
    int line, column;  /* from 1 */
    size_t what;       /* bytes of `file:line:column: `, before what is wrong */
} error_item;

/* Zero-initialise; errors_free when done. */
typedef struct errors {
    char *text;  /* all messages, each ended by a newline; NULL: none */
    size_t size; /* bytes in text, without the final 0 */
    int count;   /* messages, those not in text with them */
    int items;   /* messages in text */
    error_item item[ERRORS_SHOWN];
} errors;

/* Add one message, formatted as by printf, with no newline at its end. Messages may hold several
 * lines. Always returns false, so that a function can end with `return errors_add(...)`. */
bool errors_add(errors *e, const char *fmt, ...) KAGE_PRINTF(2, 3);

/* Add `file:line:column: what`, and behind it, as printf would write it, what shows the place. Always false. */
bool errors_add_at(errors *e, const char *file, int line, int column, const char *what, const char *fmt, ...)
    KAGE_PRINTF(6, 7);

void errors_free(errors *e);

#endif
