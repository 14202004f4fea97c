/* Errors are values: functions that can fail on a user's input add messages to a list and return false
 * or NULL. Nothing in the library prints or exits; main.c does.
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

/* Zero-initialise; errors_free when done. */
typedef struct errors {
    char *text;  /* all messages, each ended by a newline; NULL: none */
    size_t size; /* bytes in text, without the final 0 */
    int count;   /* messages, those not in text with them */
} errors;

/* Add one message, formatted as by printf, with no newline at its end. Messages may hold several
 * lines. Always returns false, so that a function can end with `return errors_add(...)`. */
bool errors_add(errors *e, const char *fmt, ...) KAGE_PRINTF(2, 3);

void errors_free(errors *e);

#endif
